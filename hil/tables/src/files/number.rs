//! Numbers in the representation of file formats: their sizes, and their values.

/// A number as messages have it: in at most 24 signs.
pub(super) fn shown(value: f64) -> String {
    match value.abs() {
        size if size > 0.0 && size.is_finite() && !(1e-5..1e15).contains(&size) => {
            format!("{value:e}")
        }
        _ => value.to_string(),
    }
}

/// A type of number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
}

impl Kind {
    /// Integer type of this many bytes.
    pub fn integer(bytes: usize, is_signed: bool) -> Option<Self> {
        Some(match (bytes, is_signed) {
            (1, true) => Self::I8,
            (1, false) => Self::U8,
            (2, true) => Self::I16,
            (2, false) => Self::U16,
            (4, true) => Self::I32,
            (4, false) => Self::U32,
            (8, true) => Self::I64,
            (8, false) => Self::U64,
            _ => return None,
        })
    }

    /// Float type of this many bytes.
    pub fn float(bytes: usize) -> Option<Self> {
        match bytes {
            2 => Some(Self::F16),
            4 => Some(Self::F32),
            8 => Some(Self::F64),
            _ => None,
        }
    }

    /// Its size in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number at a position in some bytes; NaN if they end before it does.
    pub fn read(self, bytes: &[u8], at: usize, is_little: bool) -> f64 {
        let mut number = f64::NAN;
        self.read_each(bytes, std::iter::once(at), is_little, |read| number = read);
        number
    }

    /// Gives the number at each of some positions, as `read` does. The type is looked at once for all of them.
    pub fn read_each(
        self,
        bytes: &[u8],
        places: impl Iterator<Item = usize>,
        is_little: bool,
        take: impl FnMut(f64),
    ) {
        macro_rules! each {
            ($of:ty, $to:expr) => {
                each(
                    bytes,
                    places,
                    is_little,
                    |cell| $to(<$of>::from_le_bytes(cell)),
                    take,
                )
            };
        }
        match self {
            Self::I8 => each!(i8, f64::from),
            Self::U8 => each!(u8, f64::from),
            Self::I16 => each!(i16, f64::from),
            Self::U16 => each!(u16, f64::from),
            Self::I32 => each!(i32, f64::from),
            Self::U32 => each!(u32, f64::from),
            Self::I64 => each!(i64, |number| number as f64),
            Self::U64 => each!(u64, |number| number as f64),
            Self::F16 => each!(u16, half),
            Self::F32 => each!(f32, f64::from),
            Self::F64 => each!(f64, f64::from),
        }
    }
}

fn each<const SIZE: usize>(
    bytes: &[u8],
    places: impl Iterator<Item = usize>,
    is_little: bool,
    of: impl Fn([u8; SIZE]) -> f64,
    mut take: impl FnMut(f64),
) {
    for at in places {
        let cell = bytes.get(at..).and_then(|rest| rest.first_chunk::<SIZE>());
        take(cell.map_or(f64::NAN, |&cell| {
            let mut cell = cell;
            if !is_little {
                cell.reverse();
            }
            of(cell)
        }));
    }
}

/// A float of IEEE 754's binary16.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    sign * match (exponent, bits & 0x3ff) {
        (0, _) => fraction * 2_f64.powi(-24),
        (31, 0) => f64::INFINITY,
        (31, _) => f64::NAN,
        _ => (1024.0 + fraction) * 2_f64.powi(exponent - 25),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_in_both_orders() {
        assert_eq!(Kind::I16.read(&[0xfe, 0xff], 0, true), -2.0);
        assert_eq!(Kind::I16.read(&[0xff, 0xfe], 0, false), -2.0);
        assert_eq!(Kind::U32.read(&[9, 0, 0, 1, 0], 1, false), 256.0);
        assert_eq!(Kind::F64.read(&1.5_f64.to_be_bytes(), 0, false), 1.5);
        assert!(Kind::F32.read(&[0; 3], 0, true).is_nan());
        // IEEE 754-2008: one, the largest, the smallest, and minus two.
        for (bits, is) in [
            (0x3c00_u16, 1.0),
            (0x7bff, 65504.0),
            (1, 2_f64.powi(-24)),
            (0xc000, -2.0),
        ] {
            assert_eq!(Kind::F16.read(&bits.to_le_bytes(), 0, true), is);
        }
    }
}

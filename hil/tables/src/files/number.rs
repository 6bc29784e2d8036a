//! Numbers in the representation of file formats: their sizes, and their values.

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
        let size = self.size();
        let Some(cell) = bytes.get(at..at.saturating_add(size)) else {
            return f64::NAN;
        };
        let mut word = [0; 8];
        word[..size].copy_from_slice(cell);
        if !is_little {
            word[..size].reverse();
        }
        let word = u64::from_le_bytes(word);
        match self {
            Self::I8 => f64::from(word as i8),
            Self::U8 => f64::from(word as u8),
            Self::I16 => f64::from(word as i16),
            Self::U16 => f64::from(word as u16),
            Self::I32 => f64::from(word as i32),
            Self::U32 => f64::from(word as u32),
            Self::I64 => word as i64 as f64,
            Self::U64 => word as f64,
            Self::F16 => half(word as u16),
            Self::F32 => f64::from(f32::from_bits(word as u32)),
            Self::F64 => f64::from_bits(word),
        }
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

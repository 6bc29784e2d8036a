//! The bits of a record that are a value.

use falcon_mdf::blocks::{CnBlock, DataType};
use falcon_mdf::parser::binary::{read_int, read_uint};

use crate::files::number::Kind;

/// A number in each record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field {
    /// Its first byte in the record.
    pub at: usize,
    bit: u8,
    bits: u32,
    of: DataType,
    /// Its type, if it is whole bytes.
    kind: Option<Kind>,
}

impl Field {
    /// The field that a block describes.
    pub fn of(block: &CnBlock) -> Self {
        Self::new(
            block.byte_offset as usize,
            block.bit_offset,
            block.bit_count,
            block.data_type,
        )
    }

    pub fn new(at: usize, bit: u8, bits: u32, of: DataType) -> Self {
        let bytes = bits as usize / 8;
        let kind = match of {
            DataType::FloatLe | DataType::FloatBe => Kind::float(bytes),
            DataType::IntLe | DataType::IntBe => Kind::integer(bytes, true),
            DataType::UIntLe | DataType::UIntBe => Kind::integer(bytes, false),
            _ => None,
        };
        let is_whole = bit == 0 && bits.is_multiple_of(8);
        Self {
            at,
            bit,
            bits,
            of,
            kind: kind.filter(|_| is_whole),
        }
    }

    /// The same type elsewhere in a record.
    pub fn moved_to(self, at: usize) -> Self {
        Self { at, ..self }
    }

    /// Bytes that it touches.
    pub fn width(&self) -> usize {
        (usize::from(self.bit) + self.bits as usize).div_ceil(8)
    }

    pub fn is_float(&self) -> bool {
        self.of.is_float()
    }

    /// Why it is no number that is read, if it is none.
    pub fn unread(&self) -> Option<&'static str> {
        match self.of {
            of if of.is_string() => Some("texts"),
            DataType::ComplexLe | DataType::ComplexBe => Some("complex numbers"),
            DataType::CaNopenDate | DataType::CaNopenTime => Some("dates"),
            of if !of.is_numeric() => Some("bytes"),
            _ if self.bits == 0 || self.bits > 64 || self.bit > 7 => Some("numbers of other bits"),
            of if of.is_float() && self.kind.is_none() => Some("floats of other bits"),
            _ => None,
        }
    }

    /// The number in the record that begins at `start`.
    pub fn read(&self, bytes: &[u8], start: usize) -> f64 {
        let mut number = f64::NAN;
        self.read_each(bytes, std::iter::once(start), |read| number = read);
        number
    }

    /// Gives the number in each of the records that begin at `starts`.
    pub fn read_each(
        &self,
        bytes: &[u8],
        starts: impl Iterator<Item = usize>,
        mut take: impl FnMut(f64),
    ) {
        let Self { bit, bits, .. } = *self;
        let is_little = self.of.is_little_endian();
        let places = starts.map(|start| start + self.at);
        match self.kind {
            Some(kind) => kind.read_each(bytes, places, is_little, take),
            None if self.of.is_signed() => {
                places.for_each(|at| take(read_int(bytes, at, bit, bits, is_little) as f64));
            }
            None => places.for_each(|at| take(read_uint(bytes, at, bit, bits, is_little) as f64)),
        }
    }

    /// The text in the record that begins at `start`, up to its first zero.
    pub fn text(&self, bytes: &[u8], start: usize) -> String {
        let at = start + self.at;
        let text = bytes.get(at..at + self.width()).unwrap_or_default();
        let until_zero = || text.iter().take_while(|&&byte| byte != 0);
        let wide = |of: fn([u8; 2]) -> u16| {
            let codes = text.chunks_exact(2).map(|pair| of([pair[0], pair[1]]));
            let codes: Vec<u16> = codes.take_while(|&code| code != 0).collect();
            String::from_utf16_lossy(&codes)
        };
        match self.of {
            DataType::StringUtf16Le => wide(u16::from_le_bytes),
            DataType::StringUtf16Be => wide(u16::from_be_bytes),
            DataType::StringSbc => until_zero().map(|&byte| char::from(byte)).collect(),
            _ => String::from_utf8_lossy(&text[..until_zero().count()]).into_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_from_their_bits() {
        let bytes = [0xff, 0b1010_1100, 0x01, 0x3c, 0, 0, 0, 0, 0xff];
        let read = |at, bit, bits, of| Field::new(at, bit, bits, of).read(&bytes, 1);
        assert_eq!(read(0, 2, 4, DataType::UIntLe), 11.0);
        assert_eq!(read(0, 2, 4, DataType::IntLe), -5.0);
        assert_eq!(read(0, 0, 12, DataType::UIntLe), 428.0);
        assert_eq!(read(0, 0, 16, DataType::UIntBe), 44033.0);
        // IEEE 754-2008: one.
        let half = Field::new(2, 0, 16, DataType::FloatLe);
        assert_eq!(half.read(&[0, 0, 0, 0x3c], 0), 1.0);
        for (bits, bit, of, why) in [
            (24, 0, DataType::FloatLe, Some("floats of other bits")),
            (65, 0, DataType::UIntLe, Some("numbers of other bits")),
            (8, 8, DataType::UIntLe, Some("numbers of other bits")),
            (8, 0, DataType::StringUtf8, Some("texts")),
            (64, 0, DataType::ByteArray, Some("bytes")),
            (24, 0, DataType::IntBe, None),
        ] {
            assert_eq!(Field::new(0, bit, bits, of).unread(), why, "{of:?}");
        }
    }

    #[test]
    fn a_text_ends_with_its_first_zero() {
        let text = |bytes: &[u8], of| Field::new(1, 0, 32, of).text(bytes, 0);
        assert_eq!(text(b"-on\0f", DataType::StringUtf8), "on");
        assert_eq!(text(b"-\xb5m\0\0", DataType::StringSbc), "µm");
        assert_eq!(text(b"-o\0n\0", DataType::StringUtf16Le), "on");
        assert_eq!(text(b"-\0o\0n", DataType::StringUtf16Be), "on");
        assert_eq!(text(b"-o", DataType::StringUtf8), "");
    }
}

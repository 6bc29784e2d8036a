//! A residual table in a coefficient pack: its numbers, four bytes each, and its cells in postcard's layout of a `Vec<u8>`.

use super::memory::MemoryKind;
use super::{CELLS, ResidualTable};
use crate::error::ConfigError;
use crate::frame::{Reader, Writer};

impl ResidualTable<f32> {
    /// Writes numbers and cells.
    pub(crate) fn pack(&self, writer: &mut Writer<'_>) {
        let recall = &self.recall;
        for number in [
            self.per_displacement,
            self.per_speed,
            self.unit,
            recall.rate,
        ] {
            writer.f32(number);
        }
        writer.u8(recall.kind as u8);
        for number in [recall.step, UNUSED, recall.origin, recall.gain] {
            writer.u32(number as u32);
        }
        for byte in LENGTH {
            writer.u8(byte);
        }
        for cell in &self.cells {
            writer.u16(*cell as u16);
        }
    }

    /// Reads into `self` the part that [`Self::pack`] wrote before the cells; `None` if it is not a residual table. Its numbers are
    /// not checked yet.
    ///
    /// # Errors
    /// [`ConfigError::Removed`]
    pub(crate) fn unpack_head(
        &mut self,
        reader: &mut Reader<'_>,
    ) -> Option<Result<(), ConfigError>> {
        let recall = &mut self.recall;
        for number in [
            &mut self.per_displacement,
            &mut self.per_speed,
            &mut self.unit,
            &mut recall.rate,
        ] {
            *number = reader.f32()?;
        }
        recall.kind = match MemoryKind::of_number(reader.u8()?)? {
            Ok(kind) => kind,
            Err(removed) => return Some(Err(removed)),
        };
        let mut unused = UNUSED;
        for number in [
            &mut recall.step,
            &mut unused,
            &mut recall.origin,
            &mut recall.gain,
        ] {
            *number = reader.u32()? as i32;
        }
        if unused != UNUSED {
            return None;
        }
        for byte in LENGTH {
            if reader.u8()? != byte {
                return None;
            }
        }
        Some(Ok(()))
    }

    /// Reads the cells from index `from` to before index `to`. Returns whether these were the last. `None` if they are not all
    /// there.
    pub(crate) fn unpack_cells(
        &mut self,
        reader: &mut Reader<'_>,
        from: usize,
        to: usize,
    ) -> Option<bool> {
        let cells = self.cells.len();
        for cell in self.cells.get_mut(from..to.min(cells))? {
            *cell = reader.u16()? as i16;
        }
        Some(to >= cells)
    }
}

/// In place of a number of the table over acceleration, which was removed.
const UNUSED: i32 = 0;

/// Bytes of a table in a pack: numbers, kind, numbers, length, cells.
pub(crate) const LARGEST_TABLE: usize = 4 * 4 + 1 + 4 * 4 + LENGTH.len() + 2 * CELLS;

/// The number of bytes of the cells, as postcard writes a length of 128…16383.
const LENGTH: [u8; 2] = {
    let bytes = 2 * CELLS;
    [bytes as u8 | 0x80, (bytes >> 7) as u8]
};

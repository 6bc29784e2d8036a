//! Channels with several values in each record, which are split into columns.

use falcon_mdf::blocks::{CaBlock, CaStorage, CnBlock};

use super::blocks::Blocks;
use super::field::Field;
use crate::files::refused::Refused;

const PART: &str = "the arrays of its channels";

/// The elements of a channel's array.
#[derive(Debug)]
pub(super) struct Elements {
    /// The first of them.
    pub field: Field,
    /// Arrays in arrays, the outermost first.
    levels: Vec<Level>,
    /// Links to the groups of channels, or of data, that have one of them each; none if they lie in the channel's own record.
    pub groups: Vec<u64>,
    /// The number of elements that a record really has.
    pub count_of: Option<Field>,
}

#[derive(Debug)]
struct Level {
    sizes: Vec<u64>,
    /// Bytes from one element to the next.
    step: usize,
    /// Whether the first dimension is the fastest.
    is_inverse: bool,
}

impl Level {
    fn of(block: &CaBlock, width: usize) -> Self {
        Self {
            // A size of one moves nothing.
            sizes: (block.ca_dim_size.iter().copied())
                .filter(|&size| size != 1)
                .collect(),
            step: usize::try_from(block.ca_byte_offset_base)
                .ok()
                .filter(|&step| step > 0)
                .unwrap_or(width),
            is_inverse: block.flags.inverse_layout && block.ca_ndim > 1,
        }
    }

    fn count(&self) -> u64 {
        self.sizes
            .iter()
            .fold(1, |all: u64, &size| all.saturating_mul(size))
    }

    /// Where an element is stored, counted in elements.
    fn place(&self, element: u64) -> u64 {
        if !self.is_inverse {
            return element;
        }
        let mut rest = element;
        let mut place = 0_u64;
        let mut steps: Vec<u64> = Vec::new();
        let mut step = 1_u64;
        for &size in &self.sizes {
            steps.push(step);
            step = step.saturating_mul(size);
        }
        for (&size, step) in self.sizes.iter().zip(steps).rev() {
            let size = size.max(1);
            place = place.saturating_add((rest % size).saturating_mul(step));
            rest /= size;
        }
        place
    }
}

impl Elements {
    /// The array that the block at a link describes, of the channel `parent` in the group of data and the group of channels at two
    /// links; or why it is not read.
    pub fn at(
        blocks: &Blocks,
        link: u64,
        parent: &Field,
        around: [u64; 2],
    ) -> Result<Result<Self, &'static str>, Refused> {
        let block: CaBlock = blocks.block(link)?;
        let size = 8 * (block.ca_dim_size.len() + block.ca_data.len()) + size_of::<Self>();
        blocks.budget.hold(2 * size as u64, PART)?;
        let count_of = match block.flags.dynamic_size {
            false => None,
            true => {
                let found = match block.ca_dynamic_size[..] {
                    [of] if block.ca_ndim == 1 => [of.dg, of.cg] == around && of.cn != 0,
                    _ => false,
                };
                if !found || block.ca_storage != CaStorage::CnTemplate {
                    return Ok(Err("arrays whose size is not in their record"));
                }
                let of: CnBlock = blocks.block(block.ca_dynamic_size[0].cn)?;
                Some(Field::of(&of))
            }
        };
        let is_own = block.ca_storage == CaStorage::CnTemplate;
        let groups = block.ca_data.clone();
        let mut chain = vec![block];
        // An array may have arrays as its elements.
        let field = loop {
            let inner = chain[chain.len() - 1].ca_composition;
            if inner == 0 {
                break parent.moved_to(0);
            }
            match &blocks.head(inner)?.block_type {
                b"##CN" => break Field::of(&blocks.block::<CnBlock>(inner)?),
                b"##CA" if is_own && count_of.is_none() => {
                    let next: CaBlock = blocks.block(inner)?;
                    let size = size_of::<CaBlock>() + 8 * next.ca_dim_size.len();
                    blocks.budget.hold(2 * size as u64, PART)?;
                    if next.ca_storage != CaStorage::CnTemplate || next.flags.dynamic_size {
                        return Ok(Err("arrays in arrays of another kind"));
                    }
                    chain.push(next);
                }
                _ => return Ok(Err("arrays of something else than numbers")),
            }
        };
        if let Some(why) = field.unread() {
            return Ok(Err(why));
        }
        let width = field.width().max(1);
        let levels = chain.iter().map(|block| Level::of(block, width));
        let levels: Vec<Level> = levels.filter(|level| !level.sizes.is_empty()).collect();
        let base = if is_own { parent.at } else { 0 };
        let elements = Self {
            field: field.moved_to(base + field.at),
            levels,
            groups,
            count_of,
        };
        if !is_own && elements.groups.len() as u64 != elements.count() {
            return Ok(Err("arrays with fewer groups than elements"));
        }
        Ok(Ok(elements))
    }

    /// Their number in a record.
    pub fn count(&self) -> u64 {
        self.levels
            .iter()
            .map(Level::count)
            .fold(1, u64::saturating_mul)
    }

    /// The field of one of them in the channel's own record.
    pub fn field(&self, element: u64) -> Field {
        let mut rest = element;
        let mut at = self.field.at;
        for level in self.levels.iter().rev() {
            let count = level.count().max(1);
            let place = level.place(rest % count);
            at = at.saturating_add((place as usize).saturating_mul(level.step));
            rest /= count;
        }
        self.field.moved_to(at)
    }

    /// The link to the group that has one of them.
    pub fn group(&self, element: u64) -> Option<u64> {
        let level = self.levels.first();
        let place = level.map_or(0, |level| level.place(element));
        self.groups.get(usize::try_from(place).ok()?).copied()
    }

    /// Whether all of them lie within a record of this length in bytes.
    pub fn fit(&self, record: usize) -> bool {
        let farthest = self.levels.iter().fold(self.field.at, |at, level| {
            let last = level.count().saturating_sub(1) as usize;
            at.saturating_add(last.saturating_mul(level.step))
        });
        farthest.saturating_add(self.field.width()) <= record
    }
}

#[cfg(test)]
mod tests {
    use falcon_mdf::blocks::DataType;

    use super::*;

    fn elements(levels: Vec<Level>) -> Elements {
        Elements {
            field: Field::new(10, 0, 16, DataType::UIntLe),
            levels,
            groups: Vec::new(),
            count_of: None,
        }
    }

    fn level(sizes: &[u64], step: usize, is_inverse: bool) -> Level {
        Level {
            sizes: sizes.to_vec(),
            step,
            is_inverse,
        }
    }

    #[test]
    fn elements_lie_one_after_the_other_or_transposed() {
        let places = |elements: &Elements| -> Vec<usize> {
            let each = 0..elements.count();
            each.map(|element| elements.field(element).at).collect()
        };
        let rows = elements(vec![level(&[2, 3], 2, false)]);
        assert_eq!(places(&rows), [10, 12, 14, 16, 18, 20]);
        assert!(rows.fit(22) && !rows.fit(21));
        let transposed = elements(vec![level(&[2, 3], 2, true)]);
        assert_eq!(places(&transposed), [10, 14, 18, 12, 16, 20]);
        // Two arrays of three elements.
        let nested = elements(vec![level(&[2], 20, false), level(&[3], 4, false)]);
        assert_eq!(places(&nested), [10, 14, 18, 30, 34, 38]);
        assert!(nested.fit(40) && !nested.fit(39));
        let huge = elements(vec![level(&[u64::MAX, 3], usize::MAX, false)]);
        assert!(huge.count() == u64::MAX && !huge.fit(1 << 40));
    }
}

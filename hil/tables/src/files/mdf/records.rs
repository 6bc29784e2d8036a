//! The records of a file: the blocks that have them, unpacked and put together.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};
use std::ops::Range;
use std::rc::Rc;

use falcon_mdf::blocks::{BLOCK_HEADER_SIZE, CompressionType, DlBlock, DzBlock, HlBlock, LdBlock};
use falcon_mdf::parser::links::LinkChain;
use falcon_mdf::{Mf4Error, Mf4File};

use super::blocks::Blocks;
use crate::files::refused::Refused;
use crate::files::unpack::{held, inflated};

const PART: &str = "its records";
/// Records that are kept, because the next column may be in them. Convention: the groups of one recording.
const KEPT: usize = 4;

/// A block of records.
#[derive(Clone, Debug)]
pub(super) struct Block {
    at: usize,
    /// Bytes in the file.
    stored: usize,
    /// Bytes that it has when it is unpacked.
    size: u64,
    is_packed: bool,
    /// Bytes of a row, if it was stored column by column.
    columns: Option<usize>,
    /// The bytes that say which values are invalid, if they lie apart.
    invalid: Option<Box<Self>>,
}

/// Bytes of a record: of its values, and of what says which of them are invalid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub values: usize,
    pub invalid: usize,
}

/// Bytes of records.
#[derive(Clone, Debug)]
pub(super) enum Stream {
    InFile(Range<usize>),
    Made(Rc<Vec<u8>>),
}

impl Stream {
    pub fn bytes<'s>(&'s self, blocks: &'s Blocks) -> &'s [u8] {
        match self {
            Self::InFile(range) => blocks.bytes().get(range.clone()).unwrap_or_default(),
            Self::Made(bytes) => bytes,
        }
    }
}

/// Bytes of all blocks.
pub(super) fn size(list: &[Block]) -> u64 {
    let each = list.iter().map(|block| {
        let invalid = block.invalid.as_ref().map_or(0, |invalid| invalid.size);
        block.size.saturating_add(invalid)
    });
    each.fold(0, u64::saturating_add)
}

fn unsupported(what: &str) -> Refused {
    Mf4Error::unsupported("data block", what).into()
}

/// The blocks of records at a link. `layouts` are those of the groups of records; an unfinished file may lack the length of its last
/// block.
pub(super) fn list(
    blocks: &Blocks,
    link: u64,
    is_unfinished: bool,
    layouts: &[Layout],
) -> Result<Vec<Block>, Refused> {
    let mut list = Vec::new();
    let mut link = link;
    if link != 0 && &blocks.head(link)?.block_type == b"##HL" {
        link = blocks.block::<HlBlock>(link)?.dl_first;
    }
    if link == 0 {
        return Ok(list);
    }
    let mut add = |block: Block| {
        let size = size_of::<Block>() * (1 + usize::from(block.invalid.is_some()));
        blocks.budget.hold(2 * size as u64, PART)?;
        list.push(block);
        Ok::<_, Refused>(())
    };
    let mut chain = LinkChain::new();
    match &blocks.head(link)?.block_type {
        b"##DL" => {
            while link != 0 {
                blocks.budget.hold(32, PART)?;
                chain.visit(link, "dl_next")?;
                let part: DlBlock = blocks.block(link)?;
                for &link in part.data_links.iter().filter(|&&link| link != 0) {
                    add(one(blocks, link)?)?;
                }
                link = part.dl_next;
            }
        }
        b"##LD" => {
            while link != 0 {
                blocks.budget.hold(32, PART)?;
                chain.visit(link, "ld_next")?;
                let part: LdBlock = blocks.block(link)?;
                for (place, &link) in part.data_links.iter().enumerate() {
                    if link == 0 {
                        continue;
                    }
                    let mut block = one(blocks, link)?;
                    let apart = part.invalidation_links.get(place).copied().unwrap_or(0);
                    if apart != 0 {
                        if layouts.windows(2).any(|pair| pair[0] != pair[1]) {
                            return Err(unsupported("invalid values of groups of other records"));
                        }
                        block.invalid = Some(Box::new(one(blocks, apart)?));
                    }
                    add(block)?;
                }
                link = part.ld_next;
            }
        }
        _ => {
            let mut block = one(blocks, link)?;
            if is_unfinished && block.stored == 0 {
                block.stored = blocks.bytes().len().saturating_sub(block.at);
                block.size = block.stored as u64;
            }
            add(block)?;
        }
    }
    Ok(list)
}

impl Block {
    /// One that is not packed.
    fn plain(at: usize, stored: usize) -> Self {
        Self {
            at,
            stored,
            size: stored as u64,
            is_packed: false,
            columns: None,
            invalid: None,
        }
    }
}

/// The block of records at a link.
fn one(blocks: &Blocks, link: u64) -> Result<Block, Refused> {
    let head = blocks.head(link)?;
    let at = link as usize + BLOCK_HEADER_SIZE;
    match &head.block_type {
        b"##DT" | b"##SD" | b"##RD" | b"##DV" | b"##DI" => {
            let stored = head.length as usize - BLOCK_HEADER_SIZE;
            Ok(Block::plain(at, stored))
        }
        b"##DZ" => {
            let packed: DzBlock = blocks.block(link)?;
            let columns = match packed.zip_type {
                CompressionType::Deflate => None,
                CompressionType::TransposedDeflate => Some(packed.zip_parameter as usize),
                other => return Err(unsupported(&format!("packed by {other:?}"))),
            };
            let at = packed.compressed_data_offset as usize;
            let stored = packed.compressed_size;
            let end = (at as u64).saturating_add(stored);
            if end > blocks.bytes().len() as u64 {
                let left = blocks.bytes().len().saturating_sub(at);
                return Err(Mf4Error::truncated(link, stored as usize, left).into());
            }
            Ok(Block {
                at,
                stored: stored as usize,
                size: packed.original_size,
                is_packed: true,
                columns,
                invalid: None,
            })
        }
        other => {
            let name = String::from_utf8_lossy(other);
            Err(unsupported(&format!("block '{name}' at offset {link}")))
        }
    }
}

/// Bytes that a block has; those that are made are charged as held.
fn unpacked<'b>(blocks: &'b Blocks, block: &Block) -> Result<Cow<'b, [u8]>, Refused> {
    let budget = &blocks.budget;
    let stored = &blocks.bytes()[block.at..block.at + block.stored];
    budget.work(64, PART)?;
    if !block.is_packed {
        return Ok(Cow::Borrowed(stored));
    }
    let most = usize::try_from(block.size).unwrap_or(usize::MAX - 1);
    let bytes = inflated(stored, most, budget, PART)?;
    if bytes.len() != most {
        let why = format!("a block has {} bytes instead of {most}", bytes.len());
        return Err(Refused::Damaged(why.into()));
    }
    let Some(columns) = block.columns else {
        return Ok(Cow::Owned(bytes));
    };
    budget.hold(bytes.len() as u64, PART)?;
    budget.work(bytes.len() as u64, PART)?;
    let rows = Mf4File::un_transpose(&bytes, columns)?;
    budget.release(bytes.len() as u64);
    Ok(Cow::Owned(rows))
}

/// The bytes of blocks, one after the other.
fn stream(blocks: &Blocks, list: &[Block], layout: Layout) -> Result<Stream, Refused> {
    if let [block] = list
        && !block.is_packed
        && block.invalid.is_none()
    {
        return Ok(Stream::InFile(block.at..block.at + block.stored));
    }
    let budget = &blocks.budget;
    let total = usize::try_from(size(list)).unwrap_or(usize::MAX);
    let mut all: Vec<u8> = Vec::new();
    for block in list {
        let made = unpacked(blocks, block)?;
        let invalid = match &block.invalid {
            Some(apart) => unpacked(blocks, apart)?,
            None => Cow::Borrowed(&[][..]),
        };
        if list.len() == 1 && block.invalid.is_none() {
            return Ok(Stream::Made(Rc::new(made.into_owned())));
        }
        let length = made.len() + invalid.len();
        if all.capacity() - all.len() < length {
            let room = (all.len() / 2)
                .min(total.saturating_sub(all.len()))
                .max(length);
            budget.hold(room as u64, PART)?;
            all.reserve_exact(room);
        }
        budget.work(length as u64 / 8, PART)?;
        if block.invalid.is_none() {
            all.extend_from_slice(&made);
        } else if layout.values == 0 || layout.invalid == 0 {
            return Err(unsupported("invalid values of records without a length"));
        } else {
            let rows = made.chunks_exact(layout.values);
            for (values, invalid) in rows.zip(invalid.chunks_exact(layout.invalid)) {
                all.extend_from_slice(values);
                all.extend_from_slice(invalid);
            }
        }
        budget.release(held(&made) + held(&invalid));
    }
    Ok(Stream::Made(Rc::new(all)))
}

/// A group of records that lie among those of others: its number, the bytes of a record, and whether a record states its own length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Among {
    pub number: u64,
    pub size: usize,
    pub is_of_any_length: bool,
}

/// Where the records of each group begin, of groups whose records lie among each other.
pub(super) fn places(
    blocks: &Blocks,
    bytes: &[u8],
    width: usize,
    groups: &[Among],
) -> Result<Vec<Vec<usize>>, Refused> {
    let mut of_groups = vec![Vec::new(); groups.len()];
    let numbers: BTreeMap<u64, usize> = (groups
        .iter()
        .enumerate()
        .map(|(place, group)| (group.number, place)))
    .collect();
    if ![1, 2, 4, 8].contains(&width) {
        return Ok(of_groups);
    }
    let word = |at: usize, width: usize| {
        let mut word = [0; 8];
        word[..width].copy_from_slice(bytes.get(at..at + width)?);
        Some(u64::from_le_bytes(word))
    };
    let mut at = 0;
    // Beyond a record of an unknown group nothing is known.
    while let Some(&place) = word(at, width).and_then(|number| numbers.get(&number)) {
        let group = groups[place];
        let next = match group.is_of_any_length {
            true => word(at + width, 4).map(|length| at + width + 4 + length as usize),
            false => Some(at + width + group.size),
        };
        let Some(next) = next.filter(|&next| next <= bytes.len()) else {
            break;
        };
        blocks.budget.work(2, PART)?;
        if !group.is_of_any_length {
            blocks.budget.hold(2 * size_of::<usize>() as u64, PART)?;
            of_groups[place].push(at + width);
        }
        at = next;
    }
    Ok(of_groups)
}

/// What some records are known by: their group of data, and one of its groups if they were gathered for it.
type Key = (usize, Option<usize>);

/// Records that were put together, the last ones of which are kept.
pub(super) struct Kept {
    kept: RefCell<VecDeque<(Key, Stream)>>,
}

impl Kept {
    pub fn new() -> Self {
        Self {
            kept: RefCell::default(),
        }
    }

    /// The bytes of blocks that are known by `key`.
    pub fn stream(
        &self,
        blocks: &Blocks,
        key: usize,
        list: &[Block],
        layout: Layout,
    ) -> Result<Stream, Refused> {
        self.or(blocks, (key, None), || stream(blocks, list, layout))
    }

    /// The records at some places of a stream, one after the other.
    pub fn gathered(
        &self,
        blocks: &Blocks,
        key: (usize, usize),
        of: &Stream,
        places: &[usize],
        size: usize,
    ) -> Result<Stream, Refused> {
        self.or(blocks, (key.0, Some(key.1)), || {
            let bytes = of.bytes(blocks);
            let total = places.len() * size;
            blocks.budget.hold(total as u64, PART)?;
            blocks
                .budget
                .work((places.len() + total / 8) as u64, PART)?;
            let mut all = Vec::with_capacity(total);
            for &at in places {
                all.extend_from_slice(bytes.get(at..at + size).unwrap_or_default());
            }
            Ok(Stream::Made(Rc::new(all)))
        })
    }

    fn or(
        &self,
        blocks: &Blocks,
        key: Key,
        make: impl FnOnce() -> Result<Stream, Refused>,
    ) -> Result<Stream, Refused> {
        let found = self
            .kept
            .borrow()
            .iter()
            .find(|(known, _)| *known == key)
            .cloned();
        if let Some((_, stream)) = found {
            return Ok(stream);
        }
        let made = make()?;
        let mut kept = self.kept.borrow_mut();
        kept.push_front((key, made.clone()));
        while kept.len() > KEPT {
            if let Some((_, Stream::Made(bytes))) = kept.pop_back() {
                blocks.budget.release(bytes.capacity() as u64);
            }
        }
        Ok(made)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use flate2::Compression;
    use flate2::write::ZlibEncoder;

    use super::*;
    use crate::budget::Budget;
    use crate::read_limit::ReadLimit;

    const LAYOUT: Layout = Layout {
        values: 2,
        invalid: 1,
    };

    fn blocks(bytes: &[u8]) -> Blocks {
        Blocks::new(
            bytes.to_vec(),
            Rc::new(Budget::new("a.mf4", ReadLimit::default())),
        )
    }

    #[test]
    fn blocks_are_put_together_with_what_is_invalid() {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        // Rows of 7, 8 and 5, 6, column by column.
        encoder.write_all(&[7, 5, 8, 6]).unwrap();
        let packed = encoder.finish().unwrap();
        let file = blocks(&[&[1, 2, 3, 4, 0, 1][..], &packed].concat());
        let transposed = Block {
            size: 4,
            is_packed: true,
            columns: Some(2),
            ..Block::plain(6, packed.len())
        };
        let made = |list: &[Block]| {
            let stream = stream(&file, list, LAYOUT)?;
            Ok::<_, Refused>(stream.bytes(&file).to_vec())
        };
        assert_eq!(made(&[Block::plain(0, 4)]).unwrap(), [1, 2, 3, 4]);
        assert_eq!(
            made(std::slice::from_ref(&transposed)).unwrap(),
            [7, 8, 5, 6]
        );
        let all = [Block::plain(0, 4), transposed.clone()];
        assert_eq!(made(&all).unwrap(), [1, 2, 3, 4, 7, 8, 5, 6]);
        let apart = Block {
            invalid: Some(Box::new(Block::plain(4, 2))),
            ..Block::plain(0, 4)
        };
        assert_eq!(size(std::slice::from_ref(&apart)), 6);
        assert_eq!(made(&[apart]).unwrap(), [1, 2, 0, 3, 4, 1]);
        let claims = Block {
            size: 5,
            ..transposed
        };
        assert!(made(&[claims]).is_err());
    }

    #[test]
    fn records_of_several_groups_are_told_apart() {
        let of = |number, size, is_of_any_length| Among {
            number,
            size,
            is_of_any_length,
        };
        let groups = [of(1, 2, false), of(7, 1, false), of(9, 0, true)];
        let bytes = [
            1, 10, 11, 7, 20, 9, 2, 0, 0, 0, 30, 31, 1, 12, 13, 3, 1, 14, 15,
        ];
        let file = blocks(&bytes);
        let found = places(&file, &bytes, 1, &groups).unwrap();
        // Nothing is known beyond the number 3, which no group has.
        assert_eq!(found, [vec![1, 13], vec![4], vec![]]);
        let kept = Kept::new();
        let all = Stream::InFile(0..bytes.len());
        let one = kept.gathered(&file, (0, 0), &all, &found[0], 2).unwrap();
        assert_eq!(one.bytes(&file), [10, 11, 12, 13]);
        assert!(places(&file, &bytes[..2], 1, &groups).unwrap()[0].is_empty());
    }
}

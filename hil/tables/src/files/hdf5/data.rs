//! Data sets: the shape and the type of their elements, and their bytes.

use std::borrow::Cow;
use std::sync::Arc;

use hdf5_reader::Datatype;
use hdf5_reader::btree_v1::{BTreeV1Key, BTreeV1Node};
use hdf5_reader::chunk_index::{ChunkEntry, collect_v2_chunk_entries_storage};
use hdf5_reader::error::Error;
use hdf5_reader::extensible_array::collect_extensible_array_chunk_entries_storage;
use hdf5_reader::filters::{FILTER_DEFLATE, FilterRegistry};
use hdf5_reader::fixed_array::collect_fixed_array_chunk_entries_storage;
use hdf5_reader::io::Cursor;
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::messages::dataspace::DataspaceType;
use hdf5_reader::messages::filter_pipeline::FilterDescription;
use hdf5_reader::messages::layout::{ChunkIndexing, DataLayout};

use super::file::{File, of_index};
use super::grid::Grid;
use super::lzf;
use crate::files::DEEPEST;
use crate::files::refused::Refused;
use crate::files::unpack::{held, inflated};
use crate::room::Room;

const PART: &str = "the values of its data sets";
/// The most dimensions of a data set, and the most filters of its chunks, by the format.
const RANK: usize = 32;

/// Where the bytes of a data set are, and how many it has.
pub(super) struct Data {
    pub shape: Vec<u64>,
    /// Bytes of an element.
    pub size: usize,
    largest: Option<Vec<u64>>,
    layout: DataLayout,
    filters: Vec<FilterDescription>,
    /// The value of elements that were never written.
    pub fill: Option<Vec<u8>>,
    is_elsewhere: bool,
}

/// The bytes of a data set.
#[derive(Clone)]
pub(super) enum Raw {
    /// In the file, from an address on.
    InFile(u64, u64),
    Made(Arc<Vec<u8>>),
}

impl Raw {
    pub fn bytes<'r>(&'r self, file: &'r File) -> Result<&'r [u8], Error> {
        match self {
            Self::InFile(address, length) => file.slice(*address, *length),
            Self::Made(bytes) => Ok(bytes),
        }
    }

    /// What is held for it beside the file.
    pub fn held(&self) -> u64 {
        match self {
            Self::InFile(..) => 0,
            Self::Made(bytes) => bytes.len() as u64,
        }
    }
}

impl Data {
    /// The data set with these messages, and the type of its elements; `None` for another object.
    pub fn of(file: &File, header: &[HdfMessage]) -> Result<Option<(Self, Datatype)>, Refused> {
        let (mut space, mut of, mut layout) = (None, None, None);
        let (mut filters, mut fill, mut is_elsewhere) = (Vec::new(), None, false);
        for message in header {
            match message {
                HdfMessage::Dataspace(message) => space = Some(message),
                HdfMessage::Datatype(message) => of = Some(&message.datatype),
                HdfMessage::DataLayout(message) => layout = Some(&message.layout),
                HdfMessage::FilterPipeline(message) => filters.clone_from(&message.filters),
                HdfMessage::FillValue(message) => fill.clone_from(&message.value),
                HdfMessage::ExternalFiles(_) => is_elsewhere = true,
                _ => {}
            }
        }
        if !is_dataset(header) {
            return Ok(None);
        }
        let missing = |what: &str| Error::InvalidData(format!("a data set has no {what}"));
        let space = space.ok_or_else(|| missing("shape"))?;
        let of = of.ok_or_else(|| missing("type"))?.clone();
        let mut layout = layout.ok_or_else(|| missing("place"))?.clone();
        if space.dims.len() > RANK || filters.len() > RANK {
            let why = format!("a data set has more than {RANK} dimensions or filters");
            return Err(Error::InvalidData(why).into());
        }
        let mut shape = space.dims.clone();
        if shape.is_empty() && space.dataspace_type == DataspaceType::Null {
            shape.push(0);
        }
        if let DataLayout::Chunked { dims, .. } = &mut layout
            && dims.len() == shape.len() + 1
        {
            // The last is the size of an element.
            dims.pop();
        }
        let data = Self {
            size: size(&of, file)?,
            shape,
            largest: space.max_dims.clone(),
            layout,
            filters,
            fill,
            is_elsewhere,
        };
        Ok(Some((data, of)))
    }

    /// What is held for it, without its values.
    pub fn held(&self) -> usize {
        let compact = match &self.layout {
            DataLayout::Compact { data } => data.len(),
            _ => 0,
        };
        let filters = self.filters.iter().map(|filter| {
            let name = filter.name.as_ref().map_or(0, String::len);
            size_of::<FilterDescription>() + name + 4 * filter.client_data.len()
        });
        let dimensions = 32 * self.shape.len();
        let fill = self.fill.as_ref().map_or(0, Vec::len);
        size_of::<Self>() + compact + filters.sum::<usize>() + dimensions + fill
    }

    /// Number of elements.
    pub fn count(&self) -> u64 {
        (self.shape.iter()).fold(1, |all: u64, &size| all.saturating_mul(size))
    }

    /// Its bytes. They are charged as held; whoever drops them releases them.
    pub fn raw(&self, file: &File) -> Result<Raw, Refused> {
        let length = self.count().saturating_mul(self.size as u64);
        if self.is_elsewhere {
            return Err(Error::Other("a data set lies in another file".into()).into());
        }
        match &self.layout {
            DataLayout::Contiguous { address, size }
                if *size > 0 && !file.is_undefined(*address) =>
            {
                same(*size, length)?;
                return Ok(Raw::InFile(*address, length));
            }
            DataLayout::Chunked {
                address,
                dims,
                chunk_indexing,
                ..
            } if !file.is_undefined(*address) && length > 0 => {
                let grid = Grid::of(&self.shape, self.size, dims)?;
                return self.chunks(file, *address, chunk_indexing.as_ref(), &grid);
            }
            _ => {}
        }
        let mut bytes = self.filled(file)?;
        if let DataLayout::Compact { data } = &self.layout {
            same(data.len() as u64, length)?;
            bytes.copy_from_slice(data);
        }
        Ok(Raw::Made(Arc::new(bytes)))
    }

    /// As many bytes as it has, with the value for elements that were never written.
    fn filled(&self, file: &File) -> Result<Vec<u8>, Refused> {
        let length = self.count().saturating_mul(self.size as u64);
        file.budget.hold(length, PART)?;
        file.budget.work(length / 8, PART)?;
        let mut bytes = vec![0; length as usize];
        if let Some(fill) = self
            .fill
            .as_ref()
            .filter(|fill| fill.iter().any(|&byte| byte != 0))
        {
            for element in bytes.chunks_exact_mut(fill.len()) {
                element.copy_from_slice(fill);
            }
        }
        Ok(bytes)
    }

    fn chunks(
        &self,
        file: &File,
        address: u64,
        index: Option<&ChunkIndexing>,
        grid: &Grid,
    ) -> Result<Raw, Refused> {
        let (mut bytes, mut whole) = (None, None);
        let mut take = |chunk: &ChunkEntry| -> Result<(), Refused> {
            if !grid.has(&chunk.offsets)? {
                return Ok(());
            }
            let made = self.unpacked(file, chunk, grid.length)?;
            let held = held(&made);
            if grid.is_one {
                whole = Some(match made {
                    Cow::Borrowed(_) => Raw::InFile(chunk.address, grid.length),
                    Cow::Owned(made) => Raw::Made(Arc::new(made)),
                });
                return Ok(());
            }
            let all = match &mut bytes {
                Some(all) => all,
                none => none.insert(self.filled(file)?),
            };
            file.budget.work(grid.steps(&chunk.offsets), PART)?;
            grid.copy(&made, &chunk.offsets, self.size, all);
            file.budget.release(held);
            Ok(())
        };
        let (addresses, lengths) = file.sizes;
        let rank = self.shape.len();
        let dims = &grid.chunk;
        let times = of_index(rank);
        let found = match index {
            None => {
                let mut tree = Tree::new(file, rank);
                tree.walk(address, DEEPEST, &mut take)?;
                Vec::new()
            }
            Some(ChunkIndexing::SingleChunk {
                filtered_size,
                filters,
            }) => {
                let chunk = ChunkEntry {
                    address,
                    size: *filtered_size,
                    filter_mask: *filters,
                    offsets: vec![0; rank],
                };
                take(&chunk)?;
                Vec::new()
            }
            Some(ChunkIndexing::Implicit) => {
                let mut at = address;
                for offsets in grid.places() {
                    let chunk = ChunkEntry {
                        address: at,
                        size: 0,
                        filter_mask: u32::MAX,
                        offsets,
                    };
                    take(&chunk)?;
                    at = at.saturating_add(grid.length);
                }
                Vec::new()
            }
            Some(ChunkIndexing::BTreeV2) => file.ask(times, PART, |storage| {
                let rank = rank as u32;
                collect_v2_chunk_entries_storage(
                    storage, address, addresses, lengths, rank, dims, None,
                )
            })?,
            Some(ChunkIndexing::FixedArray { .. }) => file.ask(times, PART, |storage| {
                collect_fixed_array_chunk_entries_storage(
                    storage,
                    address,
                    addresses,
                    lengths,
                    &self.shape,
                    dims,
                    None,
                )
            })?,
            Some(ChunkIndexing::ExtensibleArray { .. }) => file.ask(times, PART, |storage| {
                let largest = self.largest.as_deref();
                collect_extensible_array_chunk_entries_storage(
                    storage,
                    address,
                    addresses,
                    lengths,
                    &self.shape,
                    largest,
                    dims,
                    None,
                )
            })?,
        };
        let mut room = Room::of(&file.budget);
        let held = found.len() * (size_of::<ChunkEntry>() + 8 * rank);
        room.more(held as u64, PART)?;
        let is_tree = matches!(index, Some(ChunkIndexing::BTreeV2));
        for (place, chunk) in found.iter().enumerate() {
            if is_tree && place > 0 && found[place - 1].offsets >= chunk.offsets {
                return Err(Error::InvalidData("two chunks have the same place".into()).into());
            }
            take(chunk)?;
        }
        if let Some(whole) = whole {
            return Ok(whole);
        }
        let bytes = match bytes {
            Some(bytes) => bytes,
            None => self.filled(file)?,
        };
        Ok(Raw::Made(Arc::new(bytes)))
    }

    /// The bytes of a chunk, `length` of them. Those that are made are charged as held.
    fn unpacked<'f>(
        &self,
        file: &'f File,
        chunk: &ChunkEntry,
        length: u64,
    ) -> Result<Cow<'f, [u8]>, Refused> {
        let stored = if chunk.size > 0 { chunk.size } else { length };
        let mut bytes = Cow::Borrowed(file.slice(chunk.address, stored)?);
        file.budget.work(256, PART)?;
        let most = usize::try_from(length).map_err(|_| Error::OffsetOutOfBounds(length))?;
        for (place, filter) in self.filters.iter().enumerate().rev() {
            if chunk.filter_mask >> place & 1 == 1 {
                continue;
            }
            // A filter before this one may have made the chunk longer, by the little that it adds.
            let most = most + most / 1024 + 64;
            let before = held(&bytes);
            let made = match filter.id {
                FILTER_DEFLATE => inflated(&bytes, most, &file.budget, PART)?,
                lzf::LZF => lzf::inflated(&bytes, most, &file.budget, PART)?,
                _ => {
                    file.budget.hold(most as u64, PART)?;
                    file.budget.work(most as u64, PART)?;
                    let filters = FilterRegistry::new();
                    let made = filters.apply_with_limit(filter, &bytes, self.size, Some(most))?;
                    file.budget.release((most - made.len().min(most)) as u64);
                    made
                }
            };
            file.budget.release(before);
            bytes = Cow::Owned(made);
        }
        if bytes.len() as u64 != length {
            let why = format!(
                "a packed chunk holds {} bytes instead of {length}",
                bytes.len()
            );
            return Err(Error::InvalidData(why).into());
        }
        Ok(bytes)
    }
}

fn same(stored: u64, length: u64) -> Result<(), Error> {
    match stored == length {
        true => Ok(()),
        false => Err(Error::InvalidData(format!(
            "a data set has {stored} bytes instead of {length}"
        ))),
    }
}

/// Whether only a group has such a message.
pub(super) fn is_of_group(message: &HdfMessage) -> bool {
    matches!(
        message,
        HdfMessage::SymbolTable(_)
            | HdfMessage::Link(_)
            | HdfMessage::LinkInfo(_)
            | HdfMessage::GroupInfo(_)
    )
}

/// Whether an object is a data set.
pub(super) fn is_dataset(header: &[HdfMessage]) -> bool {
    let is_of_dataset = |message: &HdfMessage| {
        matches!(
            message,
            HdfMessage::Dataspace(_)
                | HdfMessage::DataLayout(_)
                | HdfMessage::FillValue(_)
                | HdfMessage::FilterPipeline(_)
        )
    };
    !header.iter().any(is_of_group) && header.iter().any(is_of_dataset)
}

/// Bytes of an element.
fn size(of: &Datatype, file: &File) -> Result<usize, Error> {
    Ok(match of {
        Datatype::String {
            size: hdf5_reader::StringSize::Variable,
            ..
        }
        | Datatype::VarLen { .. } => file.reference_size(),
        Datatype::Array { base, dims } => {
            let count = (dims.iter()).fold(1, |all: u64, &size| all.saturating_mul(size));
            let all = (size(base, file)? as u64).saturating_mul(count);
            usize::try_from(all).map_err(|_| Error::InvalidData("an array is too long".into()))?
        }
        Datatype::Enum { base, .. } => size(base, file)?,
        of => hdf5_reader::dtype_element_size(of)?,
    })
}

/// A tree of chunks, as the first versions of HDF5 list them.
struct Tree<'f> {
    file: &'f File,
    rank: usize,
    last: Option<Vec<u64>>,
}

impl<'f> Tree<'f> {
    fn new(file: &'f File, rank: usize) -> Self {
        Self {
            file,
            rank,
            last: None,
        }
    }

    fn walk(
        &mut self,
        address: u64,
        depth: usize,
        take: &mut dyn FnMut(&ChunkEntry) -> Result<(), Refused>,
    ) -> Result<(), Refused> {
        let broken = |why: &str| Refused::from(Error::InvalidData(why.into()));
        let depth = depth
            .checked_sub(1)
            .ok_or_else(|| broken("a tree of chunks is too deep"))?;
        let (addresses, lengths) = self.file.sizes;
        let node = self.file.ask(of_index(self.rank), PART, |storage| {
            let head = storage.read_range(address, 8)?;
            let count = usize::from(u16::from_le_bytes([head[6], head[7]]));
            let key = 8 + 8 * (self.rank + 1);
            let width = usize::from(addresses);
            let node = storage.read_range(address, 8 + 2 * width + count * (key + width) + key)?;
            BTreeV1Node::parse(
                &mut Cursor::new(&node),
                addresses,
                lengths,
                Some(self.rank as u32),
            )
        })?;
        let level = node.level;
        for (key, &child) in node.keys.iter().zip(&node.children) {
            if level > 0 {
                self.walk(child, depth, take)?;
                continue;
            }
            let BTreeV1Key::RawData {
                chunk_size,
                filter_mask,
                offsets,
            } = key
            else {
                return Err(broken("a tree of chunks has other entries"));
            };
            let offsets = offsets[..self.rank].to_vec();
            // A tree is sorted, so that a node that is reached twice shows.
            if self.last.as_ref().is_some_and(|last| *last >= offsets) {
                return Err(broken("two chunks have the same place"));
            }
            let chunk = ChunkEntry {
                address: child,
                size: u64::from(*chunk_size),
                filter_mask: *filter_mask,
                offsets,
            };
            take(&chunk)?;
            self.last = Some(chunk.offsets);
        }
        Ok(())
    }
}

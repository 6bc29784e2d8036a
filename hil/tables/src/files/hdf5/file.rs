//! A file's bytes, from which the library reads single blocks.
//!
//! The library would follow every link of a file, and keep what it finds. So it is asked for one block or one tree of blocks after the
//! other, and each time the bytes that it may look at are limited, so that the result stays within the budget.

use std::cell::Cell;
use std::io::Read as _;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use hdf5_reader::chunk_index::ChunkEntry;
use hdf5_reader::error::Error;
use hdf5_reader::filters::{FILTER_DEFLATE, FILTER_NBIT, FILTER_SCALEOFFSET, FILTER_SZIP};
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::object_header::ObjectHeader;
use hdf5_reader::superblock::Superblock;
use hdf5_reader::{FilterRegistry, Hdf5File, OpenOptions, Storage, StorageBuffer};

use crate::budget::Budget;
use crate::files::mat::Bytes;
use crate::files::refused::Refused;

/// Steps for a look at some bytes, however few.
const LOOK: u64 = 16;
/// Bytes that a header takes in memory for each of its bytes: the smallest message has four, and a list doubles as it grows.
const OF_HEADER: u64 = (size_of::<HdfMessage>() / 2) as u64;

impl From<Error> for Refused {
    fn from(error: Error) -> Self {
        match innermost(&error) {
            Error::UnsupportedFilter(_) => {
                let otherwise = "write it again with compression=\"gzip\" or without compression";
                Self::Unread(error.to_string(), otherwise)
            }
            _ => Self::Damaged(error.to_string().into()),
        }
    }
}

/// The bytes after `base`, as the library reads them, with a count of what it may still look at.
struct Metered {
    bytes: Arc<Vec<u8>>,
    base: usize,
    left: Arc<AtomicU64>,
}

impl Storage for Metered {
    fn len(&self) -> u64 {
        self.bytes.len().saturating_sub(self.base) as u64
    }

    fn read_range(&self, offset: u64, length: usize) -> Result<StorageBuffer, Error> {
        take(&self.left, length as u64 + LOOK)?;
        let offset = usize::try_from(offset).map_err(|_| Error::OffsetOutOfBounds(offset))?;
        let start = self.base.saturating_add(offset);
        StorageBuffer::from_shared_owner(self.bytes.clone(), start, length)
    }
}

fn take(left: &AtomicU64, cost: u64) -> Result<(), Error> {
    let less = |left: u64| left.checked_sub(cost);
    match left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less) {
        Ok(_) => Ok(()),
        Err(_) => Err(Error::ResourceLimit("too many bytes for one block".into())),
    }
}

/// A file, its addresses counted from its superblock.
pub(super) struct File {
    pub budget: Rc<Budget>,
    /// Sizes of an address and of a length, in bytes.
    pub sizes: (u8, u8),
    /// The address of the root group.
    pub root: u64,
    /// What unpacks the blocks of lists of links and attributes.
    pub filters: FilterRegistry,
    bytes: Arc<Vec<u8>>,
    base: usize,
    left: Arc<AtomicU64>,
    looked: Cell<u64>,
}

impl File {
    pub fn of(bytes: Vec<u8>, budget: Rc<Budget>) -> Result<Self, Refused> {
        let left = Arc::new(AtomicU64::new(0));
        let mut file = Self {
            budget,
            sizes: (8, 8),
            root: 0,
            filters: filters(&left),
            bytes: Arc::new(bytes),
            base: 0,
            left,
            looked: Cell::new(0),
        };
        let superblock = file.ask(1, "its head", |storage| {
            Superblock::parse_from_storage(storage)
        })?;
        file.sizes = (superblock.offset_size, superblock.length_size);
        file.root = superblock.root_object_header_address()?;
        file.base = usize::try_from(superblock.base_address).unwrap_or(usize::MAX);
        Ok(file)
    }

    /// The bytes from an address on, for those who hold them longer.
    pub fn from(&self, address: u64) -> Bytes {
        let address = usize::try_from(address).unwrap_or(usize::MAX);
        Bytes::new(self.bytes.clone(), self.base.saturating_add(address), true)
    }

    /// The bytes at an address.
    pub fn slice(&self, address: u64, length: u64) -> Result<&[u8], Error> {
        let slice = || {
            let start = self.base.checked_add(usize::try_from(address).ok()?)?;
            let end = start.checked_add(usize::try_from(length).ok()?)?;
            self.bytes.get(start..end)
        };
        slice().ok_or(Error::UnexpectedEof {
            offset: address,
            needed: length,
            available: (self.bytes.len() as u64).saturating_sub(address),
        })
    }

    /// Whether an address is none.
    pub fn is_undefined(&self, address: u64) -> bool {
        hdf5_reader::io::Cursor::is_undefined_offset(address, self.sizes.0)
    }

    /// What the library makes of some blocks of `part`, in words. It holds at most `times` as many bytes as it looks at.
    pub fn ask<T>(
        &self,
        times: u64,
        part: &str,
        call: impl FnOnce(&dyn Storage) -> Result<T, Error>,
    ) -> Result<T, Refused> {
        let storage = self.storage(self.base);
        self.ask_with(times, part, || call(&storage))
    }

    fn ask_with<T>(
        &self,
        times: u64,
        part: &str,
        call: impl FnOnce() -> Result<T, Error>,
    ) -> Result<T, Refused> {
        let most = self.budget.left() / times;
        self.left.store(most, Ordering::Relaxed);
        let done = call();
        let looked = most - self.left.swap(0, Ordering::Relaxed);
        self.looked.set(self.looked.get() + looked);
        self.budget.work(looked, part)?;
        if let Err(error) = &done
            && is_beyond(error)
        {
            self.budget
                .hold(self.budget.left().saturating_add(1), part)?;
        }
        Ok(done?)
    }

    /// Bytes that the library has looked at so far.
    pub fn looked(&self) -> u64 {
        self.looked.get()
    }

    /// The messages of an object.
    pub fn header(&self, address: u64) -> Result<Vec<HdfMessage>, Refused> {
        const PART: &str = "the headers of its objects";
        let (addresses, lengths) = self.sizes;
        let header = self.ask(OF_HEADER, PART, |storage| {
            ObjectHeader::parse_at_storage(storage, address, addresses, lengths)
        })?;
        let is_shared = |message: &HdfMessage| matches!(message, HdfMessage::Shared(_));
        if !header.messages.iter().any(is_shared) {
            return Ok(header.messages);
        }
        drop(header);
        // Messages that several objects share are found by the library's own file only, which would keep every header.
        let storage = Arc::new(self.storage(0));
        let options = OpenOptions::default().with_filter_registry(filters(&self.left));
        let header = self.ask_with(OF_HEADER, PART, || {
            Hdf5File::from_storage_with_options(storage, options)?.get_or_parse_header(address)
        })?;
        Ok(Arc::unwrap_or_clone(header).messages)
    }

    fn storage(&self, base: usize) -> Metered {
        Metered {
            bytes: self.bytes.clone(),
            base,
            left: self.left.clone(),
        }
    }
}

/// Bytes that an index takes in memory for each of its bytes: an address of eight becomes an entry with a place in `rank` dimensions,
/// and a list doubles as it grows.
pub(super) fn of_index(rank: usize) -> u64 {
    ((size_of::<ChunkEntry>() + 24 + 8 * rank) / 4) as u64
}

/// Unpacks blocks of links and of attributes, to no more than the library may look at. Programs pack them with zlib, if at all.
fn filters(left: &Arc<AtomicU64>) -> FilterRegistry {
    let mut filters = FilterRegistry::new();
    let left = left.clone();
    let unpack = move |_: &_, packed: &[u8], _: usize| {
        let most = left.load(Ordering::Relaxed);
        let mut bytes = Vec::new();
        (flate2::read::ZlibDecoder::new(packed).take(most.saturating_add(1)))
            .read_to_end(&mut bytes)?;
        take(&left, bytes.len() as u64)?;
        Ok(bytes)
    };
    filters.register(FILTER_DEFLATE, Box::new(unpack));
    for other in [FILTER_SZIP, FILTER_NBIT, FILTER_SCALEOFFSET] {
        let refuse = move |_: &_, _: &[u8], _: usize| {
            Err(Error::UnsupportedFilter(format!("filter {other} of links")))
        };
        filters.register(other, Box::new(refuse));
    }
    filters
}

/// The error without its context.
fn innermost(mut error: &Error) -> &Error {
    while let Error::Context { source, .. } = error {
        error = source;
    }
    error
}

/// Whether the library would have looked at more bytes than it may.
fn is_beyond(error: &Error) -> bool {
    matches!(innermost(error), Error::ResourceLimit(_))
}

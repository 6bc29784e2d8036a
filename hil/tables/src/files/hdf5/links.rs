//! The links of groups: their names, and the objects to which they lead.

use std::collections::HashMap;
use std::rc::Rc;

use hdf5_reader::btree_v1::collect_btree_v1_leaves_storage;
use hdf5_reader::btree_v2::{BTreeV2Header, BTreeV2Record, collect_btree_v2_records_storage};
use hdf5_reader::error::Error;
use hdf5_reader::fractal_heap::{FractalHeap, FractalHeapDirectBlockCache};
use hdf5_reader::io::Cursor;
use hdf5_reader::local_heap::LocalHeap;
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::messages::link::{self, LinkMessage, LinkTarget};
use hdf5_reader::messages::symbol_table_msg::SymbolTableMessage;
use hdf5_reader::symbol_table::SymbolTableNode;

use super::file::{File, of_index};
use crate::files::DEEPEST;
use crate::files::refused::Refused;
use crate::room::Room;

const PART: &str = "the links of its groups";
/// Steps of work for an object of a heap: it is found, copied and parsed, in about a microsecond, also if its block is known.
const OF_OBJECT: u64 = 256;

/// Where a link leads.
#[derive(Clone)]
enum Target {
    /// To the object at an address.
    Object(u64),
    /// To what lies at a path.
    Path(Rc<str>),
    /// To another file.
    Elsewhere,
}

/// The links of a group, in the order in which they are listed.
#[derive(Default)]
struct OfGroup {
    all: Vec<(Rc<str>, Target)>,
    places: HashMap<Rc<str>, usize>,
}

/// The links of groups that were asked for.
pub(super) struct Links<'f> {
    file: &'f File,
    groups: HashMap<u64, Rc<OfGroup>>,
    /// Objects at paths from groups; `None` for one that is not there, or that is still searched.
    paths: HashMap<(u64, Rc<str>), Option<u64>>,
}

impl<'f> Links<'f> {
    pub fn new(file: &'f File) -> Self {
        Self {
            file,
            groups: HashMap::new(),
            paths: HashMap::new(),
        }
    }

    /// The members of the group at an address: their names, and the addresses of their headers. A link that leads nowhere is left out.
    pub fn members(&mut self, group: u64) -> Result<Vec<(Rc<str>, u64)>, Refused> {
        let links = self.of(group)?;
        let mut members = Vec::new();
        for (name, target) in &links.all {
            if let Some(address) = self.follow(group, target, DEEPEST)? {
                members.push((name.clone(), address));
            }
        }
        Ok(members)
    }

    /// The member of a group with a name.
    pub fn member(&mut self, group: u64, name: &str) -> Result<Option<u64>, Refused> {
        let links = self.of(group)?;
        match links.places.get(name) {
            Some(&index) => self.follow(group, &links.all[index].1, DEEPEST),
            None => Ok(None),
        }
    }

    fn follow(
        &mut self,
        group: u64,
        target: &Target,
        depth: usize,
    ) -> Result<Option<u64>, Refused> {
        match target {
            Target::Object(address) => Ok(Some(*address)),
            Target::Path(path) => self.at(group, path, depth),
            Target::Elsewhere => Ok(None),
        }
    }

    /// The object at a path from a group; `None` if there is none, or if the links on its way lead back to it.
    fn at(&mut self, group: u64, path: &Rc<str>, depth: usize) -> Result<Option<u64>, Refused> {
        let key = (group, path.clone());
        if let Some(known) = self.paths.get(&key) {
            return Ok(*known);
        }
        let Some(depth) = depth.checked_sub(1) else {
            return Ok(None);
        };
        self.file.budget.hold(size_of_val(&key) as u64 * 2, PART)?;
        self.file.budget.work(path.len() as u64, PART)?;
        self.paths.insert(key.clone(), None);
        let is_absolute = path.starts_with('/');
        let mut place = if is_absolute { self.file.root } else { group };
        for part in path.split('/').filter(|part| !part.is_empty()) {
            let links = match self.of(place) {
                Err(Refused::Damaged(_) | Refused::Unread(..)) => return Ok(None),
                links => links?,
            };
            let target = links.places.get(part).map(|&index| &links.all[index].1);
            let Some(target) = target else {
                return Ok(None);
            };
            match self.follow(place, target, depth)? {
                Some(next) => place = next,
                None => return Ok(None),
            }
        }
        self.paths.insert(key, Some(place));
        Ok(Some(place))
    }

    fn of(&mut self, group: u64) -> Result<Rc<OfGroup>, Refused> {
        if let Some(links) = self.groups.get(&group) {
            return Ok(links.clone());
        }
        let links = Rc::new(self.read(group)?);
        self.groups.insert(group, links.clone());
        Ok(links)
    }

    fn read(&self, group: u64) -> Result<OfGroup, Refused> {
        let mut found: Vec<LinkMessage> = Vec::new();
        let mut of_group = OfGroup::default();
        let mut dense = None;
        for message in self.file.header(group)? {
            match message {
                HdfMessage::SymbolTable(table) => {
                    self.table(&table, &mut of_group)?;
                    return Ok(of_group);
                }
                HdfMessage::Link(link) => found.push(link),
                HdfMessage::LinkInfo(info) => dense = Some(info),
                _ => {}
            }
        }
        let mut room = Room::of(&self.file.budget);
        room.more((found.len() * size_of::<LinkMessage>()) as u64, PART)?;
        if let Some(info) = dense
            && !self.file.is_undefined(info.fractal_heap_address)
        {
            let index = info.btree_name_index_address;
            let each = |object: &[u8]| {
                let (addresses, lengths) = self.file.sizes;
                let link = link::parse(&mut Cursor::new(object), addresses, lengths, object.len())?;
                let size = (object.len() + size_of::<LinkMessage>()) as u64;
                room.more(size, PART)?;
                found.push(link);
                Ok(())
            };
            self.file
                .objects(info.fractal_heap_address, &[index], PART, each)?;
        }
        // Where the group tracks the order in which its links were made, they are listed in it.
        if found.iter().all(|link| link.creation_order.is_some()) {
            found.sort_by_key(|link| link.creation_order);
        }
        for link in found {
            let target = match link.target {
                LinkTarget::Hard { address } => Target::Object(address),
                LinkTarget::Soft { path } => Target::Path(path.into()),
                LinkTarget::External { .. } => Target::Elsewhere,
            };
            self.add(&mut of_group, link.name.into(), target)?;
        }
        Ok(of_group)
    }

    /// Adds a link; the first of a name counts.
    fn add(&self, of_group: &mut OfGroup, name: Rc<str>, target: Target) -> Result<(), Refused> {
        if of_group.places.contains_key(&name) {
            return Ok(());
        }
        let size = 2 * size_of::<(Rc<str>, Target)>() + 2 * size_of::<(Rc<str>, usize)>();
        self.file.budget.hold((size + name.len()) as u64, PART)?;
        of_group.places.insert(name.clone(), of_group.all.len());
        of_group.all.push((name, target));
        Ok(())
    }

    /// The links of a group of the first versions of HDF5: a tree of tables, whose names lie apart.
    fn table(&self, table: &SymbolTableMessage, of_group: &mut OfGroup) -> Result<(), Refused> {
        let (addresses, lengths) = self.file.sizes;
        let heap = self.file.ask(1, PART, |storage| {
            LocalHeap::parse_at_storage(storage, table.heap_address, addresses, lengths)
        })?;
        let leaves = self.file.ask(of_index(1), PART, |storage| {
            let root = table.btree_address;
            collect_btree_v1_leaves_storage(storage, root, addresses, lengths, None, &[], None)
        })?;
        let texts = match leaves.is_empty() {
            true => &[],
            false => (self.file).slice(heap.data_segment_address, heap.data_segment_size)?,
        };
        for (_, address) in leaves {
            let node = self.file.ask(of_index(1), PART, |storage| {
                let head = storage.read_range(address, 8)?;
                let count = usize::from(u16::from_le_bytes([head[6], head[7]]));
                let length = 8 + count * (2 * usize::from(addresses) + 24);
                let bytes = storage.read_range(address, length)?;
                SymbolTableNode::parse(&mut Cursor::new(&bytes), addresses, lengths)
            })?;
            for entry in node.entries {
                let [a, b, c, d, ..] = entry.scratch;
                let target = match entry.cache_type {
                    2 => {
                        let path = u64::from(u32::from_le_bytes([a, b, c, d]));
                        Target::Path(self.text(texts, path)?)
                    }
                    _ => Target::Object(entry.object_header_address),
                };
                let name = self.text(texts, entry.link_name_offset)?;
                self.add(of_group, name, target)?;
            }
        }
        Ok(())
    }

    /// A text that ends with a zero.
    fn text(&self, texts: &[u8], at: u64) -> Result<Rc<str>, Refused> {
        let from = usize::try_from(at).ok().and_then(|at| texts.get(at..));
        let end = from.and_then(|from| from.iter().position(|&byte| byte == 0));
        let (Some(from), Some(end)) = (from, end) else {
            return Err(Error::OffsetOutOfBounds(at).into());
        };
        self.file.budget.work(end as u64, PART)?;
        self.file.budget.hold(end as u64, PART)?;
        let text = std::str::from_utf8(&from[..end]);
        let text = text.map_err(|_| Error::InvalidData("a name of a link is no text".into()))?;
        Ok(text.into())
    }
}

impl File {
    /// Each of the objects that lie in a heap and are listed in the first readable of some `indexes`.
    pub fn objects(
        &self,
        heap: u64,
        indexes: &[u64],
        part: &str,
        mut each: impl FnMut(&[u8]) -> Result<(), Refused>,
    ) -> Result<(), Refused> {
        let (addresses, lengths) = self.sizes;
        let records = |&index: &u64| {
            self.ask(of_index(1), part, |storage| {
                let header = BTreeV2Header::parse_at_storage(storage, index, addresses, lengths)?;
                collect_btree_v2_records_storage(
                    storage,
                    &header,
                    addresses,
                    lengths,
                    None,
                    &[],
                    None,
                )
            })
        };
        let mut found = Ok(Vec::new());
        for index in indexes.iter().filter(|&&index| !self.is_undefined(index)) {
            found = records(index);
            if !matches!(found, Err(Refused::Damaged(_) | Refused::Unread(..))) {
                break;
            }
        }
        let found = found?;
        if found.is_empty() {
            return Ok(());
        }
        let heap = self.ask(1, part, |storage| {
            FractalHeap::parse_at_storage(storage, heap, addresses, lengths)
        })?;
        let mut blocks = FractalHeapDirectBlockCache::default();
        let mut room = Room::of(&self.budget);
        room.more((found.len() * size_of::<BTreeV2Record>()) as u64, part)?;
        for record in &found {
            let id = match record {
                BTreeV2Record::LinkNameHash { heap_id, .. }
                | BTreeV2Record::CreationOrder { heap_id, .. }
                | BTreeV2Record::AttributeNameHash { heap_id, .. }
                | BTreeV2Record::AttributeCreationOrder { heap_id, .. } => heap_id,
                _ => continue,
            };
            let looked = self.looked();
            let object = self.ask(2, part, |storage| {
                heap.get_object_storage_cached_with_registry(
                    id,
                    storage,
                    addresses,
                    lengths,
                    &mut blocks,
                    Some(&self.filters),
                )
            })?;
            // Blocks that were read for it are kept for the next.
            room.more(self.looked() - looked, part)?;
            self.budget.work(OF_OBJECT + object.len() as u64, part)?;
            each(&object)?;
        }
        Ok(())
    }
}

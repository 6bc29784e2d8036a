//! The attributes of an object, and texts of any length, which lie apart from what refers to them.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use hdf5_reader::error::Error;
use hdf5_reader::global_heap::GlobalHeapCollection;
use hdf5_reader::io::Cursor;
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::messages::attribute::{self, AttributeMessage};
use hdf5_reader::{Attribute, Datatype, StringPadding, StringSize, VarLenKind};

use super::file::{File, of_index};
use crate::files::refused::Refused;
use crate::room::Room;

const PART: &str = "its attributes and texts";

/// Texts of a file.
pub(super) struct Texts<'f> {
    file: &'f File,
    /// Heaps of texts that were read, by their addresses.
    heaps: RefCell<HashMap<u64, Rc<Heap>>>,
}

/// The texts of a heap, by their numbers.
type Heap = HashMap<u16, Vec<u8>>;

impl<'f> Texts<'f> {
    pub fn new(file: &'f File) -> Self {
        Self {
            file,
            heaps: RefCell::default(),
        }
    }

    /// Each attribute of the object with these messages, one after the other.
    pub fn attributes(
        &self,
        header: Vec<HdfMessage>,
        mut each: impl FnMut(Attribute) -> Result<(), Refused>,
    ) -> Result<(), Refused> {
        let mut dense = None;
        for message in header {
            match message {
                HdfMessage::Attribute(message) => self.shown(message, &mut each)?,
                HdfMessage::AttributeInfo(info) => dense = Some(info),
                _ => {}
            }
        }
        let Some(info) = dense.filter(|info| !self.file.is_undefined(info.fractal_heap_address))
        else {
            return Ok(());
        };
        // In the order in which they were made, if it is listed.
        let by_order = info.btree_creation_order_address;
        let indexes: Vec<u64> = by_order
            .into_iter()
            .chain([info.btree_name_index_address])
            .collect();
        self.file
            .objects(info.fractal_heap_address, &indexes, PART, |object| {
                let (addresses, lengths) = self.file.sizes;
                let cursor = &mut Cursor::new(object);
                let message = attribute::parse(cursor, addresses, lengths, object.len())?;
                self.shown(message, &mut each)
            })
    }

    /// Shows `each` an attribute, whose texts are held as long.
    fn shown(
        &self,
        message: AttributeMessage,
        each: &mut dyn FnMut(Attribute) -> Result<(), Refused>,
    ) -> Result<(), Refused> {
        let attribute = self.attribute(message)?;
        let mut made = 0;
        if let Some(texts) = &attribute.decoded_strings {
            made = texts.iter().map(|text| held(text.len())).sum();
        }
        let mut room = Room::of(&self.file.budget);
        // The library makes texts of a fixed length when it is asked for them, and copies others.
        if let Datatype::String { .. } = attribute.datatype {
            let bytes = attribute.raw_data.len() as u64;
            let count = attribute.num_elements().map_or(0, |count| count.min(bytes));
            room.more(made.max(count * held(0) + bytes), PART)?;
        }
        each(attribute)?;
        self.file.budget.release(made);
        Ok(())
    }

    fn attribute(&self, message: AttributeMessage) -> Result<Attribute, Refused> {
        let texts = match message.dataspace.num_elements() {
            Ok(count) => self.of_any_length(&message.datatype, &message.raw_data, count),
            Err(_) => Ok(None),
        };
        let mut attribute = Attribute::from_message(message);
        attribute.decoded_strings = match texts {
            // A text that cannot be read is none.
            Err(Refused::Damaged(_) | Refused::Unread(..)) => None,
            texts => texts?,
        };
        Ok(attribute)
    }

    /// The texts of elements of any length, of which `raw` has the places; `None` for elements of another type.
    fn of_any_length(
        &self,
        of: &Datatype,
        raw: &[u8],
        count: u64,
    ) -> Result<Option<Vec<String>>, Refused> {
        let padding = match of {
            Datatype::String {
                size: StringSize::Variable,
                padding,
                ..
            } => *padding,
            Datatype::VarLen {
                base,
                kind: VarLenKind::String,
                padding,
                ..
            } if base.is_vlen_string_base() => *padding,
            _ => return Ok(None),
        };
        let size = self.file.reference_size();
        let mut texts = Vec::new();
        for place in raw
            .chunks_exact(size)
            .take(usize::try_from(count).unwrap_or(usize::MAX))
        {
            let mut place = Cursor::new(place);
            place.skip(4)?;
            let (heap, index) = (place.read_offset(self.file.sizes.0)?, place.read_u32_le()?);
            if self.file.is_undefined(heap) || index == 0 {
                self.push(&mut texts, &[], padding)?;
                continue;
            }
            let heap = self.heap(heap)?;
            let text = u16::try_from(index).ok().and_then(|index| heap.get(&index));
            let missing = || Error::InvalidData(format!("the text {index} of a heap is missing"));
            self.push(&mut texts, text.ok_or_else(missing)?, padding)?;
        }
        let is_complete = texts.len() as u64 == count;
        Ok(is_complete.then_some(texts))
    }

    /// The texts of elements of a fixed or of any length.
    pub fn strings(&self, of: &Datatype, raw: &[u8], count: u64) -> Result<Vec<String>, Refused> {
        if let Some(texts) = self.of_any_length(of, raw, count)? {
            return Ok(texts);
        }
        let Datatype::String {
            size: StringSize::Fixed(size),
            padding,
            ..
        } = of
        else {
            return Err(Error::InvalidData("its elements are no texts".into()).into());
        };
        let mut texts = Vec::new();
        for text in raw.chunks_exact(*size as usize) {
            self.push(&mut texts, text, *padding)?;
        }
        Ok(texts)
    }

    fn push(
        &self,
        texts: &mut Vec<String>,
        text: &[u8],
        padding: StringPadding,
    ) -> Result<(), Refused> {
        let last = |is_padding: fn(&u8) -> bool| {
            let last = text.iter().rposition(|byte| !is_padding(byte));
            last.map_or(0, |last| last + 1)
        };
        let end = match padding {
            StringPadding::NullTerminate => text.iter().position(|&byte| byte == 0),
            StringPadding::NullPad => Some(last(|byte| *byte == 0)),
            StringPadding::SpacePad => Some(last(|byte| *byte == b' ')),
        };
        let text = &text[..end.unwrap_or(text.len())];
        self.file.budget.hold(held(text.len()), PART)?;
        self.file.budget.work(text.len() as u64 + 1, PART)?;
        let text = std::str::from_utf8(text);
        texts.push(
            text.map_err(|_| Error::InvalidData("a text is not UTF-8".into()))?
                .to_owned(),
        );
        Ok(())
    }

    fn heap(&self, address: u64) -> Result<Rc<Heap>, Refused> {
        if let Some(heap) = self.heaps.borrow().get(&address) {
            return Ok(heap.clone());
        }
        let (addresses, lengths) = self.file.sizes;
        let collection = self.file.ask(of_index(0), PART, |storage| {
            GlobalHeapCollection::parse_at_storage(storage, address, addresses, lengths)
        })?;
        let mut heap = Heap::new();
        for object in collection.objects {
            let size = object.data.len() + 2 * size_of::<(u16, Vec<u8>)>();
            self.file.budget.hold(size as u64, PART)?;
            heap.entry(object.index).or_insert(object.data);
        }
        let heap = Rc::new(heap);
        self.heaps.borrow_mut().insert(address, heap.clone());
        Ok(heap)
    }
}

impl File {
    /// Bytes of the place of an element of any length.
    pub fn reference_size(&self) -> usize {
        8 + usize::from(self.sizes.0)
    }
}

/// What is held for a text of a list, which doubles as it grows.
pub(super) fn held(text: usize) -> u64 {
    (text + 2 * size_of::<String>()) as u64
}

/// The text of an attribute.
pub(super) fn text(attribute: &Attribute) -> Option<String> {
    attribute.read_string().ok()
}

/// The number in an attribute; `None` for a text or for several numbers.
pub(super) fn number(attribute: &Attribute) -> Option<f64> {
    let is_one = attribute.shape.iter().all(|&size| size == 1);
    is_one.then(|| attribute.read_as_f64().ok()).flatten()
}

//! Arrow's own files and streams, and Feather version 2, which is such a file.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_buffer::Buffer;
use arrow_ipc::convert::try_fb_to_schema;
use arrow_ipc::reader::{FileDecoder, StreamDecoder, read_footer_length};
use arrow_ipc::{Block, Message};
use arrow_schema::{ArrowError, SchemaRef};
use flatbuffers::InvalidFlatbuffer;
use mesh_damper_output::error::InputError;

use super::leaf::{self, Gathered};
use super::schema;
use crate::files::guard::guarded;
use crate::files::opened::Opened;
use crate::files::packed::Packed;
use crate::files::refused::Refused;
use crate::files::{Format, Reading, Source, Tables};

const NAME: &str = "Arrow";
const MARK: &[u8] = b"ARROW1";
/// Bytes before a message, except in streams of versions before 0.15.
const CONTINUES: [u8; 4] = [0xff; 4];
/// Bytes held for an array of a batch, besides its values, and for a part of one.
const OF_ARRAY: u64 = 256;
const OF_BUFFER: u64 = 64;
/// Steps of work for a field that is searched for a dictionary.
const STEPS_OF_FIELD: u64 = 32;
const PART: &str = "its batches";

/// Arrow IPC.
pub(in crate::files) struct Arrow;

impl Format for Arrow {
    fn name(&self) -> &'static str {
        NAME
    }

    fn endings(&self) -> &'static [&'static str] {
        &["arrow", "arrows", "feather"]
    }

    fn recognizes(&self, head: &[u8]) -> bool {
        head.starts_with(MARK) || head.starts_with(&CONTINUES)
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        _: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (name, budget) = (source.name(), source.budget());
        let bytes = source.bytes()?;
        let packed = Packed::of(bytes.len(), budget);
        guarded(NAME, &name, || {
            let decoded = if bytes.starts_with(MARK) {
                file(bytes.into(), &packed)
            } else {
                stream(bytes.into(), &packed)
            };
            opened(&name, packed, decoded)
        })
    }
}

impl From<ArrowError> for Refused {
    fn from(error: ArrowError) -> Self {
        Self::Damaged(error.to_string().into())
    }
}

impl From<InvalidFlatbuffer> for Refused {
    fn from(error: InvalidFlatbuffer) -> Self {
        Self::Damaged(error.to_string().into())
    }
}

type Decoded = Result<(SchemaRef, Vec<RecordBatch>), Refused>;

/// The batches of a stream, one after the other.
fn stream(mut bytes: Buffer, packed: &Packed) -> Decoded {
    let mut seen = Seen::of(packed);
    let mut rest = bytes.as_slice();
    while let Some(after) = seen.message(rest)? {
        rest = after;
    }
    let mut decoder = StreamDecoder::new();
    let mut batches = Vec::new();
    while let Some(batch) = decoder.decode(&mut bytes)? {
        batches.push(batch);
    }
    Ok((decoder.schema().ok_or("it has no schema")?, batches))
}

/// The batches of a file, whose end lists their positions.
fn file(bytes: Buffer, packed: &Packed) -> Decoded {
    const END: &str = "it lacks its end";
    let (rest, trailer) = bytes.split_last_chunk::<10>().ok_or(END)?;
    let length = read_footer_length(*trailer)?;
    let from = rest.len().checked_sub(length).ok_or(END)?;
    let footer = schema::footer(&rest[from..])?;
    let schema = footer.schema().ok_or("it has no schema")?;
    let mut seen = Seen::of(packed);
    seen.fields = schema::charge(schema, packed.budget())?;
    let schema: SchemaRef = Arc::new(try_fb_to_schema(schema)?);
    let mut decoder = FileDecoder::new(schema.clone(), footer.version());
    let mut block = |block: &Block| -> Result<Buffer, Refused> {
        let lengths = [
            block.offset(),
            i64::from(block.metaDataLength()),
            block.bodyLength(),
        ];
        let [from, head, body] =
            lengths.map(|length| usize::try_from(length).unwrap_or(usize::MAX));
        let length = head.saturating_add(body);
        let inside = from
            .checked_add(length)
            .is_some_and(|end| end <= bytes.len());
        if !inside {
            return Err("a batch lies outside".into());
        }
        let block = bytes.slice_with_length(from, length);
        seen.message(&block)?.ok_or("a batch is cut")?;
        Ok(block)
    };
    for each in footer.dictionaries().into_iter().flatten() {
        decoder.read_dictionary(each, &block(each)?)?;
    }
    let mut batches = Vec::new();
    for each in footer.recordBatches().into_iter().flatten() {
        batches.extend(decoder.read_record_batch(each, &block(each)?)?);
    }
    Ok((schema, batches))
}

fn opened<'a>(
    name: &str,
    packed: Packed,
    decoded: Decoded,
) -> Result<Box<dyn Tables + 'a>, InputError> {
    let (schema, batches) = decoded.map_err(|why| why.error(NAME, name))?;
    let budget = packed.budget();
    let rows = batches.iter().map(|batch| batch.num_rows() as u64);
    let rows = rows.fold(0, u64::saturating_add);
    let (mut table, leaves) = leaf::table(&schema, Some(rows), budget)?;
    let said = schema.metadata().iter();
    let said = said.map(|(key, text)| (key.as_str(), text.as_str()));
    let comments = leaf::comments(said, &mut table.skipped, budget)?;
    let shared = Rc::clone(budget);
    let read = move |_: usize, column: usize| {
        let mut gathered = Gathered::of(&packed);
        for batch in &batches {
            if gathered.append(batch, &leaves[column])?.is_none() {
                return Ok(None);
            }
        }
        Ok(Some(gathered.values))
    };
    Ok(Box::new(Opened::new(
        NAME,
        shared,
        name.to_owned(),
        vec![table],
        comments,
        read,
    )?))
}

/// The messages that were charged so far.
struct Seen<'p> {
    packed: &'p Packed,
    /// Number of fields of the schema.
    fields: u64,
    /// Bytes of each dictionary, to which others may be appended.
    dictionaries: HashMap<i64, u64>,
}

impl<'p> Seen<'p> {
    fn of(packed: &'p Packed) -> Self {
        Self {
            packed,
            fields: 0,
            dictionaries: HashMap::new(),
        }
    }

    /// Charges for what the decoder makes of the first message of a stream, whose counts it believes, and returns the rest of the
    /// stream; `None` at its end.
    fn message<'b>(&mut self, bytes: &'b [u8]) -> Result<Option<&'b [u8]>, Refused> {
        const CUT: &str = "a message is cut";
        let Some((mark, rest)) = bytes.split_first_chunk::<4>() else {
            return Ok(None);
        };
        let (length, rest) = match *mark == CONTINUES {
            true => rest.split_first_chunk::<4>().ok_or(CUT)?,
            false => (mark, rest),
        };
        let length = u32::from_le_bytes(*length) as usize;
        if length == 0 {
            return Ok(None);
        }
        let (message, rest) = rest.split_at_checked(length).ok_or(CUT)?;
        let budget = self.packed.budget();
        budget.work(8 * length as u64, PART)?;
        let message = schema::message(message)?;
        let length = usize::try_from(message.bodyLength()).ok();
        let body = length.and_then(|length| rest.split_at_checked(length));
        let (body, rest) = body.ok_or(CUT)?;
        if let Some(schema) = message.header_as_schema() {
            self.fields = schema::charge(schema, budget)?;
        }
        let size = self.arrays(message, body)?;
        if let Some(dictionary) = message.header_as_dictionary_batch() {
            budget.work(STEPS_OF_FIELD * self.fields, "its dictionaries")?;
            budget.hold(OF_ARRAY, "its dictionaries")?;
            let known = self.dictionaries.entry(dictionary.id()).or_default();
            if dictionary.isDelta() {
                // Both are copied, as batches hold the one before.
                *known = known.saturating_add(size);
                budget.hold(*known, "its dictionaries")?;
                budget.work(*known, "its dictionaries")?;
            } else {
                *known = size;
            }
        }
        Ok(Some(rest))
    }

    /// Charges for the arrays of a message, and returns the number of bytes of their values.
    fn arrays(&self, message: Message<'_>, body: &[u8]) -> Result<u64, Refused> {
        let batch = match message.header_as_dictionary_batch() {
            Some(dictionary) => dictionary.data(),
            None => message.header_as_record_batch(),
        };
        let Some(batch) = batch else { return Ok(0) };
        let budget = self.packed.budget();
        let arrays = self
            .fields
            .max(batch.nodes().map_or(0, |nodes| nodes.len() as u64));
        let buffers = batch.buffers().map_or(0, |buffers| buffers.len() as u64);
        budget.hold(arrays.saturating_mul(OF_ARRAY) + buffers * OF_BUFFER, PART)?;
        budget.work(arrays.saturating_mul(OF_ARRAY) + buffers * OF_BUFFER, PART)?;
        let is_packed = batch.compression().is_some();
        let mut sum = 0_u64;
        for buffer in batch.buffers().into_iter().flatten() {
            let mut size = u64::try_from(buffer.length()).unwrap_or(0);
            let from = usize::try_from(buffer.offset()).ok();
            let stored = from.and_then(|from| {
                let end = from.checked_add(usize::try_from(size).ok()?)?;
                body.get(from..end)
            });
            let stated = stored.and_then(|stored| stored.first_chunk::<8>());
            if let (true, Some(stored), Some(stated)) = (is_packed, stored, stated) {
                // −1 marks an array that was left uncompressed.
                if let Ok(stated) = u64::try_from(i64::from_le_bytes(*stated)) {
                    size = stated;
                    if budget.is_new(stored)? {
                        budget.unpacked(size)?;
                    }
                }
            }
            sum = sum.saturating_add(size);
        }
        // Also if they are not packed: what is not aligned is copied, and several may share their bytes.
        budget.hold(sum, PART)?;
        budget.work(sum, PART)?;
        Ok(sum)
    }
}

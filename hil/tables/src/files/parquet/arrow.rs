//! Arrow's own files and streams, and Feather version 2, which is such a file.

use arrow_array::RecordBatch;
use arrow_buffer::Buffer;
use arrow_ipc::convert::try_fb_to_schema;
use arrow_ipc::reader::{FileDecoder, StreamDecoder, read_footer_length};
use arrow_ipc::{Block, Message, root_as_footer, root_as_message};
use arrow_schema::{ArrowError, SchemaRef};
use mesh_damper_output::error::InputError;

use super::leaf::{self, Gathered};
use crate::files::guard::{damaged, guarded};
use crate::files::opened::Opened;
use crate::files::{Format, Reading, Source, Tables};
use crate::read_limit::ReadLimit;

const NAME: &str = "Arrow";
const MARK: &[u8] = b"ARROW1";
/// Bytes before a message, except in streams of versions before 0.15.
const CONTINUES: [u8; 4] = [0xff; 4];

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
        let (name, limit) = (source.name(), source.limit());
        let bytes = source.bytes()?;
        guarded(NAME, &name, || {
            let decoded = if bytes.starts_with(MARK) {
                file(bytes.into(), limit)
            } else {
                stream(bytes.into(), limit)
            };
            opened(&name, limit, decoded)
        })
    }
}

/// Why a file cannot be read.
enum Unreadable {
    Broken(String),
    TooLarge,
}

impl From<ArrowError> for Unreadable {
    fn from(error: ArrowError) -> Self {
        Self::Broken(error.to_string())
    }
}

impl From<&str> for Unreadable {
    fn from(what: &str) -> Self {
        Self::Broken(what.to_owned())
    }
}

type Decoded = Result<(SchemaRef, Vec<RecordBatch>), Unreadable>;

/// The batches of a stream, one after the other.
fn stream(mut bytes: Buffer, limit: ReadLimit) -> Decoded {
    let mut rest = bytes.as_slice();
    let mut size = 0_u64;
    while let Some((of_message, after)) = message(rest) {
        size = size.saturating_add(of_message.ok_or("a message is cut")?);
        rest = after;
    }
    if size > limit.file() {
        return Err(Unreadable::TooLarge);
    }
    let mut decoder = StreamDecoder::new();
    let mut batches = Vec::new();
    while let Some(batch) = decoder.decode(&mut bytes)? {
        batches.push(batch);
    }
    Ok((decoder.schema().ok_or("it has no schema")?, batches))
}

/// The batches of a file, whose end lists their positions.
fn file(bytes: Buffer, limit: ReadLimit) -> Decoded {
    const END: &str = "it lacks its end";
    let (rest, trailer) = bytes.split_last_chunk::<10>().ok_or(END)?;
    let length = read_footer_length(*trailer)?;
    let from = rest.len().checked_sub(length).ok_or(END)?;
    let footer = root_as_footer(&rest[from..]);
    let footer = footer.map_err(|error| Unreadable::Broken(error.to_string()))?;
    let schema = footer.schema().ok_or("it has no schema")?;
    let schema: SchemaRef = std::sync::Arc::new(try_fb_to_schema(schema)?);
    let mut decoder = FileDecoder::new(schema.clone(), footer.version());
    let mut size = 0_u64;
    let mut block = |block: &Block| -> Result<Buffer, Unreadable> {
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
        let of_message = message(&block).and_then(|(size, _)| size);
        size = size.saturating_add(of_message.ok_or("a batch is cut")?);
        if size > limit.file() {
            return Err(Unreadable::TooLarge);
        }
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
    limit: ReadLimit,
    decoded: Decoded,
) -> Result<Box<dyn Tables + 'a>, InputError> {
    let (schema, batches) = decoded.map_err(|why| match why {
        Unreadable::Broken(why) => damaged(NAME, name, why),
        Unreadable::TooLarge => limit.exceeded(name),
    })?;
    let rows = batches.iter().map(|batch| batch.num_rows() as u64);
    let rows = rows.fold(0, u64::saturating_add);
    if rows.saturating_mul(8) > limit.file() {
        return Err(limit.exceeded(name));
    }
    let (table, leaves) = leaf::table(&schema, Some(rows));
    let said = schema.metadata().iter();
    let comments = leaf::comments(said.map(|(key, text)| (key.as_str(), text.as_str())));
    let owned = name.to_owned();
    let read = move |_: usize, column: usize| {
        guarded(NAME, &owned, || {
            let mut gathered = Gathered::default();
            let mut each = batches.iter();
            let is_numeric = each.all(|batch| gathered.append(batch, &leaves[column]).is_some());
            Ok(is_numeric.then_some(gathered.values))
        })
    };
    Ok(Box::new(Opened::new(
        name.to_owned(),
        vec![table],
        comments,
        read,
    )?))
}

/// The first message of a stream. Returns the unpacked size that it and its compressed arrays state, which the decoder trusts,
/// `None` if the message is incomplete; and the rest of the stream. `None` at the stream's end.
fn message(bytes: &[u8]) -> Option<(Option<u64>, &[u8])> {
    let (mark, rest) = bytes.split_first_chunk::<4>()?;
    let (length, rest) = match *mark == CONTINUES {
        true => rest.split_first_chunk::<4>()?,
        false => (mark, rest),
    };
    let length = u32::from_le_bytes(*length) as usize;
    if length == 0 {
        return None;
    }
    let whole = || {
        let (message, rest) = rest.split_at_checked(length)?;
        let message = root_as_message(message).ok()?;
        let length = usize::try_from(message.bodyLength()).ok()?;
        let (body, rest) = rest.split_at_checked(length)?;
        Some((unpacked(message, body)?.saturating_add(length as u64), rest))
    };
    Some(match whole() {
        Some((size, rest)) => (Some(size), rest),
        None => (None, &[]),
    })
}

fn unpacked(message: Message<'_>, body: &[u8]) -> Option<u64> {
    let batch = match message.header_as_dictionary_batch() {
        Some(dictionary) => dictionary.data(),
        None => message.header_as_record_batch(),
    };
    let Some(batch) = batch.filter(|batch| batch.compression().is_some()) else {
        return Some(0);
    };
    let mut sum = 0_u64;
    for buffer in batch.buffers().into_iter().flatten() {
        let from = usize::try_from(buffer.offset()).ok()?;
        let length = body.get(from..)?.first_chunk::<8>();
        if let Some(length) = length.filter(|_| buffer.length() >= 8) {
            // −1 marks an array that was left uncompressed.
            sum = sum.saturating_add(u64::try_from(i64::from_le_bytes(*length)).unwrap_or(0));
        }
    }
    Some(sum)
}

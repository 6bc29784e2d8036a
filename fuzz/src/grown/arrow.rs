//! Arrow's files and streams: schemas whose parts are shared, batches, dictionaries, and arrays that share their bytes.

use arrow_ipc::{
    Block, BodyCompressionBuilder, Buffer, CompressionType, DictionaryBatchBuilder,
    DictionaryEncodingBuilder, Field, FieldBuilder, FieldNode, FloatingPointBuilder, FooterBuilder,
    IntBuilder, KeyValueBuilder, MessageBuilder, MessageHeader, MetadataVersion, Precision,
    RecordBatchBuilder, SchemaBuilder, Struct_Builder, Type,
};
use flatbuffers::{FlatBufferBuilder, UnionWIPOffset, WIPOffset};

use super::Grow;
use super::bytes::Bytes;
use super::draw::{Draw, Names};

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("columns", columns),
    ("shared schemas", shared),
    ("depth", depth),
    ("batches", batches),
    ("blocks", blocks),
    ("dictionaries", dictionaries),
    ("shared buffers", buffers),
    ("statements", statements),
];

type Builder = FlatBufferBuilder<'static>;

/// A field of floats, or of the numbers of a dictionary.
fn field(
    to: &mut Builder,
    name: WIPOffset<&'static str>,
    dictionary: Option<i64>,
) -> WIPOffset<Field<'static>> {
    let kind = {
        let mut kind = FloatingPointBuilder::new(to);
        kind.add_precision(Precision::DOUBLE);
        kind.finish().as_union_value()
    };
    let encoding = dictionary.map(|id| {
        let mut index = IntBuilder::new(to);
        index.add_bitWidth(8);
        index.add_is_signed(true);
        let index = index.finish();
        let mut encoding = DictionaryEncodingBuilder::new(to);
        encoding.add_id(id);
        encoding.add_indexType(index);
        encoding.finish()
    });
    let children = to.create_vector::<WIPOffset<Field>>(&[]);
    let mut field = FieldBuilder::new(to);
    field.add_name(name);
    field.add_nullable(true);
    field.add_type_type(Type::FloatingPoint);
    field.add_type_(kind);
    field.add_children(children);
    if let Some(encoding) = encoding {
        field.add_dictionary(encoding);
    }
    field.finish()
}

fn text(to: &mut Builder, text: &str) -> WIPOffset<&'static str> {
    WIPOffset::new(to.create_string(text).value())
}

fn schema(
    to: &mut Builder,
    fields: &[WIPOffset<Field<'static>>],
    entries: usize,
    long: usize,
) -> WIPOffset<UnionWIPOffset> {
    let fields = to.create_vector(fields);
    let value = text(to, &"v".repeat(long));
    let entries: Vec<_> = (0..entries)
        .map(|_| {
            let mut entry = KeyValueBuilder::new(to);
            entry.add_key(value);
            entry.add_value(value);
            entry.finish()
        })
        .collect();
    let entries = to.create_vector(&entries);
    let mut schema = SchemaBuilder::new(to);
    schema.add_fields(fields);
    schema.add_custom_metadata(entries);
    schema.finish().as_union_value()
}

/// A message, without what stands around it in a stream.
fn message(
    mut to: Builder,
    kind: MessageHeader,
    header: WIPOffset<UnionWIPOffset>,
    body: usize,
) -> Vec<u8> {
    let mut message = MessageBuilder::new(&mut to);
    message.add_version(MetadataVersion::V5);
    message.add_header_type(kind);
    message.add_header(header);
    message.add_bodyLength(body as i64);
    let message = message.finish();
    to.finish(message, None);
    to.finished_data().to_vec()
}

/// A message of a stream, with the arrays after it.
fn framed(message: &[u8], body: &[u8]) -> Vec<u8> {
    let mut bytes = Bytes::default();
    let length = message.len().next_multiple_of(8);
    bytes
        .put(&[0xff; 4])
        .u32(length as u32)
        .put(message)
        .pad(8)
        .put(body);
    bytes.0
}

fn schema_of(names: &[String], dictionary: bool) -> Vec<u8> {
    let mut to = Builder::new();
    let fields: Vec<_> = names
        .iter()
        .enumerate()
        .map(|(index, name)| {
            let name = text(&mut to, name);
            field(
                &mut to,
                name,
                (dictionary && index > 2).then_some(index as i64),
            )
        })
        .collect();
    let header = schema(&mut to, &fields, 0, 0);
    message(to, MessageHeader::Schema, header, 0)
}

/// Where the values of an array begin, and their bytes; `None` for a structure, which has none of its own.
type Place = Option<(i64, i64)>;

/// A batch of these arrays, all with these rows and in these bytes; what is packed states its size.
fn batch(arrays: &[Place], rows: i64, body: &[u8], is_packed: bool) -> Vec<u8> {
    let mut to = Builder::new();
    let header = arrays_of(&mut to, arrays, rows, is_packed).as_union_value();
    framed(
        &message(to, MessageHeader::RecordBatch, header, body.len()),
        body,
    )
}

fn arrays_of(
    to: &mut Builder,
    arrays: &[Place],
    rows: i64,
    is_packed: bool,
) -> WIPOffset<arrow_ipc::RecordBatch<'static>> {
    let nodes = vec![FieldNode::new(rows, 0); arrays.len()];
    let nodes = to.create_vector(&nodes);
    let buffers: Vec<Buffer> = (arrays.iter())
        .flat_map(|place| {
            let values = place.map(|(at, length)| Buffer::new(at, length));
            [Some(Buffer::new(0, 0)), values].into_iter().flatten()
        })
        .collect();
    let buffers = to.create_vector(&buffers);
    let compression = is_packed.then(|| {
        let mut compression = BodyCompressionBuilder::new(to);
        compression.add_codec(CompressionType::ZSTD);
        compression.finish()
    });
    let mut batch = RecordBatchBuilder::new(to);
    batch.add_length(rows);
    batch.add_nodes(nodes);
    batch.add_buffers(buffers);
    if let Some(compression) = compression {
        batch.add_compression(compression);
    }
    batch.finish()
}

fn all_names(names: Names, count: usize) -> Vec<String> {
    let table = ["time_s", "displacement_mm", "force_kN"].map(str::to_owned);
    table
        .into_iter()
        .chain((0..count).map(|index| names.of(index)))
        .collect()
}

fn cut(draw: &Draw, mut stream: Vec<u8>) -> Vec<u8> {
    stream.truncate(draw.size.file);
    stream
}

fn columns(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let rows = draw.count(1000);
    let count = draw.count((draw.size.file - 8 * rows) / (200 + names.longest()));
    let names = all_names(names, count);
    let body = vec![0; 8 * rows];
    let size = body.len() as i64;
    let mut stream = framed(&schema_of(&names, false), &[]);
    let arrays = vec![Some((0, size)); names.len()];
    stream.extend(batch(&arrays, rows as i64, &body, false));
    cut(draw, stream)
}

/// A schema in which many fields are the same, or have the same name or the same texts, in this number of bytes; and their number.
pub fn shared_schema(draw: &mut Draw, room: usize) -> (Vec<u8>, usize) {
    let mut to = Builder::new();
    let count = draw.count(room / 2 / 100);
    let entries = draw.count(1000);
    // A reader may believe a schema that is a few times its size when its parts are counted where they are used.
    let times = draw.one_of(&[1, 4, room]);
    let long = draw.count((times * room / 2 / count).min(room / 2));
    let said = draw.count((times * room / 4 / entries).min(room / 8));
    let name = text(&mut to, &"n".repeat(long));
    let is_one = draw.chance();
    let one = field(&mut to, name, None);
    let mut fields = vec![one; count];
    if !is_one {
        fields = (0..count).map(|_| field(&mut to, name, None)).collect();
    }
    let header = schema(&mut to, &fields, entries, said);
    (message(to, MessageHeader::Schema, header, 0), count)
}

fn shared(draw: &mut Draw) -> Vec<u8> {
    // With a batch, which takes 48 bytes for a field.
    let room = draw.size.file / 4 * 3;
    let (schema, count) = shared_schema(draw, room);
    let mut stream = framed(&schema, &[]);
    stream.extend(batch(&vec![Some((0, 24)); count], 3, &[0; 24], false));
    cut(draw, stream)
}

/// Fields in fields.
struct Nested {
    name: WIPOffset<&'static str>,
    wide: usize,
    /// Whether the fields of a structure are one.
    is_shared: bool,
}

impl Nested {
    /// A field with others in it to this depth, whose arrays are added.
    fn field(
        &self,
        to: &mut Builder,
        deep: usize,
        arrays: &mut Vec<Place>,
    ) -> WIPOffset<Field<'static>> {
        let Some(deep) = deep.checked_sub(1) else {
            arrays.push(Some((0, 24)));
            return field(to, self.name, None);
        };
        arrays.push(None);
        let inner = if self.is_shared {
            let mut of_one = Vec::new();
            let one = self.field(to, deep, &mut of_one);
            // Of more fields, no reader looks for the arrays.
            let times = if of_one.len() < 10_000 { self.wide } else { 1 };
            arrays.extend(of_one.repeat(times));
            vec![one; self.wide]
        } else {
            (0..self.wide)
                .map(|_| self.field(to, deep, arrays))
                .collect()
        };
        let kind = Struct_Builder::new(to).finish().as_union_value();
        let children = to.create_vector(&inner);
        let mut outer = FieldBuilder::new(to);
        outer.add_name(self.name);
        outer.add_type_type(Type::Struct_);
        outer.add_type_(kind);
        outer.add_children(children);
        outer.finish()
    }
}

fn depth(draw: &mut Draw) -> Vec<u8> {
    let mut to = Builder::new();
    let long = draw.count(1 << 12);
    let name = text(&mut to, &"n".repeat(long));
    let (wide, is_shared) = (draw.count(3), draw.chance());
    let mut deep = draw.count(60);
    if !is_shared && wide > 1 {
        deep = deep.min((draw.size.file / 500).ilog(wide) as usize);
    }
    let mut arrays = Vec::new();
    let nested = Nested {
        name,
        wide,
        is_shared,
    };
    let top = nested.field(&mut to, deep, &mut arrays);
    let header = schema(&mut to, &[top], 0, 0);
    let mut stream = framed(&message(to, MessageHeader::Schema, header, 0), &[]);
    stream.extend(batch(&arrays, 3, &[0; 24], false));
    cut(draw, stream)
}

/// Batches of few rows.
fn batches(draw: &mut Draw) -> Vec<u8> {
    let (columns, count) = draw.pair(60, draw.size.file / 2);
    let names = all_names(Names::Short, columns);
    let rows = draw.below(3) as i64;
    let body = vec![0; 8 * rows as usize];
    let size = body.len() as i64;
    let mut stream = framed(&schema_of(&names, false), &[]);
    let arrays = vec![Some((0, size)); names.len()];
    let one = batch(&arrays, rows, &body, false);
    for _ in 0..count {
        if stream.len() + one.len() > draw.size.file {
            break;
        }
        stream.extend(&one);
    }
    cut(draw, stream)
}

/// A file whose end lists one batch again and again.
fn blocks(draw: &mut Draw) -> Vec<u8> {
    let (columns, rows) = (draw.count(5000), draw.count(2000));
    let names = all_names(Names::Short, columns);
    let body = vec![0; 8 * rows];
    let size = body.len() as i64;
    let arrays = vec![Some((0, size)); names.len()];
    let one = batch(&arrays, rows as i64, &body, false);
    let head = one.len() - body.len();
    let mut bytes = Bytes::default();
    bytes.put(b"ARROW1\0\0").put(&one).pad(8);
    let count = draw.count((draw.size.file / 2) / 24);
    let blocks = vec![Block::new(8, head as i32, size); count];
    let mut to = Builder::new();
    let fields: Vec<_> = names
        .iter()
        .map(|name| {
            let name = text(&mut to, name);
            field(&mut to, name, None)
        })
        .collect();
    let fields = to.create_vector(&fields);
    let mut schema = SchemaBuilder::new(&mut to);
    schema.add_fields(fields);
    let schema = schema.finish();
    let blocks = to.create_vector(&blocks);
    let none = to.create_vector::<Block>(&[]);
    let mut footer = FooterBuilder::new(&mut to);
    footer.add_version(MetadataVersion::V5);
    footer.add_schema(schema);
    footer.add_dictionaries(none);
    footer.add_recordBatches(blocks);
    let footer = footer.finish();
    to.finish(footer, None);
    let footer = to.finished_data();
    bytes.put(footer).u32(footer.len() as u32).put(b"ARROW1");
    bytes.0
}

/// Dictionaries that grow, or are replaced, between batches that use them.
fn dictionaries(draw: &mut Draw) -> Vec<u8> {
    let columns = draw.count(50);
    let names = all_names(Names::Short, columns);
    let values = draw.count(4096);
    let is_delta = draw.chance();
    let body = vec![0; 8 * values];
    let size = body.len() as i64;
    let dictionary = |id: usize, is_delta: bool| {
        let mut to = Builder::new();
        let data = arrays_of(&mut to, &[Some((0, size))], values as i64, false);
        let mut dictionary = DictionaryBatchBuilder::new(&mut to);
        dictionary.add_id(id as i64);
        dictionary.add_data(data);
        dictionary.add_isDelta(is_delta);
        let header = dictionary.finish().as_union_value();
        framed(
            &message(to, MessageHeader::DictionaryBatch, header, body.len()),
            &body,
        )
    };
    let mut stream = framed(&schema_of(&names, true), &[]);
    for id in 3..names.len() {
        stream.extend(dictionary(id, false));
    }
    let rows = [0; 8];
    let arrays: Vec<Place> = (0..names.len())
        .map(|index| Some((0, if index < 3 { 8 } else { 1 })))
        .collect();
    let one = batch(&arrays, 1, &rows, false);
    let more = dictionary(3, is_delta);
    while stream.len() + one.len() + more.len() < draw.size.file {
        stream.extend(&one);
        if draw.chance() {
            stream.extend(&more);
        }
    }
    cut(draw, stream)
}

/// Arrays that share their bytes, and begin where they need be copied.
fn buffers(draw: &mut Draw) -> Vec<u8> {
    let (columns, rows) = draw.pair(8, 1 << 34);
    let columns = columns.min(draw.size.file / 2 / 240);
    let rows = rows.min(draw.size.file / 4 / 8);
    let names = all_names(Names::Short, columns);
    let body = vec![0; 8 * rows + 8];
    let shift = draw.one_of(&[0, 1]);
    let size = 8 * rows as i64;
    let mut stream = framed(&schema_of(&names, false), &[]);
    let arrays = vec![Some((shift, size)); names.len()];
    stream.extend(batch(&arrays, rows as i64, &body, false));
    cut(draw, stream)
}

/// Sizes and counts that are not true.
fn statements(draw: &mut Draw) -> Vec<u8> {
    let large = draw.one_of(&[1 << 24, 1 << 40, i64::MAX, -2]);
    let names = all_names(Names::Short, 0);
    let mut body = Bytes::default();
    body.put(&large.to_le_bytes()).put(&[0; 56]);
    let rows = if draw.chance() { large } else { 3 };
    let length = if draw.chance() { large } else { 64 };
    let is_packed = draw.chance();
    let mut stream = framed(&schema_of(&names, false), &[]);
    let arrays = vec![Some((0, length)); names.len()];
    stream.extend(batch(&arrays, rows, &body.0, is_packed));
    stream
}

//! HDF5, and MATLAB 7.3 in it: links, groups, fields, attributes and chunks. Written by hand, as tests run without another program.

use super::Grow;
use super::bytes::{Bytes, deflated};
use super::draw::{Draw, Names};

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("links", links),
    ("groups", groups),
    ("depth", depth),
    ("shared groups", shared_groups),
    ("fields", fields),
    ("attributes", attributes),
    ("chunks", chunks),
    ("thin chunks", thin_chunks),
    ("shared times", shared_times),
    ("labels", labels),
    ("matrices", matrices),
];

const UNDEFINED: u64 = u64::MAX;
/// Place of the address of the first group, in a superblock of version 0 and of version 2.
const ROOT: [usize; 2] = [64, 36];

/// A file under construction: objects, each after those that it links to.
struct File {
    bytes: Bytes,
    is_new: bool,
}

/// A message of an object's header: its type and its contents.
type Message = (u16, Vec<u8>);

impl File {
    fn new(is_new: bool) -> Self {
        let mut bytes = Bytes::default();
        bytes.put(b"\x89HDF\r\n\x1a\n");
        if is_new {
            bytes
                .put(&[2, 8, 8, 0])
                .u64(0)
                .u64(UNDEFINED)
                .u64(0)
                .u64(0)
                .u32(0);
        } else {
            bytes.put(&[0, 0, 0, 0, 0, 8, 8, 0, 4, 0, 16, 0, 0, 0, 0, 0]);
            bytes
                .u64(0)
                .u64(UNDEFINED)
                .u64(0)
                .u64(UNDEFINED)
                .u64(0)
                .u64(0)
                .u64(0)
                .u64(0)
                .u64(0);
        }
        Self { bytes, is_new }
    }

    fn put(&mut self, bytes: &[u8]) -> u64 {
        let at = self.bytes.pad(8).len() as u64;
        self.bytes.put(bytes);
        at
    }

    /// An object with these messages.
    fn object(&mut self, messages: &[Message]) -> u64 {
        let mut all = Bytes::default();
        for (kind, message) in messages {
            if self.is_new {
                all.u8(*kind as u8)
                    .u16(message.len() as u16)
                    .u8(0)
                    .put(message);
            } else {
                let size = message.len().next_multiple_of(8);
                all.u16(*kind).u16(size as u16).u32(0).put(message).pad(8);
            }
        }
        let mut header = Bytes::default();
        if self.is_new {
            header
                .put(b"OHDR")
                .put(&[2, 2])
                .u32(all.len() as u32)
                .put(&all.0);
            let sum = checksum(&header.0);
            header.u32(sum);
        } else {
            header
                .put(&[1, 0])
                .u16(messages.len().min(0xffff) as u16)
                .u32(1);
            header.u32(all.len() as u32).u32(0).put(&all.0);
        }
        self.put(&header.0)
    }

    fn group(&mut self, links: &[(String, u64)], more: &[Message]) -> u64 {
        let links = links.iter().map(|(name, at)| link(name, *at));
        let messages: Vec<Message> = links.chain(more.iter().cloned()).collect();
        self.object(&messages)
    }

    /// A column of numbers.
    fn column(&mut self, values: &[f64], more: &[Message]) -> u64 {
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let at = self.put(&bytes);
        let messages = [
            space(&[values.len() as u64]),
            float(),
            contiguous(at, bytes.len()),
        ];
        self.object(&[&messages[..], more].concat())
    }

    fn table(&mut self) -> Vec<(String, u64)> {
        let each = ["time_s", "displacement_mm", "force_kN"].iter().enumerate();
        let each = each.map(|(index, name)| {
            let values = [0.0, 1.0, 2.0].map(|row| row * (index + 1) as f64);
            ((*name).to_owned(), self.column(&values, &[]))
        });
        each.collect()
    }

    fn ended(mut self, draw: &Draw, root: u64) -> Vec<u8> {
        let end = self.bytes.len() as u64;
        self.bytes.set_u64(ROOT[usize::from(self.is_new)], root);
        if self.is_new {
            self.bytes.set_u64(28, end);
            let sum = checksum(&self.bytes.0[..44]);
            self.bytes.0[44..48].copy_from_slice(&sum.to_le_bytes());
        } else {
            self.bytes.set_u64(40, end);
        }
        self.bytes.0.truncate(draw.size.file);
        self.bytes.0
    }

    fn is_full(&self, draw: &Draw) -> bool {
        self.bytes.len() > draw.size.file - (1 << 14)
    }
}

fn link(name: &str, at: u64) -> Message {
    let mut message = Bytes::default();
    // With a length of one byte, or of four.
    if name.len() < 256 {
        message.put(&[1, 0, name.len() as u8]);
    } else {
        message.put(&[1, 2]).u32(name.len() as u32);
    }
    message.put(name.as_bytes()).u64(at);
    (6, message.0)
}

fn space(sizes: &[u64]) -> Message {
    let mut message = Bytes::default();
    message.put(&[1, sizes.len() as u8, 0, 0, 0, 0, 0, 0]);
    sizes.iter().for_each(|size| _ = message.u64(*size));
    (1, message.0)
}

/// A float of eight bytes.
fn float_type() -> Vec<u8> {
    let mut kind = Bytes::default();
    kind.put(&[0x11, 0x20, 0x3f, 0, 8, 0, 0, 0, 0, 0, 64, 0, 52, 11, 0, 52])
        .u32(1023);
    kind.0
}

fn float() -> Message {
    (3, float_type())
}

/// A text of this length in bytes.
fn text_type(bytes: usize) -> Vec<u8> {
    let mut kind = Bytes::default();
    kind.put(&[0x13, 0, 0, 0]).u32(bytes as u32);
    kind.0
}

fn contiguous(at: u64, bytes: usize) -> Message {
    let mut message = Bytes::default();
    message.put(&[3, 1]).u64(at).u64(bytes as u64);
    (8, message.0)
}

/// Data in the header itself.
fn compact(data: &[u8]) -> Message {
    let mut message = Bytes::default();
    message.put(&[3, 0]).u16(data.len() as u16).put(data);
    (8, message.0)
}

/// One packed chunk of these sizes, of elements of `bytes` bytes.
fn one_chunk(at: u64, packed: usize, sizes: &[u64], bytes: usize) -> [Message; 2] {
    let filters = vec![2, 1, 1, 0, 0, 0, 1, 0, 6, 0, 0, 0];
    let mut layout = Bytes::default();
    layout.put(&[4, 2, 2, 1 + sizes.len() as u8, 4]);
    sizes.iter().for_each(|size| _ = layout.u32(*size as u32));
    layout
        .u32(bytes as u32)
        .u8(1)
        .u64(packed as u64)
        .u32(0)
        .u64(at);
    [(0xb, filters), (8, layout.0)]
}

fn attribute(name: &str, kind: &[u8], data: &[u8]) -> Message {
    let mut message = Bytes::default();
    let space = [1, 0, 0, 0, 0, 0, 0, 0];
    message
        .put(&[1, 0])
        .u16(name.len() as u16 + 1)
        .u16(kind.len() as u16)
        .u16(8);
    message
        .put(name.as_bytes())
        .u8(0)
        .pad(8)
        .put(kind)
        .pad(8)
        .put(&space)
        .put(data);
    (0xc, message.0)
}

/// The attribute by which MATLAB tells what an object is.
fn class(name: &str) -> Message {
    attribute("MATLAB_class", &text_type(name.len()), name.as_bytes())
}

/// The checksum of the format, lookup3 of Jenkins.
fn checksum(bytes: &[u8]) -> u32 {
    let begin = 0xdead_beef_u32.wrapping_add(bytes.len() as u32);
    let [mut a, mut b, mut c] = [begin; 3];
    let word = |bytes: &[u8]| {
        let each = bytes.iter().enumerate();
        each.fold(0, |sum, (place, byte)| {
            sum | u32::from(*byte) << (8 * place)
        })
    };
    let mut rest = bytes;
    while rest.len() > 12 {
        a = a.wrapping_add(word(&rest[..4]));
        b = b.wrapping_add(word(&rest[4..8]));
        c = c.wrapping_add(word(&rest[8..12]));
        for turn in [[4, 6, 8], [16, 19, 4]] {
            a = a.wrapping_sub(c) ^ c.rotate_left(turn[0]);
            c = c.wrapping_add(b);
            b = b.wrapping_sub(a) ^ a.rotate_left(turn[1]);
            a = a.wrapping_add(c);
            c = c.wrapping_sub(b) ^ b.rotate_left(turn[2]);
            b = b.wrapping_add(a);
        }
        rest = &rest[12..];
    }
    if rest.is_empty() {
        return c;
    }
    let part = |from: usize| word(rest.get(from..rest.len().min(from + 4)).unwrap_or_default());
    a = a.wrapping_add(part(0));
    b = b.wrapping_add(part(4));
    c = c.wrapping_add(part(8));
    c = (c ^ b).wrapping_sub(b.rotate_left(14));
    a = (a ^ c).wrapping_sub(c.rotate_left(11));
    b = (b ^ a).wrapping_sub(a.rotate_left(25));
    c = (c ^ b).wrapping_sub(b.rotate_left(16));
    a = (a ^ c).wrapping_sub(c.rotate_left(4));
    b = (b ^ a).wrapping_sub(a.rotate_left(14));
    (c ^ b).wrapping_sub(b.rotate_left(24))
}

/// Many names of one set of data, or of many.
fn links(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let names = draw.names();
    let values = vec![1.0; draw.count(draw.size.file / 64)];
    let is_of_matlab = draw.chance();
    let more = if is_of_matlab {
        vec![class("double")]
    } else {
        Vec::new()
    };
    let shared = file.column(&values, &more);
    let is_shared = draw.chance();
    let each = names.longest() + 40 + if is_shared { 0 } else { 160 };
    let count = draw.fit(2 * each);
    let mut all = file.table();
    for index in 0..count {
        if file.is_full(draw) {
            break;
        }
        let at = if is_shared {
            shared
        } else {
            file.column(&[1.0, 2.0], &more)
        };
        all.push((format!("{}{index}", names.of(index)), at));
    }
    // An older header counts no more messages.
    if !file.is_new {
        all.truncate(60_000);
    }
    let root = file.group(&all, &[]);
    file.ended(draw, root)
}

/// Groups, each with a few sets of data or with none.
fn groups(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let names = draw.names();
    let is_of_matlab = draw.chance();
    let more = if is_of_matlab {
        vec![class("struct")]
    } else {
        Vec::new()
    };
    let column = file.column(&[1.0, 2.0, 3.0], &[]);
    let inner = draw.below(3);
    let count = draw.fit(120 + 60 * inner + 2 * names.longest());
    let mut all = file.table();
    for index in 0..count {
        if file.is_full(draw) {
            break;
        }
        let inner: Vec<(String, u64)> = (0..inner)
            .map(|index| (["time_s", "y"][index].to_owned(), column))
            .collect();
        let group = file.group(&inner, &more);
        all.push((format!("{}{index}", names.of(index)), group));
    }
    if !file.is_new {
        all.truncate(60_000);
    }
    let root = file.group(&all, &[]);
    file.ended(draw, root)
}

fn depth(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let name = draw.names().of(1);
    let mut inner = file.column(&[1.0, 2.0, 3.0], &[]);
    let count = draw.fit(100 + name.len());
    let count = if draw.chance() { count.min(60) } else { count };
    let is_of_matlab = draw.chance();
    let more = if is_of_matlab {
        vec![class("struct")]
    } else {
        Vec::new()
    };
    for _ in 0..count {
        if file.is_full(draw) {
            break;
        }
        inner = file.group(&[(name.clone(), inner)], &more);
    }
    let mut all = file.table();
    all.push(("top".into(), inner));
    let root = file.group(&all, &[]);
    file.ended(draw, root)
}

/// Groups that are reached by several links each.
fn shared_groups(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let (deep, wide) = (draw.count(300), draw.count(50));
    let is_of_matlab = draw.chance();
    let more = if is_of_matlab {
        vec![class("struct")]
    } else {
        Vec::new()
    };
    let long = draw.count(200);
    let mut inner = match draw.chance() {
        true => file.column(&[1.0, 2.0, 3.0], &[]),
        false => file.group(&[], &more),
    };
    for _ in 0..deep {
        if file.is_full(draw) {
            break;
        }
        let links: Vec<(String, u64)> = (0..wide)
            .map(|index| (Names::Long(long).of(index), inner))
            .collect();
        inner = file.group(&links, &more);
    }
    let mut all = file.table();
    all.push(("top".into(), inner));
    let root = file.group(&all, &more);
    file.ended(draw, root)
}

/// A compound of many fields.
fn fields(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let (names, array) = (draw.names(), draw.count(1 << 16));
    let of_array = draw.chance();
    let each = names.longest() + 64;
    let count = draw.count(60_000 / each);
    let size = 8 * if of_array { array } else { 1 };
    let mut kind = Bytes::default();
    kind.put(&[0x16])
        .u16(count as u16)
        .u8(0)
        .u32((size * count) as u32);
    for index in 0..count {
        kind.put(names.of(index).as_bytes()).u8(0).pad(8);
        kind.u32((size * index) as u32).u8(u8::from(of_array));
        kind.put(&[0; 3])
            .u32(0)
            .u32(0)
            .u32(if of_array { array as u32 } else { 0 });
        kind.u32(0).u32(0).u32(0).put(&float_type());
    }
    let (rows, wide) = draw.pair(1, 1 << 22);
    let sizes = [rows as u64, wide as u64];
    let at = file.put(&[0; 64]);
    let one = file.object(&[
        space(&sizes),
        (3, kind.0.clone()),
        contiguous(at, rows * wide * size * count),
    ]);
    let links = draw.count(2000);
    let mut all = file.table();
    all.extend((0..links).map(|index| (format!("c{index}"), one)));
    let root = file.group(&all, &[]);
    file.ended(draw, root)
}

fn attributes(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let names = draw.names();
    let long = draw.count(1 << 10);
    let text = "v".repeat(long);
    let (count, sets) = draw.pair(names.longest() + long + 64, draw.size.file / 2);
    let prefix = draw.one_of(&["scale", "unit", "", "note", "CLASS"]);
    let is_number = draw.chance();
    let all: Vec<Message> = (0..count.min(60_000))
        .map(|index| {
            let name = format!("{prefix}{}", names.of(index));
            match is_number {
                true => attribute(&name, &float_type(), &2.5_f64.to_le_bytes()),
                false => attribute(&name, &text_type(long), text.as_bytes()),
            }
        })
        .collect();
    let mut links = file.table();
    for index in 0..sets {
        if file.is_full(draw) {
            break;
        }
        let column = file.column(&[1.0, 2.0, 3.0], &all);
        links.push((format!("a{index}"), column));
    }
    let root = file.group(&links, &[]);
    file.ended(draw, root)
}

/// Packed chunks that many links share.
fn chunks(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let rows = draw.count(draw.size.unpacked / 8);
    let packed = deflated(&vec![0; 8 * rows]);
    let stated = draw.one_of(&[rows, rows / 2 + 1, 10 * rows]);
    let at = file.put(&packed);
    let sizes = [stated as u64];
    let [filters, layout] = one_chunk(at, packed.len(), &sizes, 8);
    let one = file.object(&[space(&sizes), float(), filters, layout]);
    let count = draw.count(3000);
    let (name, is_grouped) = (
        draw.one_of(&["t", "time_s", "y", "force_kN"]),
        draw.chance(),
    );
    let mut all = Vec::new();
    for index in 0..count {
        let at = match is_grouped {
            true => file.group(&[(name.to_owned(), one)], &[]),
            false => one,
        };
        all.push((format!("{name}{index}"), at));
    }
    let root = file.group(&all, &[]);
    file.ended(draw, root)
}

/// Labels of columns, as pandas keeps them, that many tables share.
/// A chunk that is wider than its data in the last of many dimensions, so that each value is copied alone.
fn thin_chunks(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let rows = draw.count(draw.size.unpacked / 16);
    let mut shape = vec![1; draw.count(31).max(2)];
    shape[0] = rows as u64;
    let mut chunk = shape.clone();
    chunk[shape.len() - 1] = 2;
    let packed = deflated(&vec![0; 16 * rows]);
    let at = file.put(&packed);
    let [filters, layout] = one_chunk(at, packed.len(), &chunk, 8);
    let messages = [space(&shape), float(), filters, layout];
    let names = ["time_s", "force_kN", "y"];
    let all = names.map(|name| (name.to_owned(), file.object(&messages)));
    let root = file.group(&all, &[]);
    file.ended(draw, root)
}

/// Groups that share times that were never written, with values that were not written either.
fn shared_times(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let rows = [draw.count(1 << 21) as u64];
    let unwritten = [space(&rows), float(), contiguous(u64::MAX, 0)];
    let times = file.object(&unwritten);
    let count = draw.fit(600);
    let mut all = Vec::new();
    for index in 0..count {
        if file.is_full(draw) {
            break;
        }
        let [y, force] = [(); 2].map(|()| file.object(&unwritten));
        let links = [("t", times), ("y", y), ("F", force)];
        let group = file.group(&links.map(|(name, at)| (name.to_owned(), at)), &[]);
        all.push((format!("g{index}"), group));
    }
    if !file.is_new {
        all.truncate(60_000);
    }
    let root = file.group(&all, &[]);
    file.ended(draw, root)
}

fn labels(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let long = draw.count(64);
    let count = draw.count(draw.size.unpacked / (4 * long));
    let packed = deflated(&vec![0; long * count]);
    let at = file.put(&packed);
    let sizes = [count as u64];
    let [filters, layout] = one_chunk(at, packed.len(), &sizes, long);
    let one = file.object(&[space(&sizes), (3, text_type(long)), filters, layout]);
    let mut all = file.table();
    let links = draw.count(2000);
    for index in 0..links {
        all.push((format!("b{index}_items"), one));
        if draw.chance() {
            all.push((format!("axis{index}"), one));
        }
    }
    let root = file.group(&all, &[]);
    file.ended(draw, root)
}

/// Sets of data of two sizes, in the header or after it.
fn matrices(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let (rows, wide) = draw.pair(8, draw.size.file / 8);
    let rank = draw.count(20);
    let mut sizes = vec![1; rank.max(2)];
    (sizes[0], sizes[1]) = (rows as u64, wide as u64);
    let data = vec![0; 8 * rows * wide];
    let is_compact = data.len() < 60_000 && draw.chance();
    let layout = match is_compact {
        true => compact(&data),
        false => {
            let at = file.put(&data);
            contiguous(at, data.len())
        }
    };
    let one = file.object(&[space(&sizes), float(), layout, class("double")]);
    let names = draw.names();
    let links = draw.count(1000);
    let mut all = file.table();
    all.extend((0..links).map(|index| (format!("{}{index}", names.of(index)), one)));
    let root = file.group(&all, &[]);
    file.ended(draw, root)
}

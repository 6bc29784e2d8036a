//! A file of HDF5 under construction. Written by hand, as tests run without another program.

use crate::grown::bytes::Bytes;
use crate::grown::draw::Draw;

const UNDEFINED: u64 = u64::MAX;
/// Place of the address of the first group, in a superblock of version 0 and of version 2.
const ROOT: [usize; 2] = [64, 36];

/// A file under construction: objects, each after those that it links to.
pub struct File {
    bytes: Bytes,
    pub is_new: bool,
}

/// A message of an object's header: its type and its contents.
pub type Message = (u16, Vec<u8>);

impl File {
    pub fn new(is_new: bool) -> Self {
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

    pub fn put(&mut self, bytes: &[u8]) -> u64 {
        let at = self.bytes.pad(8).len() as u64;
        self.bytes.put(bytes);
        at
    }

    /// An object with these messages.
    pub fn object(&mut self, messages: &[Message]) -> u64 {
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

    pub fn group(&mut self, links: &[(String, u64)], more: &[Message]) -> u64 {
        let links = links.iter().map(|(name, at)| link(name, *at));
        let messages: Vec<Message> = links.chain(more.iter().cloned()).collect();
        self.object(&messages)
    }

    /// A column of numbers.
    pub fn column(&mut self, values: &[f64], more: &[Message]) -> u64 {
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

    pub fn table(&mut self) -> Vec<(String, u64)> {
        let each = ["time_s", "displacement_mm", "force_kN"].iter().enumerate();
        let each = each.map(|(index, name)| {
            let values = [0.0, 1.0, 2.0].map(|row| row * (index + 1) as f64);
            ((*name).to_owned(), self.column(&values, &[]))
        });
        each.collect()
    }

    /// The message of attributes or links that lie in a heap, and are each listed this number of times.
    pub fn heap(&mut self, objects: &[Vec<u8>], times: usize, is_links: bool) -> Message {
        let heap = self.bytes.pad(8).len() as u64;
        // The one block comes after the head of the heap, which has 146 bytes.
        let block = heap + 152;
        let mut records = Bytes::default();
        let mut data = Bytes::default();
        data.put(b"FHDB\0").u64(heap).u32(0);
        let mut listed = 0;
        for object in objects {
            let (at, length) = (data.len() as u32, object.len() as u16);
            data.put(object);
            for _ in 0..times.min(60_000 - listed) {
                listed += 1;
                match is_links {
                    true => records.u32(0).u8(0).u32(at).u16(length),
                    false => records.u8(0).u32(at).u16(length).put(&[0; 10]),
                };
            }
        }
        let mut head = Bytes::default();
        head.put(b"FRHP\0").u16(8).u16(0).u8(0).u32(0xffff);
        head.u64(0).u64(UNDEFINED).u64(0).u64(UNDEFINED);
        (0..8).for_each(|_| _ = head.u64(0));
        let size = data.len().max(256);
        head.u16(4).u64(size as u64).u64(size as u64);
        head.u16(32).u16(0).u64(block).u16(0);
        let sum = checksum(&head.0);
        self.put(&head.u32(sum).pad(8).0);
        data.0.resize(size, 0);
        self.put(&data.0);

        let (kind, size) = if is_links { (5, 11) } else { (8, 17) };
        let mut leaf = Bytes::default();
        leaf.put(b"BTLF\0").u8(kind).put(&records.0);
        let sum = checksum(&leaf.0);
        let leaf = leaf.u32(sum);
        let mut index = Bytes::default();
        index.put(b"BTHD\0").u8(kind).u32(leaf.len() as u32);
        let root = self.put(&leaf.0);
        index.u16(size).u16(0).u8(100).u8(40).u64(root);
        index.u16(listed as u16).u64(listed as u64);
        let sum = checksum(&index.0);
        let index = self.put(&index.u32(sum).0);
        let mut message = Bytes::default();
        message.put(&[0, 0]).u64(heap).u64(index);
        (if is_links { 2 } else { 0x15 }, message.0)
    }

    pub fn ended(mut self, draw: &Draw, root: u64) -> Vec<u8> {
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

    pub fn is_full(&self, draw: &Draw) -> bool {
        self.bytes.len() > draw.size.file - (1 << 14)
    }
}

pub fn link(name: &str, at: u64) -> Message {
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

/// A link to a path of less than 64 kB.
pub fn soft(name: &str, path: &str) -> Message {
    let mut message = Bytes::default();
    message
        .put(&[1, 8, 1, name.len() as u8])
        .put(name.as_bytes());
    message.u16(path.len() as u16).put(path.as_bytes());
    (6, message.0)
}

/// A set of data of references to objects.
pub fn references_at(at: u64, count: usize, more: &[Message]) -> Vec<Message> {
    let kind = (3, vec![0x17, 0, 0, 0, 8, 0, 0, 0]);
    let data = contiguous(at, 8 * count);
    [&[space(&[count as u64]), kind, data], more].concat()
}

pub fn space(sizes: &[u64]) -> Message {
    let mut message = Bytes::default();
    message.put(&[1, sizes.len() as u8, 0, 0, 0, 0, 0, 0]);
    sizes.iter().for_each(|size| _ = message.u64(*size));
    (1, message.0)
}

/// A float of eight bytes.
pub fn float_type() -> Vec<u8> {
    let mut kind = Bytes::default();
    kind.put(&[0x11, 0x20, 0x3f, 0, 8, 0, 0, 0, 0, 0, 64, 0, 52, 11, 0, 52])
        .u32(1023);
    kind.0
}

pub fn float() -> Message {
    (3, float_type())
}

/// A text of this length in bytes.
pub fn text_type(bytes: usize) -> Vec<u8> {
    let mut kind = Bytes::default();
    kind.put(&[0x13, 0, 0, 0]).u32(bytes as u32);
    kind.0
}

pub fn contiguous(at: u64, bytes: usize) -> Message {
    let mut message = Bytes::default();
    message.put(&[3, 1]).u64(at).u64(bytes as u64);
    (8, message.0)
}

/// Data in the header itself.
pub fn compact(data: &[u8]) -> Message {
    let mut message = Bytes::default();
    message.put(&[3, 0]).u16(data.len() as u16).put(data);
    (8, message.0)
}

/// One packed chunk of these sizes, of elements of `bytes` bytes.
pub fn one_chunk(at: u64, packed: usize, sizes: &[u64], bytes: usize) -> [Message; 2] {
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

pub fn attribute(name: &str, kind: &[u8], data: &[u8]) -> Message {
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
pub fn class(name: &str) -> Message {
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

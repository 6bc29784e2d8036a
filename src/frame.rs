//! Frames of the link between a harness and the image of a rig.
//!
//! ```text
//! "MD"   u8 version   u8 kind   u32 sequence   u16 count   u16 length of the payload   payload   u32 CRC-32 of all before
//! ```
//! Numbers are little-endian; the CRC is that of Ethernet. Both ends take turns. The harness sends a request with a sequence number
//! that increases by one. The image answers with the same number, and repeats its last answer when the request is repeated. A frame
//! is written in one piece; one that a read did not receive whole is lost, and the request is repeated as for any loss. On a line
//! that delivers bytes in arbitrary pieces, [`extent`] finds the end of a frame.

/// The version written, and the only one read.
pub const VERSION: u8 = 7;
/// Largest payload, bytes.
pub const PAYLOAD: usize = 488;
/// Largest frame, bytes.
pub const LARGEST: usize = HEADER + PAYLOAD + TRAILER;

const HEADER: usize = 12;
const TRAILER: usize = 4;
const MAGIC: [u8; 2] = *b"MD";

/// CRC of each value of four bits, least significant bit first. A table for bytes would take 1 KiB of flash.
#[cfg(not(feature = "std"))]
const CRC_OF_NIBBLE: [u32; 16] = {
    let mut table = [0; 16];
    let mut nibble = 0;
    while nibble < 16 {
        let mut crc = nibble as u32;
        let mut bit = 0;
        while bit < 4 {
            crc = (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
            bit += 1;
        }
        table[nibble] = crc;
        nibble += 1;
    }
    table
};

/// [`checksum_with`] of no bytes.
pub(crate) const CHECKSUM: u32 = u32::MAX;

/// Ethernet's CRC-32 of `parts`, concatenated.
pub(crate) fn checksum(parts: &[&[u8]]) -> u32 {
    !parts
        .iter()
        .fold(CHECKSUM, |crc, part| checksum_with(crc, part))
}

/// Ethernet's CRC-32 before its final complement: continues `crc` by `part`. Not inlined, because there is more than one part.
#[cfg(not(feature = "std"))]
#[inline(never)]
pub(crate) fn checksum_with(crc: u32, part: &[u8]) -> u32 {
    let shifted = |crc: u32| (crc >> 4) ^ CRC_OF_NIBBLE[(crc % 16) as usize];
    let next = |crc: u32, byte: &u8| shifted(shifted(crc ^ u32::from(*byte)));
    part.iter().fold(crc, next)
}

/// The same with the processor's own instructions.
#[cfg(feature = "std")]
pub(crate) fn checksum_with(crc: u32, part: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(!crc);
    hasher.update(part);
    !hasher.finalize()
}

/// Header of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Header {
    /// Kind of the payload, as [`crate::message`] numbers it.
    pub kind: u8,
    /// Number of the exchange.
    pub sequence: u32,
    /// Number of ticks, motions or other items in the payload.
    pub count: u16,
}

/// A received frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Its header.
    pub header: Header,
    /// Its payload.
    pub payload: &'a [u8],
}

/// The frame being written. It stays until the next one, so that it can be sent again.
#[derive(Clone, Debug)]
pub struct FrameBuffer {
    bytes: [u8; LARGEST],
    length: usize,
}

impl Default for FrameBuffer {
    fn default() -> Self {
        Self::new()
    }
}

impl FrameBuffer {
    /// An empty buffer.
    pub const fn new() -> Self {
        Self {
            bytes: [0; LARGEST],
            length: 0,
        }
    }

    /// Writes a new frame whose payload `write` writes. If the payload does not fit, the frame's end is left out too, so that no
    /// receiver takes it for whole.
    #[inline]
    pub fn write(&mut self, header: Header, write: impl FnOnce(&mut Writer<'_>)) {
        let (_, rest) = self.bytes.split_at_mut(HEADER);
        let (payload, _) = rest.split_at_mut(PAYLOAD);
        let mut writer = Writer::new(payload);
        write(&mut writer);
        let length = writer.left().map(|left| PAYLOAD.saturating_sub(left));
        self.seal(header, length);
    }

    /// Puts the header before a payload of `length` bytes and the checksum after it. Not inlined, because a separate function
    /// writes each kind of frame.
    #[inline(never)]
    fn seal(&mut self, header: Header, length: Option<usize>) {
        self.length = 0;
        let Some(length) = length else {
            return;
        };
        let (place, _) = self.bytes.split_at_mut(HEADER);
        let [m0, m1] = MAGIC;
        let mut writer = Writer::new(place);
        writer.words([
            u32::from_le_bytes([m0, m1, VERSION, header.kind]),
            header.sequence,
            u32::from(header.count) | (length as u32) << 16,
        ]);
        let end = HEADER + length;
        if let Some((covered, trailer)) = self.bytes.split_at_mut_checked(end)
            && let Some(trailer) = trailer.first_chunk_mut()
        {
            *trailer = checksum(&[covered]).to_le_bytes();
            self.length = end + TRAILER;
        }
    }

    /// The bytes of the frame.
    #[inline]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}

/// Writes a payload.
#[derive(Debug)]
pub struct Writer<'a> {
    rest: &'a mut [u8],
    full: bool,
}

impl<'a> Writer<'a> {
    /// A writer into `room`.
    pub fn new(room: &'a mut [u8]) -> Self {
        Self {
            rest: room,
            full: false,
        }
    }

    /// Writes bytes unchanged.
    #[inline(always)]
    pub fn bytes(&mut self, bytes: &[u8]) {
        match core::mem::take(&mut self.rest).split_at_mut_checked(bytes.len()) {
            Some((place, rest)) => {
                place.copy_from_slice(bytes);
                self.rest = rest;
            }
            None => self.full = true,
        }
    }

    /// Writes words of four bytes each.
    #[inline(always)]
    pub fn words<const N: usize>(&mut self, values: [u32; N]) {
        match core::mem::take(&mut self.rest).split_at_mut_checked(4 * N) {
            Some((place, rest)) => {
                let (chunks, _) = place.as_chunks_mut();
                for (chunk, value) in chunks.iter_mut().zip(values) {
                    *chunk = value.to_le_bytes();
                }
                self.rest = rest;
            }
            None => self.full = true,
        }
    }

    /// Writes one byte.
    #[inline(always)]
    pub fn u8(&mut self, value: u8) {
        self.bytes(&[value]);
    }

    /// Writes two bytes.
    #[inline(always)]
    pub fn u16(&mut self, value: u16) {
        self.bytes(&value.to_le_bytes());
    }

    /// Writes four bytes.
    #[inline(always)]
    pub fn u32(&mut self, value: u32) {
        self.bytes(&value.to_le_bytes());
    }

    /// Writes four bytes, bit for bit.
    #[inline(always)]
    pub fn f32(&mut self, value: f32) {
        self.u32(value.to_bits());
    }

    /// Bytes left in the room; `None` if something did not fit.
    pub fn left(&self) -> Option<usize> {
        (!self.full).then_some(self.rest.len())
    }
}

/// Reads a payload; every method returns `None` at its end.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    #[inline(always)]
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }

    /// Reads words of four bytes each.
    #[inline(always)]
    pub fn words<const N: usize>(&mut self) -> Option<[u32; N]> {
        let (bytes, rest) = self.0.split_at_checked(4 * N)?;
        self.0 = rest;
        let (chunks, _) = bytes.as_chunks();
        let mut words = [0; N];
        for (word, chunk) in words.iter_mut().zip(chunks) {
            *word = u32::from_le_bytes(*chunk);
        }
        Some(words)
    }

    /// Reads one byte.
    #[inline(always)]
    pub fn u8(&mut self) -> Option<u8> {
        let [byte] = self.take()?;
        Some(byte)
    }

    /// Reads two bytes.
    #[inline(always)]
    pub fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    /// Reads four bytes.
    #[inline]
    pub fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    /// Reads four bytes, bit for bit.
    #[inline(always)]
    pub fn f32(&mut self) -> Option<f32> {
        self.u32().map(f32::from_bits)
    }

    /// All remaining bytes.
    #[inline(always)]
    pub fn rest(&mut self) -> &'a [u8] {
        core::mem::take(&mut self.0)
    }
}

/// A type that goes over the link field by field, four bytes each.
pub trait Fields: Sized {
    /// Writes all fields.
    fn write(&self, writer: &mut Writer<'_>);

    /// Reads the fields that [`Fields::write`] wrote; `None` if they are incomplete.
    fn read(reader: &mut Reader<'_>) -> Option<Self>;
}

/// The two halves of `value`, the lower one first.
pub(crate) fn halves(value: u64) -> [u32; 2] {
    [value as u32, (value >> 32) as u32]
}

/// Joins two [`halves`].
pub(crate) fn whole([low, high]: [u32; 2]) -> u64 {
    u64::from(low) | u64::from(high) << 32
}

/// Iterates over the whole and undamaged frames in received bytes, in order, and skips the bytes between them.
#[derive(Clone, Copy, Debug)]
pub struct Frames<'a>(pub &'a [u8]);

impl<'a> Iterator for Frames<'a> {
    type Item = Frame<'a>;

    #[inline]
    fn next(&mut self) -> Option<Frame<'a>> {
        while self.0.len() >= HEADER + TRAILER {
            if let Some((frame, rest)) = first(self.0) {
                self.0 = rest;
                return Some(frame);
            }
            let (_, rest) = self.0.split_first()?;
            self.0 = rest;
        }
        None
    }
}

/// Result of [`extent`] for the bytes at the head of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// The beginning of a frame, or no bytes: more have to arrive.
    More,
    /// A frame of this many bytes if it is undamaged, of any version: [`Frames`] checks it for damage.
    Frame(usize),
    /// This many bytes do not begin a frame.
    Junk(usize),
}

/// Finds out whether `bytes` begin with a frame, and how long it is. A damaged length may ask for bytes that never arrive, so treat
/// a line that has been idle for a while as the end of a frame too.
#[inline]
pub fn extent(bytes: &[u8]) -> Extent {
    let [m0, m1] = MAGIC;
    if let Some(junk) = bytes
        .iter()
        .position(|byte| *byte == m0)
        .filter(|at| *at > 0)
    {
        return Extent::Junk(junk);
    }
    match bytes {
        [] => return Extent::More,
        [first, ..] if *first != m0 => return Extent::Junk(bytes.len()),
        [_, second, ..] if *second != m1 => return Extent::Junk(1),
        _ => {}
    }
    let Some(&[.., low, high]) = bytes.first_chunk::<HEADER>() else {
        return Extent::More;
    };
    let length = usize::from(u16::from_le_bytes([low, high]));
    let whole = HEADER + length + TRAILER;
    if length > PAYLOAD {
        Extent::Junk(1)
    } else if bytes.len() < whole {
        Extent::More
    } else {
        Extent::Frame(whole)
    }
}

/// Version of the first undamaged frame in `bytes` whose version differs from [`VERSION`]: the other end of the link uses that
/// version.
pub fn other_version(bytes: &[u8]) -> Option<u8> {
    let mut rest = bytes;
    while let [_, next @ ..] = rest {
        if let Extent::Frame(whole) = extent(rest)
            && let Some((frame, _)) = rest.split_at_checked(whole)
            && let Some((covered, stated)) = frame.split_last_chunk::<TRAILER>()
            && checksum(&[covered]) == u32::from_le_bytes(*stated)
            && let [_, _, version, ..] = covered
            && *version != VERSION
        {
            return Some(*version);
        }
        rest = next;
    }
    None
}

/// The frame at the beginning of `bytes`, and the bytes after it.
#[inline]
fn first(bytes: &[u8]) -> Option<(Frame<'_>, &[u8])> {
    let mut reader = Reader(bytes);
    if reader.take()? != MAGIC || reader.u8()? != VERSION {
        return None;
    }
    let header = Header {
        kind: reader.u8()?,
        sequence: reader.u32()?,
        count: reader.u16()?,
    };
    let length = usize::from(reader.u16()?);
    let (covered, rest) = bytes.split_at_checked(HEADER + length)?;
    let (stated, rest) = rest.split_first_chunk::<TRAILER>()?;
    if checksum(&[covered]) != u32::from_le_bytes(*stated) {
        return None;
    }
    let payload = covered.get(HEADER..)?;
    Some((Frame { header, payload }, rest))
}

//! A file of MDF4 under construction.

use crate::grown::bytes::{Bytes, deflated};
use crate::grown::draw::Draw;

pub const HEADER: u64 = 64;
/// Place in a block of its link with this number.
pub fn link(block: u64, number: usize) -> usize {
    block as usize + 24 + 8 * number
}

/// A file under construction: blocks, each after those that it links to.
pub struct File(pub Bytes);

/// Kinds of channels: of values, of times, and of times that are computed of the row.
pub const VALUES: [u8; 2] = [0, 0];
pub const TIMES: [u8; 2] = [2, 1];
pub const VIRTUAL: [u8; 2] = [3, 1];

/// A channel's parts that others may share.
#[derive(Clone, Copy, Default)]
pub struct Channel {
    pub name: u64,
    pub unit: u64,
    pub conversion: u64,
    pub composition: u64,
    pub comment: u64,
    pub kind: [u8; 2],
    pub at: u32,
}

impl File {
    pub fn new() -> Self {
        let mut bytes = Bytes::default();
        bytes
            .put(b"MDF     4.10    grown   ")
            .u32(0)
            .u16(410)
            .pad(64);
        let mut file = Self(bytes);
        let mut start = Bytes::default();
        start.u64(0).u64(0).u64(0).u64(0);
        file.block("##HD", &[0; 6], &start.0);
        file
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn block(&mut self, id: &str, links: &[u64], data: &[u8]) -> u64 {
        let at = self.0.pad(8).len() as u64;
        let length = 24 + 8 * links.len() + data.len();
        self.0
            .put(id.as_bytes())
            .u32(0)
            .u64(length as u64)
            .u64(links.len() as u64);
        links.iter().for_each(|link| _ = self.0.u64(*link));
        self.0.put(data);
        at
    }

    pub fn text(&mut self, text: &str) -> u64 {
        let mut data = Bytes::default();
        data.put(text.as_bytes()).u8(0).pad(8);
        self.block("##TX", &[], &data.0)
    }

    /// A channel of floats of eight bytes, after which comes `next`.
    pub fn channel(&mut self, next: u64, of: Channel) -> u64 {
        let links = [
            next,
            of.composition,
            of.name,
            0,
            of.conversion,
            0,
            of.unit,
            of.comment,
        ];
        let mut data = Bytes::default();
        data.put(&of.kind)
            .u8(4)
            .u8(0)
            .u32(of.at)
            .u32(64)
            .u32(0)
            .u32(0)
            .u32(0);
        (0..6).for_each(|_| _ = data.u64(0));
        self.block("##CN", &links, &data.0)
    }

    /// A group of channels with this number of rows of this size in bytes, as a group of data.
    pub fn group(&mut self, next: u64, first: u64, rows: u64, bytes: u32, data: u64) -> u64 {
        let group = self.channels(0, 0, first, rows, bytes);
        self.data(next, group, data, 0)
    }

    /// A group of channels, whose records begin with this number if their group of data has several.
    pub fn channels(&mut self, next: u64, number: u64, first: u64, rows: u64, bytes: u32) -> u64 {
        let mut of_group = Bytes::default();
        of_group
            .u64(number)
            .u64(rows)
            .u16(0)
            .u16(0)
            .u32(0)
            .u32(bytes)
            .u32(0);
        self.block("##CG", &[next, first, 0, 0, 0, 0], &of_group.0)
    }

    /// A group of data, whose records begin with a number of this width in bytes.
    pub fn data(&mut self, next: u64, group: u64, data: u64, width: u8) -> u64 {
        self.block(
            "##DG",
            &[next, group, data, 0],
            &[width, 0, 0, 0, 0, 0, 0, 0],
        )
    }

    /// A group with a table.
    pub fn table(&mut self, next: u64) -> u64 {
        let mut channels = 0;
        for (index, name) in ["force_kN", "displacement_mm", "time_s"].iter().enumerate() {
            let name = self.text(name);
            let of = Channel {
                name,
                kind: if index == 2 { TIMES } else { VALUES },
                at: 8 * (2 - index as u32),
                ..Channel::default()
            };
            channels = self.channel(channels, of);
        }
        let mut data = Bytes::default();
        for row in 0..3 {
            (0..3).for_each(|column| _ = data.f64(f64::from(row * (column + 1))));
        }
        let data = self.block("##DT", &[], &data.0);
        self.group(next, channels, 3, 24, data)
    }

    pub fn packed(&mut self, records: &[u8]) -> u64 {
        let packed = deflated(records);
        let mut data = Bytes::default();
        data.put(b"DT")
            .u8(0)
            .u8(0)
            .u32(0)
            .u64(records.len() as u64)
            .u64(packed.len() as u64);
        data.put(&packed).pad(8);
        self.block("##DZ", &[], &data.0)
    }

    /// The file, whose groups begin with `first`.
    pub fn ended(mut self, draw: &Draw, first: u64) -> Vec<u8> {
        self.0.set_u64(link(HEADER, 0), first);
        self.0.pad(8);
        self.0.0.truncate(draw.size.file);
        self.0.0
    }

    pub fn is_full(&self, draw: &Draw) -> bool {
        self.len() > draw.size.file - (1 << 14)
    }
}

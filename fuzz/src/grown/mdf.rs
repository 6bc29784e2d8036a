//! MDF4: channels, groups, texts, conversions and lists of data.

use super::Grow;
use super::bytes::{Bytes, deflated};
use super::draw::Draw;

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("channels", channels),
    ("groups", groups),
    ("texts", texts),
    ("marks", marks),
    ("conversions", conversions),
    ("compositions", compositions),
    ("data lists", data_lists),
    ("packed groups", packed_groups),
    ("cycles", cycles),
];

const HEADER: u64 = 64;
/// Place in a block of its link with this number.
fn link(block: u64, number: usize) -> usize {
    block as usize + 24 + 8 * number
}

/// A file under construction: blocks, each after those that it links to.
struct File(Bytes);

/// A channel's parts that others may share.
#[derive(Clone, Copy, Default)]
struct Channel {
    name: u64,
    unit: u64,
    conversion: u64,
    composition: u64,
    comment: u64,
    is_time: bool,
    at: u32,
}

impl File {
    fn new() -> Self {
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

    fn len(&self) -> usize {
        self.0.len()
    }

    fn block(&mut self, id: &str, links: &[u64], data: &[u8]) -> u64 {
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

    fn text(&mut self, text: &str) -> u64 {
        let mut data = Bytes::default();
        data.put(text.as_bytes()).u8(0).pad(8);
        self.block("##TX", &[], &data.0)
    }

    /// A channel of floats of eight bytes, after which comes `next`.
    fn channel(&mut self, next: u64, of: Channel) -> u64 {
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
        let kind = if of.is_time { [2, 1] } else { [0, 0] };
        let mut data = Bytes::default();
        data.put(&kind)
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

    /// Groups of channels with this number of rows of this size in bytes, as a group of data.
    fn group(&mut self, next: u64, first: u64, rows: u64, bytes: u32, data: u64) -> u64 {
        let mut of_group = Bytes::default();
        of_group
            .u64(0)
            .u64(rows)
            .u16(0)
            .u16(0)
            .u32(0)
            .u32(bytes)
            .u32(0);
        let group = self.block("##CG", &[0, first, 0, 0, 0, 0], &of_group.0);
        self.block("##DG", &[next, group, data, 0], &[0; 8])
    }

    /// A group with a table.
    fn table(&mut self, next: u64) -> u64 {
        let mut channels = 0;
        for (index, name) in ["force_kN", "displacement_mm", "time_s"].iter().enumerate() {
            let name = self.text(name);
            let of = Channel {
                name,
                is_time: index == 2,
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

    fn packed(&mut self, records: &[u8]) -> u64 {
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
    fn ended(mut self, draw: &Draw, first: u64) -> Vec<u8> {
        self.0.set_u64(link(HEADER, 0), first);
        self.0.pad(8);
        self.0.0.truncate(draw.size.file);
        self.0.0
    }

    fn is_full(&self, draw: &Draw) -> bool {
        self.len() > draw.size.file - (1 << 14)
    }
}

fn channels(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let (is_shared, has_unit) = (draw.chance(), draw.chance());
    let each = 24 + 64 + 72 + if is_shared { 0 } else { 40 + names.longest() };
    let count = draw.fit(each);
    let mut file = File::new();
    let long = if draw.chance() {
        draw.count(draw.size.file / 4)
    } else {
        4
    };
    let shared = file.text(&"n".repeat(long));
    let unit = if has_unit { file.text("kN") } else { 0 };
    let mut next = 0;
    for index in 0..count {
        if file.is_full(draw) {
            break;
        }
        let name = if is_shared {
            shared
        } else {
            file.text(&names.of(index))
        };
        let of = Channel {
            name,
            unit,
            comment: if draw.chance() { shared } else { 0 },
            at: if draw.chance() { 0 } else { index as u32 },
            ..Channel::default()
        };
        next = file.channel(next, of);
    }
    let data = file.block("##DT", &[], &[0; 4096]);
    let rows = draw.one_of(&[0, 1, 4, 1 << 20]);
    let group = file.group(0, next, rows, 1024, data);
    let table = file.table(group);
    file.ended(draw, table)
}

fn groups(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let is_shared = draw.chance();
    let mut file = File::new();
    let name = file.text(&names.of(1));
    let of = Channel {
        name,
        is_time: draw.chance(),
        ..Channel::default()
    };
    let shared = file.channel(0, of);
    let data = file.block("##DT", &[], &[0; 64]);
    let count = draw.fit(if is_shared { 170 } else { 340 });
    let mut next = 0;
    for index in 0..count {
        if file.is_full(draw) {
            break;
        }
        let first = if is_shared {
            shared
        } else {
            file.channel(0, of)
        };
        let rows = if draw.chance() { 8 } else { index as u64 };
        next = file.group(next, first, rows, 8, data);
    }
    let table = file.table(next);
    file.ended(draw, table)
}

/// Long texts that many things share.
fn texts(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new();
    let long = draw.count(draw.size.file / 2);
    let word = draw.one_of(&["n", "kN ", "<TX>a</TX>", "[", "\u{fc}"]);
    let text = word.repeat(long / word.len());
    let shared = match draw.chance() {
        true => file.text(&text),
        false => {
            let text = format!("<CNcomment><TX>{text}</TX></CNcomment>");
            let mut data = Bytes::default();
            data.put(text.as_bytes()).u8(0).pad(8);
            file.block("##MD", &[], &data.0)
        }
    };
    let count = draw.count((draw.size.file / 2) / 180);
    let which = draw.below(3);
    let mut next = 0;
    for _ in 0..count {
        if file.is_full(draw) {
            break;
        }
        let mut of = Channel {
            name: shared,
            ..Channel::default()
        };
        match which {
            0 => of.unit = shared,
            1 => of.comment = shared,
            _ => {}
        }
        next = file.channel(next, of);
    }
    let data = file.block("##DT", &[], &[0; 64]);
    let group = file.group(0, next, 8, 8, data);
    let table = file.table(group);
    file.0.set_u64(link(HEADER, 5), shared);
    file.ended(draw, table)
}

/// Marks of blocks that are none.
fn marks(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new();
    let table = file.table(0);
    let mark = draw.one_of(&[
        "##TX\0\0\0\0",
        "##MD",
        "##DT\0\0\0\0",
        "##CN\0\0\0\0\u{18}\0\0\0\0\0\0\0",
        "####",
    ]);
    file.0.pad(8);
    let count = draw.fit(mark.len());
    file.0.put(mark.repeat(count).as_bytes());
    file.ended(draw, table)
}

fn conversions(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new();
    let (refs, values) = draw.pair(16, draw.size.file / 4);
    let text = file.text(&"t".repeat(draw.count(1 << 10)));
    let kind = draw.below(12) as u8;
    let conversion = |file: &mut File, inner: u64, refs: usize, values: usize| {
        let mut links = vec![0, 0, 0, 0];
        links.resize(4 + refs, inner);
        let mut data = Bytes::default();
        data.u8(kind)
            .u8(0)
            .u16(0)
            .u16(refs as u16)
            .u16(values as u16)
            .f64(0.0)
            .f64(0.0);
        (0..values).for_each(|index| _ = data.f64(index as f64));
        file.block("##CC", &links, &data.0)
    };
    let mut one = conversion(&mut file, text, refs.min(60_000), values.min(60_000));
    // Conversions that refer to one another.
    for _ in 0..draw.count(500) {
        if file.is_full(draw) {
            break;
        }
        let refs = draw.count(4);
        one = conversion(&mut file, one, refs, 2);
    }
    let count = draw.count(20_000);
    let mut next = 0;
    for _ in 0..count {
        if file.is_full(draw) {
            break;
        }
        let of = Channel {
            name: text,
            conversion: one,
            ..Channel::default()
        };
        next = file.channel(next, of);
    }
    let data = file.block("##DT", &[], &[0; 64]);
    let group = file.group(0, next, 8, 8, data);
    let table = file.table(group);
    file.ended(draw, table)
}

/// Channels in channels.
fn compositions(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new();
    let name = file.text(&draw.names().of(7));
    let count = draw.fit(160);
    let width = draw.count(4);
    let mut inner = 0;
    for index in 0..count {
        if file.is_full(draw) {
            break;
        }
        let of = Channel {
            name,
            composition: inner,
            ..Channel::default()
        };
        // Both the next one and what it is composed of.
        let next = if index % width == 0 { 0 } else { inner };
        inner = file.channel(next, of);
    }
    let data = file.block("##DT", &[], &[0; 64]);
    let group = file.group(0, inner, 8, 8, data);
    let table = file.table(group);
    file.ended(draw, table)
}

/// Lists of the same data again and again, packed or not.
fn data_lists(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new();
    let size = draw.count(1 << 20).next_multiple_of(8);
    let plain = vec![0; size];
    let is_packed = draw.chance();
    let data = match is_packed {
        true => file.packed(&plain),
        false => file.block("##DT", &[], &plain),
    };
    let most = (draw.size.unpacked / size).min(draw.size.file / 16);
    let count = draw.count(most);
    let mut next = 0;
    let mut left = count;
    let width = draw.count(count);
    while left > 0 && !file.is_full(draw) {
        let here = width.min(left);
        let mut links = vec![next];
        links.resize(1 + here, data);
        let mut about = Bytes::default();
        about.u8(1).u8(0).u16(0).u32(here as u32).u64(size as u64);
        next = file.block("##DL", &links, &about.0);
        left -= here;
    }
    let name = file.text("F");
    let of = Channel {
        name,
        ..Channel::default()
    };
    let channel = file.channel(0, of);
    let rows = (count * size / 8) as u64;
    let group = file.group(0, channel, rows, 8, next);
    let table = file.table(group);
    file.ended(draw, table)
}

/// Links that lead back.
/// Groups of the same packed records, which are unpacked for the times of each and for its values.
fn packed_groups(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new();
    let rows = draw.count(1 << 18);
    let records = file.packed(&vec![0; 16 * rows]);
    let most = draw.size.unpacked / (16 * rows);
    let count = match draw.chance() {
        true => draw.count(most),
        false => draw.fit(500),
    };
    let mut next = 0;
    for _ in 0..count {
        if file.is_full(draw) {
            break;
        }
        let [y, time] = ["y", "t"].map(|name| file.text(name));
        let value = file.channel(
            0,
            Channel {
                name: y,
                at: 8,
                ..Channel::default()
            },
        );
        let time = file.channel(
            value,
            Channel {
                name: time,
                is_time: true,
                ..Channel::default()
            },
        );
        next = file.group(next, time, rows as u64, 16, records);
    }
    let table = file.table(next);
    file.ended(draw, table)
}

fn cycles(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new();
    let name = file.text(&draw.names().of(3));
    let count = draw.count(1000);
    let mut all = Vec::new();
    let mut next = 0;
    for _ in 0..count {
        let of = Channel {
            name,
            ..Channel::default()
        };
        next = file.channel(next, of);
        all.push(next);
    }
    let back = draw.below(2);
    file.0.set_u64(link(all[0], back), draw.one_of(&all));
    let data = file.block("##DT", &[], &[0; 64]);
    let group = file.group(0, next, 8, 8, data);
    if draw.chance() {
        file.0.set_u64(link(group, 0), group);
    }
    let table = file.table(group);
    file.ended(draw, table)
}

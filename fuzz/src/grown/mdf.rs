//! MDF4: channels, groups, texts, conversions and lists of data.

mod file;

use super::Grow;
use super::bytes::Bytes;
use super::draw::Draw;
use file::{Channel, File, HEADER, TIMES, VALUES, VIRTUAL, link};

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("channels", channels),
    ("groups", groups),
    ("texts", texts),
    ("marks", marks),
    ("conversions", conversions),
    ("compositions", compositions),
    ("arrays", arrays),
    ("virtual times", virtual_times),
    ("unsorted records", unsorted),
    ("data lists", data_lists),
    ("packed groups", packed_groups),
    ("cycles", cycles),
];

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
        kind: draw.one_of(&[VALUES, TIMES]),
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

/// Channels of arrays of many dimensions, which consist of arrays again.
fn arrays(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new();
    let elements = draw.count(2000);
    let (rank, deep) = (draw.count(1000), draw.count(60));
    let mut inner = 0;
    for _ in 0..deep {
        let mut about = Bytes::default();
        about.u8(0).u8(0).u16(rank as u16).u32(0).u32(8).u32(0);
        about.u64(elements as u64);
        (1..rank).for_each(|_| _ = about.u64(1));
        inner = file.block("##CA", &[inner], &about.0);
        if draw.chance() || file.is_full(draw) {
            break;
        }
    }
    let names = draw.names();
    let mut next = 0;
    for index in 0..draw.fit(200 + names.longest()) {
        if file.is_full(draw) {
            break;
        }
        let of = Channel {
            name: file.text(&names.of(index)),
            composition: inner,
            ..Channel::default()
        };
        next = file.channel(next, of);
    }
    let bytes = 8 * elements;
    let data = file.packed(&vec![0; 4 * bytes]);
    let group = file.group(0, next, 4, bytes as u32, data);
    let table = file.table(group);
    file.ended(draw, table)
}

/// Groups whose times are computed, with values in records or with none.
fn virtual_times(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new();
    let rows = draw.count(draw.size.unpacked / 8);
    let data = match draw.chance() {
        true => file.packed(&vec![0; 8 * rows]),
        false => 0,
    };
    let rows = if data > 0 {
        rows as u64
    } else {
        draw.one_of(&[1000, 1 << 20, 1 << 40])
    };
    let name = file.text("t");
    let mut next = 0;
    for _ in 0..draw.fit(500) {
        if file.is_full(draw) {
            break;
        }
        let values = match data {
            0 => 0,
            _ => file.channel(
                0,
                Channel {
                    name,
                    ..Channel::default()
                },
            ),
        };
        let times = Channel {
            name,
            kind: VIRTUAL,
            ..Channel::default()
        };
        let times = file.channel(values, times);
        next = file.group(next, times, rows, if data > 0 { 8 } else { 0 }, data);
    }
    let table = file.table(next);
    file.ended(draw, table)
}

/// Records of many groups in one piece, each with the number of its group before it.
fn unsorted(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new();
    let names = draw.names();
    let count = draw.count(255);
    let size = draw.one_of(&[0, 8]);
    let mut groups = 0;
    for number in 0..count {
        let mut first = 0;
        for index in 0..draw.count(20) {
            let name = file.text(&names.of(index));
            first = file.channel(
                first,
                Channel {
                    name,
                    ..Channel::default()
                },
            );
        }
        groups = file.channels(groups, number as u64, first, 0, size);
    }
    let record = 1 + size as usize;
    let rows = draw.count(draw.size.unpacked / record);
    let mut records = vec![0; rows * record];
    for (row, record) in records.chunks_exact_mut(record).enumerate() {
        record[0] = (row % count) as u8;
    }
    let records = file.packed(&records);
    let data = file.data(0, groups, records, 1);
    let table = file.table(data);
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
                kind: TIMES,
                ..Channel::default()
            },
        );
        next = file.group(next, time, rows as u64, 16, records);
    }
    let table = file.table(next);
    file.ended(draw, table)
}

/// Links that lead back, or none.
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
    if draw.chance() {
        file.0.set_u64(link(all[0], back), draw.one_of(&all));
    }
    let data = file.block("##DT", &[], &[0; 64]);
    let group = file.group(0, next, 8, 8, data);
    if draw.chance() {
        file.0.set_u64(link(group, 0), group);
    }
    let table = file.table(group);
    file.ended(draw, table)
}

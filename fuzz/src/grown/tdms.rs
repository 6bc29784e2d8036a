//! TDMS: segments, objects, properties and the scalers of DAQmx.

use super::Grow;
use super::bytes::Bytes;
use super::draw::Draw;

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("objects", objects),
    ("segments", segments),
    ("properties", properties),
    ("scalers", scalers),
    ("clocks", clocks),
    ("scales", scales),
    ("lists", lists),
    ("empty counts", empty_counts),
];

const METADATA: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const RAW: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const DAQMX: u32 = 1 << 7;
const NONE: u32 = 0xffff_ffff;
/// The types of values: a float of eight bytes, a byte, a text, an integer of four bytes, and a date.
const DOUBLE: u32 = 10;
const BYTE: u32 = 5;
const TEXT: u32 = 0x20;
const INTEGER: u32 = 3;
const DATE: u32 = 0x44;

fn text(bytes: &mut Bytes, text: &str) {
    bytes.u32(text.len() as u32).put(text.as_bytes());
}

/// A segment of a list of objects and raw values.
fn segment(metadata: &[u8], raw: &[u8], bits: u32) -> Vec<u8> {
    let mut bytes = Bytes::default();
    bytes.put(b"TDSm").u32(bits).u32(4713);
    bytes
        .u64((metadata.len() + raw.len()) as u64)
        .u64(metadata.len() as u64);
    bytes.put(metadata).put(raw);
    bytes.0
}

/// A segment of a new list of objects and raw values.
fn listed(metadata: &[u8], raw: &[u8]) -> Vec<u8> {
    segment(metadata, raw, METADATA | NEW_LIST | RAW)
}

/// An object with values of this type, and properties that are written already.
fn object(bytes: &mut Bytes, path: &str, kind: u32, rows: u64, properties: &[Vec<u8>]) {
    text(bytes, path);
    bytes.u32(20).u32(kind).u32(1).u64(rows);
    bytes.u32(properties.len() as u32);
    properties
        .iter()
        .for_each(|property| _ = bytes.put(property));
}

fn number(name: &str, value: f64) -> Vec<u8> {
    let mut bytes = Bytes::default();
    text(&mut bytes, name);
    bytes.u32(DOUBLE).f64(value);
    bytes.0
}

fn words(name: &str, value: &str) -> Vec<u8> {
    let mut bytes = Bytes::default();
    text(&mut bytes, name);
    bytes.u32(TEXT);
    text(&mut bytes, value);
    bytes.0
}

fn integer(name: &str, value: u32) -> Vec<u8> {
    let mut bytes = Bytes::default();
    text(&mut bytes, name);
    bytes.u32(INTEGER).u32(value);
    bytes.0
}

/// A segment with a table.
fn table() -> Vec<u8> {
    let mut list = Bytes::default();
    list.u32(3);
    let mut raw = Bytes::default();
    for (index, name) in ["time_s", "displacement_mm", "force_kN"].iter().enumerate() {
        object(&mut list, &format!("/'g'/'{name}'"), DOUBLE, 3, &[]);
        (0..3).for_each(|row| _ = raw.f64((index * row) as f64));
    }
    listed(&list.0, &raw.0)
}

fn path(names: super::draw::Names, index: usize) -> String {
    format!("/'g'/'{}'", names.of(index).replace('\'', ""))
}

fn objects(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let (count, again) = draw.pair(names.longest() + 40, draw.size.file * 7 / 8);
    let is_interleaved = draw.chance();
    let mut list = Bytes::default();
    list.u32(count as u32);
    (0..count).for_each(|index| object(&mut list, &path(names, index), BYTE, 1, &[]));
    let raw = vec![1; count];
    let bits = METADATA | NEW_LIST | RAW | if is_interleaved { INTERLEAVED } else { 0 };
    let mut file = table();
    for _ in 0..again {
        file.extend(segment(&list.0, &raw, bits));
    }
    file.truncate(draw.size.file);
    file
}

/// Segments that repeat the objects of the first, each with a few values.
fn segments(draw: &mut Draw) -> Vec<u8> {
    let (objects, count) = draw.pair(40, draw.size.file * 7 / 8);
    let mut list = Bytes::default();
    list.u32(objects as u32);
    let names = super::draw::Names::Short;
    (0..objects).for_each(|index| object(&mut list, &path(names, index), BYTE, 1, &[]));
    let raw = vec![1; objects];
    let mut file = listed(&list.0, &raw);
    // An object that is written again with the values that it had.
    let mut same = Bytes::default();
    let again = draw.one_of(&[0, 1, 2]).min(objects);
    same.u32(again as u32);
    for index in 0..again {
        text(&mut same, &path(names, index));
        same.u32(0).u32(0);
    }
    let bits = RAW | if again > 0 { METADATA } else { 0 };
    let metadata = if again > 0 { &same.0[..] } else { &[] };
    let raw = if draw.chance() { &raw[..] } else { &[] };
    let next = segment(metadata, raw, bits);
    for _ in 0..count {
        if file.len() + next.len() > draw.size.file {
            break;
        }
        file.extend(&next);
    }
    file
}

fn properties(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let value = "v".repeat(draw.count(64));
    let (objects, count) = draw.pair(names.longest() + value.len() + 12, draw.size.file / 2);
    let is_same = draw.chance();
    let name = |index| {
        if is_same {
            "unit_string".to_owned()
        } else {
            names.of(index)
        }
    };
    let properties: Vec<Vec<u8>> = (0..count)
        .map(|index| words(&name(index), &value))
        .collect();
    let mut list = Bytes::default();
    list.u32(objects as u32);
    for index in 0..objects {
        let place = if draw.chance() {
            "/".to_owned()
        } else {
            path(names, index)
        };
        object(&mut list, &place, BYTE, 1, &properties);
    }
    let mut file = table();
    file.extend(listed(&list.0, &vec![1; objects]));
    file.truncate(draw.size.file);
    file
}

fn scalers(draw: &mut Draw) -> Vec<u8> {
    let (count, again) = (draw.count(draw.size.file / 40), draw.count(30_000));
    let is_same = draw.chance();
    let mut list = Bytes::default();
    list.u32(1);
    text(&mut list, "/'g'/'a'");
    list.u32(0x1269).u32(NONE).u32(1).u64(1).u32(count as u32);
    for index in 0..count {
        let id = if is_same { 0 } else { index as u32 };
        list.u32(0).u32(0).u32(0).u32(0).u32(id);
    }
    list.u32(1).u32(1).u32(0);
    let mut file = segment(&list.0, &[1], METADATA | NEW_LIST | RAW | DAQMX);
    let next = segment(&[], &[1], RAW | DAQMX);
    for _ in 0..again {
        if file.len() + next.len() > draw.size.file {
            break;
        }
        file.extend(&next);
    }
    file
}

/// Clocks of many channels, or of one whose step and start change with its segments.
fn clocks(draw: &mut Draw) -> Vec<u8> {
    let (count, again) = draw.pair(130, draw.size.file * 7 / 8);
    let is_same = draw.chance();
    let groups = draw.one_of(&[1, count]);
    let mut file = Vec::new();
    for change in 0..again {
        let mut list = Bytes::default();
        list.u32(count as u32);
        for index in 0..count {
            let step = 1.0 + (change + if is_same { 0 } else { index }) as f64 * 1e-6;
            let properties = [start(change), number("wf_increment", step)];
            let path = format!("/'g{}'/'c{index}'", index % groups);
            object(&mut list, &path, BYTE, 1, &properties);
        }
        file.extend(listed(&list.0, &vec![1; 2 * count]));
    }
    file.truncate(draw.size.file);
    file
}

/// The start of a clock, this many seconds after 1904.
fn start(seconds: usize) -> Vec<u8> {
    let mut bytes = Bytes::default();
    text(&mut bytes, "wf_start_time");
    bytes.u32(DATE).u64(0).u64(seconds as u64);
    bytes.0
}

/// Scales that refer to one another.
fn scales(draw: &mut Draw) -> Vec<u8> {
    let count = draw.count(draw.size.file / 200);
    let stated = draw.one_of(&[count, 0, u32::MAX as usize]);
    let kind = draw.one_of(&["Linear", "Polynomial", "Table", "Add", "Subtract", "RTD"]);
    let mut properties = vec![integer("NI_Number_Of_Scales", stated as u32)];
    for index in 0..count {
        let name = |what: &str| format!("NI_Scale[{index}]_{what}");
        properties.push(words(&name("Scale_Type"), kind));
        properties.push(number(&name(&format!("{kind}_Slope")), 1.0));
        let source = draw.one_of(&[index.wrapping_sub(1), index, count - 1, 0]);
        properties.push(integer(
            &name(&format!("{kind}_Input_Source")),
            source as u32,
        ));
    }
    let channels = draw.count(8);
    let mut list = Bytes::default();
    list.u32(channels as u32);
    for index in 0..channels {
        object(&mut list, &format!("/'g'/'c{index}'"), BYTE, 3, &properties);
        if list.len() > draw.size.file / 2 {
            break;
        }
    }
    let mut file = table();
    file.extend(listed(&list.0, &vec![1; 3 * channels]));
    file.truncate(draw.size.file);
    file
}

/// Lists of the same object again and again, and objects without values.
fn lists(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let name = path(names, 0);
    let count = draw.fit(name.len() + 12);
    let index = draw.one_of(&[0, NONE]);
    let mut list = Bytes::default();
    list.u32(count as u32);
    for _ in 0..count {
        text(&mut list, &name);
        list.u32(index).u32(0);
    }
    let mut first = Bytes::default();
    first.u32(1);
    object(&mut first, &name, BYTE, 1, &[]);
    let mut file = listed(&first.0, &[1]);
    file.extend(segment(&list.0, &[1; 64], METADATA | RAW));
    file.truncate(draw.size.file);
    file
}

/// Many chunks of one value, in which other channels have none.
fn empty_counts(draw: &mut Draw) -> Vec<u8> {
    let names = super::draw::Names::Short;
    let (count, chunks) = draw.pair(40, draw.size.file / 2);
    let count = count.min(draw.size.file / 100);
    let mut one = Bytes::default();
    one.u32(count as u32 + 1);
    object(&mut one, &path(names, count), BYTE, 1, &[]);
    (0..count).for_each(|index| object(&mut one, &path(names, index), BYTE, 1, &[]));
    let mut file = listed(&one.0, &vec![1; count + 1]);
    let mut empty = Bytes::default();
    empty.u32(count as u32);
    (0..count).for_each(|index| object(&mut empty, &path(names, index), BYTE, 0, &[]));
    let raw = vec![1; 40 * chunks];
    file.extend(segment(&empty.0, &raw, METADATA | RAW));
    file.truncate(draw.size.file);
    file
}

//! MATLAB 5: variables, structures, cells and what is packed.

use super::Grow;
use super::bytes::{Bytes, deflated};
use super::draw::Draw;

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("variables", variables),
    ("fields", fields),
    ("cells", cells),
    ("depth", depth),
    ("packed", packed),
    ("dimensions", dimensions),
    ("types", types),
];

const CELL: u32 = 1;
const STRUCTURE: u32 = 2;
const CHARACTERS: u32 = 4;
const DOUBLE: u32 = 6;

/// An element of a type, which is padded.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = Bytes::default();
    bytes.u32(kind).u32(data.len() as u32).put(data).pad(8);
    bytes.0
}

/// A matrix of a class, with the elements after its name.
fn matrix(class: u32, dimensions: &[i32], name: &str, rest: &[u8]) -> Vec<u8> {
    let dimensions: Vec<u8> = dimensions
        .iter()
        .flat_map(|size| size.to_le_bytes())
        .collect();
    let flags = [class.to_le_bytes(), [0; 4]].concat();
    let parts = [
        element(6, &flags),
        element(5, &dimensions),
        element(1, name.as_bytes()),
        rest.to_vec(),
    ];
    element(14, &parts.concat())
}

fn column(name: &str, values: &[f64]) -> Vec<u8> {
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    matrix(DOUBLE, &[values.len() as i32, 1], name, &element(9, &bytes))
}

/// A file with a table beside what grows, which is packed or not.
fn file(draw: &mut Draw, grown: &[u8]) -> Vec<u8> {
    let mut bytes = Bytes::default();
    bytes.put(format!("{:<124}", "MATLAB 5.0 MAT-file").as_bytes());
    bytes.u16(0x0100).put(b"IM");
    for name in ["time_s", "displacement_mm", "force_kN"] {
        bytes.put(&column(name, &[0.0, 1.0, 2.0]));
    }
    let is_packed = draw.chance() || grown.len() + bytes.len() > draw.size.file;
    if !is_packed {
        return bytes.put(grown).0.clone();
    }
    let stream = deflated(&grown[..grown.len().min(draw.size.unpacked)]);
    if stream.len() + 1024 <= draw.size.file {
        bytes.u32(15).u32(stream.len() as u32).put(&stream);
    }
    bytes.0
}

fn room(draw: &mut Draw) -> usize {
    if draw.chance() {
        draw.size.file - 2048
    } else {
        draw.size.unpacked
    }
}

fn variables(draw: &mut Draw) -> Vec<u8> {
    let (names, room) = (draw.names(), room(draw));
    let values = draw.count(64);
    let most = room / (72 + names.longest() + 8 * values);
    let count = draw.count(most);
    let data = vec![1.0; values];
    let grown: Vec<u8> = (0..count)
        .flat_map(|index| column(&names.of(index), &data))
        .collect();
    file(draw, &grown)
}

/// The names of a structure's fields, each in as many bytes as the longest, and its elements.
fn structure(names: &[String], elements: usize, inner: &[u8], name: &str) -> Vec<u8> {
    let longest = 1 + names.iter().map(String::len).max().unwrap_or(0);
    let mut text = Vec::new();
    for name in names {
        text.extend(name.bytes());
        text.resize(text.len().next_multiple_of(longest).max(longest), 0);
    }
    let mut rest = element(5, &(longest as i32).to_le_bytes());
    rest.extend(element(1, &text));
    rest.extend(inner.repeat(names.len() * elements));
    matrix(STRUCTURE, &[1, elements as i32], name, &rest)
}

/// An element without contents, or a small array.
fn inner(draw: &mut Draw) -> Vec<u8> {
    match draw.below(3) {
        0 => element(14, &[]),
        1 => column("", &[1.0, 2.0]),
        _ => matrix(CHARACTERS, &[1, 2], "", &element(16, b"kN")),
    }
}

fn fields(draw: &mut Draw) -> Vec<u8> {
    let (inner, room, long) = (inner(draw), room(draw), draw.count(1 << 20));
    let (count, elements) = draw.pair(inner.len() + 8, room / 2);
    let names = draw.names();
    let mut names: Vec<String> = (0..count).map(|index| names.of(index)).collect();
    // Each name takes as many bytes as the longest.
    if long * count < room / 2 {
        names[0] = "f".repeat(long);
    }
    let name = draw.one_of(&["s", "time", "data"]);
    let grown = structure(&names, elements, &inner, name);
    file(draw, &grown)
}

fn cells(draw: &mut Draw) -> Vec<u8> {
    let (inner, room, long) = (inner(draw), room(draw), draw.count(1 << 20));
    let count = draw.count((room - long) / inner.len());
    let name = "c".repeat(long);
    let grown = matrix(CELL, &[1, count as i32], &name, &inner.repeat(count));
    file(draw, &grown)
}

fn depth(draw: &mut Draw) -> Vec<u8> {
    let deep = draw.count(3000);
    let long = draw.count(64);
    let is_of_cells = draw.chance();
    let mut grown = column("", &[1.0, 2.0, 3.0]);
    for level in 0..deep {
        let names: Vec<String> = (0..1 + level % 2).map(|_| "f".repeat(long)).collect();
        grown = match is_of_cells {
            true => matrix(CELL, &[1, 1], "", &grown),
            false => structure(&names[..1], 1, &grown, ""),
        };
        if grown.len() > draw.size.file / 2 {
            break;
        }
    }
    file(draw, &grown)
}

/// Many packed variables, or packed ones in packed ones.
fn packed(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let size = draw.count(draw.size.unpacked / 8);
    let inner = matrix(
        DOUBLE,
        &[(size / 8) as i32, 1],
        &names.of(0),
        &element(9, &vec![0; size / 8 * 8]),
    );
    let mut stream = deflated(&inner);
    for _ in 0..draw.below(3) {
        let mut packed = Bytes::default();
        packed.u32(15).u32(stream.len() as u32).put(&stream);
        stream = deflated(&packed.0);
    }
    let most = (draw.size.file / (stream.len() + 8)).min(draw.size.unpacked / inner.len());
    let count = draw.count(most);
    let mut grown = Bytes::default();
    for _ in 0..count {
        grown.u32(15).u32(stream.len() as u32).put(&stream);
    }
    let mut whole = file(draw, &[]);
    whole.extend(grown.0);
    whole.truncate(draw.size.file);
    whole
}

/// Arrays of many dimensions, or of sizes that are not there.
fn dimensions(draw: &mut Draw) -> Vec<u8> {
    let count = draw.count(1 << 12);
    let size = draw.one_of(&[0, 1, 2, 1000, i32::MAX, -1]);
    let mut sizes = vec![1; count];
    let at = draw.below(count);
    sizes[at] = size;
    let class = draw.one_of(&[CELL, STRUCTURE, CHARACTERS, DOUBLE, 5]);
    let one = matrix(class, &sizes, "x", &element(9, &[0; 16]));
    let most = draw.size.file / one.len();
    let grown = one.repeat(draw.count(most));
    file(draw, &grown)
}

/// Small elements of every class and type.
fn types(draw: &mut Draw) -> Vec<u8> {
    let mut grown = Vec::new();
    let most = draw.size.file / 2;
    let length = draw.count(most);
    while grown.len() < length {
        let class = draw.below(20) as u32;
        let kind = draw.below(20) as u32;
        let data = vec![1; draw.count(64)];
        grown.extend(matrix(class, &[2, 2], "v", &element(kind, &data)));
    }
    file(draw, &grown)
}

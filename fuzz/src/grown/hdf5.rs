//! HDF5, and MATLAB 7.3 in it: links, groups, fields, attributes and chunks.

mod file;

use super::Grow;
use super::bytes::{Bytes, deflated};
use super::draw::{Draw, Names};
use file::{
    File, Message, attribute, class, compact, contiguous, float, float_type, link, one_chunk,
    references_at, soft, space, text_type,
};

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("links", links),
    ("groups", groups),
    ("depth", depth),
    ("shared groups", shared_groups),
    ("paths", paths),
    ("references", references),
    ("fields", fields),
    ("attributes", attributes),
    ("dense", dense),
    ("chunks", chunks),
    ("thin chunks", thin_chunks),
    ("shared times", shared_times),
    ("labels", labels),
    ("matrices", matrices),
];

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

/// Links to paths that lead on through other paths, back, or in circles.
fn paths(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let (deep, wide) = (draw.count(200), draw.count(50));
    let around = format!("{}n", "./".repeat(draw.count(2000)));
    let deeper = format!("{}y", "n/".repeat(deep.min(2000)));
    let path = draw.one_of(&["n", "n/a", "n/a/a/a/a", "/", "/top/a", &around, &deeper]);
    let mut inner = file.column(&[1.0, 2.0, 3.0], &[]);
    for level in 0..deep {
        if file.is_full(draw) {
            break;
        }
        let paths: Vec<Message> = (0..wide)
            .map(|index| soft(&Names::Short.of(index), path))
            .collect();
        let name = if level == 0 { "y" } else { "n" };
        inner = file.group(&[(name.to_owned(), inner)], &paths);
    }
    let mut all = file.table();
    all.push(("top".into(), inner));
    let root = file.group(&all, &[soft("p", "/q"), soft("q", "/p"), soft("r", path)]);
    file.ended(draw, root)
}

/// Cells of MATLAB, each of which refers to the one before many times, or fields that do.
fn references(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let values = vec![1.0; draw.count(1 << 14)];
    let mut inner = file.column(&values, &[class("double")]);
    let (deep, wide) = (draw.count(60), draw.count(4000));
    let names = draw.names();
    let mut all = file.table();
    let mut cells = Vec::new();
    for level in 0..deep {
        if file.is_full(draw) {
            break;
        }
        let to = file.put(&inner.to_le_bytes().repeat(wide));
        inner = file.object(&references_at(to, wide, &[class("cell")]));
        cells.push((format!("c{level}"), inner));
        if draw.chance() {
            let of_fields = file.object(&references_at(to, wide, &[]));
            let fields: Vec<(String, u64)> = (0..draw.count(100))
                .map(|index| (names.of(index), of_fields))
                .collect();
            let structure = file.group(&fields, &[class("struct")]);
            all.push((format!("s{level}"), structure));
        }
    }
    all.push(("#refs#".into(), file.group(&cells, &[])));
    all.push(("top".into(), inner));
    let root = file.group(&all, &[]);
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

/// Attributes or links that lie in a heap, some of them listed many times.
fn dense(draw: &mut Draw) -> Vec<u8> {
    let mut file = File::new(draw.chance());
    let (names, is_links) = (draw.names(), draw.chance());
    let long = draw.count(1 << 10);
    let text = "v".repeat(long);
    let column = file.column(&[1.0, 2.0, 3.0], &[]);
    let most = (draw.size.file - (1 << 14)) / (names.longest() + long + 80);
    let objects: Vec<Vec<u8>> = (0..draw.count(most.min(60_000)))
        .map(|index| match is_links {
            true => link(&names.of(index), column).1,
            false => attribute(&names.of(index), &text_type(long), text.as_bytes()).1,
        })
        .collect();
    let times = if draw.chance() { draw.count(1000) } else { 1 };
    let heap = file.heap(&objects, times, is_links);
    let mut all = file.table();
    for index in 0..draw.count(1000) {
        if file.is_full(draw) {
            break;
        }
        let one = match is_links {
            true => file.group(&[], std::slice::from_ref(&heap)),
            false => file.column(&[1.0, 2.0, 3.0], std::slice::from_ref(&heap)),
        };
        all.push((format!("d{index}"), one));
    }
    let root = file.group(&all, &[]);
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

/// Labels of columns, as pandas keeps them, that many tables share.
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

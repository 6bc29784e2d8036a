//! Parquet: columns, names, groups of rows, pages and what they state of themselves. Written by hand: its writers make only what is true.

use super::Grow;
use super::arrow;
use super::bytes::{Bytes, gzipped};
use super::draw::Draw;

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("columns", columns),
    ("nested names", nested),
    ("row groups", row_groups),
    ("repeated values", repeated),
    ("pages", pages),
    ("dictionaries", dictionaries),
    ("statements", statements),
    ("metadata", metadata),
    ("schemas", schemas),
];

const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCTURE: u8 = 12;
const DOUBLE: i64 = 5;
const BYTES: i64 = 6;

/// A value of Thrift's compact protocol.
enum Value {
    Integer(i64),
    Binary(Vec<u8>),
    /// The type of its elements, and each as it is written.
    List(u8, Vec<Vec<u8>>),
    Structure(Vec<u8>),
}

fn word(mut number: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while number > 0x7f {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
    bytes
}

fn integer(value: i64) -> Vec<u8> {
    word((value << 1 ^ value >> 63) as u64)
}

fn binary(bytes: &[u8]) -> Vec<u8> {
    [&word(bytes.len() as u64)[..], bytes].concat()
}

/// A structure of fields, each with its number.
fn structure(fields: &[(i64, Value)]) -> Vec<u8> {
    let mut bytes = Bytes::default();
    for (number, value) in fields {
        let kind = match value {
            Value::Integer(_) => 6,
            Value::Binary(_) => BINARY,
            Value::List(..) => LIST,
            Value::Structure(_) => STRUCTURE,
        };
        bytes.u8(kind).put(&integer(*number));
        match value {
            Value::Integer(value) => bytes.put(&integer(*value)),
            Value::Binary(value) => bytes.put(&binary(value)),
            Value::List(kind, each) => {
                bytes.u8(0xf0 | kind).put(&word(each.len() as u64));
                bytes.put(&each.concat())
            }
            Value::Structure(value) => bytes.put(value),
        };
    }
    bytes.u8(0);
    bytes.0
}

/// A field of the schema: a column of this type, or a group of this number of fields.
fn field(name: &str, kind: i64, children: i64) -> Vec<u8> {
    let name = (4, Value::Binary(name.into()));
    match children {
        0 => structure(&[(1, Value::Integer(kind)), (3, Value::Integer(0)), name]),
        children => structure(&[(3, Value::Integer(0)), name, (5, Value::Integer(children))]),
    }
}

/// A page of values, or of a dictionary.
struct Page<'p> {
    is_dictionary: bool,
    values: i64,
    encoding: i64,
    unpacked: i64,
    bytes: &'p [u8],
}

impl Page<'_> {
    fn written(&self) -> Vec<u8> {
        let values = (1, Value::Integer(self.values));
        let encoding = (2, Value::Integer(self.encoding));
        let (kind, number, about) = match self.is_dictionary {
            true => (2, 7, structure(&[values, encoding])),
            false => {
                let levels = [(3, Value::Integer(3)), (4, Value::Integer(3))];
                let [a, b] = levels;
                (0, 5, structure(&[values, encoding, a, b]))
            }
        };
        let header = structure(&[
            (1, Value::Integer(kind)),
            (2, Value::Integer(self.unpacked)),
            (3, Value::Integer(self.bytes.len() as i64)),
            (number, Value::Structure(about)),
        ]);
        [&header, self.bytes].concat()
    }
}

/// A plain page of floats.
fn plain(values: &[f64]) -> Vec<u8> {
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let page = Page {
        is_dictionary: false,
        values: values.len() as i64,
        encoding: 0,
        unpacked: bytes.len() as i64,
        bytes: &bytes,
    };
    page.written()
}

/// Where the pages of a column are, and what is stated of them.
#[derive(Clone, Copy)]
struct Chunk {
    at: usize,
    length: usize,
    values: i64,
    codec: i64,
    has_dictionary: bool,
}

impl Chunk {
    fn written(&self, name: &str) -> Vec<u8> {
        let length = self.length as i64;
        let mut about = vec![
            (1, Value::Integer(DOUBLE)),
            (2, Value::List(5, vec![integer(0), integer(8)])),
            (3, Value::List(BINARY, vec![binary(name.as_bytes())])),
            (4, Value::Integer(self.codec)),
            (5, Value::Integer(self.values)),
            (6, Value::Integer(length)),
            (7, Value::Integer(length)),
            (9, Value::Integer(self.at as i64)),
        ];
        if self.has_dictionary {
            about.push((11, Value::Integer(self.at as i64)));
        }
        structure(&[
            (2, Value::Integer(self.at as i64)),
            (3, Value::Structure(structure(&about))),
        ])
    }
}

/// A file of these pages, fields, groups of rows and texts.
fn file(
    draw: &Draw,
    pages: &[u8],
    fields: Vec<Vec<u8>>,
    rows: i64,
    groups: Vec<Vec<u8>>,
    texts: Vec<Vec<u8>>,
) -> Vec<u8> {
    let footer = structure(&[
        (1, Value::Integer(1)),
        (2, Value::List(STRUCTURE, fields)),
        (3, Value::Integer(rows)),
        (4, Value::List(STRUCTURE, groups)),
        (5, Value::List(STRUCTURE, texts)),
    ]);
    let mut bytes = Bytes::default();
    bytes.put(b"PAR1").put(pages);
    // Without its footer it would be no file: the pages are cut.
    bytes
        .0
        .truncate(draw.size.file.saturating_sub(footer.len() + 8));
    bytes.put(&footer).u32(footer.len() as u32).put(b"PAR1");
    bytes.0.truncate(draw.size.file);
    bytes.0
}

fn group(chunks: Vec<Vec<u8>>, rows: i64) -> Vec<u8> {
    structure(&[
        (1, Value::List(STRUCTURE, chunks)),
        (2, Value::Integer(0)),
        (3, Value::Integer(rows)),
    ])
}

const TABLE: [&str; 3] = ["time_s", "displacement_mm", "force_kN"];

/// A file of columns that all have the same pages, after those of a table.
fn of_columns(draw: &Draw, names: &[String], pages: &[u8], chunk: Chunk, groups: usize) -> Vec<u8> {
    let names: Vec<&str> = TABLE
        .into_iter()
        .chain(names.iter().map(String::as_str))
        .collect();
    let mut fields = vec![field("root", 0, names.len() as i64)];
    fields.extend(names.iter().map(|name| field(name, DOUBLE, 0)));
    let chunks: Vec<Vec<u8>> = names.iter().map(|name| chunk.written(name)).collect();
    let groups = vec![group(chunks, chunk.values); groups];
    let rows = chunk.values.saturating_mul(groups.len() as i64);
    file(draw, pages, fields, rows, groups, Vec::new())
}

fn one_chunk(pages: &[u8], values: usize) -> Chunk {
    Chunk {
        at: 4,
        length: pages.len(),
        values: values as i64,
        codec: 0,
        has_dictionary: false,
    }
}

fn columns(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let values = draw.count(1000);
    let pages = plain(&vec![1.0; values]);
    let count = draw.count((draw.size.file - pages.len()) / (150 + 2 * names.longest()));
    let names: Vec<String> = (0..count).map(|index| names.of(index)).collect();
    of_columns(draw, &names, &pages, one_chunk(&pages, values), 1)
}

/// Groups of fields in groups of fields.
fn nested(draw: &mut Draw) -> Vec<u8> {
    let (deep, long) = (draw.count(40), draw.count(draw.size.file / 4));
    let count = draw.count(draw.size.file / 300);
    let pages = plain(&[1.0, 2.0, 3.0]);
    let chunk = one_chunk(&pages, 3);
    let mut fields = vec![field("root", 0, 1)];
    let each = long / deep + 1;
    for level in 0..deep {
        let children = if level + 1 == deep { count } else { 1 };
        fields.push(field(&"g".repeat(each), 0, children as i64));
    }
    fields.extend((0..count).map(|index| field(&format!("c{index}"), DOUBLE, 0)));
    let chunks = (0..count).map(|index| chunk.written(&format!("c{index}")));
    let groups = vec![group(chunks.collect(), 3)];
    file(draw, &pages, fields, 3, groups, Vec::new())
}

/// Groups of rows with the same pages.
fn row_groups(draw: &mut Draw) -> Vec<u8> {
    let values = draw.one_of(&[0, 1, 100, 1 << 12]);
    let pages = plain(&vec![1.0; values]);
    let (columns, groups) = draw.pair(80, draw.size.file / 2);
    let names: Vec<String> = (0..columns).map(|index| format!("c{index}")).collect();
    of_columns(draw, &names, &pages, one_chunk(&pages, values), groups)
}

/// A dictionary of one value, and runs of it.
fn runs(values: usize) -> Vec<u8> {
    let dictionary = Page {
        is_dictionary: true,
        values: 1,
        encoding: 0,
        unpacked: 8,
        bytes: &1.5_f64.to_le_bytes(),
    };
    let run = [&[1][..], &word((values as u64) << 1), &[0]].concat();
    let page = Page {
        is_dictionary: false,
        values: values as i64,
        encoding: 8,
        unpacked: run.len() as i64,
        bytes: &run,
    };
    [dictionary.written(), page.written()].concat()
}

/// Many rows in a few bytes.
fn repeated(draw: &mut Draw) -> Vec<u8> {
    let (values, columns) = draw.pair(8, draw.size.unpacked);
    let (values, columns) = (values.max(columns), values.min(columns).min(64));
    let pages = runs(values);
    let names: Vec<String> = (0..columns).map(|index| format!("c{index}")).collect();
    let chunk = Chunk {
        has_dictionary: true,
        ..one_chunk(&pages, values)
    };
    of_columns(draw, &names, &pages, chunk, 1)
}

/// Many pages of a few values, packed or not.
fn pages(draw: &mut Draw) -> Vec<u8> {
    let values = draw.count(16);
    let is_packed = draw.chance();
    let page = match is_packed {
        true => {
            let bytes = gzipped(&vec![0; 8 * values]);
            let page = Page {
                is_dictionary: false,
                values: values as i64,
                encoding: 0,
                unpacked: 8 * values as i64,
                bytes: &bytes,
            };
            page.written()
        }
        false => plain(&vec![1.0; values]),
    };
    let count = draw.fit(page.len());
    let pages = page.repeat(count);
    let chunk = Chunk {
        codec: if is_packed { 2 } else { 0 },
        ..one_chunk(&pages, values * count)
    };
    of_columns(draw, &[], &pages, chunk, 1)
}

/// Dictionaries of many values, of which few are used.
fn dictionaries(draw: &mut Draw) -> Vec<u8> {
    let size = draw.count(draw.size.unpacked / 8);
    let packed = gzipped(&vec![0; 8 * size]);
    let stated = draw.one_of(&[size, 2 * size, i32::MAX as usize]) as i64;
    let dictionary = Page {
        is_dictionary: true,
        values: stated,
        encoding: 0,
        unpacked: 8 * size as i64,
        bytes: &packed,
    };
    let run = gzipped(&[1, 6, 0]);
    let page = Page {
        is_dictionary: false,
        values: 3,
        encoding: 8,
        unpacked: 3,
        bytes: &run,
    };
    let pages = [dictionary.written(), page.written()].concat();
    let chunk = Chunk {
        codec: 2,
        has_dictionary: true,
        ..one_chunk(&pages, 3)
    };
    let groups = draw.count(1000);
    of_columns(draw, &[], &pages, chunk, groups)
}

/// Sizes and counts that are not true.
fn statements(draw: &mut Draw) -> Vec<u8> {
    let large = draw.one_of(&[i64::from(i32::MAX), 1 << 40, -1]);
    let large = draw.one_of(&[large, 1 << 24, 1 << 26, 1 << 27, 1 << 28]);
    let bytes = match draw.chance() {
        true => gzipped(&vec![0; draw.size.unpacked]),
        false => gzipped(&[0; 24]),
    };
    let mut page = Page {
        is_dictionary: draw.chance(),
        values: 3,
        encoding: draw.one_of(&[0, 5, 7, 8]),
        unpacked: 24,
        bytes: &bytes,
    };
    let mut rows = 3;
    match draw.below(4) {
        0 => page.unpacked = large,
        1 => page.values = large,
        2 => rows = large,
        _ => (page.values, rows) = (large, large),
    }
    let pages = page.written();
    let chunk = Chunk {
        codec: 2,
        has_dictionary: page.is_dictionary,
        values: rows,
        ..one_chunk(&pages, 3)
    };
    let mut file = of_columns(draw, &[], &pages, chunk, 1);
    if draw.below(4) == 0 {
        // A group with more fields than there are.
        let fields = vec![field("root", 0, large), field("a", DOUBLE, 0)];
        file = self::file(draw, &pages, fields, 3, Vec::new(), Vec::new());
    }
    file
}

fn metadata(draw: &mut Draw) -> Vec<u8> {
    let pages = plain(&[0.0, 1.0, 2.0]);
    let long = draw.count(draw.size.file / 4);
    let line = draw.one_of(&["\n", "a\n", "abc: 1\n"]);
    let lines = draw.count(draw.size.file / 2 / line.len());
    let key = draw.one_of(&["k", "pandas", "comments"]);
    let key = key.to_owned() + &"k".repeat(if key == "k" { long } else { 0 });
    let value = match key == "pandas" {
        true => format!(
            "{{\"attributes\":{{\"units\":{{{}\"a\":\"b\"}}}}}}",
            "\"a\":\"b\",".repeat(lines / 5)
        ),
        false => line.repeat(lines),
    };
    let entry = structure(&[
        (1, Value::Binary(key.into_bytes())),
        (2, Value::Binary(value.into_bytes())),
    ]);
    let small = structure(&[
        (1, Value::Binary(b"k".to_vec())),
        (2, Value::Binary(b"v".to_vec())),
    ]);
    let mut texts = vec![entry];
    let count = draw.count(draw.size.file / 8 / small.len());
    texts.extend(vec![small; count]);
    let chunk = one_chunk(&pages, 3);
    let mut fields = vec![field("root", 0, 3)];
    fields.extend(TABLE.iter().map(|name| field(name, DOUBLE, 0)));
    let chunks = TABLE.iter().map(|name| chunk.written(name)).collect();
    file(draw, &pages, fields, 3, vec![group(chunks, 3)], texts)
}

/// A schema of Arrow in the footer, whose parts are shared, or none; and columns of texts.
fn schemas(draw: &mut Draw) -> Vec<u8> {
    let pages = plain(&[0.0, 1.0, 2.0]);
    let (message, _) = arrow::shared_schema(draw, draw.size.file / 2);
    let text = base_64(&message);
    let entry = structure(&[
        (1, Value::Binary(b"ARROW:schema".to_vec())),
        (2, Value::Binary(text)),
    ]);
    let chunk = one_chunk(&pages, 3);
    let count = draw.count(1000);
    let mut fields = vec![field("root", 0, 3 + count as i64)];
    fields.extend(TABLE.iter().map(|name| field(name, DOUBLE, 0)));
    fields.extend((0..count).map(|index| field(&format!("w{index}"), BYTES, 0)));
    let words = (0..count).map(|index| chunk.written(&format!("w{index}")));
    let chunks = TABLE
        .iter()
        .map(|name| chunk.written(name))
        .chain(words)
        .collect();
    let texts = if draw.chance() {
        vec![entry]
    } else {
        Vec::new()
    };
    file(draw, &pages, fields, 3, vec![group(chunks, 3)], texts)
}

fn base_64(bytes: &[u8]) -> Vec<u8> {
    const SIGNS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = Vec::new();
    for group in bytes.chunks(3) {
        let mut three = [0; 4];
        three[1..=group.len()].copy_from_slice(group);
        let word = u32::from_be_bytes(three);
        let signs = (0..4).map(|place| SIGNS[(word >> (18 - 6 * place)) as usize & 63]);
        text.extend(signs.take(group.len() + 1));
        text.extend(std::iter::repeat_n(b'=', 3 - group.len()));
    }
    text
}

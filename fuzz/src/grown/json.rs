//! JSON: columns, records, groups and what is said beside them.

use super::Grow;
use super::draw::Draw;

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("columns", columns),
    ("records", records),
    ("rows", rows),
    ("groups", groups),
    ("runs", runs),
    ("statements", statements),
    ("depth", depth),
    ("lengths", lengths),
    ("lines", lines),
];

const TABLE: &str = r#""time_s":[0,1,2],"displacement_mm":[0,1,0],"force_kN":[0,2,1]"#;

/// As many of the parts as have room in a file, each after a comma.
fn joined(room: usize, parts: impl Iterator<Item = String>) -> String {
    let mut text = String::new();
    for part in parts {
        if text.len() + part.len() + 1 > room {
            break;
        }
        if !text.is_empty() {
            text.push(',');
        }
        text.push_str(&part);
    }
    text
}

/// An object with as many of these members as have room in a file.
fn object(draw: &Draw, members: impl Iterator<Item = String>) -> String {
    format!("{{{}}}", joined(draw.size.file - 4, members))
}

/// The members of a table, before others.
fn table() -> impl Iterator<Item = String> {
    [TABLE.to_owned()].into_iter()
}

fn columns(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let value = draw.one_of(&[
        "[1,2,3]",
        "[]",
        "[\"a\",1,2]",
        "[[1,2],[3,4]]",
        "[null]",
        "1",
        "{\"a\":[1,2,3]}",
    ]);
    let count = draw.fit(names.longest() + value.len() + 4);
    let many = (0..count).map(|index| format!("\"{}\":{value}", names.of(index)));
    object(draw, table().chain(many)).into_bytes()
}

/// Records of the same fields, in one order or another.
fn records(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let value = draw.one_of(&["1", "\"a\"", "null", "[1]", "{}"]);
    let (fields, count) = draw.pair(names.longest() + value.len() + 4, draw.size.file);
    let (is_reversed, is_shifted) = (draw.chance(), draw.chance());
    let record = |record: usize| {
        let field = |index: usize| {
            let place = match (is_reversed && record % 2 == 1, is_shifted) {
                (true, _) => fields - 1 - index,
                (_, true) => index + record * fields,
                _ => index,
            };
            format!("\"{}\":{value}", names.of(place))
        };
        object(draw, (0..fields).map(field))
    };
    let records = joined(draw.size.file - 2, (0..count).map(record));
    format!("[{records}]").into_bytes()
}

fn rows(draw: &mut Draw) -> Vec<u8> {
    let (width, count) = draw.pair(4, draw.size.file);
    let names = draw.names();
    let cell = draw.one_of(&["1", "\"a\"", "null"]);
    let row = format!("[{}]", vec![cell; width].join(","));
    let head: Vec<String> = (0..width)
        .map(|index| format!("\"{}\"", names.of(index)))
        .collect();
    let head = head.join(",");
    let rows = vec![row; count].join(",");
    let mut text = match draw.below(3) {
        0 => format!("[{rows}]"),
        1 => format!("[[{head}],{rows}]"),
        _ => format!("{{\"columns\":[{head}],\"data\":[{rows}]}}"),
    };
    text.truncate(draw.size.file);
    text.into_bytes()
}

/// Groups, each with its own times or units or none, one beside the other or one in the other.
fn groups(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let inner = draw.one_of(&[
        "\"t\":[#,1],\"y\":[1,2]",
        "\"y\":[1,2]",
        "\"a\":[1,2],\"b\":[1,2]",
        "\"units\":{\"y\":\"kN\"},\"y\":[1,2]",
        "\"fs\":#",
        "\"unit\":\"N\",\"values\":[1,2,3]",
    ]);
    let count = draw.fit(names.longest() + inner.len() + 12);
    let group = |index: usize| {
        let inner = inner.replace('#', &index.to_string());
        format!("\"{}{index}\":{{{inner}}}", names.of(index))
    };
    object(draw, table().chain((0..count).map(group))).into_bytes()
}

/// Runs of one test, and arrays that all of them share.
fn runs(draw: &mut Draw) -> Vec<u8> {
    let count = draw.count(2000);
    let shared = draw.fit(16);
    let run = |index: usize| format!("\"r{index}\":{{\"a\":[1,2],\"b\":[1,2]}}");
    let array = |index: usize| format!("\"c{index}\":[1,2]");
    object(draw, (0..count).map(run).chain((0..shared).map(array))).into_bytes()
}

/// Numbers and texts beside the columns.
fn statements(draw: &mut Draw) -> Vec<u8> {
    let said = draw.one_of(&[
        "\"fs#\":100",
        "\"fs#\":#",
        "\"dt_#\":0.01",
        "\"scale#\":2.5",
        "\"unit of y#\":\"kN\"",
        "\"note#\":\"abc\"",
        "\"!#\":100",
    ]);
    let (columns, count) = (draw.count(30_000), draw.fit(said.len() + 16));
    let said = |index: usize| said.replace('#', &index.to_string());
    let column = |index: usize| format!("\"c{index}\":[1,2,3]");
    let times = draw.chance().then(table).into_iter().flatten();
    let said = (0..count).map(said);
    let members = times.chain((0..columns).map(column)).chain(said);
    object(draw, members).into_bytes()
}

fn depth(draw: &mut Draw) -> Vec<u8> {
    let name = draw.names().of(1);
    let (begin, end) = match draw.below(3) {
        0 => ("[".to_owned(), "]"),
        1 => (format!("{{\"{name}\":"), "}"),
        _ => (format!("[{{\"{name}\":"), "}]"),
    };
    let count = draw.fit(begin.len() + end.len());
    // Deeper ones are refused at once.
    let count = if draw.chance() { count.min(100) } else { count };
    let inner = format!("{{{TABLE}}}");
    (begin.repeat(count) + &inner + &end.repeat(count)).into_bytes()
}

/// Arrays of different lengths.
fn lengths(draw: &mut Draw) -> Vec<u8> {
    let most = (draw.size.file as f64).sqrt() as usize;
    let count = draw.count(most);
    let array = |index: usize| format!("\"c{index}\":[{}]", vec!["1"; index + 2].join(","));
    object(draw, (0..count).map(array)).into_bytes()
}

/// A record in each line.
fn lines(draw: &mut Draw) -> Vec<u8> {
    let line = draw.one_of(&[
        "{\"time_s\":1,\"force_kN\":2}\n",
        "[1,2,3]\n",
        "{\"a#\":1}\n",
        "{}\n",
        "{\"a\":[1,2,3],\"b\":{\"c\":1}}\n",
    ]);
    let count = draw.fit(line.len() + 6);
    let line = |index: usize| line.replace('#', &index.to_string());
    (0..count).map(line).collect::<String>().into_bytes()
}

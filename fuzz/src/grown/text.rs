//! Texts: columns, lines and blocks of rows, plain or packed.

use super::Grow;
use super::bytes::gzipped;
use super::draw::Draw;

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("columns", columns),
    ("lines", lines),
    ("preambles", preamble),
    ("blocks", blocks),
    ("cells", cells),
    ("segments", segments),
    ("gzip members", members),
    ("encodings", encodings),
];

const OWN: &str = "time_s,displacement_mm,force_kN";
const FOREIGN: &str = "Time [s];Disp [mm];Load [kN]";

/// A text that is packed or not; what does not fit in either way is left out.
fn packed(draw: &mut Draw, mut text: Vec<u8>) -> Vec<u8> {
    text.truncate(draw.size.unpacked);
    if draw.chance() || text.len() > draw.size.file {
        let packed = gzipped(&text);
        if packed.len() <= draw.size.file {
            return packed;
        }
    }
    text.truncate(draw.size.file);
    text
}

/// Bytes that a text may have: those that a file may unpack to, half of the time.
fn room(draw: &mut Draw) -> usize {
    if draw.chance() {
        draw.size.file
    } else {
        draw.size.unpacked
    }
}

fn header(draw: &mut Draw) -> &'static str {
    draw.one_of(&[OWN, FOREIGN, "Zeit,Weg,Kraft", "# Time Disp Load", "1;2;3"])
}

fn columns(draw: &mut Draw) -> Vec<u8> {
    let (names, room) = (draw.names(), room(draw));
    let (count, rows) = draw.pair(names.longest() + 3, room);
    let separator = draw.one_of(&[",", ";", "\t", "|", " "]);
    let head = if draw.chance() { OWN } else { FOREIGN };
    let mut text = head.replace([',', ';'], separator);
    for index in 0..count {
        text.push_str(separator);
        text.push_str(&names.of(index));
    }
    let cell = draw.one_of(&["1", "", "x", "0,5", "12:00:00"]);
    let row = format!(
        "0{separator}1{separator}2{}",
        format!("{separator}{cell}").repeat(count)
    );
    for _ in 0..rows {
        if text.len() > room {
            break;
        }
        text.push('\n');
        text.push_str(&row);
    }
    text.push('\n');
    packed(draw, text.into_bytes())
}

fn table(draw: &mut Draw) -> String {
    let head = header(draw);
    let separator = if head.contains(',') { "," } else { ";" };
    let rows = (0..20).map(|row| format!("{row}{separator}0.{row}{separator}1.5\n"));
    format!("{head}\n{}", rows.collect::<String>())
}

/// Many lines of one kind after a table, or before it.
fn lines(draw: &mut Draw) -> Vec<u8> {
    let mut line = draw.one_of(&[
        "",
        "#",
        "# a",
        "#a,b,c",
        "x",
        "a;b;c",
        "\"",
        "\"a\nb\"",
        "\"a,\n",
        ";;",
        ",",
        "1,2",
        "1;2;3",
        "Time [s];Disp [mm];Load [kN]",
        "1,1,1",
        "12:00:00;1;2",
        "\r",
        "% Time Disp Load",
        "Max;2;3",
    ]);
    if draw.below(8) == 0 {
        line = "1;1,5;2,5";
    }
    let count = room(draw) / (line.len() + 1);
    let count = draw.count(count);
    let many = format!("{line}\n").repeat(count);
    let table = table(draw);
    let text = match draw.below(3) {
        0 => many + &table,
        1 => table.clone() + &many + &table,
        _ => table + &many,
    };
    packed(draw, text.into_bytes())
}

fn preamble(draw: &mut Draw) -> Vec<u8> {
    let key = draw.one_of(&["key", "Sample rate", "dt", "x [y] (z)"]);
    let value = draw.one_of(&["1 Hz", "a", "0.001 s", "12:00:00"]);
    let sign = draw.one_of(&[": ", "=", ";", "\t"]);
    let (length, count) = draw.pair(key.len() + 16, draw.size.file);
    let value = value.repeat(length.min(1 << 20));
    let mut text = String::new();
    for index in 0..count {
        if text.len() > draw.size.file {
            break;
        }
        text.push_str(&format!("{key} {index}{sign}{value}\n"));
    }
    text += &table(draw);
    packed(draw, text.into_bytes())
}

/// Runs of rows of numbers with changing numbers of cells, each below a header.
fn blocks(draw: &mut Draw) -> Vec<u8> {
    let (rows, head) = (draw.count(12), draw.chance());
    let width = draw.count(30);
    let mut text = String::new();
    let mut index = 0;
    while text.len() < draw.size.file / 2 {
        index += 1;
        let cells = 2 + index % width;
        if head {
            text.push_str(&(["a", "Load"][index % 2].to_owned() + &";a".repeat(cells - 1)));
            text.push('\n');
        }
        let row = "1".to_owned() + &";2".repeat(cells - 1) + "\n";
        text.push_str(&row.repeat(rows));
    }
    packed(draw, text.into_bytes())
}

/// A long row.
fn cells(draw: &mut Draw) -> Vec<u8> {
    let cell = draw.one_of(&[
        "1,",
        "1;",
        "\"1\";",
        "\"a\"\"\",",
        ",",
        "1 ",
        "\"\n\",",
        "a",
        "\"",
        "- ",
    ]);
    let count = room(draw) / cell.len();
    let row = cell.repeat(draw.count(count));
    let table = table(draw);
    let text = match draw.below(3) {
        0 => row,
        1 => format!("{table}{row}\n"),
        _ => format!("{row}\n{row}\n{table}"),
    };
    packed(draw, text.into_bytes())
}

/// Segments of a LabVIEW measurement file.
fn segments(draw: &mut Draw) -> Vec<u8> {
    let mut text = "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\n".to_owned();
    let (channels, fields) = draw.pair(16, draw.size.file / 2);
    let field = draw.one_of(&[
        "Delta_X\t0.1",
        "Channels\t3",
        "Y_Unit_Label\tkN",
        "Samples\t2",
        "X_Dimension\tTime",
    ]);
    for index in 0..fields {
        text.push_str(&format!("{field}{index}\n"));
    }
    let names = draw.names();
    text.push_str("***End_of_Header***\t\nX_Value");
    for index in 0..channels {
        if text.len() > draw.size.file / 2 {
            break;
        }
        text.push_str(&format!("\t{}", names.of(index)));
    }
    text.push('\n');
    let row = "0".to_owned() + &"\t1".repeat(channels) + "\n";
    let again = format!("***End_of_Header***\t\n{field}\n");
    let is_one = draw.chance();
    while text.len() + row.len() < draw.size.file {
        text.push_str(&row);
        if !is_one && draw.chance() {
            text.push_str(&again);
        }
    }
    packed(draw, text.into_bytes())
}

/// Many packed parts of a few bytes.
fn members(draw: &mut Draw) -> Vec<u8> {
    let part = draw.one_of(&["", "0,1,2\n", "#\n", "\n"]);
    let member = gzipped(part.as_bytes());
    let mut file = gzipped(table(draw).as_bytes());
    let count = draw.fit(member.len());
    (0..count).for_each(|_| file.extend(&member));
    file
}

fn encodings(draw: &mut Draw) -> Vec<u8> {
    let sign = draw.one_of(&["ä", "\u{4f4d}", "1;", "\n"]);
    let count = room(draw) / (3 * sign.len());
    let text = table(draw) + &sign.repeat(draw.count(count)) + "\n";
    let bytes: Vec<u8> = match draw.below(3) {
        0 => text.encode_utf16().flat_map(u16::to_le_bytes).collect(),
        1 => text.encode_utf16().flat_map(u16::to_be_bytes).collect(),
        // One byte for each character, which is no UTF-8.
        _ => text.chars().map(|sign| sign as u32 as u8).collect(),
    };
    packed(draw, bytes)
}

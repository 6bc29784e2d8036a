//! Excel's workbooks: sheets, texts, styles, and cells far from one another.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use zip::write::SimpleFileOptions;

use super::Grow;
use super::draw::Draw;

pub const STRUCTURES: &[(&str, Grow)] = &[
    ("sheets", sheets),
    ("repeated sheets", repeated),
    ("texts", texts),
    ("repeated texts", repeated_texts),
    ("styles", styles),
    ("far cells", far),
    ("cells", cells),
    ("huge cell", huge_cell),
    ("columns", columns),
    ("statements", statements),
    ("files", files),
    ("elements", elements),
];

const SCHEMAS: &str = "http://schemas.openxmlformats.org";

/// The parts of a workbook.
#[derive(Default)]
struct Book {
    /// Name and path of each sheet.
    sheets: Vec<(String, String)>,
    texts: String,
    styles: String,
    /// The path and the rows of each part with cells.
    parts: Vec<(String, String)>,
    more: usize,
}

/// A table in the first rows of a sheet.
fn table() -> String {
    let names = ["time_s", "displacement_mm", "force_kN"];
    let cell = |name: &str| format!("<c t=\"str\"><v>{name}</v></c>");
    let mut rows = format!("<row>{}</row>", names.map(cell).concat());
    for row in 0..10 {
        let cells = (0..3).map(|column| format!("<c><v>{}</v></c>", row * (column + 1)));
        let _ = write!(rows, "<row>{}</row>", cells.collect::<String>());
    }
    rows
}

impl Book {
    /// With one sheet of these rows.
    fn of(rows: String) -> Self {
        Self {
            sheets: vec![("a".into(), "worksheets/sheet1.xml".into())],
            parts: vec![("worksheets/sheet1.xml".into(), rows)],
            ..Self::default()
        }
    }

    fn written(&self, draw: &Draw) -> Vec<u8> {
        let office = format!("{SCHEMAS}/officeDocument/2006/relationships");
        let relations = |each: String| {
            format!(
                "<Relationships xmlns=\"{SCHEMAS}/package/2006/relationships\">{each}</Relationships>"
            )
        };
        let main = format!("{SCHEMAS}/spreadsheetml/2006/main");
        let mut sheets = String::new();
        let mut targets = String::new();
        for (index, (name, path)) in self.sheets.iter().enumerate() {
            let _ = write!(
                sheets,
                "<sheet name=\"{name}\" sheetId=\"1\" r:id=\"r{index}\"/>"
            );
            let _ = write!(
                targets,
                "<Relationship Id=\"r{index}\" Type=\"{office}/worksheet\" Target=\"{path}\"/>"
            );
        }
        let document = format!(
            "<Relationship Id=\"r\" Type=\"{office}/officeDocument\" Target=\"xl/workbook.xml\"/>"
        );
        let mut parts = vec![
            ("_rels/.rels".to_owned(), relations(document)),
            ("xl/_rels/workbook.xml.rels".to_owned(), relations(targets)),
            (
                "xl/workbook.xml".to_owned(),
                format!(
                    "<workbook xmlns=\"{main}\" xmlns:r=\"{office}\"><sheets>{sheets}</sheets></workbook>"
                ),
            ),
        ];
        if !self.texts.is_empty() {
            parts.push(("xl/sharedStrings.xml".into(), self.texts.clone()));
        }
        if !self.styles.is_empty() {
            let styles = format!("<styleSheet xmlns=\"{main}\">{}</styleSheet>", self.styles);
            parts.push(("xl/styles.xml".into(), styles));
        }
        for (path, rows) in &self.parts {
            let sheet =
                format!("<worksheet xmlns=\"{main}\"><sheetData>{rows}</sheetData></worksheet>");
            parts.push((format!("xl/{path}"), sheet));
        }
        parts.extend((0..self.more).map(|index| (format!("m{index}"), String::new())));
        let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default().compression_level(Some(1));
        for (path, text) in parts {
            archive.start_file(path, options).expect("to memory");
            archive.write_all(text.as_bytes()).expect("to memory");
        }
        let mut bytes = archive.finish().expect("to memory").into_inner();
        // What is cut has lost the list of its files: it is refused at once.
        bytes.truncate(draw.size.file);
        bytes
    }
}

/// Bytes of XML that a workbook may have: they pack well.
fn room(draw: &mut Draw) -> usize {
    let most = draw.size.unpacked * 7 / 8;
    if draw.chance() { most } else { most / 8 }
}

fn sheets(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let kinds = [
        table(),
        String::new(),
        "<row><c><v>1</v></c></row>".to_owned(),
        "<row><c t=\"str\"><v>a</v></c></row>".to_owned(),
    ];
    let rows = &kinds[draw.below(kinds.len())];
    let count = draw.count(draw.size.file / (600 + 2 * names.longest()));
    let mut book = Book::of(table());
    for index in 0..count {
        let path = format!("worksheets/s{index}.xml");
        let name = names.of(index).replace(['<', '>', '&', '"'], "-");
        book.sheets.push((name, path.clone()));
        book.parts.push((path, rows.clone()));
    }
    book.written(draw)
}

/// Sheets with the same cells, and long names.
fn repeated(draw: &mut Draw) -> Vec<u8> {
    let (count, long) = draw.pair(1, draw.size.unpacked / 4);
    let mut book = Book::of(table());
    let path = format!("worksheets/{}.xml", "p".repeat(long.min(60_000)));
    book.parts.push((path.clone(), table().repeat(20)));
    for index in 0..count.min(draw.size.unpacked / 256) {
        let name = format!("{}{index}", "n".repeat(long.min(1000)));
        book.sheets.push((name, path.clone()));
        if index * (long + 200) > draw.size.unpacked / 2 {
            break;
        }
    }
    book.written(draw)
}

fn of_texts(each: &str, count: usize) -> String {
    format!(
        "<sst count=\"{count}\" uniqueCount=\"{count}\">{}</sst>",
        each.repeat(count)
    )
}

fn texts(draw: &mut Draw) -> Vec<u8> {
    let each = draw.one_of(&[
        "<si/>",
        "<si><t>a</t></si>",
        "<si><t/></si>",
        "<si><r><t>a</t></r><r><t>b</t></r></si>",
        "<si><t>_x000D_&amp;&#65;</t></si>",
        "<si><rPh><t>a</t></rPh></si>",
    ]);
    let most = room(draw) / each.len();
    let count = draw.count(most);
    let mut book = Book::of(table());
    book.texts = of_texts(each, count);
    book.written(draw)
}

/// Cells that refer to one long text.
fn repeated_texts(draw: &mut Draw) -> Vec<u8> {
    let long = draw.count(1 << 20);
    let sign = draw.one_of(&["a", "1", "_x0041_", "\u{e4}"]);
    let cell = "<c t=\"s\"><v>0</v></c>";
    let most = room(draw) / cell.len();
    let (rows, columns) = draw.pair(1, most);
    let row = format!("<row>{}</row>", cell.repeat(columns));
    let mut book = Book::of(table() + &row.repeat(rows));
    book.texts = of_texts(
        &format!("<si><t>{}</t></si>", sign.repeat(long / sign.len() + 1)),
        1,
    );
    book.written(draw)
}

fn styles(draw: &mut Draw) -> Vec<u8> {
    let long = draw.count(1 << 20);
    let xf = "<xf numFmtId=\"164\" fontId=\"0\"/>";
    let most = room(draw) / xf.len();
    let count = draw.count(most);
    let text = "y".repeat(long);
    let formats = draw.count(1000);
    let format = format!("<numFmt numFmtId=\"164\" formatCode=\"{text}\"/>");
    let formats = formats.min(draw.size.unpacked / 4 / format.len() + 1);
    let mut book = Book::of(table());
    book.styles = format!(
        "<numFmts>{}</numFmts><fonts><font><name val=\"{text}\"/></font></fonts><cellXfs>{}</cellXfs>",
        format.repeat(formats),
        xf.repeat(count)
    );
    book.written(draw)
}

/// Cells far from one another.
fn far(draw: &mut Draw) -> Vec<u8> {
    let column = draw.one_of(&["XFD", "ZZZZ", "AAA", "B", "ZZZZZZ"]);
    let step = draw.count(1 << 20);
    let first = draw.one_of(&[1, 1 << 20, 1 << 31]);
    let most = room(draw) / 60;
    let count = draw.count(most).min(1 << 16);
    let mut rows = table();
    for index in 0..count {
        let row = first + 20 + index * step;
        let _ = write!(
            rows,
            "<row r=\"{row}\"><c r=\"{column}{row}\"><v>1</v></c></row>"
        );
    }
    Book::of(rows).written(draw)
}

fn cells(draw: &mut Draw) -> Vec<u8> {
    let cell = draw.one_of(&[
        "<c><v>1</v></c>",
        "<c/>",
        "<c><v>1e300</v></c>",
        "<c t=\"e\"><v>#DIV/0!</v></c>",
        "<c t=\"str\"><v>1,5</v></c>",
        "<c t=\"inlineStr\"><is><t>1.234</t></is></c>",
        "<c t=\"b\"><v>1</v></c>",
        "<c><f>A1</f><v>2</v></c>",
        "<c><v>1<!-- a -->2</v></c>",
    ]);
    let most = room(draw);
    let (columns, rows) = draw.pair(cell.len() + 8, most);
    let row = format!("<row>{}</row>", cell.repeat(columns));
    Book::of(table() + &row.repeat(rows)).written(draw)
}

/// One cell of many signs, as its own text or as an attribute of it.
fn huge_cell(draw: &mut Draw) -> Vec<u8> {
    let sign = draw.one_of(&["a", "1", "&amp;", "_x0041_", "\t"]);
    let text = sign.repeat(room(draw) / sign.len());
    let cell = match draw.chance() {
        true => format!("<row><c t=\"str\"><v>{text}</v></c></row>"),
        false => format!("<row><c s=\"{text}\"><v>1</v></c></row>"),
    };
    Book::of(table() + &cell).written(draw)
}

fn columns(draw: &mut Draw) -> Vec<u8> {
    let names = draw.names();
    let most = room(draw);
    let (count, rows) = draw.pair(names.longest() + 40, most);
    let mut head = String::new();
    for index in 0..count {
        let name = names.of(index).replace(['<', '>', '&'], "-");
        let _ = write!(head, "<c t=\"str\"><v>{name}</v></c>");
    }
    let row = format!("<row>{}</row>", "<c><v>1</v></c>".repeat(count));
    Book::of(format!("<row>{head}</row>{}", row.repeat(rows))).written(draw)
}

/// Counts that are not true.
fn statements(draw: &mut Draw) -> Vec<u8> {
    let large = draw.one_of(&["99999999999", "4000000000", "18446744073709551615", "-1"]);
    let mut book = Book::of(table());
    book.texts = format!("<sst count=\"{large}\" uniqueCount=\"{large}\"><si><t>a</t></si></sst>");
    book.styles = format!("<cellXfs count=\"{large}\"><xf numFmtId=\"{large}\"/></cellXfs>");
    let mut bytes = book.written(draw);
    if draw.chance() {
        // The number of files at the end of the archive.
        let at = bytes.len() - 22 + 10;
        bytes[at..at + 2].copy_from_slice(&[0xff; 2]);
    }
    bytes
}

fn files(draw: &mut Draw) -> Vec<u8> {
    let mut book = Book::of(table());
    book.more = draw.count(draw.size.file / 110);
    book.written(draw)
}

/// Elements in elements, attributes and comments.
fn elements(draw: &mut Draw) -> Vec<u8> {
    let each = draw.one_of(&[
        "<a>",
        "<a b=\"c\"/>",
        "<!---->",
        "<row/>",
        "&amp;",
        "<?a?>",
        "<![CDATA[]]>",
        "<a ",
    ]);
    let most = room(draw) / each.len();
    let count = draw.count(most);
    let rows = match draw.chance() {
        true => table() + &each.repeat(count),
        false => format!("{}<c><v>{}</v></c>", table(), each.repeat(count)),
    };
    Book::of(rows).written(draw)
}

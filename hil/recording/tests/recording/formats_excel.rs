//! Workbooks as Excel itself saves them, built by hand: features that Excel's files have and other programs' files lack.
//!
//! Excel keeps each text once in a separate table, in pieces where the letters differ in style, with readings of Japanese words
//! next to it. It marks a date by a style alone, often by one of its built-in numbers without a format code. It keeps cells that
//! are formatted and empty, values of formulas, and errors. It adds its own namespaces and attributes. It may count days from 1904
//! or write the strict form of the standard.

use mesh_damper_recording::Recording;
use mesh_damper_tables::files::Reading;
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
const RELATIONS: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";

/// The parts of a workbook with one sheet, or with a second.
struct Book {
    /// Between the tags of the workbook: `<workbookPr date1904="1"/>`.
    settings: &'static str,
    /// Of `<si>` elements.
    texts: &'static str,
    /// Of `<xf>` elements.
    styles: &'static str,
    rows: String,
    /// Of a sheet `Tabelle2`.
    second: Option<String>,
    main: &'static str,
    relations: &'static str,
}

impl Book {
    fn of(texts: &'static str, rows: String) -> Self {
        Self {
            settings: "<workbookPr defaultThemeVersion=\"166925\"/>",
            texts,
            styles: "<xf numFmtId=\"0\"/><xf numFmtId=\"47\" applyNumberFormat=\"1\"/><xf numFmtId=\"22\" applyNumberFormat=\"1\"/>\
                     <xf numFmtId=\"164\" applyNumberFormat=\"1\"/>",
            rows,
            second: None,
            main: MAIN,
            relations: RELATIONS,
        }
    }

    fn bytes(&self) -> Vec<u8> {
        let (main, relations) = (self.main, self.relations);
        let packages = "http://schemas.openxmlformats.org/package/2006";
        let head = "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\r\n";
        let kind = "application/vnd.openxmlformats-officedocument.spreadsheetml";
        let (entry, relation) = match self.second {
            Some(_) => (
                "<sheet name=\"Tabelle2\" sheetId=\"2\" r:id=\"rId2\"/>",
                format!(
                    "<Relationship Id=\"rId2\" Type=\"{relations}/worksheet\" Target=\"worksheets/sheet2.xml\"/>"
                ),
            ),
            None => ("", String::new()),
        };
        let sheet = |rows: &str| {
            format!(
                "<worksheet xmlns=\"{main}\" xmlns:r=\"{relations}\" xmlns:x14ac=\"http://schemas.microsoft.com/office/spreadsheetml/2009/9/ac\">\
                 <dimension ref=\"A1:D400\"/><sheetViews><sheetView workbookViewId=\"0\"><selection activeCell=\"A1\" sqref=\"A1\"/></sheetView></sheetViews>\
                 <sheetFormatPr baseColWidth=\"10\" defaultRowHeight=\"15\" x14ac:dyDescent=\"0.25\"/><sheetData>{rows}</sheetData>\
                 <mergeCells count=\"1\"><mergeCell ref=\"A1:C1\"/></mergeCells><pageMargins left=\"0.7\" right=\"0.7\" top=\"0.7\" bottom=\"0.7\" header=\"0.3\" footer=\"0.3\"/></worksheet>"
            )
        };
        let mut parts = vec![
            (
                "[Content_Types].xml",
                format!(
                    "<Types xmlns=\"{packages}/content-types\"><Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
                     <Default Extension=\"xml\" ContentType=\"application/xml\"/><Override PartName=\"/xl/workbook.xml\" ContentType=\"{kind}.sheet.main+xml\"/></Types>"
                ),
            ),
            (
                "_rels/.rels",
                format!(
                    "<Relationships xmlns=\"{packages}/relationships\"><Relationship Id=\"rId1\" Type=\"{relations}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
                ),
            ),
            (
                "xl/_rels/workbook.xml.rels",
                format!(
                    "<Relationships xmlns=\"{packages}/relationships\"><Relationship Id=\"rId3\" Type=\"{relations}/styles\" Target=\"styles.xml\"/>\
                     <Relationship Id=\"rId1\" Type=\"{relations}/worksheet\" Target=\"worksheets/sheet1.xml\"/>{relation}\
                     <Relationship Id=\"rId4\" Type=\"{relations}/sharedStrings\" Target=\"sharedStrings.xml\"/></Relationships>"
                ),
            ),
            (
                "xl/workbook.xml",
                format!(
                    "<workbook xmlns=\"{main}\" xmlns:r=\"{relations}\" xmlns:mc=\"http://schemas.openxmlformats.org/markup-compatibility/2006\" mc:Ignorable=\"x15\" \
                     xmlns:x15=\"http://schemas.microsoft.com/office/spreadsheetml/2010/11/main\"><fileVersion appName=\"xl\" lastEdited=\"7\" lowestEdited=\"7\" rupBuild=\"22228\"/>{}\
                     <bookViews><workbookView xWindow=\"0\" yWindow=\"0\" windowWidth=\"28800\" windowHeight=\"12225\"/></bookViews>\
                     <sheets><sheet name=\"Tabelle1\" sheetId=\"1\" r:id=\"rId1\"/>{entry}</sheets><calcPr calcId=\"191029\"/></workbook>",
                    self.settings
                ),
            ),
            (
                "xl/styles.xml",
                format!(
                    "<styleSheet xmlns=\"{main}\"><numFmts count=\"1\"><numFmt numFmtId=\"164\" formatCode=\"[$-F400]h:mm:ss\\ AM/PM\"/></numFmts>\
                     <cellXfs count=\"4\">{}</cellXfs></styleSheet>",
                    self.styles
                ),
            ),
            (
                "xl/sharedStrings.xml",
                format!(
                    "<sst xmlns=\"{main}\" count=\"9\" uniqueCount=\"9\">{}</sst>",
                    self.texts
                ),
            ),
            ("xl/worksheets/sheet1.xml", sheet(&self.rows)),
        ];
        if let Some(rows) = &self.second {
            parts.push(("xl/worksheets/sheet2.xml", sheet(rows)));
        }
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = zip::write::SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Stored);
        for (name, text) in parts {
            zip.start_file(name, options).unwrap();
            zip.write_all(head.as_bytes()).unwrap();
            zip.write_all(text.as_bytes()).unwrap();
        }
        zip.finish().unwrap().into_inner()
    }

    fn read(&self) -> Result<Recording, String> {
        self.read_as(&Reading::default())
    }

    fn read_as(&self, reading: &Reading) -> Result<Recording, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("book.xlsx");
        std::fs::write(&path, self.bytes()).unwrap();
        Recording::read_as(&path, reading).map_err(|error| error.to_string())
    }
}

const ROWS: usize = 300;

fn truth(row: usize) -> [f64; 3] {
    let time = 0.0125 * row as f64;
    [time, (14.0 * time).sin(), 1.5 * (14.0 * time + 0.4).sin()]
}

/// Rows as Excel writes them, below `head`; `time` is the cell of the times.
fn rows(head: &str, first: usize, time: &dyn Fn(usize, String) -> String) -> String {
    let mut rows = head.to_owned();
    for row in 0..ROWS {
        let line = first + row;
        let [_, y, force] = truth(row);
        let time = time(row, format!("A{line}"));
        // A column of formatted empty cells, and the value of a formula.
        let _ = write!(
            rows,
            "<row r=\"{line}\" spans=\"1:4\" x14ac:dyDescent=\"0.25\">{time}<c r=\"B{line}\" s=\"0\"><v>{y:e}</v></c>\
             <c r=\"C{line}\"><f>B{line}*1.5</f><v>{force}</v></c><c r=\"D{line}\" s=\"2\"/></row>"
        );
    }
    rows
}

/// Texts with pieces, readings and significant blanks.
const TEXTS: &str = "<si><t>Prüfstand</t></si>\
    <si><r><rPr><b/></rPr><t>Ti</t></r><r><t xml:space=\"preserve\">me [s]</t></r></si>\
    <si><t xml:space=\"preserve\"> Disp [mm] </t><phoneticPr fontId=\"1\"/></si>\
    <si><t>荷重 [kN]</t><rPh sb=\"0\" eb=\"2\"><t>カジュウ</t></rPh><phoneticPr fontId=\"1\"/></si>\
    <si><t>Time</t></si>";

const HEAD: &str = "<row r=\"1\" spans=\"1:4\"><c r=\"A1\" t=\"s\"><v>0</v></c><c r=\"B1\"><v>4</v></c></row>\
    <row r=\"3\" spans=\"1:4\"><c r=\"A3\" s=\"1\" t=\"s\"><v>1</v></c><c r=\"B3\" t=\"s\"><v>2</v></c><c r=\"C3\" t=\"s\"><v>3</v></c><c r=\"D3\" s=\"2\"/></row>";
/// The same with a column `Time` without a unit.
const HEAD_OF_STAMPS: &str = "<row r=\"3\"><c r=\"A3\" t=\"s\"><v>4</v></c><c r=\"B3\" t=\"s\"><v>2</v></c><c r=\"C3\" t=\"s\"><v>3</v></c></row>";

fn plain(row: usize, place: String) -> String {
    format!("<c r=\"{place}\"><v>{}</v></c>", truth(row)[0])
}

fn holds(read: &Recording, off: f64) {
    assert_eq!(read.len(), ROWS);
    for row in 0..ROWS {
        let [time, y, force] = truth(row);
        assert!(
            (read.time[row] - read.time[0] - time).abs() <= off,
            "row {row}"
        );
        assert!(
            read.displacement[row] == y && read.force[row] == force,
            "row {row}"
        );
    }
}

#[test]
fn shared_texts_and_empty_cells_are_read() {
    let read = Book::of(TEXTS, rows(HEAD, 4, &plain)).read().unwrap();
    holds(&read, 0.0);
    assert!(
        read.guesses()
            .iter()
            .any(|said| said.contains("column \"Time [s]\"")),
        "{:?}",
        read.guesses()
    );
    assert_eq!(read.comments, ["Prüfstand: 4"]);
}

#[test]
fn the_strict_form_is_read_or_said() {
    let book = Book {
        main: "http://purl.oclc.org/ooxml/spreadsheetml/main",
        relations: "http://purl.oclc.org/ooxml/officeDocument/relationships",
        ..Book::of(TEXTS, rows(HEAD, 4, &plain))
    };
    holds(&book.read().unwrap(), 0.0);
}

/// mm:ss.0, a date with a time of day, and a country's format, each marked by a style alone.
#[test]
fn dates_are_known_by_their_styles() {
    for style in [1, 2, 3] {
        for settings in ["<workbookPr/>", "<workbookPr date1904=\"1\"/>"] {
            let stamps = |row: usize, place: String| {
                let days = 45_352.5 + truth(row)[0] / 86_400.0;
                format!("<c r=\"{place}\" s=\"{style}\"><v>{days}</v></c>")
            };
            let book = Book {
                settings,
                ..Book::of(TEXTS, rows(HEAD_OF_STAMPS, 4, &stamps))
            };
            // A date in Excel resolves 2⁻³⁷ of a day: 0.6 µs.
            holds(&book.read().unwrap(), 1e-6);
        }
    }
    // Dates of which only the time of day remains.
    let times = |row: usize, place: String| {
        format!(
            "<c r=\"{place}\" s=\"1\"><v>{}</v></c>",
            truth(row)[0] / 86_400.0
        )
    };
    holds(
        &Book::of(TEXTS, rows(HEAD_OF_STAMPS, 4, &times))
            .read()
            .unwrap(),
        1e-8,
    );
}

#[test]
fn an_error_is_a_missing_sample() {
    let text = rows(HEAD, 4, &plain);
    let cell = |value: &str| format!("<c r=\"C20\"{value}</v></c>");
    let good = cell(&format!("><f>B20*1.5</f><v>{}", truth(16)[2]));
    let error = text.replacen(&good, &cell(" t=\"e\"><f>B20/0</f><v>#DIV/0!"), 1);
    assert_ne!(error, text);
    let read = Book::of(TEXTS, error).read().unwrap();
    assert_eq!(read.len(), ROWS - 1);
}

#[test]
fn cells_in_no_order_are_refused() {
    let text = rows(HEAD, 4, &plain);
    for (from, to) in [
        ("r=\"B20\"", "r=\"A20\""),
        ("<row r=\"30\"", "<row r=\"7\""),
    ] {
        let spoilt = text
            .replacen(from, to, 1)
            .replacen("r=\"A30\"", "r=\"A7\"", 1);
        let message = Book::of(TEXTS, spoilt).read().unwrap_err();
        assert!(message.contains("cells are in no order"), "{message}");
    }
}

#[test]
fn a_sheet_whose_decimal_sign_is_open_is_asked_for() {
    let thousandths = |row: usize, place: String| {
        format!(
            "<c r=\"{place}\" t=\"inlineStr\"><is><t>{},{:03}</t></is></c>",
            row + 1,
            125
        )
    };
    let second = Some(rows(HEAD, 4, &plain));
    let book = Book {
        second,
        ..Book::of(TEXTS, rows(HEAD, 4, &thousandths))
    };
    let question = book.read().unwrap_err();
    for words in ["table \"Tabelle1\"", "--decimal", "--table"] {
        assert!(question.contains(words), "{question}");
    }
    let reading = Reading {
        table: Some("Tabelle2".into()),
        ..Reading::default()
    };
    let named = book.read_as(&reading).unwrap();
    holds(&named, 0.0);
    // Of a sheet that was not asked for, nothing is said.
    let is_of_other = |note: &&String| note.contains("Tabelle1");
    assert_eq!(named.guesses().iter().find(is_of_other), None);
    // A single sheet has no other to be named.
    let question = Book::of(TEXTS, rows(HEAD, 4, &thousandths))
        .read()
        .unwrap_err();
    assert!(
        question.contains("--decimal") && !question.contains("--table"),
        "{question}"
    );
    // With the sign, both are recordings.
    let reading = Reading {
        decimal: Some(','),
        ..Reading::default()
    };
    let question = book.read_as(&reading).unwrap_err();
    assert!(question.contains("2 tables hold a recording"), "{question}");
}

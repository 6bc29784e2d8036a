//! Columns as a MAT file of version 5.

use std::io::Write as _;

use super::Column;

/// Bytes before the first variable.
const HEADER: usize = 128;

/// Types of elements.
const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Classes of matrices.
const STRUCTURE: u8 = 2;
const TEXT: u8 = 4;
const NUMBERS: u8 = 6;
/// The longest name that MATLAB takes, and the length of the field for it.
const LONGEST: usize = 63;

/// A file that MATLAB, Octave and SciPy load. Each column is a variable, `comments` is a text with one row per comment, and `units`
/// is a structure with the units of the variables that have one.
pub(super) fn write(comments: &[String], columns: &[Column<'_>]) -> Vec<u8> {
    let mut file = b"MATLAB 5.0 MAT-file, written by mesh-damper".to_vec();
    file.resize(HEADER - 12, b' ');
    // No subsystem data, then the version and the byte order.
    file.extend([0; 8]);
    file.extend([0, 1, b'I', b'M']);
    let names = identifiers(columns);
    for (column, name) in columns.iter().zip(&names) {
        let bytes: Vec<u8> = column
            .values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let numbers = element(DOUBLE, &bytes);
        let matrix = matrix(NUMBERS, [column.values.len(), 1], name, &numbers);
        variable(&mut file, &matrix);
    }
    if !comments.is_empty() {
        variable(&mut file, &text("comments", comments));
    }
    let units: Vec<(String, &str)> = (columns.iter().zip(names))
        .filter_map(|(column, name)| Some((name, column.unit?)))
        .collect();
    if !units.is_empty() {
        variable(&mut file, &structure("units", &units));
    }
    file
}

/// Appends a variable, compressed.
fn variable(file: &mut Vec<u8>, matrix: &[u8]) {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    // Writing to memory does not fail.
    let _ = encoder.write_all(matrix);
    let packed = encoder.finish().unwrap_or_default();
    file.extend(COMPRESSED.to_le_bytes());
    file.extend((packed.len() as u32).to_le_bytes());
    file.extend(packed);
}

fn element(kind: u32, bytes: &[u8]) -> Vec<u8> {
    let mut element = kind.to_le_bytes().to_vec();
    element.extend((bytes.len() as u32).to_le_bytes());
    element.extend(bytes);
    element.resize(element.len().next_multiple_of(8), 0);
    element
}

fn matrix(class: u8, dimensions: [usize; 2], name: &str, body: &[u8]) -> Vec<u8> {
    let mut inner = element(UINT32, &[class, 0, 0, 0, 0, 0, 0, 0]);
    let sizes = dimensions.map(|size| (size as i32).to_le_bytes());
    inner.extend(element(INT32, sizes.as_flattened()));
    inner.extend(element(INT8, name.as_bytes()));
    inner.extend(body);
    element(MATRIX, &inner)
}

/// Lines as the rows of a text, padded with blanks.
fn text<L: AsRef<str>>(name: &str, lines: &[L]) -> Vec<u8> {
    let lines: Vec<Vec<u16>> = lines
        .iter()
        .map(|line| line.as_ref().encode_utf16().collect())
        .collect();
    let longest = lines.iter().map(Vec::len).max().unwrap_or_default();
    let at = |column: usize| {
        lines
            .iter()
            .map(move |line| line.get(column).copied().unwrap_or(u16::from(b' ')))
    };
    let bytes: Vec<u8> = (0..longest)
        .flat_map(at)
        .flat_map(u16::to_le_bytes)
        .collect();
    matrix(TEXT, [lines.len(), longest], name, &element(UINT16, &bytes))
}

fn structure(name: &str, fields: &[(String, &str)]) -> Vec<u8> {
    const FIELD: usize = LONGEST + 1;
    let mut names = Vec::new();
    for (field, _) in fields {
        names.extend(field.as_bytes());
        names.resize(names.len().next_multiple_of(FIELD), 0);
    }
    let mut body = element(INT32, &(FIELD as i32).to_le_bytes());
    body.extend(element(INT8, &names));
    for (_, value) in fields {
        body.extend(text("", &[value]));
    }
    matrix(STRUCTURE, [1, 1], name, &body)
}

/// The names of the variables, all different: MATLAB would keep only the last of two with the same name.
fn identifiers(columns: &[Column<'_>]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for column in columns {
        let plain = identifier(column.name);
        let numbered = (2..).map(|number| {
            let ending = format!("_{number}");
            format!(
                "{}{ending}",
                &plain[..plain.len().min(LONGEST - ending.len())]
            )
        });
        let is_free =
            |name: &String| !names.contains(name) && name != "comments" && name != "units";
        let mut tried = [plain.clone()].into_iter().chain(numbered);
        let name = tried.find(is_free).unwrap_or(plain.clone());
        names.push(name);
    }
    names
}

/// A name that MATLAB accepts: letters, digits and underscores, starting with a letter.
fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let mut name: String = name.chars().map(plain).take(LONGEST).collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name.insert_str(0, "x_");
        name.truncate(LONGEST);
    }
    name
}

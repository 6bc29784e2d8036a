//! Columns as a MAT file of version 5.

use std::io::Write as _;

use super::{Column, Unwritten};

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
/// The format has 32 bits for a length, of which MATLAB reads 31.
const MOST: usize = i32::MAX as usize;
/// The longest name that MATLAB takes, and the length of the field for it.
const LONGEST: usize = 63;

/// A file that MATLAB, Octave and SciPy load. Each column is a variable, `comments` is a text with one row per comment, and `units`
/// is a structure with the units of the variables that have one.
pub(super) fn write(comments: &[String], columns: &[Column<'_>]) -> Result<Vec<u8>, Unwritten> {
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
        let numbers = element(DOUBLE, &bytes)?;
        let matrix = matrix(NUMBERS, [column.values.len(), 1], name, &numbers)?;
        variable(&mut file, &matrix)?;
    }
    if !comments.is_empty() {
        variable(&mut file, &text("comments", comments)?)?;
    }
    let units: Vec<(String, &str)> = (columns.iter().zip(names))
        .filter_map(|(column, name)| Some((name, column.unit?)))
        .collect();
    if !units.is_empty() {
        variable(&mut file, &structure("units", &units)?)?;
    }
    Ok(file)
}

/// Appends a variable, compressed.
fn variable(file: &mut Vec<u8>, matrix: &[u8]) -> Result<(), Unwritten> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    let packed = encoder.write_all(matrix).and_then(|()| encoder.finish());
    let packed = packed.map_err(Unwritten::by)?;
    file.extend(COMPRESSED.to_le_bytes());
    file.extend(length(packed.len())?);
    file.extend(packed);
    Ok(())
}

/// A number of bytes or values, as the format stores it.
fn length(count: usize) -> Result<[u8; 4], Unwritten> {
    match u32::try_from(count) {
        Ok(stored) if count <= MOST => Ok(stored.to_le_bytes()),
        _ => Err(Unwritten {
            problem: "a MAT file holds no column of 2 GiB or more".into(),
            remedy: "name a file that ends in .csv.gz or .parquet, or record fewer samples",
        }),
    }
}

fn element(kind: u32, bytes: &[u8]) -> Result<Vec<u8>, Unwritten> {
    let mut element = kind.to_le_bytes().to_vec();
    element.extend(length(bytes.len())?);
    element.extend(bytes);
    element.resize(element.len().next_multiple_of(8), 0);
    Ok(element)
}

fn matrix(
    class: u8,
    dimensions: [usize; 2],
    name: &str,
    body: &[u8],
) -> Result<Vec<u8>, Unwritten> {
    let mut inner = element(UINT32, &[class, 0, 0, 0, 0, 0, 0, 0])?;
    let [rows, columns] = dimensions;
    let sizes = [length(rows)?, length(columns)?];
    inner.extend(element(INT32, sizes.as_flattened())?);
    inner.extend(element(INT8, name.as_bytes())?);
    inner.extend(body);
    element(MATRIX, &inner)
}

/// Lines as the rows of a text, padded with blanks.
fn text<L: AsRef<str>>(name: &str, lines: &[L]) -> Result<Vec<u8>, Unwritten> {
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
    let letters = element(UINT16, &bytes)?;
    matrix(TEXT, [lines.len(), longest], name, &letters)
}

fn structure(name: &str, fields: &[(String, &str)]) -> Result<Vec<u8>, Unwritten> {
    const FIELD: usize = LONGEST + 1;
    let mut names = Vec::new();
    for (field, _) in fields {
        names.extend(field.as_bytes());
        names.resize(names.len().next_multiple_of(FIELD), 0);
    }
    let mut body = element(INT32, &length(FIELD)?)?;
    body.extend(element(INT8, &names)?);
    for (_, value) in fields {
        body.extend(text("", &[value])?);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_that_would_wrap_is_refused() {
        assert_eq!(length(MOST).unwrap(), i32::MAX.to_le_bytes());
        for count in [MOST + 1, u32::MAX as usize, usize::MAX] {
            let refused = length(count).unwrap_err();
            assert!(refused.problem.contains("2 GiB"), "{}", refused.problem);
            assert!(refused.remedy.contains(".parquet"), "{}", refused.remedy);
        }
    }
}

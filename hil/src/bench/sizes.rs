//! Bytes of what is counted, from the images' symbols.

use std::path::Path;

use mesh_damper::power::PowerTable;
use object::{Object as _, ObjectSymbol as _};

use super::results::Size;
use crate::error::InputError;

/// Parts of the mangled names of the functions that a form of |v|^α is made of.
const IN_RUST: [(&str, &[&str]); 4] = [
    ("power/general", &["5suite5power7general"]),
    ("power/table", &["5suite5power9tabulated"]),
    ("power/libm", &["5suite5power4libm", "4libm4math4powf"]),
    (
        "power/micromath",
        &["5suite5power9micromath", "9micromath5float"],
    ),
];
const IN_C: [(&str, &[&str]); 1] = [("power/c", &["powf"])];
/// The generator's sine.
const SINE: &str = "4sine4SINE";

/// Code of the forms of |v|^α in Rust, and the tables of the tick.
///
/// # Errors
/// A file that cannot be read, or is none.
pub fn of_counted(elf: &Path) -> Result<Vec<Size>, InputError> {
    let symbols = symbols(elf)?;
    let table = size_of::<PowerTable>() as u64;
    let tables = [
        ("power/table", "table", table),
        ("tick/whole", "tables", table + sum(&symbols, &[SINE])),
    ];
    let tables = tables.map(|(name, of, bytes)| Size {
        name: name.into(),
        of,
        bytes,
    });
    Ok(code(&symbols, &IN_RUST).chain(tables).collect())
}

/// Code of |v|^α in C.
///
/// # Errors
/// A file that cannot be read, or is none.
pub fn of_peer(elf: &Path) -> Result<Vec<Size>, InputError> {
    Ok(code(&symbols(elf)?, &IN_C).collect())
}

type Symbol = (String, u64);

/// Name and bytes of every symbol.
fn symbols(elf: &Path) -> Result<Vec<Symbol>, InputError> {
    let bytes = std::fs::read(elf).map_err(|error| InputError::io(elf, "read", &error))?;
    let file = object::File::parse(&*bytes).map_err(|error| {
        let name = elf.display().to_string();
        InputError::new(name, error.to_string(), "build the image again")
    })?;
    let named = file.symbols().filter_map(|symbol| {
        let name = symbol.name().ok()?;
        Some((name.to_owned(), symbol.size()))
    });
    Ok(named.collect())
}

fn sum(symbols: &[Symbol], parts: &[&str]) -> u64 {
    let is_one = |(name, _): &&Symbol| parts.iter().any(|part| name.contains(part));
    symbols.iter().filter(is_one).map(|(_, bytes)| bytes).sum()
}

fn code(symbols: &[Symbol], of: &[(&str, &[&str])]) -> impl Iterator<Item = Size> {
    of.iter().map(|(name, parts)| Size {
        name: (*name).into(),
        of: "code",
        bytes: sum(symbols, parts),
    })
}

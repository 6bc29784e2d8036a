//! Bytes of the counted code, from the images' symbols.

use std::path::Path;

use mesh_damper::power::PowerTable;
use mesh_damper_output::error::InputError;
use object::{Object as _, ObjectSymbol as _};

use super::results::Size;

/// Parts of the mangled names of the functions for each form of |v|^α.
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
const SINE: &str = "4sine5phase4SINE";

/// Code of the forms of |v|^α in Rust, and the tables of the tick.
///
/// # Errors
/// The file cannot be read, is no image, or lacks a symbol to size.
pub fn of_counted(elf: &Path) -> Result<Vec<Size>, InputError> {
    let symbols = symbols(elf)?;
    let table = size_of::<PowerTable>() as u64;
    let tables = [
        ("power/table", "table", table),
        ("tick/whole", "tables", table + sum(&symbols, &[SINE])?),
    ];
    let tables = tables.map(|(name, of, bytes)| Size {
        name: name.into(),
        of,
        bytes,
    });
    Ok([code(&symbols, &IN_RUST)?, tables.into()].concat())
}

/// Code of |v|^α in C.
///
/// # Errors
/// The file cannot be read, is no image, or lacks a symbol to size.
pub fn of_peer(elf: &Path) -> Result<Vec<Size>, InputError> {
    code(&symbols(elf)?, &IN_C)
}

/// Code whose only purpose can be a panic.
///
/// # Errors
/// The file cannot be read, is no image, or has no symbols.
pub fn of_panics(elf: &Path) -> Result<u64, InputError> {
    let symbols = symbols(elf)?;
    // A stripped image would also have no panics.
    sum(&symbols, &["main"])?;
    let panics = symbols
        .iter()
        .filter(|(name, _)| name.contains("panicking") || name.contains("panic_"));
    Ok(panics.map(|(_, bytes)| bytes).sum())
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

/// Bytes of the symbols whose names contain one of `parts`. There must be some: otherwise a renamed symbol would count as 0 bytes.
fn sum(symbols: &[Symbol], parts: &[&str]) -> Result<u64, InputError> {
    let is_one = |(name, _): &&Symbol| parts.iter().any(|part| name.contains(part));
    let bytes = symbols.iter().filter(is_one).map(|(_, bytes)| bytes).sum();
    if bytes == 0 {
        return Err(InputError::new(
            "the image that counts",
            format!("it has no symbol with {} in its name", parts.join(" or ")),
            "name what took its place in hil/trials/src/bench/sizes.rs",
        ));
    }
    Ok(bytes)
}

fn code(symbols: &[Symbol], of: &[(&str, &[&str])]) -> Result<Vec<Size>, InputError> {
    of.iter()
        .map(|(name, parts)| {
            Ok(Size {
                name: (*name).into(),
                of: "code",
                bytes: sum(symbols, parts)?,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_added_up_and_a_missing_one_is_said() {
        let symbols = [("a4sine1", 3), ("b4sine2", 4), ("c", 9)];
        let symbols = symbols.map(|(name, bytes)| (name.to_owned(), bytes));
        assert_eq!(sum(&symbols, &["4sine", "c", "d"]).unwrap(), 16);
        let error = sum(&symbols, &["x", "z"]).unwrap_err().to_string();
        assert!(error.contains("no symbol with x or z in"), "{error}");
    }
}

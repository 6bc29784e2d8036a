//! Bytes of what is counted, from the image's symbols.

use std::path::Path;

use mesh_damper::power::PowerTable;
use object::{Object as _, ObjectSymbol as _};

use super::results::Size;
use crate::error::InputError;

/// Parts of the mangled names of the functions that a form of |v|^α is made of.
const CODE: [(&str, &[&str]); 3] = [
    ("power/general", &["5suite5power7general"]),
    ("power/table", &["5suite5power9tabulated"]),
    ("power/libm", &["5suite5power4libm", "4libm4math4powf"]),
];

/// Code of the forms of |v|^α, and the tables of the tick.
///
/// # Errors
/// A file that cannot be read, or is none.
pub fn of_counted(elf: &Path) -> Result<Vec<Size>, InputError> {
    let bytes = std::fs::read(elf).map_err(|error| InputError::io(elf, "read", &error))?;
    let file = object::File::parse(&*bytes).map_err(|error| {
        let name = elf.display().to_string();
        InputError::new(name, error.to_string(), "build the image again")
    })?;
    let code = CODE.map(|(name, parts)| Size {
        name: name.into(),
        of: "code",
        bytes: file
            .symbols()
            .filter(|symbol| {
                symbol
                    .name()
                    .is_ok_and(|name| parts.iter().any(|part| name.contains(part)))
            })
            .map(|symbol| symbol.size())
            .sum(),
    });
    let table = size_of::<PowerTable>() as u64;
    let sine: u64 = file
        .symbols()
        .filter(|symbol| symbol.name().is_ok_and(|name| name.contains("4sine4SINE")))
        .map(|symbol| symbol.size())
        .sum();
    let size = |name: &str, of, bytes| Size {
        name: name.into(),
        of,
        bytes,
    };
    let tables = [
        size("power/table", "table", table),
        size("tick/whole", "tables", table + sine),
    ];
    Ok(code.into_iter().chain(tables).collect())
}

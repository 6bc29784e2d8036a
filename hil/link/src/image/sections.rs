//! Memory use of an image on a board, from its ELF file.

use std::path::Path;

use mesh_damper_output::error::InputError;
use object::{Object as _, ObjectSection as _, SectionFlags, SectionKind, elf};
use serde::Serialize;

/// Sizes in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Sections {
    /// Code, constants and the initial values of variables.
    pub flash: u64,
    /// Variables, without the stack.
    pub ram: u64,
}

/// The sizes of the ELF file at `path`.
///
/// # Errors
/// A file that cannot be read, or is not an ELF file.
pub fn sections(path: &Path) -> Result<Sections, InputError> {
    let bytes = std::fs::read(path).map_err(|error| InputError::io(path, "read", &error))?;
    let file = object::File::parse(&*bytes).map_err(|error| {
        let name = path.display().to_string();
        InputError::new(name, error.to_string(), "build the image again")
    })?;
    let mut sizes = Sections::default();
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            continue;
        };
        if sh_flags & u64::from(elf::SHF_ALLOC) == 0 {
            continue;
        }
        if section.kind() != SectionKind::UninitializedData {
            sizes.flash += section.size();
        }
        if sh_flags & u64::from(elf::SHF_WRITE) != 0 {
            sizes.ram += section.size();
        }
    }
    Ok(sizes)
}

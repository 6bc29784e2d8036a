//! A coefficient pack in a file.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use mesh_damper::pack::{LARGEST, PackInfo};
use mesh_damper_output::error::InputError;

/// The bytes of the pack at `path`, after a check of its header and checksum.
///
/// # Errors
/// A file that cannot be read, or that is not a pack.
pub fn read_pack(path: &Path) -> Result<Vec<u8>, InputError> {
    read_with_info(path).map(|(bytes, _)| bytes)
}

/// The same, with the information in the pack about itself.
///
/// # Errors
/// As [`read_pack`].
pub fn read_with_info(path: &Path) -> Result<(Vec<u8>, Option<PackInfo>), InputError> {
    // A byte more than the largest pack has: of what is longer the length is wrong.
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(LARGEST as u64 + 1).read_to_end(&mut bytes))
        .map_err(|error| InputError::io(path, "read", &error))?;
    let info = PackInfo::of(&bytes).map_err(|error| {
        let remedy = "give a pack that `hil export --format pack` wrote";
        InputError::new(path.display().to_string(), error.to_string(), remedy)
    })?;
    Ok((bytes, info))
}

//! The option of every command that replaces the default numbers of the policy.

use std::path::Path;

use mesh_damper_output::error::{InputError, Place};
use mesh_damper_tables::read_limit::{ReadLimit, read_json};
use mesh_damper_trials::numbers::Policies;
use serde::de::DeserializeOwned;

/// Uses the numbers of the file at `path`; other numbers keep their defaults.
pub fn install(path: &Path) -> Result<(), InputError> {
    let policies: Policies = read(path)?;
    policies.install().map_err(|error| {
        InputError::new(path.display().to_string(), error.to_string(), "report this")
    })
}

/// The contents of a JSON file.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, InputError> {
    let text = read_json(path, ReadLimit::default())?;
    let json = &mut serde_json::Deserializer::from_slice(&text);
    serde_path_to_error::deserialize(json).map_err(|error| {
        InputError::new(
            path.display().to_string(),
            error.inner().to_string(),
            "see docs/numbers.md for the names of the numbers",
        )
        .at(Place::Field(error.path().to_string()))
    })
}

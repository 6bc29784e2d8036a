//! A model as a file, `model.json`: `trace` writes it, `predict` and `run` read it.
//!
//! ```json
//! { "format": "mesh-damper-model", "version": 1,
//!   "units": { "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" },
//!   "law": [ { "amplitude": 0.0, "k1": 1.2, "k3": 30.0, "c": 0.1, "alpha": 0.3 } ],
//!   "effects": [ { "family": "stick_slip", "parameters": { "stiffness": 1.2, "slip_limit": 0.03 } } ],
//!   "fitted_range": { "displacement": [-0.2, 0.2], "velocity": [-6.3, 6.3] } }
//! ```
//! A law under control inputs names them, `"controls": [ { "name": "current_A", "range": [0.0, 1.0] } ]`: by its place there an effect
//! says which of them it sees. `law` holds eq 13's coefficients at increasing amplitudes; parameters are in the units of
//! [`crate::parameter_unit`].

mod check;
mod elsewhere;
mod fitted_range;
mod unique;

use std::path::Path;

pub use check::model_error;
pub use elsewhere::Elsewhere;
pub use fitted_range::FittedRange;

use mesh_damper::error::ConfigError;
use mesh_damper::pack::Identity;
use mesh_damper_output::error::{InputError, Place};
use mesh_damper_recording::rig::RigFacts;
use mesh_damper_tables::read_limit::{ReadLimit, read_json};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use crate::correction::CorrectionTable;
use crate::{AddedEffect, Control, LawNode, Model};
use unique::Unique;

/// The word that marks a model file.
const FORMAT: &str = "mesh-damper-model";
/// The version that is written, and the only version that is read.
const VERSION: u64 = 1;

/// The contents of a model file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// The word `mesh-damper-model`.
    format: String,
    /// The version of the format, 1.
    version: u64,
    /// The units of all numbers.
    units: ModelUnits,
    /// Coefficients of eq 13 at increasing amplitudes.
    law: Vec<LawNode>,
    /// The effects added to the law.
    effects: Vec<AddedEffect>,
    /// The residual table; absent if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    correction: Option<CorrectionTable>,
    /// The control inputs; absent if the law has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    controls: Vec<Control>,
    /// The operating range: the motion that the model was fitted on.
    fitted_range: FittedRange,
    /// Smallest and largest offset that was subtracted from the displacements of the fitted recordings, mm: the law's displacement
    /// starts there. Absent if it is 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    displacement_zero: [f64; 2],
    /// The error of the model on motions that it was not fitted to; absent if it is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    elsewhere: Option<Elsewhere>,
    /// What was stated about the rig of the fitted recordings; absent if nothing was. A mass there is an effect of the law.
    #[serde(default, skip_serializing_if = "RigFacts::is_empty")]
    rig: RigFacts,
}

fn is_zero(range: &[f64; 2]) -> bool {
    *range == [0.0; 2]
}

/// Units of a model file. No others are allowed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct ModelUnits {
    /// Unit of displacements.
    displacement: Millimetre,
    /// Unit of forces.
    force: Kilonewton,
    /// Unit of times.
    time: Second,
    /// Unit of temperatures.
    temperature: Celsius,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum Millimetre {
    #[serde(rename = "mm")]
    Mm,
}
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum Kilonewton {
    #[serde(rename = "kN")]
    KN,
}
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum Second {
    #[serde(rename = "s")]
    S,
}
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum Celsius {
    #[serde(rename = "degC")]
    DegC,
}

impl ModelFile {
    /// The file of a model fitted on motions within `fitted_range`.
    pub fn new(model: Model, fitted_range: FittedRange) -> Self {
        Self {
            format: FORMAT.into(),
            version: VERSION,
            units: ModelUnits {
                displacement: Millimetre::Mm,
                force: Kilonewton::KN,
                time: Second::S,
                temperature: Celsius::DegC,
            },
            law: model.law,
            effects: model.effects,
            correction: model.correction,
            controls: model.controls,
            fitted_range,
            displacement_zero: [0.0; 2],
            elsewhere: None,
            rig: RigFacts::default(),
        }
    }

    /// As [`ModelFile::new`], for recordings whose displacement had an offset subtracted: from the smallest to the largest, mm.
    #[must_use]
    pub fn with_displacement_zero(self, displacement_zero: [f64; 2]) -> Self {
        Self {
            displacement_zero,
            ..self
        }
    }

    /// As [`ModelFile::new`], with the error on motions that were left out of the fit.
    #[must_use]
    pub fn with_elsewhere(self, elsewhere: Option<Elsewhere>) -> Self {
        Self { elsewhere, ..self }
    }

    /// The same with the facts that were stated about the rig.
    #[must_use]
    pub fn with_rig(self, rig: RigFacts) -> Self {
        Self { rig, ..self }
    }

    /// Reads a model. The crate checks every coefficient in f64 and in f32.
    ///
    /// # Errors
    /// The error names the file and the field: not a model file, another version, a missing or unknown field, one that is given
    /// twice, a field of another type, an unknown family, a coefficient or parameter out of range, or a file beyond the default [`ReadLimit`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, InputError> {
        Self::read_within(path, ReadLimit::default())
    }

    /// [`ModelFile::read`] with another limit.
    ///
    /// # Errors
    /// As [`ModelFile::read`].
    pub fn read_within(path: impl AsRef<Path>, limit: ReadLimit) -> Result<Self, InputError> {
        let path = path.as_ref();
        let bytes = read_json(path, limit)?;
        Self::from_bytes(&path.display().to_string(), &bytes)
    }

    /// [`ModelFile::read`] of a file's bytes; errors call the file `name`.
    ///
    /// # Errors
    /// As [`ModelFile::read`], without the errors of the file system.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, InputError> {
        let refused = |field: &str, problem: String, remedy: &str| {
            InputError::new(name, problem, remedy).at(Place::Field(field.into()))
        };
        let value: serde_json::Value =
            serde_json::from_slice(bytes).map_err(|error| not_json(name, &error))?;
        let mut json = serde_json::Deserializer::from_slice(bytes);
        serde_path_to_error::deserialize::<_, Unique>(&mut json).map_err(|error| {
            refused(
                &error.path().to_string(),
                error.inner().to_string(),
                "keep the right one of the two",
            )
        })?;
        match value.get("format").and_then(serde_json::Value::as_str) {
            Some(FORMAT) => {}
            Some(other) => {
                return Err(refused(
                    "format",
                    format!(
                        "{} is another format",
                        mesh_damper_output::error::quoted(other)
                    ),
                    "give the model.json that `hil trace` wrote",
                ));
            }
            None => {
                return Err(refused(
                    "format",
                    "missing, so this is not a model file".into(),
                    "give the model.json that `hil trace` wrote",
                ));
            }
        }
        match value.get("version") {
            Some(version) if version.as_u64() == Some(VERSION) => {}
            other => {
                let problem = match other {
                    Some(found) => format!(
                        "version {found} is not supported; this program reads version {VERSION}"
                    ),
                    None => "the version is missing".into(),
                };
                return Err(refused(
                    "version",
                    problem,
                    "trace the recordings again with this program",
                ));
            }
        }
        if let Some(removed) = removed_memory(&value) {
            return Err(refused(
                "correction.memory.of",
                removed.to_string(),
                "trace the recordings again with this program",
            ));
        }
        let file: Self = serde_path_to_error::deserialize(value).map_err(|error| {
            refused(
                &error.path().to_string(),
                error.inner().to_string(),
                "correct the field, or trace the recordings again",
            )
        })?;
        file.check(name)?;
        Ok(file)
    }

    /// The model.
    pub fn model(&self) -> Model {
        Model {
            law: self.law.clone(),
            effects: self.effects.clone(),
            correction: self.correction.clone(),
            controls: self.controls.clone(),
        }
    }

    /// The identity of the model: the first bytes of the SHA-256 of its law, effects, residual table and operating range, as JSON
    /// without spaces. The layout of the file is no part of it, nor is the zero of a recording: the force of the law is the same.
    ///
    /// # Panics
    /// Never: numbers and names are valid JSON.
    pub fn identity(&self) -> Identity {
        let meaning = (
            &self.law,
            &self.effects,
            &self.correction,
            self.fitted_range,
        );
        let mut json = serde_json::to_vec(&meaning).expect("numbers and names are JSON");
        // A model without control inputs keeps the identity from before there were any.
        if !self.controls.is_empty() {
            json.extend(serde_json::to_vec(&self.controls).expect("numbers and names are JSON"));
        }
        let hash = Sha256::digest(json);
        let mut first = [0; 8];
        first.copy_from_slice(&hash[..8]);
        Identity(first)
    }

    /// The range of motion that it was fitted on.
    pub fn fitted_range(&self) -> FittedRange {
        self.fitted_range
    }

    /// The error on motions that it was not fitted to, if it is known.
    pub fn elsewhere(&self) -> Option<Elsewhere> {
        self.elsewhere
    }

    /// Smallest and largest offset of the recorded displacement, mm. The law's displacement is the recorded one minus the offset.
    pub fn displacement_zero(&self) -> [f64; 2] {
        self.displacement_zero
    }

    /// What was stated about the rig of the fitted recordings.
    pub fn rig(&self) -> RigFacts {
        self.rig
    }
}

fn not_json(name: &str, error: &serde_json::Error) -> InputError {
    InputError::new(
        name,
        format!("not JSON: {error}"),
        "give the model.json that `hil trace` wrote",
    )
    .at(Place::Line(error.line() as u64))
}

/// The axis of a residual table that only model files of an earlier version have.
fn removed_memory(file: &serde_json::Value) -> Option<ConfigError> {
    let of = file.pointer("/correction/memory/of")?;
    // A variant without parameters is its name alone.
    let name = of
        .as_str()
        .or_else(|| of.as_object()?.keys().next().map(String::as_str));
    Some(ConfigError::Removed(match name? {
        "level" => "residual table over level",
        "cycles" => "residual table over cycles",
        "acceleration" => "residual table over acceleration",
        _ => return None,
    }))
}

#[cfg(test)]
mod tests;

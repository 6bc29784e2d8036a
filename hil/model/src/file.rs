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

use std::path::Path;

use mesh_damper::effects::CONTROLS;
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::pack::Identity;
use mesh_damper_recording::error::{InputError, Place};
use mesh_damper_recording::read_limit::{ReadLimit, read_json};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use crate::correction::CorrectionTable;
use crate::{AddedEffect, Control, LawNode, Model, ModelError};

/// The word that marks a model file.
const FORMAT: &str = "mesh-damper-model";
/// The version that is written, and the only version that is read.
const VERSION: u64 = 1;
/// The tick with which effects are built to check their parameters, s: that of the rig.
const CHECKED_TICK: f64 = 1e-4;

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

/// Range of motion that a model was fitted on. Outside it the model extrapolates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FittedRange {
    /// Smallest and largest displacement, mm.
    pub displacement: [f64; 2],
    /// Smallest and largest velocity, mm/s.
    pub velocity: [f64; 2],
}

impl FittedRange {
    /// The range of a motion with `displacement` in mm and `velocity` in mm/s; `None` for an empty motion.
    pub fn of<'a>(
        displacement: impl IntoIterator<Item = &'a f64>,
        velocity: impl IntoIterator<Item = &'a f64>,
    ) -> Option<Self> {
        Some(Self {
            displacement: range(displacement)?,
            velocity: range(velocity)?,
        })
    }

    /// How far a motion's displacement and velocity exceed these ranges, each as a fraction of the larger end; 0 inside.
    pub fn exceeded_in(&self, motion: &Self) -> [f64; 2] {
        let beyond = |own: [f64; 2], other: [f64; 2]| {
            let reach = own[0].abs().max(own[1].abs());
            let excess = (own[0] - other[0]).max(other[1] - own[1]).max(0.0);
            if excess > 0.0 { excess / reach } else { 0.0 }
        };
        [
            beyond(self.displacement, motion.displacement),
            beyond(self.velocity, motion.velocity),
        ]
    }
}

fn range<'a>(values: impl IntoIterator<Item = &'a f64>) -> Option<[f64; 2]> {
    values.into_iter().fold(None, |range, &value| {
        let [low, high] = range.unwrap_or([value, value]);
        Some([value.min(low), value.max(high)])
    })
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

    /// Reads a model. The crate checks every coefficient in f64 and in f32.
    ///
    /// # Errors
    /// The error names the file and the field: not a model file, another version, a missing or unknown field, a field of another
    /// type, an unknown family, a coefficient or parameter out of range, or a file beyond the default [`ReadLimit`].
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
        let value: serde_json::Value = serde_json::from_slice(bytes).map_err(|error| {
            InputError::new(
                name,
                format!("not JSON: {error}"),
                "give the model.json that `hil trace` wrote",
            )
            .at(Place::Line(error.line() as u64))
        })?;
        let refused = |field: &str, problem: String, remedy: &str| {
            InputError::new(name, problem, remedy).at(Place::Field(field.into()))
        };
        match value.get("format").and_then(serde_json::Value::as_str) {
            Some(FORMAT) => {}
            Some(other) => {
                return Err(refused(
                    "format",
                    format!(
                        "{} is another format",
                        mesh_damper_recording::error::quoted(other)
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
                let found = other.map_or("none".into(), ToString::to_string);
                return Err(refused(
                    "version",
                    format!("{found} is unknown, this program reads version {VERSION}"),
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

    /// Smallest and largest offset of the recorded displacement, mm. The law's displacement is the recorded one minus the offset.
    pub fn displacement_zero(&self) -> [f64; 2] {
        self.displacement_zero
    }

    fn check(&self, name: &str) -> Result<(), InputError> {
        let refused = |field: String, problem: String| {
            Err(InputError::new(
                name,
                problem,
                "correct the field, or trace the recordings again",
            )
            .at(Place::Field(field)))
        };
        for (index, node) in self.law.iter().enumerate() {
            if !(0.0..=mesh_damper::limits::DISPLACEMENT).contains(&node.amplitude) {
                return refused(
                    format!("law[{index}].amplitude"),
                    format!(
                        "{} is outside 0…{}",
                        node.amplitude,
                        mesh_damper::limits::DISPLACEMENT
                    ),
                );
            }
            if let Err(error) = Law::new(node.k1, node.k3, node.c, node.alpha) {
                return refused(
                    format!("law[{index}]{}", field_of(&error)),
                    error.to_string(),
                );
            }
        }
        for (field, [low, high]) in [
            ("displacement", self.fitted_range.displacement),
            ("velocity", self.fitted_range.velocity),
        ] {
            // An infinite value would be written as null, which cannot be read back; a firmware takes the value as f32.
            if !((low as f32).is_finite() && (high as f32).is_finite() && low <= high) {
                return refused(
                    format!("fitted_range.{field}"),
                    format!("{low} to {high} is not a finite range"),
                );
            }
        }
        let [low, high] = self.displacement_zero;
        if !(low.is_finite() && high.is_finite() && low <= high) {
            return refused(
                "displacement_zero".into(),
                format!("{low} to {high} is not a finite range"),
            );
        }
        for (index, control) in self.controls.iter().enumerate() {
            let others = &self.controls[..index];
            if control.name.is_empty() || others.iter().any(|each| each.name == control.name) {
                return refused(
                    format!("controls[{index}].name"),
                    format!("{:?} is empty or used twice", control.name),
                );
            }
            let [low, high] = control.range;
            if !(low.is_finite() && high.is_finite() && low <= high) {
                return refused(
                    format!("controls[{index}].range"),
                    format!("{low} to {high} is not a finite range"),
                );
            }
        }
        if self.controls.len() > CONTROLS {
            return refused(
                "controls".into(),
                format!("{} are more than {CONTROLS}", self.controls.len()),
            );
        }
        let unnamed = |effect: &AddedEffect| {
            let place = effect.parameters.get("input").copied();
            let is_controlled = effect.family.depends_on_control();
            is_controlled && place.unwrap_or_default() >= self.controls.len() as f64
        };
        if let Some(index) = self.effects.iter().position(unnamed) {
            return refused(
                format!("effects[{index}]"),
                "depends on a control input that `controls` does not name".into(),
            );
        }
        let amplitude = self.law.first().map_or(0.0, |node| node.amplitude);
        let model = self.model();
        model
            .augmented::<f64>(amplitude, CHECKED_TICK)
            .map_err(|error| model_error(name, &error))?;
        model
            .augmented::<f32>(amplitude, CHECKED_TICK)
            .map_err(|error| model_error(name, &error))?;
        Ok(())
    }
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

/// The error of a model that cannot be built, with the file of the model.
pub fn model_error(file: &str, error: &ModelError) -> InputError {
    let (field, problem) = match error {
        ModelError::Refused { place, error } => (place.clone(), error.to_string()),
        ModelError::Parameters { place, problem } => (place.clone(), problem.clone()),
        ModelError::Nodes(problem) => ("law".into(), (*problem).to_owned()),
        ModelError::Pack(error) => ("effects".into(), error.to_string()),
    };
    InputError::new(
        file,
        problem,
        "correct the field, or trace the recordings again",
    )
    .at(Place::Field(field))
}

/// `.k1` if the error names k1.
fn field_of(error: &ConfigError) -> String {
    match error {
        ConfigError::NonFinite(field) | ConfigError::OutOfRange { field, .. } => {
            format!(".{field}")
        }
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Family;
    use crate::correction::{MemoryAxis, Remembered};
    use mesh_damper::effects::residual_table::CELLS;

    fn correction() -> CorrectionTable {
        let cells = |count| {
            (0..count)
                .map(|cell| 100 * (cell as i16 % 300) - 15_000)
                .collect()
        };
        CorrectionTable {
            reach: 0.2,
            speed: 6.3,
            unit: 1e-6,
            cells: cells(CELLS),
            memory: Some(MemoryAxis {
                of: Remembered::Lag { time: 0.05 },
                range: [-0.1, 0.1],
            }),
        }
    }

    fn example() -> ModelFile {
        let node = |amplitude| LawNode {
            amplitude,
            k1: 1.2,
            k3: 30.0,
            c: 0.1,
            alpha: 0.3,
        };
        let effect = |family, parameters: &[(&str, f64)]| AddedEffect {
            family: Family::named(family).unwrap(),
            parameters: parameters
                .iter()
                .map(|&(name, value)| (name.to_owned(), value))
                .collect(),
        };
        ModelFile::new(
            Model {
                law: vec![node(0.05), node(0.1 + 0.2)],
                effects: vec![
                    effect("offset", &[("force", -0.1)]),
                    effect("asymmetry", &[("k2", 3.0)]),
                    effect("hardening", &[("k5", 100.0)]),
                    effect("viscous", &[("c1", 0.01)]),
                    effect("inertia", &[("mass", 2.0)]),
                    effect(
                        "stick_slip",
                        &[
                            ("stiffness", 1.2),
                            ("slip_limit", 0.03),
                            ("stiffness_2", 0.5),
                            ("slip_limit_2", 0.1),
                        ],
                    ),
                    effect(
                        "relaxation",
                        &[
                            ("stiffness", 0.4),
                            ("time", 0.05),
                            ("stiffness_2", 0.3),
                            ("time_2", 0.7),
                        ],
                    ),
                    effect("temperature", &[("beta", 0.004), ("reference", 20.0)]),
                ],
                correction: Some(correction()),
                controls: vec![Control {
                    name: "current_A".into(),
                    range: [0.0, 1.5],
                }],
            },
            FittedRange {
                displacement: [-0.2, 0.2],
                velocity: [-6.3, 6.3],
            },
        )
    }

    fn read_changed(change: impl FnOnce(&mut serde_json::Value)) -> String {
        let mut value = serde_json::to_value(example()).unwrap();
        change(&mut value);
        ModelFile::from_bytes("m.json", value.to_string().as_bytes())
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn comes_back_as_it_was() {
        let file = example();
        let bytes = serde_json::to_vec_pretty(&file).unwrap();
        assert_eq!(ModelFile::from_bytes("m.json", &bytes).unwrap(), file);
    }

    #[test]
    fn a_zero_is_kept_and_changes_neither_older_files_nor_the_identity() {
        let file = example();
        assert!(!serde_json::to_string(&file).unwrap().contains("zero"));
        let moved = file.clone().with_displacement_zero([0.13, 0.14]);
        assert_eq!(moved.identity(), file.identity());
        let bytes = serde_json::to_vec(&moved).unwrap();
        let read = ModelFile::from_bytes("m.json", &bytes).unwrap();
        assert_eq!(read.displacement_zero(), [0.13, 0.14]);
        assert!(
            read_changed(|v| v["displacement_zero"] = serde_json::json!([1.0, 0.0]))
                .starts_with("m.json: field displacement_zero: 1 to 0 is not a finite range")
        );
    }

    #[test]
    fn refuses_naming_the_field() {
        for (said, error) in [
            (
                "m.json: field version: 2 is unknown",
                read_changed(|v| v["version"] = 2.into()),
            ),
            (
                "m.json: field version: none is unknown",
                read_changed(|v| drop(v.as_object_mut().unwrap().remove("version"))),
            ),
            (
                "m.json: field format: missing",
                read_changed(|v| drop(v.as_object_mut().unwrap().remove("format"))),
            ),
            (
                "m.json: field effects[1].family: unknown variant `magic`",
                read_changed(|v| v["effects"][1]["family"] = "magic".into()),
            ),
            (
                "m.json: field law[1].alpha: alpha = 1.5 is outside 0…1",
                read_changed(|v| v["law"][1]["alpha"] = 1.5.into()),
            ),
            (
                "m.json: field law[0].c: c = -1 is outside",
                read_changed(|v| v["law"][0]["c"] = (-1.0).into()),
            ),
            (
                "m.json: field law: amplitudes must increase",
                read_changed(|v| v["law"][1]["amplitude"] = 0.0.into()),
            ),
            (
                "m.json: field law: there is no node",
                read_changed(|v| v["law"] = serde_json::json!([])),
            ),
            (
                "m.json: field effects[5] (stick_slip): slip_limit = 0 is outside",
                read_changed(|v| v["effects"][5]["parameters"]["slip_limit_2"] = 0.0.into()),
            ),
            (
                "m.json: field effects[0] (offset): parameter force is missing",
                read_changed(|v| v["effects"][0]["parameters"] = serde_json::json!({})),
            ),
            (
                "m.json: field fitted_range.velocity:",
                read_changed(|v| v["fitted_range"]["velocity"] = serde_json::json!([1.0, -1.0])),
            ),
            (
                "m.json: field fitted_range.displacement: 0 to 10000000000",
                read_changed(|v| v["fitted_range"]["displacement"] = serde_json::json!([0, 1e300])),
            ),
            (
                "m.json: field units.force: unknown variant `N`",
                read_changed(|v| v["units"]["force"] = "N".into()),
            ),
            (
                "m.json: field correction: cells = 305 is outside 306",
                read_changed(|v| drop(v["correction"]["cells"].as_array_mut().unwrap().pop())),
            ),
            (
                "m.json: field correction.memory.of: unknown variant `dreams`",
                read_changed(|v| v["correction"]["memory"]["of"] = "dreams".into()),
            ),
            (
                "m.json: field law[0].k1: invalid type: string",
                read_changed(|v| v["law"][0]["k1"] = "1".into()),
            ),
        ] {
            assert!(error.starts_with(said), "{error}");
            assert!(!error.contains('\n'));
        }
    }

    #[test]
    fn what_was_removed_is_refused_by_name() {
        for (of, name) in [
            (
                serde_json::json!({ "cycles": { "cycles": 10.0 } }),
                "cycles",
            ),
            (serde_json::json!({ "level": { "time": 0.2 } }), "level"),
            (serde_json::json!("acceleration"), "acceleration"),
        ] {
            assert_eq!(
                read_changed(|v| v["correction"]["memory"]["of"] = of),
                format!(
                    "m.json: field correction.memory.of: there is no residual table over {name} any more; \
                     trace the recordings again with this program"
                )
            );
        }
    }

    #[test]
    fn says_how_far_a_motion_goes_beyond() {
        let fitted = example().fitted_range();
        let motion = FittedRange::of(&[-0.1, 0.25], &[-6.0, 6.0]).unwrap();
        // (0.25 − 0.2)/0.2
        let [displacement, velocity] = fitted.exceeded_in(&motion);
        assert!((displacement - 0.25).abs() < 1e-12);
        assert_eq!(velocity, 0.0);
        assert_eq!(motion.exceeded_in(&motion), [0.0; 2]);
    }
}

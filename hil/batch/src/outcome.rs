//! The outcome of one trace, as a row of the batch shows it.

use std::collections::BTreeMap;

use mesh_damper_identify::trace::Trace;
use mesh_damper_identify::trace::conclusion::Conclusion;
use mesh_damper_identify::trace::result::{Estimate, FoundEffect, LawEstimate, Verdict};
use mesh_damper_model::file::FittedRange;
use mesh_damper_recording::Recording;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};

/// The outcome of one trace.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "outcome", rename_all = "snake_case")]
pub enum Outcome {
    /// The trace was made.
    Traced(Box<Found>),
    /// The trace could not be made.
    Failed(Failure),
}

impl<'de> Deserialize<'de> for Outcome {
    /// Goes through JSON values: the code that serde derives for a tag keeps the fields in its own values, and these lose numbers
    /// if any crate of a build enables arbitrary precision in serde_json.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut fields = Map::deserialize(deserializer)?;
        let kind = fields.remove("outcome");
        let fields = Value::Object(fields);
        match kind.as_ref().and_then(Value::as_str) {
            Some("traced") => serde_json::from_value(fields).map(Self::Traced),
            Some("failed") => serde_json::from_value(fields).map(Self::Failed),
            _ => return Err(D::Error::custom("the outcome is neither traced nor failed")),
        }
        .map_err(D::Error::custom)
    }
}

/// The reason why a trace could not be made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Failure {
    /// One line with the file, the place, the error and the remedy.
    pub error: String,
    /// The read limit of a file, bytes, if it stopped the reading of a recording. The recording may be read with a larger limit.
    pub read_limit: Option<u64>,
}

impl Failure {
    /// For an error that does not depend on the read limit.
    pub(crate) fn of(error: &impl ToString) -> Self {
        Self {
            error: error.to_string(),
            read_limit: None,
        }
    }
}

/// The part of `trace.json` that a table of many traces needs. An error that is not finite is null.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Found {
    /// The folder with the trace's files, relative to the batch's folder; empty if no files were written.
    pub folder: String,
    /// The version of the program that made the trace.
    pub program_version: String,
    /// Duration of the trace, s.
    pub trace_s: f64,
    /// Number of samples in all recordings.
    pub samples: usize,
    /// Duration of all recordings, s.
    pub duration_s: f64,
    /// The operating range: the displacement, mm, and the velocity, mm/s, of the fitted samples.
    pub fitted_range: FittedRange,
    /// The conclusion.
    pub verdict: Verdict,
    /// Errors of the force, RMS over RMS.
    pub nrmse: Nrmse,
    /// Whether the model contains the effects found.
    pub adopted: bool,
    /// The law's name.
    pub law_name: String,
    /// Coefficients of the law, amplitude by amplitude.
    pub law: Vec<LawEstimate>,
    /// The effects found.
    pub effects: Vec<Effect>,
    /// Effects that are not confirmed.
    pub unconfirmed: Vec<Effect>,
    /// Remainder of the law with all effects, as a multiple of the noise; null if it is only noise.
    pub remainder_times_noise: Option<f64>,
    /// Whether the model explains the fitted samples, but its residual on the held-out samples is larger than their noise explains.
    #[serde(default)]
    pub held_out_differs: bool,
    /// The variables that the force beyond the law depends on.
    pub depends_on: Vec<String>,
    /// The test that would distinguish the candidates, if one is needed.
    pub separating_test: Option<String>,
    /// Problems of the data, as sentences. They contain the file names at the time of the trace.
    pub warnings: Vec<String>,
    /// Guesses made in reading the files, as sentences.
    pub guesses: Vec<String>,
}

/// Errors of the force, RMS over RMS of the measured force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Nrmse {
    /// NRMSE of the noise of the measured force.
    pub noise_floor: Option<f64>,
    /// NRMSE of the law alone on fitted samples.
    pub baseline_fitted: Option<f64>,
    /// The same on held-out samples.
    pub baseline_held_out: Option<f64>,
    /// NRMSE of the model, in f64, on fitted samples.
    pub augmented_fitted: Option<f64>,
    /// The same on held-out samples.
    pub augmented_held_out: Option<f64>,
    /// NRMSE of the embedded model, in f32, on held-out samples.
    pub on_target_held_out: Option<f64>,
}

/// One effect in addition to the law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Effect {
    /// The family's name.
    pub family: String,
    /// Its parameters by name, with their 90 % intervals.
    pub parameters: BTreeMap<String, Estimate>,
    /// Held-out error without this effect.
    pub nrmse_without: Option<f64>,
    /// Held-out error with this effect.
    pub nrmse_with: Option<f64>,
}

impl Found {
    /// The verdict as a reader needs it.
    pub fn conclusion(&self) -> Conclusion {
        // An error that is missing is not finite: nothing is hidden behind it.
        let error = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let Nrmse {
            augmented_fitted,
            noise_floor,
            ..
        } = self.nrmse;
        Conclusion::of(
            self.verdict,
            error(augmented_fitted),
            error(noise_floor),
            self.held_out_differs,
        )
    }

    /// From `trace`, which was made of `recordings` in `trace_s`.
    pub(crate) fn of(
        trace: &Trace,
        recordings: &[Recording],
        fitted_range: FittedRange,
        folder: String,
        trace_s: f64,
    ) -> Self {
        let result = &trace.result;
        let length = |recording: &Recording| match recording.time[..] {
            [first, .., last] => last - first,
            _ => 0.0,
        };
        let effects = |all: &[FoundEffect]| all.iter().map(Effect::of).collect();
        let left = result.remainder.as_ref();
        Self {
            folder,
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            trace_s,
            samples: recordings.iter().map(Recording::len).sum(),
            duration_s: recordings.iter().map(length).sum(),
            fitted_range,
            verdict: result.verdict,
            nrmse: Nrmse {
                noise_floor: finite(result.noise_floor_nrmse),
                baseline_fitted: finite(result.baseline.nrmse_fitted),
                baseline_held_out: finite(result.baseline.nrmse_held_out),
                augmented_fitted: finite(result.augmented.nrmse_fitted),
                augmented_held_out: finite(result.augmented.nrmse_held_out),
                on_target_held_out: finite(result.on_target.nrmse_held_out),
            },
            adopted: result.adopted,
            law_name: result.baseline.law.clone(),
            law: result.law.clone(),
            effects: effects(&result.effects),
            unconfirmed: effects(&result.unconfirmed),
            remainder_times_noise: left.and_then(|left| finite(left.times_noise)),
            held_out_differs: result.held_out_differs,
            depends_on: result.depends_on.clone(),
            separating_test: result.separating_test.clone(),
            warnings: result.warnings.clone(),
            guesses: result.guesses.clone(),
        }
    }
}

impl Effect {
    fn of(effect: &FoundEffect) -> Self {
        Self {
            family: effect.family.clone(),
            parameters: effect.parameters.clone(),
            nrmse_without: finite(effect.nrmse_without),
            nrmse_with: finite(effect.nrmse_with),
        }
    }
}

/// JSON has no other numbers.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

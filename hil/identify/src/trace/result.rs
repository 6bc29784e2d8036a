//! The result of a trace: the contents of `trace.json`.
//!
//! Every error is an NRMSE: the RMS of the force's error over the RMS of the measured force. "Held out" means never fitted.

use std::collections::BTreeMap;

use mesh_damper_model::correction::{CorrectionTable, Remembered};
use mesh_damper_model::file::Elsewhere;
use mesh_damper_output::{Label, LabelField};
use mesh_damper_recording::rig::RigFacts;
use mesh_damper_reference::protocol::TestBlock;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::rule::Rule;
pub use super::witness::Explainable;

/// The result of a trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TraceResult {
    /// The fitted recordings.
    pub recordings: Vec<String>,
    /// The recordings that were held out completely.
    pub held_out: Vec<String>,
    /// NRMSE of the noise of the measured force, estimated from the recordings.
    pub noise_floor_nrmse: f64,
    /// Whether the samples show that noise. Otherwise it is an upper bound: the force was held, interpolated or filtered.
    #[serde(default = "is_known")]
    pub noise_known: bool,
    /// The law alone.
    pub baseline: Baseline,
    /// Coefficients of the law, identified together with the effects found, amplitude by amplitude; one entry if they hold for all
    /// amplitudes.
    pub law: Vec<LawEstimate>,
    /// The conclusion.
    pub verdict: Verdict,
    /// The effects found. For [`Verdict::Ambiguous`], the effects that the data cannot distinguish.
    pub effects: Vec<FoundEffect>,
    /// Effects in the law that are not confirmed. Empty unless other effects are confirmed and the law is incomplete.
    #[serde(default)]
    pub unconfirmed: Vec<FoundEffect>,
    /// Results for each effect on conditions that were held out in turn. Empty if the error with the effects is at the noise.
    #[serde(default)]
    pub conditions: Vec<HeldCondition>,
    /// The remainder beyond the noise of the law with all effects; null if there is none.
    #[serde(default)]
    pub remainder: Option<Remainder>,
    /// How much of the residual of the law of `model.json` a general regressor predicts from the motion's history; null if there are too few
    /// conditions to leave out.
    #[serde(default)]
    pub explainable: Option<Explainable>,
    /// The error of the law of `model.json` on conditions left out of its fit; null if the recordings hold one amplitude and frequency.
    #[serde(default)]
    pub elsewhere: Option<Elsewhere>,
    /// All families that were tried, the best first.
    pub candidates: Vec<Candidate>,
    /// The rule by which the effects found are not the complete explanation; null if they are, or if nothing was found.
    #[serde(default)]
    pub effects_rejected_by: Option<Rule>,
    /// The rule by which there is no residual table although the law is incomplete; null if there is a table, or if the law is
    /// complete.
    #[serde(default)]
    pub table_rejected_by: Option<Rule>,
    /// The test that would distinguish the candidates, if one is needed.
    pub separating_test: Option<String>,
    /// The blocks of the separating test, amplitude in mm and frequency in Hz; empty if no test is needed, or if no test would
    /// help.
    #[serde(default)]
    pub separating_blocks: Vec<TestBlock>,
    /// Whether the model explains the fitted samples, but its residual on the held-out samples is larger than their noise explains.
    #[serde(default)]
    pub held_out_differs: bool,
    /// The variables on which the force beyond the law depends: `displacement`, `velocity`, `history`, `time`, `cycle`,
    /// `temperature`, `frequency`, `amplitude`.
    pub depends_on: Vec<String>,
    /// The residual table; null if there is none.
    pub correction: Option<CorrectionSummary>,
    /// Problems of the data, as sentences.
    pub warnings: Vec<String>,
    /// Guesses made while reading the files of the recordings, as sentences.
    #[serde(default)]
    pub guesses: Vec<String>,
    /// What was stated about the rig, and entered the fit as known.
    #[serde(default)]
    pub rig: RigFacts,
    /// Errors of the law of `model.json` in f64; the law includes the effects found if they were adopted.
    pub augmented: Errors,
    /// Error of the same law as embedded in f32.
    pub on_target: OnTarget,
    /// Whether the law of `model.json` contains the effects found. It is the law alone if nothing was found, or if the effects do
    /// not improve it on conditions that are held out in turn.
    #[serde(default = "is_adopted")]
    pub adopted: bool,
    /// The errors of the effects found but not adopted; null if they were adopted, or if nothing was found.
    #[serde(default)]
    pub rejected: Option<Rejected>,
    /// The conditions of the fitted samples; null in older results without this field.
    #[serde(default)]
    pub operating_conditions: Option<OperatingConditions>,
}

/// The conditions of the fitted samples, in addition to the motion and the control inputs, whose ranges are in `model.json`. Each
/// entry is the smallest and the largest value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OperatingConditions {
    /// Offset subtracted from the recorded displacement, mm: the law's displacement starts there.
    pub displacement_zero: [f64; 2],
    /// Temperature, °C; null if a recording has none.
    pub temperature: Option<[f64; 2]>,
    /// Cycles since the first sample of the recording.
    pub cycles: [f64; 2],
}

impl TraceResult {
    /// The label of `trace.json`.
    pub const LABEL: Label = Label::new("trace", LabelField::Format);
}

/// Older results without this field took every noise for known.
fn is_known() -> bool {
    true
}

/// Older results without this field had adopted their effects.
fn is_adopted() -> bool {
    true
}

/// The errors of a law that was not adopted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rejected {
    /// Errors in f64.
    pub augmented: Errors,
    /// Error of the embedded law in f32.
    pub on_target: OnTarget,
}

/// The conclusion of a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The law explains the recordings down to their noise.
    None,
    /// Named effects explain the part of the force that the law does not.
    Found,
    /// Several effects explain that part equally well.
    Ambiguous,
    /// No listed effect explains that part.
    Unlisted,
}

/// The law before any effect is added.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Baseline {
    /// The law's name: `mixed_damping`, `linear` or `none`.
    pub law: String,
    /// Families of known effects. They are part of the law, whatever the search finds.
    #[serde(default)]
    pub known: Vec<String>,
    /// NRMSE on the fitted samples.
    pub nrmse_fitted: f64,
    /// NRMSE on the held-out samples.
    pub nrmse_held_out: f64,
    /// Error on the validation data, as for the candidates; null in an older result.
    #[serde(default)]
    pub nrmse_judged: Option<f64>,
    /// Errors of the same law with its coefficients identified in two stages as in the paper (eqs 14, 15) instead of jointly; null
    /// if that fails.
    pub staged: Option<Errors>,
}

/// Eq 13 at one amplitude.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LawEstimate {
    /// Amplitude, mm; 0 if the coefficients hold for all amplitudes.
    pub amplitude: f64,
    /// Linear stiffness, kN/mm.
    pub k1: Estimate,
    /// Cubic stiffness, kN/mm³.
    pub k3: Estimate,
    /// Damping, kN·(s/mm)^α.
    pub c: Estimate,
    /// Damping exponent α, dimensionless.
    pub alpha: Estimate,
}

/// One effect in addition to the law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FoundEffect {
    /// The family's name, as in the model file.
    pub family: String,
    /// The effect's parameters by name.
    pub parameters: BTreeMap<String, Estimate>,
    /// Held-out error without this effect.
    pub nrmse_without: f64,
    /// Held-out error with this effect.
    pub nrmse_with: f64,
    /// The reason why the effect is not confirmed, if it was tested on conditions held out in turn. Null if it is confirmed, or if
    /// the error of the law is only noise.
    #[serde(default)]
    pub unconfirmed_by: Option<Rule>,
    /// Families that do equally well in place of the effect, if it is not confirmed because of them; `zero` is another zero of the
    /// displacement.
    #[serde(default)]
    pub rivals: Vec<String>,
}

/// One condition that was held out: the law was fitted to all others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HeldCondition {
    /// Recording of the condition.
    pub recording: String,
    /// Times of the condition's first sample and of the first sample after it, s.
    pub span: [f64; 2],
    /// Further blocks or recordings of the same motion, which were held out with it.
    #[serde(default)]
    pub repeats: usize,
    /// Amplitude of the condition, mm; null for a motion without blocks.
    pub amplitude: Option<f64>,
    /// Frequency of the condition, Hz; null for a motion without blocks.
    pub frequency: Option<f64>,
    /// NRMSE of the law with all effects. A sample counts less where the estimated motion is uncertain.
    pub nrmse_with: f64,
    /// NRMSE without the effects of each family.
    pub nrmse_without: BTreeMap<String, f64>,
}

/// The remaining error of a law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Remainder {
    /// Error over the RMS of the force.
    pub nrmse: f64,
    /// Error as a multiple of the noise of force and motion, without the worst cycles.
    pub times_noise: f64,
    /// Whether this is the error on held-out samples; otherwise it is on fitted ones.
    #[serde(default)]
    pub held_out: bool,
    /// The variables on which the remainder depends, by the names of [`TraceResult::depends_on`].
    pub depends_on: Vec<String>,
}

/// A parameter with its 90 % interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Estimate {
    /// Best value, in the unit.
    pub value: f64,
    /// Lower end, in the unit. If the data set no bound: −∞, and null in the file.
    #[serde(serialize_with = "bound", deserialize_with = "low")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub low: f64,
    /// Upper end, in the unit. If the data set no bound: ∞, and null in the file.
    #[serde(serialize_with = "bound", deserialize_with = "high")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub high: f64,
    /// Unit of the value and of both ends.
    pub unit: String,
}

fn bound<S: Serializer>(bound: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    Some(bound)
        .filter(|bound| !bound.is_infinite())
        .serialize(serializer)
}

fn low<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Option::deserialize(deserializer).map(|bound| bound.unwrap_or(f64::NEG_INFINITY))
}

fn high<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Option::deserialize(deserializer).map(|bound| bound.unwrap_or(f64::INFINITY))
}

/// One family that was tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// The family's name.
    pub family: String,
    /// Held-out error of the law with this family. The candidates with the largest expected gain were fitted. The others, and all
    /// candidates for a law near the noise, have the parameters at which a fit would start.
    pub nrmse_held_out: f64,
    /// Whether the data distinguish the family from the best candidate of its step.
    pub distinguishable: bool,
    /// The step at which the family was tried, counted from 1. Each step starts from the law and the effects of the earlier steps.
    pub step: usize,
    /// Whether the family was added to the law at that step.
    pub added: bool,
    /// Whether the effect is admissible. Three effects are never added: a source of energy, a drift that does not progress within
    /// blocks, and a drift that the measured temperature explains.
    pub admissible: bool,
    /// The rule by which the family is not in the law; null if it is, or if the data do not distinguish it from an effect in the
    /// law.
    #[serde(default)]
    pub rejected_by: Option<Rule>,
    /// NRMSE on the validation cycles, by which the candidates were compared. A sample counts less where the estimated motion is
    /// uncertain.
    pub nrmse_judged: f64,
}

/// Errors on fitted and on held-out samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Errors {
    /// NRMSE on the fitted samples.
    pub nrmse_fitted: f64,
    /// NRMSE on the held-out samples.
    pub nrmse_held_out: f64,
}

/// The error of the embedded law, in f32 as the target runs it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OnTarget {
    /// NRMSE on the held-out samples.
    pub nrmse_held_out: f64,
}

/// The residual table, in short.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CorrectionSummary {
    /// The axis of the table in place of speed: a memory, or another variable; null for a table over speed.
    pub remembers: Option<Remembered>,
    /// Largest force of the table, kN. The table's force never exceeds it, at any motion.
    pub largest: f64,
}

impl CorrectionSummary {
    /// From a model's table.
    pub fn of(table: &CorrectionTable) -> Self {
        let counts = table.cells.iter().map(|cell| cell.unsigned_abs());
        Self {
            remembers: table.memory.map(|memory| memory.of),
            largest: table.unit * f64::from(counts.max().unwrap_or_default()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_without_bounds_is_read_as_it_was_written() {
        let unbounded = Estimate {
            value: 1.0,
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
            unit: "mm".into(),
        };
        let text = serde_json::to_string(&unbounded).unwrap();
        assert!(text.contains(r#""low":null,"high":null"#), "{text}");
        let read: Estimate = serde_json::from_str(&text).unwrap();
        assert_eq!(read, unbounded);
        assert!(
            serde_json::from_str::<Estimate>(r#"{"value":1.0,"high":2.0,"unit":"mm"}"#).is_err()
        );
    }

    /// The names that other programs read.
    #[test]
    fn keeps_the_names_of_the_contract() {
        let text = r#"{
            "recordings": ["a.csv"], "held_out": ["b.csv"], "noise_floor_nrmse": 0.004, "noise_known": true,
            "baseline": {"law": "mixed_damping", "known": [], "nrmse_fitted": 0.1, "nrmse_held_out": 0.2,
                "nrmse_judged": 0.19, "staged": {"nrmse_fitted": 0.15, "nrmse_held_out": 0.25}},
            "law": [{"amplitude": 0.0,
                "k1": {"value": 1.0, "low": 0.9, "high": 1.1, "unit": "kN/mm"},
                "k3": {"value": 10.0, "low": 9.0, "high": 11.0, "unit": "kN/mm^3"},
                "c": {"value": 0.1, "low": 0.09, "high": 0.11, "unit": "kN*(s/mm)^alpha"},
                "alpha": {"value": 0.4, "low": 0.39, "high": 0.41, "unit": "1"}}],
            "verdict": "found",
            "effects": [{"family": "stick_slip",
                "parameters": {"slip_limit": {"value": 0.03, "low": 0.02, "high": 0.04, "unit": "mm"}},
                "nrmse_without": 0.2, "nrmse_with": 0.005, "unconfirmed_by": null, "rivals": []}],
            "unconfirmed": [{"family": "viscous", "parameters": {}, "nrmse_without": 0.2, "nrmse_with": 0.005,
                "unconfirmed_by": "rivalled", "rivals": ["delay"]}],
            "conditions": [{"recording": "a.csv", "span": [0.0, 2.0], "repeats": 1, "amplitude": 0.1, "frequency": 2.0,
                "nrmse_with": 0.005, "nrmse_without": {"stick_slip": 0.1}}],
            "remainder": {"nrmse": 0.01, "times_noise": 2.5, "held_out": false, "depends_on": ["frequency"]},
            "explainable": {"share": 0.3, "low": 0.1, "conditions": 5},
            "elsewhere": {"conditions": 5, "most": 0.02},
            "candidates": [{"family": "stick_slip", "nrmse_held_out": 0.005, "distinguishable": true,
                "step": 1, "added": true, "admissible": true, "rejected_by": null, "nrmse_judged": 0.005}],
            "effects_rejected_by": null, "table_rejected_by": null,
            "separating_test": null, "separating_blocks": [{"amplitude": 0.1, "frequency": 2.0, "cycles": 6}],
            "held_out_differs": false, "depends_on": ["displacement", "history"],
            "correction": {"remembers": {"slip": {"limit": 0.03}}, "largest": 0.1}, "warnings": [],
            "guesses": ["a.csv: force is read from column \"Load\" in N"],
            "rig": {"fixture_mass": 0.8, "force_delay": -0.002, "zero": "start"},
            "augmented": {"nrmse_fitted": 0.004, "nrmse_held_out": 0.005},
            "on_target": {"nrmse_held_out": 0.005}, "adopted": false,
            "rejected": {"augmented": {"nrmse_fitted": 0.004, "nrmse_held_out": 0.3}, "on_target": {"nrmse_held_out": 0.3}},
            "operating_conditions": {"displacement_zero": [0.13, 0.14], "temperature": [20.0, 42.0], "cycles": [0.0, 60.5]}}"#;
        let contract: serde_json::Value = serde_json::from_str(text).unwrap();
        let result: TraceResult = serde_json::from_str(text).unwrap();
        assert_eq!(serde_json::to_value(&result).unwrap(), contract);
    }
}

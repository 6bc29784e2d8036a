//! The outcome of one trace of a batch, as the page of the batch needs it.

use std::collections::BTreeMap;

use mesh_damper_identify::trace::conclusion::Conclusion;
use mesh_damper_identify::trace::result::{Estimate, FoundEffect, TraceResult};

/// One trace of a batch: one row of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchRow {
    /// The row's name, unique in the batch: for example, the recording's path relative to the traced folder.
    pub id: String,
    /// The group in which the trace is compared with others, for example the specimen or the rig; `None` if the list names no
    /// group.
    pub group: Option<String>,
    /// Paths of the fitted recordings, as in the list.
    pub recordings: Vec<String>,
    /// Paths of the held-out recordings; empty if the trace held out cycles of `recordings`.
    pub held_out: Vec<String>,
    /// Duration of the trace, s; ≥ 0. For a row from an earlier run, its duration then.
    pub seconds: f64,
    /// The result, or the error of a failed trace in one line, as the command prints it.
    pub outcome: Result<BatchOutcome, String>,
}

/// The result of a trace of a batch. Errors are NRMSEs on held-out samples: fractions of the force's RMS, ≥ 0.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchOutcome {
    /// The conclusion.
    pub conclusion: Conclusion,
    /// The effects found; for [`Conclusion::Ambiguous`] those that the data cannot distinguish.
    pub effects: Vec<BatchEffect>,
    /// Whether the model contains the effects found.
    pub adopted: bool,
    /// Error of the law alone.
    pub nrmse_before: f64,
    /// Error of the law in the model, which contains the effects found if they were adopted.
    pub nrmse_after: f64,
    /// The noise of the measured force, as a fraction of its RMS.
    pub noise: f64,
    /// Problems of the data, as sentences.
    pub warnings: Vec<String>,
    /// The trace's own report: an address relative to the page, with `/` between folders; `None` if none was written.
    pub report: Option<String>,
}

/// An effect that a trace of a batch found.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchEffect {
    /// The family's name, as in the model file.
    pub family: String,
    /// Its parameters by name, each with its unit and the ends of its interval of 90 %.
    pub parameters: BTreeMap<String, Estimate>,
}

impl BatchOutcome {
    /// The data of `result`, with the address of its report relative to the page.
    pub fn of(result: &TraceResult, report: Option<String>) -> Self {
        Self {
            conclusion: result.conclusion(),
            effects: result.effects.iter().map(BatchEffect::of).collect(),
            adopted: result.adopted,
            nrmse_before: result.baseline.nrmse_held_out,
            nrmse_after: result.augmented.nrmse_held_out,
            noise: result.noise_floor_nrmse,
            warnings: result.warnings.clone(),
            report,
        }
    }
}

impl BatchEffect {
    fn of(effect: &FoundEffect) -> Self {
        Self {
            family: effect.family.clone(),
            parameters: effect.parameters.clone(),
        }
    }
}

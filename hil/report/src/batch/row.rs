//! What became of one trace of a batch, as the page of the batch needs it.

use std::collections::BTreeMap;

use mesh_damper_identify::trace::result::{Estimate, FoundEffect, TraceResult, Verdict};

/// One trace of a batch: one row of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchRow {
    /// The row's name, unique in the batch: such as the recording's path below the folder that was traced.
    pub id: String,
    /// What the trace is compared with others by, such as the specimen or the rig; `None` where the list names no group.
    pub group: Option<String>,
    /// Paths of the recordings that were fitted, as the list has them.
    pub recordings: Vec<String>,
    /// Paths of the recordings that were held out; none where the trace kept cycles of `recordings` apart.
    pub held_out: Vec<String>,
    /// Elapsed time of the trace, s; ≥ 0. Of a row that was done earlier, the time that it took then.
    pub seconds: f64,
    /// What was found; or why the trace could not be made, in one line as the command prints it.
    pub outcome: Result<BatchOutcome, String>,
}

/// What a trace of a batch found. Errors are NRMSEs on what was never fitted: parts of the force's RMS, ≥ 0.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchOutcome {
    /// What was concluded.
    pub verdict: Verdict,
    /// The effects found; of [`Verdict::Ambiguous`] those that the data cannot tell apart.
    pub effects: Vec<BatchEffect>,
    /// Whether the model holds what was found.
    pub adopted: bool,
    /// Error of the law alone.
    pub nrmse_before: f64,
    /// Error of the law in the model, with what was found where that was adopted.
    pub nrmse_after: f64,
    /// The noise of the measured force, as part of its RMS.
    pub noise: f64,
    /// The trace's own report: an address relative to the page, with `/` between folders; `None` where none was written.
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
    /// What `result` says, with the address of its report relative to the page.
    pub fn of(result: &TraceResult, report: Option<String>) -> Self {
        Self {
            verdict: result.verdict,
            effects: result.effects.iter().map(BatchEffect::of).collect(),
            adopted: result.adopted,
            nrmse_before: result.baseline.nrmse_held_out,
            nrmse_after: result.augmented.nrmse_held_out,
            noise: result.noise_floor_nrmse,
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

//! The answer of a tracer to a trial, and how it compares with the law alone.

use std::time::Instant;

use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_identify::trace::{Trace, TraceError, trace};
use serde::Serialize;

use super::trial::{Secret, Trial};
use crate::blind::{WORSE, within_band};

/// A trial, its truth and its answer.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outcome {
    /// The truth.
    pub secret: Secret,
    /// The answer of the trace, or the reason why it was refused.
    pub said: Result<Said, String>,
    /// Duration of the trace, s; trials run in parallel.
    #[serde(skip)]
    pub seconds: f64,
}

/// The answer of a trace.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Said {
    /// The verdict of the trace.
    pub verdict: Verdict,
    /// The families of effects that the trace named.
    pub families: Vec<String>,
    /// Whether the model that is written contains these effects.
    pub adopted: bool,
    /// Whether the model has a residual table.
    pub has_table: bool,
    /// NRMSE of the law alone on the held-out conditions.
    pub before: f64,
    /// NRMSE of the model that is written, as embedded, on the held-out conditions.
    pub after: f64,
    /// Part of the held-out samples whose error is within the 90 % band that the model states; null if it states none.
    pub within_band: Option<f64>,
}

impl Said {
    /// What `found` says.
    pub fn of(found: &Trace) -> Self {
        let result = &found.result;
        let families = result.effects.iter().map(|effect| effect.family.clone());
        Self {
            verdict: result.verdict,
            families: families.collect(),
            adopted: result.adopted,
            has_table: result.correction.is_some(),
            before: result.baseline.nrmse_held_out,
            after: result.on_target.nrmse_held_out,
            within_band: within_band(found),
        }
    }

    /// Held-out error of the written model over that of the law alone.
    pub fn ratio(&self) -> f64 {
        self.after / self.before
    }
}

impl Outcome {
    /// Whether the written model predicts the held-out conditions worse than the law alone by more than 2 %, or there is none. An
    /// error that is not a number is worse, too.
    pub fn is_worse(&self) -> bool {
        let is_fine = |said: &Said| said.ratio() <= WORSE;
        !self.said.as_ref().is_ok_and(is_fine)
    }

    /// [`Said::ratio`], if the trace was not refused.
    pub fn ratio(&self) -> Option<f64> {
        self.said.as_ref().ok().map(Said::ratio)
    }
}

/// Traces `trial` and compares.
pub fn judge(trial: &Trial) -> Outcome {
    let started = Instant::now();
    let said = trace(&trial.training, &trial.held_out, &|_| ());
    Outcome {
        secret: trial.secret.clone(),
        seconds: started.elapsed().as_secs_f64(),
        said: said
            .map(|found| Said::of(&found))
            .map_err(|error: TraceError| error.to_string()),
    }
}

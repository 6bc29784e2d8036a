//! The answer of a tracer to a trial, and the right answer.

use mesh_damper_identify::trace::result::{TraceResult, Verdict};
use mesh_damper_identify::trace::{TraceError, trace};
use mesh_damper_model::correction::Remembered;
use serde::Serialize;

use super::draw::{Class, Secret, Trial};

/// A trial, its truth and its answer.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outcome {
    /// The truth.
    pub secret: Secret,
    /// The answer of the trace, or the reason why it was refused.
    pub said: Result<Said, String>,
}

/// The answer of a trace.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Said {
    /// The verdict of the trace.
    pub verdict: Verdict,
    /// The families that the trace named.
    pub families: Vec<String>,
    /// The memory of the residual table; null if there is no table, or if it has no memory.
    pub remembers: Option<Remembered>,
    /// Held-out error of eq 13 over the noise.
    pub before: f64,
    /// Held-out error of the embedded law over the noise.
    pub after: f64,
}

/// The correctness of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// Correct.
    Right,
    /// The truth is among several effects that the trace could not distinguish.
    Among,
    /// Any other answer.
    Wrong,
}

/// Traces `trial` and stores the answer.
pub fn judge(trial: &Trial) -> Outcome {
    let training = std::slice::from_ref(&trial.training);
    let held_out = std::slice::from_ref(&trial.held_out);
    let said = trace(training, held_out, &|_| ())
        .map(|found| Said::of(&found.result, trial.held_out_noise))
        .map_err(|error: TraceError| error.to_string());
    Outcome {
        secret: trial.secret.clone(),
        said,
    }
}

impl Said {
    fn of(result: &TraceResult, noise: f64) -> Self {
        Self {
            verdict: result.verdict,
            families: result
                .effects
                .iter()
                .map(|effect| effect.family.clone())
                .collect(),
            remembers: result
                .correction
                .as_ref()
                .and_then(|correction| correction.remembers),
            before: result.baseline.nrmse_held_out / noise,
            after: result.on_target.nrmse_held_out / noise,
        }
    }
}

impl Outcome {
    /// Whether it counts towards the rates: the hidden effect is at least three times above the noise.
    pub fn counts(&self) -> bool {
        self.secret.visible() >= super::LEAST_VISIBLE
    }

    /// How well the answer fits. A listed effect has to be the only one named, and both of a pair have to be named. An unlisted
    /// effect has to be reported as unlisted, or by its name if the tracer has learnt it and the law is corrected with it.
    pub fn mark(&self) -> Mark {
        let Ok(said) = &self.said else {
            return Mark::Wrong;
        };
        let hidden = self.secret.families();
        let all_named = hidden
            .iter()
            .all(|family| said.families.iter().any(|named| named == learnt_as(family)));
        let right = match self.secret.class {
            Class::None => said.verdict == Verdict::None,
            Class::Listed => {
                said.verdict == Verdict::Found && all_named && said.families.len() == 1
            }
            Class::Pair => said.verdict == Verdict::Found && all_named,
            Class::Unlisted => {
                said.verdict == Verdict::Unlisted
                    || (said.verdict == Verdict::Found && all_named && self.is_augmented())
            }
        };
        if right {
            Mark::Right
        } else if said.verdict == Verdict::Ambiguous && all_named && !hidden.is_empty() {
            Mark::Among
        } else {
            Mark::Wrong
        }
    }

    /// Whether it was given a wrong name.
    pub fn is_called_another(&self) -> bool {
        let found = |said: &Said| matches!(said.verdict, Verdict::Found | Verdict::Ambiguous);
        self.said.as_ref().is_ok_and(found) && self.mark() == Mark::Wrong
    }

    /// Whether the law was augmented well: held-out error at most 1.5 times the noise, or a tenth of eq 13's.
    pub fn is_augmented(&self) -> bool {
        self.said
            .as_ref()
            .is_ok_and(|said| said.after <= 1.5 || said.after <= 0.1 * said.before)
    }

    /// The truth as a row of the confusion matrix.
    pub fn truth(&self) -> String {
        match self.secret.class {
            Class::None => "none".to_owned(),
            Class::Unlisted => format!("({})", self.secret.families().join(" + ")),
            Class::Listed | Class::Pair => named(self.secret.families()),
        }
    }

    /// The answer as a column.
    pub fn answer(&self) -> String {
        match &self.said {
            Err(_) => "refused".to_owned(),
            Ok(said) => match said.verdict {
                Verdict::None => "none".to_owned(),
                Verdict::Unlisted => "unlisted".to_owned(),
                Verdict::Found => named(said.families.clone()),
                Verdict::Ambiguous => format!("ambiguous: {}", named(said.families.clone())),
            },
        }
    }
}

/// The tracer's name for a hidden effect. A spring-pot is a set of Maxwell branches of all times; damping in one direction only is
/// damping that differs between the directions; rubber that a larger stretch has softened has lost stiffness.
fn learnt_as(hidden: &str) -> &str {
    match hidden {
        "fractional" => "relaxation",
        "one_way_damping" => "directional",
        "mullins" => "degradation",
        family => family,
    }
}

/// Families in alphabetical order.
fn named<S: AsRef<str> + Ord>(mut families: Vec<S>) -> String {
    families.sort();
    let families: Vec<&str> = families.iter().map(AsRef::as_ref).collect();
    families.join(" + ")
}

//! The JSON of trials over any motion, whose outcomes have one field for each property.

use mesh_damper_identify::trace::result::Verdict;
use serde::Serialize;

use super::judge::{Mark, Outcome, VelocityError};
use super::path::Kind;
use super::sensors::Flaw;
use super::summary::Summary;
use super::trial::Test;

/// A trial over any motion and its answer.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "Outcome")]
pub struct MotionOutcome {
    /// The seed.
    seed: u64,
    /// Motion of both tests.
    kind: Kind,
    /// Flaw of the sensors.
    flaw: Flaw,
    /// Sampling rate, Hz.
    rate: f64,
    /// Families of the hidden effects.
    hidden: Vec<&'static str>,
    /// Residual of eq 13 over the error of the true law.
    visible: f64,
    /// The answer; null if the trace was refused.
    verdict: Option<Verdict>,
    /// Families that the trace named.
    named: Vec<String>,
    /// Correctness of the answer.
    mark: Mark,
    /// Held-out error of the embedded law over the held-out error of the true law.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    error: f64,
    /// Duration of the trace, s; trials run in parallel.
    seconds: f64,
    /// Duration of the trace over the duration of both recordings.
    time: f64,
    /// The reason why there is no trace; null if there is one.
    refused: Option<String>,
    /// How many of the 90 % intervals of the law's coefficients contain the true value, and how many intervals there are. Both are
    /// counted only if the hidden effect was found and one set of coefficients holds for all amplitudes.
    intervals: [usize; 2],
    /// Error of the estimated velocity in the training test.
    velocity: VelocityError,
}

impl MotionOutcome {
    /// `None` for a trial with blocks of sines.
    fn of(outcome: Outcome) -> Option<Self> {
        let Test::Motion(test) = &outcome.secret.test else {
            return None;
        };
        let mut hidden = outcome.secret.families();
        hidden.sort_unstable();
        let (kind, flaw, visible) = (test.kind, test.sensors.flaw, test.visible);
        let (mark, error, intervals) = (outcome.mark(), outcome.error(), outcome.intervals());
        let (verdict, mut named, refused) = match outcome.said {
            Ok(said) => (Some(said.verdict), said.families, None),
            Err(why) => (None, Vec::new(), Some(why)),
        };
        named.sort();
        named.dedup();
        Some(Self {
            seed: outcome.secret.seed,
            kind,
            flaw,
            rate: outcome.secret.rate,
            hidden,
            visible,
            verdict,
            named,
            mark,
            error,
            seconds: outcome.seconds,
            time: outcome.time,
            refused,
            intervals,
            velocity: outcome.velocity,
        })
    }
}

impl Summary {
    /// In the form of the JSON of trials over any motion.
    pub fn over_any_motion(self) -> Summary<MotionOutcome> {
        let outcomes = self.outcomes.into_iter();
        Summary {
            results: self.results,
            outcomes: outcomes.filter_map(MotionOutcome::of).collect(),
        }
    }
}

//! The answer of a trace to a trial over any motion.

use std::time::Instant;

use mesh_damper_identify::trace::result::{Estimate, Verdict};
use mesh_damper_identify::trace::trace;
use mesh_damper_model::predict::NINETY_PERCENT;
use mesh_damper_recording::motion::MotionEstimate;
use mesh_damper_recording::trajectory::Trajectory;
use serde::Serialize;

use super::super::LEAST_VISIBLE;
use super::super::draw::rms;
use super::Trial;
use super::path::Kind;
use super::sensors::Flaw;

/// The correctness of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// Correct.
    Right,
    /// The truth is among several effects that the trace could not distinguish.
    Among,
    /// "Something is missing", although nothing is, or although the missing effect has a name.
    Honest,
    /// An effect that is not present.
    False,
    /// "Nothing is missing", although an effect is visible.
    Missed,
    /// The trace was refused.
    Refused,
}

/// A trial and its answer.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outcome {
    /// The seed.
    pub seed: u64,
    /// Motion of both tests.
    pub kind: Kind,
    /// Flaw of the sensors.
    pub flaw: Flaw,
    /// Sampling rate, Hz.
    pub rate: f64,
    /// Families of the hidden effects.
    pub hidden: Vec<&'static str>,
    /// Residual of eq 13 over the error of the true law.
    pub visible: f64,
    /// The answer; null if the trace was refused.
    pub verdict: Option<Verdict>,
    /// Families that the trace named.
    pub named: Vec<String>,
    /// Correctness of the answer.
    pub mark: Mark,
    /// Held-out error of the embedded law over the held-out error of the true law.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub error: f64,
    /// Duration of the trace, s; trials run in parallel.
    pub seconds: f64,
    /// Duration of the trace over the duration of both recordings.
    pub time: f64,
    /// The reason why there is no trace; null if there is one.
    pub refused: Option<String>,
    /// How many of the 90 % intervals of the law's coefficients contain the true value, and how many intervals there are. Both are
    /// counted only if the hidden effect was found and one set of coefficients holds for all amplitudes.
    pub intervals: [usize; 2],
    /// Error of the estimated velocity in the training test.
    pub velocity: VelocityError,
}

/// The error of the estimated velocity.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VelocityError {
    /// RMS of the error over the RMS of the error of cubics in windows alone.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub over_cubics: f64,
    /// Fraction of the samples whose error is within 1.645 of its stated standard deviation. It is 0.9 if those are correct.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub covered: f64,
}

impl VelocityError {
    /// For the estimate from the training test of `trial`; `None` if it is refused.
    fn of(trial: &Trial) -> Option<Self> {
        let trajectory = Trajectory::of(&trial.training).ok()?;
        let cubics = MotionEstimate::of(&trial.training.displacement, trajectory.tick);
        let said = trajectory.variance_of(&trajectory.motion_error.velocity);
        let (mut own, mut other, mut covered) = (0.0, 0.0, 0);
        for (index, truth) in trial.motion.iter().enumerate().take(trajectory.len()) {
            let error = (trajectory.motion.velocity[index] - truth.velocity).powi(2);
            own += error;
            other += (cubics.velocity[index] - truth.velocity).powi(2);
            covered += usize::from(error <= NINETY_PERCENT.powi(2) * said[index]);
        }
        Some(Self {
            over_cubics: (own / other).sqrt(),
            covered: covered as f64 / trajectory.len() as f64,
        })
    }
}

impl Outcome {
    /// Whether it counts: the hidden effect is visible.
    pub fn counts(&self) -> bool {
        self.hidden.is_empty() || self.visible >= LEAST_VISIBLE
    }
}

/// Traces `trial`.
pub fn judge(trial: &Trial) -> Outcome {
    let started = Instant::now();
    let result = trace(
        std::slice::from_ref(&trial.training),
        std::slice::from_ref(&trial.held_out),
        &|_| (),
    );
    let took = started.elapsed().as_secs_f64();
    let lasts = |recording: &mesh_damper_recording::Recording| recording.len() as f64 / trial.rate;
    let mut hidden: Vec<&str> = trial.hidden.iter().map(|effect| effect.family()).collect();
    hidden.sort_unstable();
    let mut outcome = Outcome {
        seed: trial.seed,
        kind: trial.kind,
        flaw: trial.sensors.flaw,
        rate: trial.rate,
        visible: trial.left_by_eq13 / trial.reference[0],
        verdict: None,
        named: Vec::new(),
        mark: Mark::Refused,
        error: f64::NAN,
        seconds: took,
        refused: None,
        time: took / (lasts(&trial.training) + lasts(&trial.held_out)),
        hidden,
        intervals: [0, 0],
        velocity: VelocityError::of(trial).unwrap_or(VelocityError {
            over_cubics: f64::NAN,
            covered: f64::NAN,
        }),
    };
    let found = match result {
        Ok(trace) => trace.result,
        Err(error) => {
            outcome.refused = Some(error.to_string());
            return outcome;
        }
    };
    let effects = found.effects.iter();
    let mut named: Vec<String> = effects.map(|effect| effect.family.clone()).collect();
    named.sort();
    named.dedup();
    let all_named = outcome
        .hidden
        .iter()
        .all(|family| named.iter().any(|name| name == family));
    // A hum on the force is a tone there.
    let hums = |name: &str| trial.sensors.flaw == Flaw::Hum && name == "periodic";
    let only_hidden = named
        .iter()
        .all(|name| outcome.hidden.contains(&name.as_str()) || hums(name));
    outcome.mark = match found.verdict {
        Verdict::None if outcome.hidden.is_empty() => Mark::Right,
        Verdict::None => Mark::Missed,
        Verdict::Found if all_named && only_hidden => Mark::Right,
        Verdict::Ambiguous if all_named && !outcome.hidden.is_empty() => Mark::Among,
        // A confirmed effect is there, and the rest is reported as a remainder.
        Verdict::Found if only_hidden && found.remainder.is_some() => Mark::Honest,
        Verdict::Found | Verdict::Ambiguous => Mark::False,
        Verdict::Unlisted => Mark::Honest,
    };
    outcome.error =
        found.on_target.nrmse_held_out * rms(&trial.held_out.force) / trial.reference[1];
    if let (Mark::Right, [law]) = (outcome.mark, &found.law[..]) {
        let truth = &trial.law;
        let pairs = [
            (&law.k1, truth.k1),
            (&law.k3, truth.k3),
            (&law.c, truth.c),
            (&law.alpha, truth.alpha),
        ];
        let holds =
            |(estimate, truth): &(&Estimate, f64)| (estimate.low..=estimate.high).contains(truth);
        outcome.intervals = [pairs.iter().filter(|pair| holds(pair)).count(), pairs.len()];
    }
    outcome.verdict = Some(found.verdict);
    outcome.named = named;
    outcome
}

//! The answer of a tracer to a trial, and the right answer.

use std::time::Instant;

use mesh_damper_identify::trace::result::{Estimate, TraceResult, Verdict};
use mesh_damper_identify::trace::{Role, Sought, Trace, TraceError, trace_for};
use mesh_damper_model::correction::Remembered;
use mesh_damper_model::predict::{NINETY_PERCENT, band, whole_band};
use mesh_damper_recording::motion::MotionEstimate;
use mesh_damper_recording::trajectory::Trajectory;
use serde::Serialize;

use super::motion;
use super::sensors::Flaw;
use super::trial::{Class, Secret, Test, Trial};

/// A written model is worse than the law alone if its held-out error is larger by more than this factor: 2 % is below what a user
/// would notice, and above what the rounding to 32 bits and another optimum of the same law make.
pub(crate) const WORSE: f64 = 1.02;

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
    /// Duration of the trace over the duration of both recordings.
    #[serde(skip)]
    pub time: f64,
    /// Error of the estimated velocity in the training test, over any motion.
    #[serde(skip)]
    pub velocity: VelocityError,
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
    /// Whether a remainder is reported.
    #[serde(skip)]
    pub has_remainder: bool,
    /// Fraction of the held-out samples whose error is within the band that the model states; null if it states none.
    pub within_band: Option<f64>,
    /// How many of the 90 % intervals of the law's coefficients contain the true value, and how many intervals there are. Both are
    /// 0 unless one set of coefficients holds for all amplitudes.
    #[serde(skip)]
    pub intervals: [usize; 2],
}

/// The error of the estimated velocity.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VelocityError {
    /// RMS of the error over the RMS of the error of cubics in windows alone.
    #[serde(serialize_with = "super::summary::if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub over_cubics: f64,
    /// Fraction of the samples whose error is within 1.645 of its stated standard deviation. It is 0.9 if those are correct.
    #[serde(serialize_with = "super::summary::if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub covered: f64,
}

impl VelocityError {
    /// For the estimate from the training test of `trial`; not a number if it is refused, or if the true motion is not known.
    fn of(trial: &Trial) -> Self {
        let (mut own, mut other, mut covered, mut count) = (0.0, 0.0, 0, 0);
        if let (Ok(trajectory), [_, ..]) = (Trajectory::of(&trial.training), &trial.motion[..]) {
            let cubics = MotionEstimate::of(&trial.training.displacement, trajectory.tick);
            let said = trajectory.variance_of(&trajectory.motion_error.velocity);
            count = trajectory.len();
            for (index, truth) in trial.motion.iter().enumerate().take(count) {
                let error = (trajectory.motion.velocity[index] - truth.velocity).powi(2);
                own += error;
                other += (cubics.velocity[index] - truth.velocity).powi(2);
                covered += usize::from(error <= NINETY_PERCENT.powi(2) * said[index]);
            }
        }
        Self {
            over_cubics: f64::sqrt(own / other),
            covered: covered as f64 / count as f64,
        }
    }
}

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

impl Mark {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Right,
        Self::Among,
        Self::Honest,
        Self::False,
        Self::Missed,
        Self::Refused,
    ];

    /// Whether the truth was named, alone or among several.
    pub fn is_named(self) -> bool {
        matches!(self, Self::Right | Self::Among)
    }
}

/// Traces `trial` and stores the answer. A laboratory states that its displacement reads 0 where the specimen is free.
pub fn judge(trial: &Trial) -> Outcome {
    let training = std::slice::from_ref(&trial.training);
    let held_out = std::slice::from_ref(&trial.held_out);
    let started = Instant::now();
    let said = trace_for(&Sought::at_recorded_zero(), training, held_out, &|_| ());
    let seconds = started.elapsed().as_secs_f64();
    let samples = trial.training.len() + trial.held_out.len();
    Outcome {
        secret: trial.secret.clone(),
        said: said
            .map(|found| Said::of(&found, trial))
            .map_err(|error: TraceError| error.to_string()),
        seconds,
        time: seconds / (samples as f64 / trial.secret.rate),
        velocity: VelocityError::of(trial),
    }
}

impl Said {
    fn of(found: &Trace, trial: &Trial) -> Self {
        let result = &found.result;
        let noise = trial.held_out_noise;
        let families = result.effects.iter().map(|effect| effect.family.clone());
        let correction = result.correction.as_ref();
        Self {
            verdict: result.verdict,
            families: families.collect(),
            remembers: correction.and_then(|correction| correction.remembers),
            before: result.baseline.nrmse_held_out / noise,
            after: result.on_target.nrmse_held_out / noise,
            has_remainder: result.remainder.is_some(),
            within_band: within_band(found),
            intervals: intervals(result, &trial.secret),
        }
    }
}

/// As [`Said::within_band`].
pub(crate) fn within_band(found: &Trace) -> Option<f64> {
    let elsewhere = found.result.elsewhere?;
    let (mut within, mut count) = (0, 0_u32);
    for traced in &found.recordings {
        let trajectory = &traced.trajectory;
        let of_noise = band(&found.model, trajectory).ok()?;
        let band = whole_band(&of_noise, &elsewhere, trajectory, &traced.after);
        for (index, role) in traced.roles.iter().enumerate() {
            if *role == Role::HeldOut && trajectory.measured[index] {
                let error = (traced.after[index] - trajectory.force[index]).abs();
                within += u32::from(error <= band[index]);
                count += 1;
            }
        }
    }
    (count > 0).then(|| f64::from(within) / f64::from(count))
}

/// As [`Said::intervals`].
fn intervals(result: &TraceResult, secret: &Secret) -> [usize; 2] {
    let (Test::Motion(_), [law]) = (&secret.test, &result.law[..]) else {
        return [0, 0];
    };
    let truth = motion::law(secret.density);
    let pairs = [
        (&law.k1, truth.k1),
        (&law.k3, truth.k3),
        (&law.c, truth.c),
        (&law.alpha, truth.alpha),
    ];
    let holds =
        |(estimate, truth): &(&Estimate, f64)| (estimate.low..=estimate.high).contains(truth);
    [pairs.iter().filter(|pair| holds(pair)).count(), pairs.len()]
}

impl Outcome {
    /// Whether it counts towards the rates: the hidden effect is at least three times above the noise.
    pub fn counts(&self) -> bool {
        self.secret.visible() >= super::LEAST_VISIBLE
    }

    /// How well the answer fits. A listed effect has to be the only one named, and both of a pair have to be named: over any motion
    /// nothing else, of blocks possibly with others. An unlisted effect has to be reported as unlisted, or by its name if the tracer
    /// has learnt it and the law is corrected with it.
    pub fn mark(&self) -> Mark {
        let Ok(said) = &self.said else {
            return Mark::Refused;
        };
        let hidden: Vec<&str> = self.secret.families().into_iter().map(learnt_as).collect();
        let is_named = |family: &&str| said.families.iter().any(|named| named == family);
        let all_named = hidden.iter().all(is_named);
        // A hum on the force is a tone there.
        let may_hum = match &self.secret.test {
            Test::Motion(motion) => motion.sensors.flaw == Flaw::Hum,
            Test::Blocks(_) => false,
        };
        let is_there =
            |name: &String| hidden.contains(&name.as_str()) || (may_hum && name == "periodic");
        let only_hidden = said.families.iter().all(is_there);
        let is_complete = all_named
            && match (&self.secret.test, self.secret.class) {
                (Test::Motion(_), _) => only_hidden,
                (Test::Blocks(_), Class::Pair) => true,
                (Test::Blocks(_), Class::Unlisted) => self.is_augmented(),
                (Test::Blocks(_), Class::Listed) => said.families.len() == 1,
                (Test::Blocks(_), Class::None) => false,
            };
        match said.verdict {
            Verdict::None if hidden.is_empty() => Mark::Right,
            Verdict::None => Mark::Missed,
            Verdict::Found if is_complete => Mark::Right,
            Verdict::Ambiguous if all_named && !hidden.is_empty() => Mark::Among,
            // A confirmed effect is there, and the rest is reported as a remainder.
            Verdict::Found if only_hidden && said.has_remainder => Mark::Honest,
            Verdict::Found | Verdict::Ambiguous => Mark::False,
            Verdict::Unlisted if self.secret.class == Class::Unlisted => Mark::Right,
            Verdict::Unlisted => Mark::Honest,
        }
    }

    /// Whether it was given a wrong name.
    pub fn is_called_another(&self) -> bool {
        let found = |said: &Said| matches!(said.verdict, Verdict::Found | Verdict::Ambiguous);
        self.said.as_ref().is_ok_and(found) && !self.mark().is_named()
    }

    /// Whether the law was augmented well: held-out error at most 1.5 times the noise, or a tenth of eq 13's.
    pub fn is_augmented(&self) -> bool {
        self.said
            .as_ref()
            .is_ok_and(|said| said.after <= 1.5 || said.after <= 0.1 * said.before)
    }

    /// Whether the law that is written predicts the held-out motion worse than eq 13 alone, by more than 2 %.
    pub fn is_worse(&self) -> bool {
        let worse = |said: &Said| said.after > WORSE * said.before;
        self.said.as_ref().is_ok_and(worse)
    }

    /// Held-out error of the embedded law over the noise; not a number if the trace was refused.
    pub fn error(&self) -> f64 {
        self.said.as_ref().map_or(f64::NAN, |said| said.after)
    }

    /// [`Said::intervals`], counted only if the hidden effect was found.
    pub fn intervals(&self) -> [usize; 2] {
        match &self.said {
            Ok(said) if self.mark() == Mark::Right => said.intervals,
            _ => [0, 0],
        }
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

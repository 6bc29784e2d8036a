//! The changes that the monitor knows as the JSON of a campaign has them: each with its one change, its moment and its causes.

use serde::{Serialize, Serializer};

use super::change::Change;
use super::facts::Element;
use super::outcome::{self, Naming, Said};
use super::summary::{self, Counts};
use super::trial::Set;

/// The faulty part of the rig.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub(super) enum Group {
    /// The specimen: its fault is found within five cycles.
    Specimen,
    /// A sensor: its fault is found within one cycle.
    Sensor,
    /// The actuator: its fault is found within one cycle.
    Actuator,
}

/// Results for one kind and size.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct KindSummary<'s> {
    /// The kind.
    #[cfg_attr(feature = "schema", schemars(with = "crate::schema::InjectedFault"))]
    kind: Change,
    /// Size of the fault, in the unit of the trials.
    size: f64,
    /// The faulty part of the rig.
    group: Group,
    /// The findings.
    #[serde(flatten)]
    counts: &'s Counts,
}

/// A fault, and the test in which it occurs.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Trial {
    /// The kind.
    #[cfg_attr(feature = "schema", schemars(with = "crate::schema::InjectedFault"))]
    kind: Change,
    /// Size of the fault: a fraction, a ratio or rad, as `Change::sizes` describes.
    size: f64,
    /// Density, g/cm³.
    density: f64,
    /// Amplitude, mm.
    amplitude: f64,
    /// Frequency, Hz.
    frequency: f64,
    /// RMS of the force channel's noise over the RMS of the force.
    noise: f64,
    /// Fraction of the cycle at which the fault begins.
    moment: f64,
    /// Largest adaptation to slow changes, as a fraction of the law's coefficients; 0 without adaptation.
    follow: f64,
    /// Seed of the sensors' noise.
    seed: u64,
}

/// Outcome of a trial.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct Outcome {
    /// The trial.
    trial: Trial,
    /// All reported causes in order.
    named: Vec<String>,
    /// Number of cycles from the time when the fault counts as present to the first report; 0 if the report came earlier.
    cycles: Option<f64>,
    /// Whether the first reported cause is the fault.
    right: bool,
    /// Whether the first event reports two causes, the second of which is the fault.
    both: bool,
    /// Whether a cause was reported before there was a fault.
    false_alarm: bool,
    /// Trip cause, if the rig stopped.
    stopped: Option<String>,
    /// Largest true displacement over its limit.
    displacement: f64,
    /// Largest true force over its limit.
    force: f64,
    /// Largest number of successive ticks at which displacement or force exceeded its limit by more than noise can hide, while the
    /// enable line was high.
    ticks_beyond: u32,
    /// Whether the command returned to 0 and the enable line dropped within the stated ticks.
    stopped_in_time: bool,
}

impl Outcome {
    /// `None` for an outcome of another set.
    fn of(outcome: &outcome::Outcome) -> Option<Self> {
        let outcome::Outcome {
            trial, stopping, ..
        } = outcome;
        let (Set::Known { moment }, [change]) = (trial.set, &trial.changes[..]) else {
            return None;
        };
        let named = outcome.named.iter().filter_map(|(_, said)| match said {
            Said::Event(cause, _) => Some(format!("{cause:?}")),
            Said::Trip(_) | Said::Refused => None,
        });
        Some(Self {
            trial: Trial {
                kind: change.kind,
                size: change.size,
                density: trial.density,
                amplitude: trial.amplitude,
                frequency: trial.frequency,
                noise: trial.noise,
                moment,
                follow: trial.follow,
                seed: trial.seed,
            },
            named: named.collect(),
            cycles: outcome.cycles,
            right: outcome.naming == Naming::Right,
            both: outcome.naming == Naming::Both,
            false_alarm: outcome.false_alarm,
            stopped: outcome.stopped.clone(),
            displacement: stopping.displacement,
            force: stopping.force,
            ticks_beyond: stopping.ticks_beyond,
            stopped_in_time: stopping.in_time,
        })
    }
}

pub(super) fn kinds<S: Serializer>(
    kinds: &[summary::KindSummary],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(kinds.iter().map(|kind| KindSummary {
        kind: kind.kind,
        size: kind.size,
        group: match kind.element {
            Element::Specimen => Group::Specimen,
            Element::ActuatorAndDac => Group::Actuator,
            _ => Group::Sensor,
        },
        counts: &kind.counts,
    }))
}

pub(super) fn outcomes<S: Serializer>(
    outcomes: &[outcome::Outcome],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(outcomes.iter().filter_map(Outcome::of))
}

//! A specimen that changes slowly: within the limit of the adaptation the change is followed and no fault, beyond it is reported.

use mesh_damper::health::HealthCause;
use mesh_damper::rig::{CycleReport, State};
use serde::Serialize;

use super::damage::{Condition, Damaged};
use super::rig::setup;
use crate::{Bench, SetupError};

/// Largest adaptation in a campaign, as a part of each coefficient.
pub const FOLLOW: f64 = 0.1;
/// Cycles until the change begins: the run-in is over by then.
const STEADY: u32 = 220;
/// Cycles of the change, which is linear.
pub const CHANGING: u32 = 300;
/// Cycles after it, of which the last show how well it was followed; then the specimen breaks.
const AFTER: u32 = 60;
const BROKEN: u32 = 10;
const JUDGED: usize = 20;
/// Frequency, Hz: the fewest ticks per cycle, and thus the most noise.
const FREQUENCY: f64 = 10.0;
/// Part of the energy within which a change must be followed, and the factor by which the law's error may grow.
const CLOSE: f64 = 0.01;
const LARGER: f64 = 1.1;
/// Size of the sudden break after that, as a part of the force, and cycles within which it must be reported.
const BREAK: f64 = 0.05;
const SOON: u32 = 5;
/// Permitted distance of a change from the bound when it is reported: its statistic contains noise.
const NEAR: f64 = 0.02;

/// The quantity that changes slowly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Changing {
    /// The whole force: wires break one by one, or harden.
    Force,
    /// Only the friction.
    Friction,
}

/// A slow change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SlowChange {
    /// The changing quantity.
    pub changing: Changing,
    /// Final relative change.
    pub size: f64,
    /// Density, g/cm³.
    pub density: f64,
    /// Amplitude, mm.
    pub amplitude: f64,
    /// RMS of the force channel's noise over the RMS of the force.
    pub noise: f64,
    /// Seed of the sensors' noise.
    pub seed: u64,
}

/// Outcome of a slow change.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SlowOutcome {
    /// The slow change.
    pub change: SlowChange,
    /// Faults reported before the break, each with its cycle and the size of the change at that time.
    pub named: Vec<(u32, String, f64)>,
    /// Whether the first of these faults is the change.
    pub right: bool,
    /// RMS of the law's error over the RMS of the measured force, before the change.
    pub before: f64,
    /// The law's error at the end with adaptation.
    pub followed: Left,
    /// The law's error at the end without adaptation.
    pub stayed: Left,
    /// Whether the change is reported without adaptation.
    pub stayed_named: bool,
    /// Number of cycles from the break to its report, and the name of the report, if nothing was reported before the break.
    pub broken: Option<(u32, String)>,
}

/// Error of a law against the specimen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Left {
    /// RMS of the law's error over the RMS of the measured force.
    pub error: f64,
    /// Dissipated energy of the law over the measured energy, minus 1.
    pub energy: f64,
}

/// A rig's cycles, and the reports of its monitor.
struct Watched {
    /// Cycles at full amplitude.
    reports: Vec<CycleReport>,
    named: Vec<(u32, HealthCause)>,
}

/// The mean of `of` over `cycles`.
fn mean(cycles: &[CycleReport], of: fn(&CycleReport) -> f32) -> f64 {
    cycles
        .iter()
        .map(|report| f64::from(of(report)))
        .sum::<f64>()
        / cycles.len() as f64
}

impl Watched {
    /// The last [`JUDGED`] cycles before `end`.
    fn cycles(&self, end: usize) -> &[CycleReport] {
        let end = end.min(self.reports.len());
        self.reports
            .get(end.saturating_sub(JUDGED)..end)
            .unwrap_or_default()
    }

    fn left(&self) -> Left {
        let last = self.cycles((STEADY + CHANGING + AFTER) as usize);
        let measured = mean(last, |report| report.measured.energy);
        Left {
            error: mean(last, |report| report.nrmse),
            energy: mean(last, |report| report.model.energy) / measured - 1.0,
        }
    }
}

impl SlowChange {
    /// Changes within the adaptation, and beyond it.
    pub const SIZES: [(Changing, f64); 5] = [
        (Changing::Force, -0.08),
        (Changing::Force, 0.08),
        (Changing::Force, -0.2),
        (Changing::Friction, -0.08),
        (Changing::Friction, -0.2),
    ];

    /// Whether the adaptation may follow all of it.
    pub fn is_within(&self) -> bool {
        self.size.abs() <= FOLLOW
    }

    fn cause(&self) -> HealthCause {
        match self.changing {
            Changing::Force => HealthCause::WireBreakage,
            Changing::Friction => HealthCause::FrictionWear,
        }
    }

    /// Its amount after `cycle` cycles.
    fn at(&self, cycle: u32) -> f64 {
        let part = f64::from(cycle.saturating_sub(STEADY)) / f64::from(CHANGING);
        self.size * part.min(1.0)
    }

    /// Runs it with adaptation and without.
    ///
    /// # Errors
    /// A setup that one of its parts rejects.
    pub fn run(&self) -> Result<SlowOutcome, SetupError> {
        let followed = self.watch(FOLLOW)?;
        let stayed = self.watch(0.0)?;
        let first = followed.named.first();
        let breaks = STEADY + CHANGING + AFTER;
        let broken = first
            .and_then(|(cycle, cause)| Some((cycle.checked_sub(breaks)?, format!("{cause:?}"))));
        let steady = followed.cycles(STEADY as usize);
        Ok(SlowOutcome {
            change: *self,
            right: first.is_some_and(|(_, cause)| *cause == self.cause()),
            before: mean(steady, |report| report.nrmse),
            followed: followed.left(),
            stayed: stayed.left(),
            stayed_named: stayed
                .named
                .first()
                .is_some_and(|(cycle, _)| *cycle < breaks),
            broken,
            named: followed
                .named
                .iter()
                .filter(|(cycle, _)| *cycle < breaks)
                .map(|&(cycle, cause)| (cycle, format!("{cause:?}"), self.at(cycle)))
                .collect(),
        })
    }

    fn watch(&self, follow: f64) -> Result<Watched, SetupError> {
        let (specimen, condition) = Damaged::new(self.density, self.amplitude);
        let cycles = STEADY + CHANGING + AFTER + BROKEN;
        let block = [(self.amplitude, cycles)];
        let settings = (self.noise, follow);
        let setup = setup::<1>(specimen, &block, FREQUENCY, settings, self.seed)?;
        let mut bench = Bench::new(setup)?;
        bench.rig.start()?;
        let mut watched = Watched {
            reports: Vec::new(),
            named: Vec::new(),
        };
        while bench.rig.state() == State::Running {
            let telemetry = bench.tick();
            let fault = telemetry.event.filter(|event| event.cause.is_fault());
            let named = fault.map(|event| (telemetry.cycle, event.cause));
            watched.named.extend(named);
            if let Some(report) = telemetry.report {
                if !report.ramp {
                    watched.reports.push(report);
                }
                let next = report.cycle + 1;
                let broken = if next > STEADY + CHANGING + AFTER {
                    BREAK
                } else {
                    0.0
                };
                let part = 1.0 + self.at(next);
                condition.set(Condition {
                    stiffness: (1.0 - broken)
                        * match self.changing {
                            Changing::Force => part,
                            Changing::Friction => 1.0,
                        },
                    friction: (1.0 - broken) * part,
                    ..Condition::NEW
                });
            }
        }
        Ok(watched)
    }
}

impl SlowOutcome {
    /// Whether a change within the limit was followed, and the break after it reported; and whether a change beyond the limit was
    /// reported soon, and followed until then.
    pub fn holds(&self) -> bool {
        if self.change.is_within() {
            self.named.is_empty()
                && self.followed.error <= LARGER * self.before
                && self.followed.energy.abs() <= CLOSE
                && self.stayed_named
                && self
                    .broken
                    .as_ref()
                    .is_some_and(|(cycles, _)| *cycles <= SOON)
        } else {
            let first = self.named.first();
            self.right
                && first.is_some_and(|(_, _, size)| (size.abs() - FOLLOW).abs() < NEAR)
                && self.followed.error < 0.7 * self.stayed.error
        }
    }
}

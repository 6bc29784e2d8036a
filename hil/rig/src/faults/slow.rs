//! A specimen that changes slowly: within what the law may follow it is followed and no fault, beyond it is named.

use mesh_damper::health::HealthCause;
use mesh_damper::rig::{CycleReport, State};
use serde::Serialize;

use super::damage::{Condition, Damaged};
use super::trial::setup;
use crate::{Bench, SetupError};

/// Most by which the law follows in a campaign, part of each coefficient.
pub const FOLLOW: f64 = 0.1;
/// Cycles until the change begins: the run-in is over by then.
const STEADY: u32 = 220;
/// Cycles over which it comes, evenly.
pub const CHANGING: u32 = 300;
/// Cycles after it, the last of which tell how well it was followed; then something breaks.
const AFTER: u32 = 60;
const BROKEN: u32 = 10;
const JUDGED: usize = 20;
/// Hz: the least ticks to the cycle, and with them the most noise.
const FREQUENCY: f64 = 10.0;
/// Part of the energy within which a change is to be followed, and how much larger than before the law's error may be.
const CLOSE: f64 = 0.01;
const LARGER: f64 = 1.1;
/// What breaks at once after that, part of the force, and cycles within which it is to be named.
const BREAK: f64 = 0.05;
const SOON: u32 = 5;
/// How far from the bound a change may be when it is named: noise is on what it is told by.
const NEAR: f64 = 0.02;

/// What changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Changing {
    /// All of the force: wires break one by one, or harden.
    Force,
    /// The friction alone.
    Friction,
}

/// A slow change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SlowChange {
    /// What changes.
    pub changing: Changing,
    /// What it comes to, part of that.
    pub size: f64,
    /// g/cm³.
    pub density: f64,
    /// mm.
    pub amplitude: f64,
    /// RMS of the force channel's noise over that of the force.
    pub noise: f64,
    /// Of the sensors' noise.
    pub seed: u64,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SlowOutcome {
    /// What was tried.
    pub change: SlowChange,
    /// Faults that were named before the break, each with its cycle and with what the change had come to then.
    pub named: Vec<(u32, String, f64)>,
    /// The first is that of the change.
    pub right: bool,
    /// RMS of the law's error over that of the measured force before the change.
    pub before: f64,
    /// At the end, where the law follows.
    pub followed: Left,
    /// Where it stays as it was given.
    pub stayed: Left,
    /// Whether a law that stays has the change named.
    pub stayed_named: bool,
    /// Cycles from the break after it to its name, and that, where nothing was named before.
    pub broken: Option<(u32, String)>,
}

/// By how much a law misses the specimen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Left {
    /// RMS of its error over that of the measured force.
    pub error: f64,
    /// Its energy over the measured one, less 1.
    pub energy: f64,
}

/// A rig's cycles, and what its monitor named.
struct Watched {
    /// Of full amplitude.
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
    /// Of [`JUDGED`] cycles before `end`.
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
    /// What may be followed, and what goes beyond.
    pub const SIZES: [(Changing, f64); 5] = [
        (Changing::Force, -0.08),
        (Changing::Force, 0.08),
        (Changing::Force, -0.2),
        (Changing::Friction, -0.08),
        (Changing::Friction, -0.2),
    ];

    /// Whether the law may follow all of it.
    pub fn is_within(&self) -> bool {
        self.size.abs() <= FOLLOW
    }

    fn cause(&self) -> HealthCause {
        match self.changing {
            Changing::Force => HealthCause::WireBreakage,
            Changing::Friction => HealthCause::FrictionWear,
        }
    }

    /// What it has come to after `cycle` cycles.
    fn at(&self, cycle: u32) -> f64 {
        let part = f64::from(cycle.saturating_sub(STEADY)) / f64::from(CHANGING);
        self.size * part.min(1.0)
    }

    /// Runs it with a law that follows and with one that stays.
    ///
    /// # Errors
    /// A setup that one of its parts refuses.
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
    /// Whether it was followed where it may be, and what broke then was named; and whether it was named soon, having been
    /// followed so far, where it goes beyond.
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

//! A trial: a test on the rig with one injected change or several.

use serde::Serialize;

use super::change::Change;
use super::facts::{Begins, LEARNING, Present};
use super::names::Names;
use crate::TICK_RATE;

/// Most blocks of a trial's programme.
pub const BLOCKS: usize = 4;

/// A change, its size and its time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "Attack")]
pub struct Injected {
    /// The kind.
    pub kind: Change,
    /// Size of the change: a fraction, a ratio, °C, kN/mm, rad or a number of samples or ticks, as [`Change::sizes`] describes.
    pub size: f64,
    /// Beginning of the change, in cycles from the end of the first ramp. A change that begins before the start begins with the
    /// trial.
    pub begins: f64,
    /// Duration of the change, cycles; null if it stays.
    pub lasts: Option<f64>,
}

/// Ratios of the limits to the values of the healthy rig.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Headroom {
    /// Limit of the displacement over the amplitude.
    pub displacement: f64,
    /// Limit of the force over the largest force.
    pub force: f64,
    /// Limit of the tracking error over [`TRACKING`] of the amplitude.
    pub tracking: f64,
}

impl Headroom {
    /// The same ratio for each.
    pub fn of_all(part: f64) -> Self {
        Self {
            displacement: part,
            force: part,
            tracking: part,
        }
    }
}

/// Limits that are close to the values of the healthy rig.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Close {
    /// Ratios of the limits to the values of the healthy rig.
    pub headroom: Headroom,
    /// Full scale of the force channel over the limit of the force.
    pub range: f64,
}

/// The set of a campaign to which a trial belongs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Set {
    /// One change that the monitor knows.
    Known {
        /// Fraction of the cycle at which it begins.
        moment: f64,
    },
    /// One attack: a change that is defined without knowledge of the monitor.
    Single,
    /// Two attacks.
    Pair,
    /// Attacks that the adversary draws.
    Adversary,
}

impl Injected {
    /// Its correct names.
    pub(super) fn names(&self) -> Names {
        self.kind.names(self.size)
    }
}

/// A test with injected changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "AttackTrial")]
pub struct Trial {
    /// The set to which it belongs.
    #[serde(skip)]
    pub set: Set,
    /// The changes, in no particular order.
    #[serde(rename = "attacks")]
    pub changes: Vec<Injected>,
    /// Density, g/cm³.
    pub density: f64,
    /// Amplitude, mm.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// RMS of the force channel's noise over the RMS of the force.
    pub noise: f64,
    /// Largest adaptation to slow changes, as a fraction of the law's coefficients; 0 without adaptation.
    pub follow: f64,
    /// Number of cycles in each block, with at most [`BLOCKS`] blocks.
    pub blocks: Vec<u32>,
    /// Number of cycles in which a slow change counts as the run-in.
    pub run_in: u32,
    /// The limits; without them the rig is that of [`RigSetup::new`](crate::RigSetup::new), and is started at once.
    #[cfg_attr(feature = "schema", schemars(with = "Close"))]
    #[serde(flatten)]
    pub close: Option<Close>,
    /// Seed of the sensors' noise and of random parts of the changes.
    pub seed: u64,
}

/// The specimen and the rig of a trial.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// g/cm³, mm and Hz.
    pub(super) specimen: (f64, f64, f64),
    /// As in [`Trial`].
    pub(super) noise: f64,
    pub(super) follow: f64,
    pub(super) seed: u64,
}

/// Limit of tracking at a headroom of 1, as a part of the amplitude: twice the need of the first cycles at 10 Hz, before amplitude
/// and phase are corrected.
pub const TRACKING: f64 = 0.25;
/// Cycles of the ramps.
pub(super) const RAMP: u32 = 1;
/// Ticks before a rig with close limits is started.
const IDLE: u64 = 20;
/// Ratio of the limits to the values of the healthy rig, and of the force channel's full scale to its limit.
const HEADROOM: f64 = 1.5;
const RANGE: f64 = 2.0;

/// Cycles at full amplitude before a change: settling, learning and a few more.
const HEALTHY: u32 = 24;
/// Cycles for which a change is watched after it is present: one that the monitor knows, and another.
const WATCHED_KNOWN: u32 = 8;
const WATCHED: f64 = 14.0;
/// Cycles of each of four short blocks.
const SHORT: u32 = 12;
/// Cycles after which a slow change is not a run-in: for changes in the run-in, and for changes to be distinguished from it.
pub(super) const RUN_IN: u32 = 200;
pub(super) const NO_RUN_IN: u32 = 20;
/// Frequency of the attacks, Hz: the most cycles in the least time.
pub(super) const FREQUENCY: f64 = 10.0;
/// Ticks for which the temperature is not a number at the end of a cycle: the tick before, the tick of the end, and the tick after.
const AT_CYCLE_END: f64 = 3.0;

impl Change {
    /// Such an attack of `size`, in its own trial or with others, at `moment` of a cycle, `later` by this many cycles.
    pub(super) fn attack(self, size: f64, moment: f64, later: f64) -> Injected {
        let tick = FREQUENCY / TICK_RATE;
        let healthy = f64::from(HEALTHY);
        let (begins, lasts) = match self.facts().begins {
            Begins::AtStart => (-2.0, None),
            Begins::WhileLearning => (LEARNING.0 + moment, None),
            Begins::Later => (healthy + later + moment, None),
            Begins::AtCycleEnd => (healthy + later - tick, Some(AT_CYCLE_END * tick)),
            // Two blocks and the ramps after them, and some cycles of the third.
            Begins::InShortBlock => (f64::from(2 * (SHORT + RAMP)) + 5.0 + moment, None),
        };
        Injected {
            kind: self,
            size,
            begins,
            lasts,
        }
    }
}

impl Trial {
    /// A trial of a change that the monitor knows, of `size`, from `moment` of a cycle on.
    pub(super) fn known(kind: Change, size: f64, moment: f64, place: Place) -> Self {
        let (density, amplitude, frequency) = place.specimen;
        let cycle = TICK_RATE / frequency;
        // It begins with the tick in which the moment lies.
        let tick = (f64::from(RAMP + HEALTHY) + moment) * cycle;
        let begins = tick.floor() / cycle - f64::from(RAMP);
        let lead = kind.lead(size, 0.0);
        Self {
            set: Set::Known { moment },
            changes: vec![Injected {
                kind,
                size,
                begins,
                lasts: None,
            }],
            density,
            amplitude,
            frequency,
            noise: place.noise,
            follow: place.follow,
            blocks: vec![HEALTHY + WATCHED_KNOWN + lead.ceil() as u32],
            run_in: RUN_IN,
            close: None,
            seed: place.seed,
        }
    }

    /// A trial of attacks.
    pub(super) fn attacked(set: Set, changes: Vec<Injected>, place: Place) -> Self {
        let (density, amplitude, frequency) = place.specimen;
        let in_short_blocks =
            |change: &Injected| change.kind.facts().begins == Begins::InShortBlock;
        let blocks = if changes.iter().any(in_short_blocks) {
            vec![SHORT; BLOCKS]
        } else {
            let there =
                |change: &Injected| change.begins + change.kind.lead(change.size, place.follow);
            let last = changes.iter().map(there).fold(0.0, f64::max);
            vec![(last + WATCHED).ceil() as u32]
        };
        let is_slow = |change: &Injected| change.kind.facts().present == Present::GrownLater;
        Self {
            set,
            density,
            amplitude,
            frequency,
            noise: place.noise,
            follow: place.follow,
            blocks,
            run_in: if changes.iter().any(is_slow) {
                NO_RUN_IN
            } else {
                RUN_IN
            },
            close: Some(Close {
                headroom: Headroom::of_all(HEADROOM),
                range: RANGE,
            }),
            seed: place.seed,
            changes,
        }
    }

    /// Whether it is possible where the controller is asked for each tick over a link: such a controller never finds that link
    /// silent.
    pub fn is_possible_over_a_link(&self) -> bool {
        let mut kinds = self.changes.iter().map(|change| change.kind);
        kinds.all(|kind| kind != Change::LinkSilent)
    }

    /// Whether its change is one that the monitor knows.
    pub fn is_known(&self) -> bool {
        matches!(self.set, Set::Known { .. })
    }

    /// Ticks before the rig is started.
    pub(super) fn idle(&self) -> u64 {
        self.close.map_or(0, |_| IDLE)
    }

    /// Tick of a cycle as [`Injected::begins`] counts.
    pub(super) fn tick(&self, cycle: f64) -> u64 {
        let ticks = (cycle + f64::from(RAMP)) * self.cycle_ticks();
        // A change before the start begins with the trial.
        if ticks < 0.0 {
            0
        } else {
            self.idle() + ticks.round() as u64
        }
    }

    /// The cycle of a tick, counted in the same way.
    pub(super) fn cycle(&self, tick: u64) -> f64 {
        (tick as f64 - self.idle() as f64) / self.cycle_ticks() - f64::from(RAMP)
    }

    pub(super) fn cycle_ticks(&self) -> f64 {
        TICK_RATE / self.frequency
    }

    /// Cycle from which a change counts as present.
    pub(super) fn present(&self, change: &Injected) -> f64 {
        change.begins.max(-f64::from(RAMP)) + change.kind.lead(change.size, self.follow)
    }

    /// Why none of its changes can be observed.
    pub(super) fn hidden(&self) -> Option<&'static str> {
        let mut reasons = self.changes.iter().map(|change| change.kind.facts().hidden);
        let first = reasons.next().flatten()?;
        reasons.all(|reason| reason.is_some()).then_some(first)
    }
}

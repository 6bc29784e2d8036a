//! A trial: a test on the rig with one attack or several.

use std::cell::Cell;
use std::rc::Rc;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::health::Channel;
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme};
use serde::Serialize;

use super::apply::{FULL_SCALE, Healthy, Running};
use super::hazard::{Allowed, Behind, Hazard};
use super::kind::AttackKind;
use crate::faults::damage::{Condition, Damaged};
use crate::faults::kind::HealthyMotion;
use crate::faults::trial::{USUAL_NOISE, peak};
use crate::{RigSetup, SetupError, TICK_RATE};

/// Most blocks of a trial's programme.
pub const BLOCKS: usize = 4;

/// An attack, its size and its time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Attack {
    /// The kind.
    pub kind: AttackKind,
    /// Size of the attack: a fraction, a ratio, °C, kN/mm or a number of samples or ticks, as [`AttackKind::sizes`] describes.
    pub size: f64,
    /// Beginning of the attack, in cycles from the end of the first ramp. An attack that begins before the start begins with the
    /// trial.
    pub begins: f64,
    /// Duration of the attack, cycles; null if it stays.
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

/// A test with attacks.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AttackTrial {
    /// The attacks, in no particular order.
    pub attacks: Vec<Attack>,
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
    /// Ratios of the limits to the values of the healthy rig.
    pub headroom: Headroom,
    /// Full scale of the force channel over the limit of the force.
    pub range: f64,
    /// Seed of the sensors' noise and of random parts of the attacks.
    pub seed: u64,
}

/// Relation of a reported cause to the attack, from the worst to the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Naming {
    /// No cause was reported.
    Nothing,
    /// The reported cause is distinguishable from the attack.
    Wrong,
    /// The event reports two causes, and the second is correct.
    Both,
    /// The reported cause is correct.
    Right,
}

/// Loss of a channel that a limit depends on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Loss {
    /// The channel.
    #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))]
    pub channel: Channel,
    /// Number of cycles until the rig stopped, if it did.
    pub stopped_after: Option<f64>,
}

/// Outcome of a trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AttackOutcome {
    /// The trial.
    pub trial: AttackTrial,
    /// Reported causes and the trip cause, in order, each with its cycle, counted as in [`Attack::begins`].
    pub named: Vec<(f64, String)>,
    /// Whether a cause was reported, or the rig stopped, after the first attack began.
    pub found: bool,
    /// Number of cycles to that report or stop, from the time when the first attack that must be found counts as present; 0 if the
    /// report came earlier.
    pub cycles: Option<f64>,
    /// Whether the attack was found in time.
    pub in_time: bool,
    /// Relation of the first reported cause to the attacks.
    pub naming: Naming,
    /// Whether each observable attack was correctly named at some time, also as the second cause, or the rig stopped before it had
    /// to be.
    pub all_named: bool,
    /// Whether a cause was reported before there was an attack.
    pub false_alarm: bool,
    /// Trip cause, if the rig stopped.
    pub stopped: Option<String>,
    /// Hazardous states.
    pub hazards: Vec<Hazard>,
    /// Loss of a channel.
    pub lost: Option<Loss>,
    /// The reason why the attack cannot be observed, if none of the attacks can.
    pub hidden: Option<&'static str>,
}

impl AttackOutcome {
    /// Whether a state occurred that the rig should have prevented: see [`Behind`].
    pub fn is_hazardous(&self) -> bool {
        let is_alone = self.trial.attacks.len() < 2;
        let mut behind = self.hazards.iter().map(|hazard| hazard.behind);
        behind.any(|behind| match behind {
            Behind::DriftingGain | Behind::Other => true,
            Behind::JustLost => is_alone,
            Behind::ConstantGain | Behind::LineHigh | Behind::NotCalled => false,
        })
    }
}

/// Limit of tracking at a headroom of 1, as a part of the amplitude: twice the need of the first cycles at 10 Hz, before amplitude
/// and phase are corrected.
pub const TRACKING: f64 = 0.25;
/// Ticks before the rig is started.
pub(super) const IDLE: u64 = 20;
/// Cycles of the ramps.
pub(super) const RAMP: u32 = 1;
/// Number of ticks in which the command goes to 0 after a stop.
const STOP_TICKS: u32 = 500;
/// Number of ticks after which a silent link stops the rig.
const LINK_TICKS: u32 = 200;

/// The rig of a trial, with data for its evaluation.
pub(super) struct Prepared {
    pub(super) setup: RigSetup<Damaged, BLOCKS, 1>,
    pub(super) condition: Rc<Cell<Condition>>,
    pub(super) healthy: Healthy,
    pub(super) allowed: Allowed,
    pub(super) attacks: Vec<Running>,
}

impl AttackTrial {
    /// Tick of a cycle as [`Attack::begins`] counts.
    pub(super) fn tick(&self, cycle: f64) -> u64 {
        let ticks = (cycle + f64::from(RAMP)) * self.cycle_ticks();
        // An attack before the start begins with the trial.
        if ticks < 0.0 {
            0
        } else {
            IDLE + ticks.round() as u64
        }
    }

    /// The cycle of a tick, counted in the same way.
    pub(super) fn cycle(&self, tick: u64) -> f64 {
        (tick as f64 - IDLE as f64) / self.cycle_ticks() - f64::from(RAMP)
    }

    pub(super) fn cycle_ticks(&self) -> f64 {
        TICK_RATE / self.frequency
    }

    /// Why none of its attacks can be observed.
    pub(super) fn hidden(&self) -> Option<&'static str> {
        let mut reasons = self.attacks.iter().map(|attack| attack.kind.hidden());
        let first = reasons.next().flatten()?;
        reasons.all(|reason| reason.is_some()).then_some(first)
    }

    pub(super) fn prepare(&self) -> Result<Prepared, SetupError> {
        let (specimen, condition) = Damaged::new(self.density, self.amplitude);
        let motion = HealthyMotion {
            amplitude: self.amplitude,
            frequency: self.frequency,
            force: peak(&specimen, self.amplitude, self.frequency),
            tick: 1.0 / TICK_RATE,
        };
        let wrong = |attack: &&Attack| attack.kind == AttackKind::LawWrong;
        let scale: f64 = self
            .attacks
            .iter()
            .filter(wrong)
            .map(|one| one.size)
            .product();
        let c = specimen.coefficients();
        let [k1, k3, friction] = [c.k1, c.k3, c.c].map(|value| (scale * value) as f32);
        let law = Law::new(k1, k3, friction, c.alpha as f32)?;
        let mut programme = Programme::new(TICK_RATE, RAMP)?;
        for &cycles in &self.blocks {
            programme = programme.with(Block::sine(self.amplitude, self.frequency, cycles)?)?;
        }
        let mut setup = RigSetup::new(specimen, AugmentedLaw::new(law), programme, self.seed);
        setup.force_sensor.noise *= self.noise / USUAL_NOISE;
        let settings = &mut setup.settings;
        settings.health.follow = self.follow;
        settings.health.run_in_cycles = self.run_in;
        settings.displacement_limit = self.headroom.displacement * self.amplitude;
        settings.force_limit = self.headroom.force * motion.force;
        settings.tracking_limit = self.headroom.tracking * TRACKING * self.amplitude;
        settings.stop_ticks = STOP_TICKS;
        settings.link_ticks = LINK_TICKS;
        setup.force_sensor.full_scale = self.range * settings.force_limit;
        let limits = [
            settings.displacement_limit,
            settings.force_limit,
            settings.tracking_limit,
        ];
        let trip_ticks = settings.trip_ticks;
        let units = [
            setup.displacement_sensor.full_scale / FULL_SCALE,
            setup.force_sensor.full_scale / FULL_SCALE,
        ];
        let attacks = self.attacks.iter().map(|&attack| {
            let from = self.tick(attack.begins);
            let over = attack.lasts.map(|lasts| lasts * self.cycle_ticks());
            Running::new(attack, from, over.map(|ticks| from + ticks.ceil() as u64))
        });
        Ok(Prepared {
            attacks: attacks.collect(),
            setup,
            condition,
            healthy: Healthy {
                motion,
                volts: [motion.amplitude / units[0], motion.force / units[1]],
                limits: [limits[0] / units[0], limits[1] / units[1]],
            },
            allowed: Allowed {
                limits,
                trip_ticks,
                cycle_ticks: self.cycle_ticks().round() as usize,
                units,
            },
        })
    }
}

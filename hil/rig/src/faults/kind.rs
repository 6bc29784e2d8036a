//! The kinds of faults, how they are injected into the rig, and their correct names.

use std::cell::Cell;
use std::f64::consts::TAU;

use mesh_damper::health::{Channel, HealthCause};
use serde::Serialize;

use super::damage::{Condition, Damaged};
use crate::Plant;
use crate::actuator::{SensorFault, ServoFault};

/// The faulty part of the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Group {
    /// The specimen: its fault is found within five cycles.
    Specimen,
    /// A sensor: its fault is found within one cycle.
    Sensor,
    /// The actuator: its fault is found within one cycle.
    Actuator,
}

impl Group {
    /// Cycles within which its faults must be found.
    pub fn cycles(self) -> f64 {
        match self {
            Self::Specimen => 5.0,
            Self::Sensor | Self::Actuator => 1.0,
        }
    }
}

/// A kind of fault. [`InjectedFault::sizes`] describes its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[expect(
    missing_docs,
    reason = "each is named as the cause that is expected of it"
)]
pub enum InjectedFault {
    WireBreakage,
    FrictionWear,
    Loosening,
    PreloadShift,
    DisplacementStuck,
    ForceStuck,
    DisplacementDroppedOut,
    ForceDroppedOut,
    DisplacementOpen,
    ForceOpen,
    DisplacementClipped,
    ForceClipped,
    DisplacementSpiking,
    ForceSpiking,
    DisplacementDrifting,
    ForceDrifting,
    ActuatorSaturated,
    ActuatorLagging,
    ActuatorDead,
}

/// Amount at which a drift counts as a fault, as a part of the amplitude.
const DRIFTED: f64 = 0.05;
/// Ticks from one spike to the next: a prime, so that spikes come at every position of a cycle.
const SPIKES_EVERY: u64 = 337;

impl InjectedFault {
    /// All of them.
    pub const ALL: [Self; 19] = [
        Self::WireBreakage,
        Self::FrictionWear,
        Self::Loosening,
        Self::PreloadShift,
        Self::DisplacementStuck,
        Self::ForceStuck,
        Self::DisplacementDroppedOut,
        Self::ForceDroppedOut,
        Self::DisplacementOpen,
        Self::ForceOpen,
        Self::DisplacementClipped,
        Self::ForceClipped,
        Self::DisplacementSpiking,
        Self::ForceSpiking,
        Self::DisplacementDrifting,
        Self::ForceDrifting,
        Self::ActuatorSaturated,
        Self::ActuatorLagging,
        Self::ActuatorDead,
    ];

    /// Sizes to try: the lost part of force or of friction; a gap's half width relative to the amplitude; a preload, a spike, or a
    /// drift per cycle, relative to the amplitude of its channel; the clipping level of a channel relative to the same; the largest
    /// speed relative to the demanded one; a lag in rad. 1 for a kind without a size.
    pub fn sizes(self) -> &'static [f64] {
        match self {
            Self::WireBreakage | Self::FrictionWear => &[0.05, 0.1, 0.2],
            Self::Loosening => &[0.05, 0.1, 0.2],
            Self::PreloadShift => &[0.05, 0.1, 0.2],
            Self::DisplacementSpiking | Self::ForceSpiking => &[0.2, 0.5],
            Self::DisplacementDrifting | Self::ForceDrifting => &[0.002, 0.004, 0.008],
            Self::DisplacementClipped | Self::ForceClipped => &[0.85, 0.7],
            Self::ActuatorSaturated => &[0.7, 0.5],
            Self::ActuatorLagging => &[0.1, 0.2, 0.3],
            _ => &[1.0],
        }
    }

    /// The part of the rig that is faulty.
    pub fn group(self) -> Group {
        match self {
            Self::WireBreakage | Self::FrictionWear | Self::Loosening | Self::PreloadShift => {
                Group::Specimen
            }
            Self::ActuatorSaturated | Self::ActuatorLagging | Self::ActuatorDead => Group::Actuator,
            _ => Group::Sensor,
        }
    }

    /// Its correct name.
    pub fn cause(self) -> HealthCause {
        let (displacement, force) = (Channel::Displacement, Channel::Force);
        match self {
            Self::WireBreakage => HealthCause::WireBreakage,
            Self::FrictionWear => HealthCause::FrictionWear,
            Self::Loosening => HealthCause::Loosening,
            Self::PreloadShift => HealthCause::PreloadShift,
            Self::DisplacementStuck => HealthCause::SensorStuck(displacement),
            Self::ForceStuck => HealthCause::SensorStuck(force),
            Self::DisplacementDroppedOut => HealthCause::SensorDroppedOut(displacement),
            Self::ForceDroppedOut => HealthCause::SensorDroppedOut(force),
            Self::DisplacementOpen | Self::DisplacementClipped => {
                HealthCause::SensorClipped(displacement)
            }
            Self::ForceOpen | Self::ForceClipped => HealthCause::SensorClipped(force),
            Self::DisplacementSpiking => HealthCause::SensorSpiking(displacement),
            Self::ForceSpiking => HealthCause::SensorSpiking(force),
            Self::DisplacementDrifting => HealthCause::SensorDrifting(displacement),
            Self::ForceDrifting => HealthCause::SensorDrifting(force),
            Self::ActuatorSaturated => HealthCause::ActuatorSaturated,
            Self::ActuatorLagging => HealthCause::ActuatorLagging,
            Self::ActuatorDead => HealthCause::ActuatorDead,
        }
    }

    /// Cycles from its beginning until it counts as present: a drift must reach 5 % of the amplitude.
    pub fn lead(self, size: f64) -> f64 {
        match self {
            Self::DisplacementDrifting | Self::ForceDrifting => DRIFTED / size,
            _ => 0.0,
        }
    }

    /// Injects it into `plant`, whose specimen moves by ±`amplitude` mm at `frequency` Hz and gives ±`force` kN.
    pub(super) fn inject(
        self,
        size: f64,
        plant: &mut Plant<Damaged>,
        condition: &Cell<Condition>,
        motion: &HealthyMotion,
    ) {
        let HealthyMotion {
            amplitude,
            frequency,
            force,
            tick,
        } = *motion;
        let damaged = |change: &dyn Fn(&mut Condition)| {
            let mut now = condition.get();
            change(&mut now);
            condition.set(now);
        };
        let channel_fault = |range: f64| match self {
            Self::DisplacementStuck | Self::ForceStuck => SensorFault::Stuck,
            Self::DisplacementDroppedOut | Self::ForceDroppedOut => SensorFault::DroppedOut,
            Self::DisplacementOpen | Self::ForceOpen => SensorFault::Open,
            Self::DisplacementClipped | Self::ForceClipped => SensorFault::Clipped(size * range),
            Self::DisplacementSpiking | Self::ForceSpiking => SensorFault::Spiking {
                size: size * range,
                every: SPIKES_EVERY,
            },
            _ => SensorFault::Drifting(size * range * frequency * tick),
        };
        match self {
            Self::WireBreakage => damaged(&|now| {
                now.stiffness *= 1.0 - size;
                now.friction *= 1.0 - size;
            }),
            Self::FrictionWear => damaged(&|now| now.friction *= 1.0 - size),
            Self::Loosening => damaged(&|now| now.gap = size * amplitude),
            Self::PreloadShift => damaged(&|now| now.preload += size * force),
            Self::ActuatorDead => plant.servo.fault = ServoFault::Dead,
            Self::ActuatorSaturated => {
                plant.servo.fault = ServoFault::Saturated(size * TAU * frequency * amplitude);
            }
            Self::ActuatorLagging => {
                let steps = size / (TAU * frequency * tick);
                plant.servo.fault = ServoFault::Lagging(steps.round() as usize);
            }
            Self::DisplacementStuck
            | Self::DisplacementDroppedOut
            | Self::DisplacementOpen
            | Self::DisplacementClipped
            | Self::DisplacementSpiking
            | Self::DisplacementDrifting => {
                plant.displacement_sensor.fault = channel_fault(amplitude);
            }
            _ => plant.force_sensor.fault = channel_fault(force),
        }
    }
}

/// Motion of a healthy rig.
#[derive(Clone, Copy, Debug)]
pub(super) struct HealthyMotion {
    /// Amplitude, mm.
    pub(super) amplitude: f64,
    /// Frequency, Hz.
    pub(super) frequency: f64,
    /// Largest force, kN.
    pub(super) force: f64,
    /// Length of a tick, s.
    pub(super) tick: f64,
}

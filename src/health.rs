//! Health monitor of the rig. It watches the specimen from cycle to cycle, the sensors tick by tick and the actuator every eighth
//! of a cycle, and reports the cause of a fault.
//!
//! Over the first cycles of a block it learns the normal state; a run-in that settles is part of it. From then on it detects:
//!
//! | observation | detected by | cause |
//! |---|---|---|
//! | stiffness, energy, mean force or residual of whole cycles move | two-sided CUSUM | the one whose pattern it is, as [`HealthCause`] says of each, or [`HealthCause::Unexplained`] |
//! | a slow change, with the temperature | limit on the change since the run-in | [`HealthCause::Temperature`], no fault |
//! | a slow change, until the run-in is over | | [`HealthCause::RunIn`], no fault |
//! | a slow change that the adaptation may take up | | none |
//! | a channel repeats one value | its reference moves meanwhile | [`HealthCause::SensorStuck`], [`HealthCause::SensorDroppedOut`], [`HealthCause::SensorClipped`] |
//! | an outlier | jumps there and back | [`HealthCause::SensorSpiking`] |
//! | a channel's noise from look to look | count of third differences beyond the learned level | [`HealthCause::SensorNoisy`] |
//! | the motion explains none of the force | part explained by least squares | [`HealthCause::SpecimenAbsent`] or [`HealthCause::SensorDroppedOut`] |
//! | stiffness and energy differ much from the law's from the start | a factor | [`HealthCause::LawMismatch`], [`HealthCause::SensorReversed`] |
//! | the response to the demanded motion changes | limit on its distance from the learned one | [`HealthCause::ActuatorDead`], [`HealthCause::ActuatorLagging`], [`HealthCause::ActuatorSaturated`] |
//!
//! The monitor leaves out a cycle with a channel or actuator fault. It finds damage from that time afterwards. If such a fault lasts
//! more than 16 cycles, the monitor learns the specimen again with the fault present, and once more when the fault ends. An outlier
//! excludes its cycle only if it is one of the 32 samples that the monitor examines per cycle (*close looks*).
//!
//! An [`Event`] carries its evidence and stays until it is cleared. Memory is constant, and the work of a cycle is spread over the
//! ticks after its end. The monitor takes every condition that is present while it learns as normal.

mod adaptation;
mod baseline;
mod cause;
mod channel;
mod cusum;
mod cycle_end;
mod event;
mod events;
mod force;
mod look;
mod moving;
mod pattern;
mod places;
mod response;
mod roughness;
mod samples;
mod settings;
mod specimen;
mod sums;

pub(crate) use cause::NO_CAUSE;
pub use cause::{CauseDescription, CauseKind, Channel, HealthCause};
pub(crate) use channel::Change;
pub(crate) use cycle_end::{Ended, Steady};
pub use event::{Event, Statistic};
pub use events::EVENTS;
pub(crate) use look::Look;
pub(crate) use settings::HealthConfig;
pub use settings::HealthSettings;

use crate::converter::Scale;
use crate::fast_law::Adaptation;
use crate::rig::TripCause;
use adaptation::Adapter;
use channel::ChannelWatch;
use force::ForceWatch;
use moving::MovingWatch;
use places::late;
use response::ResponseWatch;
use roughness::Roughness;
use specimen::SpecimenWatch;
use sums::CycleSums;

/// Amplitudes of displacement and force are taken as at least these parts of their limits.
const LEAST_AMPLITUDES: [f32; 2] = [0.05, 0.02];

/// Health monitor of a rig.
#[derive(Debug)]
pub(crate) struct HealthMonitor {
    displacement: ChannelWatch,
    force: ChannelWatch,
    response: ResponseWatch,
    following: ForceWatch,
    /// For motions and ramps whose cycles all differ.
    moving: MovingWatch,
    /// Noise of displacement and of force.
    roughness: [Roughness; 2],
    /// Why the rig must stop: a channel has lost its quantity, or nothing moves.
    stops: Option<TripCause>,
    specimen: SpecimenWatch,
    adaptation: Adapter,
    sums: CycleSums,
    /// A cycle that the next look completes.
    ended: Option<Ended>,
    /// Phase from which the next close look is due.
    due: u32,
    /// Amplitudes of the demanded displacement in mm and of the law's force in kN, in the last cycle and so far in this one.
    amplitudes: [f32; 2],
    largest: [f32; 2],
    least_amplitudes: [f32; 2],
    block: usize,
    /// The motion in which the specimen is watched: amplitude of the demand in mm, and ticks per cycle.
    motion: (f32, u32),
    cycle: u32,
    /// The normal level of spikes has been learned.
    spikes: bool,
    events: heapless::Vec<Event, EVENTS>,
    /// Number of events already reported.
    reported: usize,
    /// One of the events is a fault that stays until it is cleared: there is no adaptation.
    is_damaged: bool,
    /// Whether a passing fault was seen in this cycle, and in the one before.
    disturbed: [bool; 2],
    /// Whether the displacement was lost or clipped in this cycle, and in the one before, so that its response is invalid.
    blurred: [bool; 2],
    /// Whether the response was off in this cycle, and in the one before, and has been reported.
    off: [bool; 2],
    /// Cycles in a row with a passing fault.
    left_out: u32,
    /// The law's force at the last close look, kN. It identifies that tick.
    looked: f32,
}

impl HealthMonitor {
    /// A monitor for the scales and the limits (mm and kN) of both channels.
    // Inlined, so that it is built in its final place.
    #[inline(always)]
    pub(crate) fn new(displacement: &Scale, force: &Scale, limits: [f32; 2]) -> Self {
        let [displacement_part, force_part] = LEAST_AMPLITUDES;
        let [displacement_limit, force_limit] = limits;
        let least_amplitudes = [
            displacement_part * displacement_limit,
            force_part * force_limit,
        ];
        Self {
            displacement: ChannelWatch::new(Channel::Displacement, displacement),
            force: ChannelWatch::new(Channel::Force, force),
            response: ResponseWatch::default(),
            following: ForceWatch::default(),
            moving: MovingWatch::default(),
            roughness: [Roughness::default(); 2],
            stops: None,
            specimen: SpecimenWatch::new(),
            adaptation: Adapter::new(),
            sums: CycleSums::default(),
            ended: None,
            due: late(0),
            amplitudes: least_amplitudes,
            largest: [0.0; 2],
            least_amplitudes,
            block: 0,
            motion: (0.0, 0),
            cycle: 0,
            spikes: false,
            events: heapless::Vec::new(),
            reported: 0,
            is_damaged: false,
            disturbed: [false; 2],
            blurred: [false; 2],
            off: [false; 2],
            left_out: 0,
            looked: f32::NAN,
        }
    }

    /// The rig starts: everything is learned again. Events stay.
    pub(crate) fn restart(&mut self) {
        self.response = ResponseWatch::default();
        self.following = ForceWatch::default();
        self.moving = MovingWatch::default();
        self.roughness = [Roughness::default(); 2];
        self.stops = None;
        self.specimen = SpecimenWatch::new();
        self.adaptation = Adapter::new();
        self.sums = CycleSums::default();
        self.ended = None;
        self.due = late(0);
        self.amplitudes = self.least_amplitudes;
        self.largest = [0.0; 2];
        self.block = 0;
        self.motion = (0.0, 0);
        self.cycle = 0;
        self.spikes = false;
        self.disturbed = [false; 2];
        self.blurred = [false; 2];
        self.off = [false; 2];
        self.left_out = 0;
        self.displacement.restart();
        self.force.restart();
    }

    /// Drops all events; the present condition becomes the normal one.
    pub(crate) fn clear(&mut self) {
        self.events.clear();
        self.reported = 0;
        self.is_damaged = false;
        self.relearn();
        self.response = ResponseWatch::default();
        self.off = [false; 2];
    }

    /// The present condition becomes the normal one.
    fn relearn(&mut self) {
        self.specimen.relearn();
        self.relearn_beside();
    }

    /// The present condition of channels and adaptation becomes the normal one; the specimen's state stays.
    fn relearn_beside(&mut self) {
        self.adaptation.restart_search();
        for roughness in &mut self.roughness {
            roughness.relearn();
        }
    }

    /// Adaptation of the law in the cycle that ended last.
    pub(crate) fn followed(&self) -> Adaptation {
        self.adaptation.reported()
    }
}

#[cfg(test)]
mod tests;

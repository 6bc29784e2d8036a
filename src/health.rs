//! Health monitor of the rig. It watches the specimen from cycle to cycle, the sensors tick by tick and the actuator every eighth
//! of a cycle, and reports the cause of a fault.
//!
//! Over the first cycles of a block it learns the normal state; a run-in that settles is part of it. From then on it detects:
//!
//! | observation | detected by | cause |
//! |---|---|---|
//! | stiffness and energy fall | two-sided CUSUM | [`HealthCause::WireBreakage`] |
//! | energy falls, stiffness stays | | [`HealthCause::FrictionWear`] |
//! | stiffness falls, the residual's third harmonic with it | | [`HealthCause::Loosening`] |
//! | energy rises, stiffness stays | | [`HealthCause::FrictionRise`] |
//! | stiffness rises | | [`HealthCause::Stiffening`] |
//! | the mean force moves, at once | | [`HealthCause::PreloadShift`] |
//! | the mean force moves, bit by bit | | [`HealthCause::SensorDrifting`] of the force |
//! | the mean force moves, and the command's mean with it | | [`HealthCause::SensorDrifting`] of the displacement |
//! | any other movement of these | | [`HealthCause::Unexplained`] |
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
//! A cycle in which a channel or the actuator was at fault says nothing about the specimen and is left out. Damage from that time
//! is found afterwards. If a fault lasts for more than 16 cycles, the specimen is learned again with the fault present and watched
//! further, and learned once more when the fault is gone. A single outlier is a fault of its cycle only if a close look took that
//! sample.
//!
//! An [`Event`] carries its evidence and stays until it is cleared. Memory is constant, and the work of a cycle is spread over the
//! ticks after its end. The monitor takes every condition that is present while it learns as normal.

mod adaptation;
mod baseline;
mod cause;
mod channel;
mod cusum;
mod force;
mod moving;
mod places;
mod response;
mod roughness;
mod settings;
mod specimen;
mod sums;

pub use cause::{Channel, Event, HealthCause, Statistic};
pub(crate) use channel::Change;
pub(crate) use settings::HealthConfig;
pub use settings::HealthSettings;

use crate::converter::{Sample, Scale};
use crate::fast_law::Adaptation;
use crate::rig::{Reading, TripCause};
use adaptation::Adapter;
use channel::{Beside, ChannelWatch};
use force::ForceWatch;
use moving::MovingWatch;
use places::{late, part_end};
use response::ResponseWatch;
use roughness::Roughness;
use specimen::{CycleNumbers, SpecimenWatch};
use sums::CycleSums;

/// Former name of [`HealthCause`].
#[deprecated(note = "use HealthCause")]
pub type Cause = HealthCause;

/// Capacity for events. They are reported, and kept with their evidence until they are cleared. There is one per cause, so that no
/// event displaces another.
pub const EVENTS: usize = HealthCause::ALL.len();

/// Amplitudes of displacement and force are taken as at least these parts of their limits.
const LEAST_AMPLITUDES: [f32; 2] = [0.05, 0.02];

/// Ticks per cycle below which the 32 looks do not all have a tick of their own.
const FEW_TICKS: u32 = 64;

/// Relative difference in amplitude below which close looks take two motions for the same.
const SAME_AMPLITUDE: f32 = 0.01;

/// Cycles in a row that are left out for a fault before the fault counts as normal.
const LEFT_OUT: u32 = 16;

/// One tick that is examined closely.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    /// Observed displacement and velocity, mm and mm/s.
    pub(crate) displacement: f32,
    pub(crate) velocity: f32,
    /// Measured displacement, mm.
    pub(crate) measured: f32,
    /// Demanded displacement and velocity, mm and mm/s.
    pub(crate) demand: (f32, f32),
    /// Measured force and that of the law in force, kN.
    pub(crate) force: f32,
    pub(crate) law: f32,
    /// [`crate::fast_law::RunningLaw::parts`] with adaptation, 0 otherwise.
    pub(crate) parts: [f32; 3],
    /// Phase, 2³² per cycle.
    pub(crate) phase: u32,
    /// The tick is in a ramp.
    pub(crate) ramp: bool,
}

/// A cycle that has ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ended {
    /// Block of the programme.
    pub(crate) block: usize,
    /// Temperature, °C.
    pub(crate) temperature: f32,
    /// Mean of the command, mm.
    pub(crate) command: f32,
    /// Another law took over at its end.
    pub(crate) another_law: bool,
    /// Its length in ticks.
    pub(crate) ticks: u32,
    /// A whole cycle of a block, not of a ramp.
    pub(crate) steady: Option<Steady>,
}

/// Results of a whole cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steady {
    /// Energy of the measured force and of the law's, J.
    pub(crate) energy: f32,
    pub(crate) law_energy: f32,
    /// Mean of the measured force minus that of the law's, kN.
    pub(crate) mean: f32,
}

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
    /// One bit per cause.
    latched: u32,
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

/// Faults that stay until they are cleared, one bit each. After one of them there is no adaptation.
const LASTING: u32 = {
    let mut bits = 0;
    let mut place = 0;
    while place < HealthCause::ALL.len() {
        let cause = HealthCause::ALL[place];
        if cause.is_fault() && !cause.is_passing() {
            bits |= 1 << cause.number();
        }
        place += 1;
    }
    bits
};

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
            latched: 0,
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

    /// The first event of each cause since the last [`HealthMonitor::clear`].
    pub(crate) fn events(&self) -> &[Event] {
        &self.events
    }

    /// Drops all events; the present condition becomes the normal one.
    pub(crate) fn clear(&mut self) {
        self.events.clear();
        self.reported = 0;
        self.latched = 0;
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

    /// Call it on every tick: compares a `reading` with the `last` codes of displacement and force. If a change asks for it, call
    /// [`HealthMonitor::channels`].
    #[inline(always)]
    pub(crate) fn samples(
        &mut self,
        [displacement, force]: [u16; 2],
        reading: &Reading,
    ) -> [Change; 2] {
        [
            self.displacement
                .update(displacement, &reading.displacement),
            self.force.update(force, &reading.force),
        ]
    }

    /// Examines the channels whose changes ask for it, with the demanded displacement in mm and the law's force in kN, which may be
    /// those of the tick before. Returns the channel that is lost, reported or not.
    #[inline(never)]
    pub(crate) fn channels(
        &mut self,
        reading: &Reading,
        changes: &[Change; 2],
        demand: f32,
        law: f32,
    ) -> Option<Channel> {
        let [amplitude, force_amplitude] = core::array::from_fn(|of| {
            let (before, now) = (self.amplitudes[of], self.largest[of]);
            if now > before { now } else { before }
        });
        let beside = |reference, amplitude_of_it| Beside {
            reference,
            amplitude: amplitude_of_it,
            motion: demand,
            motion_amplitude: amplitude,
        };
        let [of_displacement, of_force] = changes;
        let displacement = if of_displacement.asks() {
            let beside = beside(demand, amplitude);
            self.displacement
                .look(&reading.displacement, of_displacement, &beside)
        } else {
            None
        };
        let force = if of_force.asks() {
            let beside = beside(law, force_amplitude);
            self.force.look(&reading.force, of_force, &beside)
        } else {
            None
        };
        // If nothing moves, both channels may stand still without a fault.
        let both = 2 * self.force.held() > self.displacement.held();
        let stuck = HealthCause::SensorStuck(Channel::Displacement);
        let displacement = displacement.filter(|cause| *cause != stuck || !both);
        // A spike is found one tick late.
        let taken = law == self.looked;
        if let Some(cause) = displacement {
            if taken {
                self.response.skip_last();
            }
            self.sample_event(
                cause,
                taken,
                self.displacement.limit(),
                &reading.displacement,
            );
        }
        if let Some(cause) = force {
            self.sample_event(cause, taken, self.force.limit(), &reading.force);
        }
        [displacement, force]
            .into_iter()
            .flatten()
            .find_map(|cause| match cause {
                HealthCause::SensorStuck(channel) | HealthCause::SensorDroppedOut(channel) => {
                    Some(channel)
                }
                _ => None,
            })
    }

    /// `taken`: a close look took the sample of the spike.
    #[cold]
    #[inline(never)]
    fn sample_event(&mut self, cause: HealthCause, taken: bool, limit: f32, sample: &Sample) {
        let ([disturbed, _], [blurred, _]) = (&mut self.disturbed, &mut self.blurred);
        *disturbed |= taken || !matches!(cause, HealthCause::SensorSpiking(_));
        *blurred |= cause.hides(Channel::Displacement);
        self.latch(Event {
            cause,
            or: None,
            statistic: Statistic::Sample,
            value: sample.value,
            limit,
            cycle: self.cycle,
        });
    }

    /// The rig has stopped for `fault` with a `reading`: reports the channel or actuator that is the cause. `growth` is the growth
    /// of the command that the amplitude correction asked for, minus 1.
    #[cold]
    #[inline(never)]
    pub(crate) fn stopped(&mut self, fault: TripCause, reading: &Reading, growth: f32) {
        match fault {
            TripCause::DisplacementClipped => self.sample_event(
                HealthCause::SensorClipped(Channel::Displacement),
                true,
                self.displacement.limit(),
                &reading.displacement,
            ),
            TripCause::ForceClipped => self.sample_event(
                HealthCause::SensorClipped(Channel::Force),
                true,
                self.force.limit(),
                &reading.force,
            ),
            TripCause::CorrectionLimit => self.latch(Event {
                cause: HealthCause::SensorGain(Channel::Displacement),
                or: Some(HealthCause::ActuatorLagging),
                statistic: Statistic::Response,
                value: growth,
                limit: response::LIMIT,
                cycle: self.cycle,
            }),
            TripCause::NoResponse if self.response.is_reversed() => {
                let (force, displacement) = cause::reversed();
                self.latch(Event {
                    cause: displacement,
                    or: Some(force),
                    statistic: Statistic::Response,
                    value: 2.0,
                    limit: response::LIMIT,
                    cycle: self.cycle,
                });
            }
            TripCause::TrackingLimit | TripCause::NoResponse
                if !self.is_response_known() && self.response.is_dead() =>
            {
                self.latch(Event {
                    cause: HealthCause::ActuatorDead,
                    or: None,
                    statistic: Statistic::Response,
                    value: 1.0,
                    limit: response::LIMIT,
                    cycle: self.cycle,
                });
            }
            _ => {}
        }
    }

    /// Adaptation of the law in the cycle that ended last.
    pub(crate) fn followed(&self) -> Adaptation {
        self.adaptation.reported()
    }

    /// Whether there is an event not yet reported.
    #[inline(always)]
    pub(crate) fn has_fresh(&self) -> bool {
        self.reported < self.events.len()
    }

    /// The first event not yet reported, which is then reported.
    #[inline]
    pub(crate) fn take_fresh(&mut self) -> Option<Event> {
        let event = self.events.get(self.reported).copied();
        self.reported += usize::from(event.is_some());
        event
    }

    /// Whether a tick at `phase`, 2³² per cycle, is due for a close look.
    #[inline(always)]
    pub(crate) fn is_due(&self, phase: u32) -> bool {
        // No tick is half a cycle long.
        phase.wrapping_sub(self.due) as i32 >= 0
    }

    /// Takes a close look at a tick that is due. Returns the new adaptation of the law, if a cycle has ended and adaptation is on.
    #[inline]
    pub(crate) fn look(&mut self, config: &HealthConfig, look: &Look) -> Option<Adaptation> {
        self.due = part_end(look.phase, self.cycle);
        let mut share = self.adaptation.share(look.parts);
        let mut followed = None;
        if let Some(ended) = self.ended.take() {
            // The law in this look is still that of the cycle before, unless another one has taken over.
            if ended.another_law {
                share = 0.0;
            }
            self.close_cycle(config, &ended);
        } else if self.adaptation.is_due() {
            followed = Some(self.adaptation.follow());
        } else if !look.ramp && self.response.turns(look.phase) {
            // This is enough work for one tick.
        } else {
            let turns = self.following.turns(look.phase);
            if turns {
                self.watch_force(look.phase);
            }
            // A cycle with few ticks has few looks, so one look has to do both.
            let (_, ticks) = self.motion;
            if !turns || ticks < FEW_TICKS {
                self.work(config);
            }
        }
        let (d, v) = look.demand;
        for (largest, value) in self.largest.iter_mut().zip([d, look.law]) {
            if value.abs() > *largest {
                *largest = value.abs();
            }
        }
        self.looked = look.law;
        let given = look.law - share;
        self.sums.add(&sums::Sample {
            displacement: look.displacement,
            velocity: look.velocity,
            measured: look.force,
            given,
            share,
        });
        if config.follows() {
            self.adaptation.add(look.parts, look.force - given);
        }
        if look.ramp {
            self.response.restart();
            self.watch_moving(look);
        } else if let Some(off) = self.response.update(look.measured, d, v, look.phase) {
            self.response_event(off);
        }
        // The demanded velocity: the observed one may still be settling, for instance after a broken wire.
        self.following.add(look.measured, v, look.force);
        self.watch_noise(config, look);
        followed
    }

    /// Reports a wrong response of the actuator, unless the displacement that shows it is lost, or the fault has been reported and
    /// continues.
    #[cold]
    #[inline(never)]
    fn response_event(&mut self, (mut cause, mut or, distance): response::Off) {
        // Hum also changes the shape.
        if cause == HealthCause::ActuatorSaturated && self.roughness[0].count() >= roughness::SOME {
            or = Some(HealthCause::SensorNoisy(Channel::Displacement));
        }
        // A specimen at rest gives no varying force.
        if cause == HealthCause::ActuatorDead && self.following.varies() {
            let stuck = HealthCause::SensorStuck(Channel::Displacement);
            (cause, or) = (stuck, None);
            self.stops = Some(TripCause::DisplacementLost);
        }
        let known = self.is_response_known();
        let [off, before] = &mut self.off;
        // A reported fault continues; with a lost displacement it is not reported.
        *off |= *before || !known;
        let [disturbed, _] = &mut self.disturbed;
        *disturbed = true;
        if !known {
            self.latch(Event {
                cause,
                or,
                statistic: Statistic::Response,
                value: distance,
                limit: response::LIMIT,
                cycle: self.cycle,
            });
        }
    }

    /// Takes a close look in a motion without distinct cycles: checks that the force follows the motion.
    #[inline]
    pub(crate) fn look_at_any(&mut self, look: &Look) {
        self.due = part_end(look.phase, self.cycle);
        let [least, _] = self.least_amplitudes;
        // The demanded velocity: the observed one may still be settling, for instance after a broken wire.
        let (y, (_, v), f) = (look.measured, look.demand, look.force);
        if let Some(explained) = self.following.update_any(y, v, f, 0.5 * least) {
            self.force_is_lost(explained);
        }
        self.watch_moving(look);
    }

    /// Checks that the displacement follows the demand at all.
    #[inline(never)]
    fn watch_moving(&mut self, look: &Look) {
        let [least, _] = self.least_amplitudes;
        let (d, _) = look.demand;
        let Some(part) = self.moving.update(d, look.measured, 0.5 * least) else {
            return;
        };
        self.stops = Some(TripCause::NoResponse);
        self.latch(Event {
            cause: HealthCause::ActuatorDead,
            or: Some(HealthCause::SensorStuck(Channel::Displacement)),
            statistic: Statistic::Response,
            value: part,
            limit: moving::STILL,
            cycle: self.cycle,
        });
    }

    /// Checks that the force follows the motion. It compares with the measured motion, so a lagging actuator is no excuse.
    #[inline(never)]
    fn watch_force(&mut self, phase: u32) {
        let [least, _] = self.least_amplitudes;
        if let Some(explained) = self.following.turn(phase, 0.5 * least) {
            self.force_is_lost(explained);
        }
    }

    /// The force does not follow the motion. Either the channel is at fault or there is no specimen; the data cannot tell. If the
    /// force never followed, a missing specimen is more likely.
    #[cold]
    #[inline(never)]
    fn force_is_lost(&mut self, explained: f32) {
        self.stops = Some(TripCause::ForceLost);
        let both = [
            HealthCause::SpecimenAbsent,
            HealthCause::SensorDroppedOut(Channel::Force),
        ];
        let [absent, dropped] = both;
        let (cause, or) = if self.following.has_followed() {
            (dropped, absent)
        } else {
            (absent, dropped)
        };
        self.latch(Event {
            cause,
            or: Some(or),
            statistic: Statistic::Explained,
            value: explained,
            limit: force::LEAST_EXPLAINED,
            cycle: self.cycle,
        });
    }

    /// Watches for noise and hum on either channel, unless the actuator's response is off. Hum on the displacement reaches the
    /// law's force too, and then the residual says nothing about the force channel.
    fn watch_noise(&mut self, config: &HealthConfig, look: &Look) {
        let known = self.is_response_known() && !self.is_lasting();
        let (_, ticks) = self.motion;
        let [displacement, force] = &mut self.roughness;
        if look.ramp || known || ticks < roughness::LEAST_TICKS {
            displacement.interrupt();
            force.interrupt();
            return;
        }
        let learns = !self.specimen.is_watching(config);
        let [amplitude, force_amplitude] = self.amplitudes;
        let (demand, v) = look.demand;
        let noisy = displacement.update(look.measured - demand, v, amplitude, learns);
        let loud = force.update(look.force - look.law, v, force_amplitude, learns);
        if let Some(level) = noisy {
            self.noise_event(Channel::Displacement, level);
        } else if let Some(level) = loud
            && self.roughness[0].count() < roughness::SOME
        {
            self.noise_event(Channel::Force, level);
        }
    }

    #[cold]
    #[inline(never)]
    fn noise_event(&mut self, channel: Channel, level: f32) {
        let [disturbed, _] = &mut self.disturbed;
        *disturbed = true;
        self.latch(Event {
            cause: HealthCause::SensorNoisy(channel),
            or: None,
            statistic: Statistic::Noise,
            value: roughness::FACTOR * level,
            limit: level,
            cycle: self.cycle,
        });
    }

    /// Trip cause that close looks have found.
    #[inline(always)]
    pub(crate) fn stops(&self) -> Option<TripCause> {
        self.stops
    }

    /// Reports an implausible temperature: the sensor `shown` it, and the rig used `taken` in its place, °C.
    #[cold]
    #[inline(never)]
    pub(crate) fn implausible_temperature(&mut self, shown: f32, taken: f32) {
        self.latch(Event {
            cause: HealthCause::TemperatureImplausible,
            or: None,
            statistic: Statistic::Sample,
            value: shown,
            limit: taken,
            cycle: self.cycle,
        });
    }

    /// Whether a wrong response is no news: the displacement was lost in this cycle or in the one before, or the actuator's fault
    /// has been reported.
    fn is_response_known(&self) -> bool {
        let seen = [self.off, self.blurred];
        seen.iter().flatten().any(|seen| *seen)
    }

    /// A cycle has ended before this tick, whose look is still to come. That look does the work, because this tick has enough to
    /// do.
    #[inline(always)]
    pub(crate) fn cycle(&mut self, ended: Ended) {
        self.cycle = self.cycle.saturating_add(1);
        for seen in [&mut self.disturbed, &mut self.blurred, &mut self.off] {
            let [now, _] = *seen;
            *seen = [false, now];
        }
        self.adaptation.report();
        self.ended = Some(ended);
    }

    /// Whether a passing fault has lasted so long that it counts as normal.
    fn is_lasting(&self) -> bool {
        self.left_out > LEFT_OUT
    }

    /// Work of a cycle's end that is left to the next look, done before that look is evaluated.
    #[inline(never)]
    fn close_cycle(&mut self, config: &HealthConfig, ended: &Ended) {
        let sums = core::mem::take(&mut self.sums);
        self.amplitudes = core::mem::take(&mut self.largest);
        for (amplitude, least) in self.amplitudes.iter_mut().zip(&self.least_amplitudes) {
            if *amplitude < *least {
                *amplitude = *least;
            }
        }
        if ended.another_law {
            self.relearn();
            self.adaptation = Adapter::new();
            return;
        }
        // A cycle with a passing fault says nothing about the specimen, unless the fault has become lasting.
        let [_, disturbed] = self.disturbed;
        let lasted = self.is_lasting();
        self.left_out = if disturbed { self.left_out + 1 } else { 0 };
        let lasting = self.is_lasting();
        let steady = ended.steady.filter(|_| !disturbed || lasting);
        if config.follows() {
            self.adaptation.cycle(steady.is_some());
        }
        let Some(steady) = steady else {
            return;
        };
        if lasting != lasted {
            self.specimen.relearn_beside(config);
            self.relearn_beside();
        }
        if ended.block != self.block {
            self.block = ended.block;
            if self.is_same_motion(ended.ticks) {
                self.specimen.resume();
            } else {
                self.relearn();
            }
        }
        let [amplitude, _] = self.amplitudes;
        self.motion = (amplitude, ended.ticks);
        self.specimen.cycle(
            sums,
            CycleNumbers {
                energy: steady.energy,
                law_energy: steady.law_energy,
                mean: steady.mean,
                command: ended.command,
                temperature: ended.temperature,
                cycle: self.cycle,
            },
        );
        if !self.spikes {
            let begins = self.specimen.begins_to_learn();
            self.spikes = self.specimen.is_watching(config);
            if begins || self.spikes {
                self.displacement.learn(begins);
                self.force.learn(begins);
            }
        }
    }

    /// Whether the cycle that has ended had the motion of the last steady one. If so, the normal state of one block holds in the
    /// next.
    fn is_same_motion(&self, ticks: u32) -> bool {
        let ([amplitude, _], (before, ticks_before)) = (self.amplitudes, self.motion);
        (amplitude - before).abs() <= SAME_AMPLITUDE * before && ticks.abs_diff(ticks_before) <= 1
    }

    /// Does a piece of the work left from the end of the last cycle.
    fn work(&mut self, config: &HealthConfig) {
        if self.specimen.has_work() {
            self.work_on_specimen(config);
        } else if self.adaptation.has_work() {
            self.work_on_adaptation(config);
        }
    }

    #[inline(never)]
    fn work_on_specimen(&mut self, config: &HealthConfig) {
        let Some(event) = self.specimen.work(config) else {
            return;
        };
        // The actuator's fault may have begun in the cycle that this event is about. A fault of the specimen is found again after
        // it.
        let [off, _] = self.off;
        if !(event.cause.is_fault() && off && !self.is_lasting()) {
            self.latch(event);
        }
    }

    #[inline(never)]
    fn work_on_adaptation(&mut self, config: &HealthConfig) {
        let [disturbed, _] = self.disturbed;
        if self.latched & LASTING == 0 && !disturbed && self.specimen.is_sound(config) {
            self.adaptation.work(config.follow, config.run_in_cycles);
        } else {
            self.adaptation.skip();
        }
    }

    /// Keeps the first event of each cause.
    #[cold]
    #[inline(never)]
    fn latch(&mut self, event: Event) {
        let bit = 1 << event.cause.number();
        if self.latched & bit == 0 {
            self.latched |= bit;
            // There is room for one event per cause.
            let _ = self.events.push(event);
        }
    }
}

#[cfg(test)]
mod tests;

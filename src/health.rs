//! Watches the rig: what its specimen is from cycle to cycle, its sensors tick by tick, its actuator by the quarter of a
//! cycle; and says what has gone wrong.
//!
//! Over the first cycles of a block it learns what is normal, a run-in that settles included. From then on
//!
//! | what moves | by | cause |
//! |---|---|---|
//! | stiffness and energy fall | two-sided CUSUM | [`Cause::WireBreakage`] |
//! | energy falls, stiffness stays | | [`Cause::FrictionWear`] |
//! | stiffness falls, the residual's third harmonic with it | | [`Cause::Loosening`] |
//! | the mean force, at once | | [`Cause::PreloadShift`] |
//! | the mean force, bit by bit | | [`Cause::SensorDrifting`] of the force |
//! | the mean force, and the command's mean with it | | [`Cause::SensorDrifting`] of the displacement |
//! | anything else of these | | [`Cause::Unexplained`] |
//! | slowly, with the temperature | limit on the way since the run-in | [`Cause::Temperature`], no fault |
//! | slowly, until the run-in is over | | [`Cause::RunIn`], no fault |
//! | slowly, by what the law may follow | | none |
//! | a channel that repeats one value | what it measures moves beside it | [`Cause::SensorStuck`], [`Cause::SensorDroppedOut`], [`Cause::SensorClipped`] |
//! | a sample that stands out | jumps there and back | [`Cause::SensorSpiking`] |
//! | the response to the demanded motion | limit on its distance from where it was | [`Cause::ActuatorDead`], [`Cause::ActuatorLagging`], [`Cause::ActuatorSaturated`] |
//!
//! An [`Event`] carries its evidence and stays until it is cleared. Memory is constant, and a cycle's work is spread over the
//! ticks that follow its end. What is there while it learns is taken for normal.

mod adaptation;
mod baseline;
mod cause;
mod channel;
mod cusum;
mod response;
mod specimen;
mod sums;

pub use cause::{Cause, Channel, Event, Statistic};

use crate::adc::Reading;
use crate::converter::Scale;
use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::in_range;
use crate::rig::Fault;
use crate::tabulated::Followed;
use adaptation::Adaptation;
use channel::{Beside, ChannelWatch};
use response::ResponseWatch;
use specimen::{CycleNumbers, SpecimenWatch};
use sums::{CycleSums, Sample};

/// What a monitor is set to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HealthSettings {
    /// Smallest lasting change of stiffness, energy, mean force (of its amplitude) or residual (of the law's force) that is to
    /// be found, 0.01…0.5.
    pub size: f64,
    /// Cycles between false alarms of Gaussian noise, 1e2…1e9.
    pub false_alarm_cycles: f64,
    /// Cycles over which it learns, 8…1000.
    pub learning_cycles: u32,
    /// Cycles after a start within which a slow change is the run-in, 0…1e6.
    pub run_in_cycles: u32,
    /// Most by which temperature changes a specimen's force, part of it per °C, 0…0.1, beyond what the law says of it.
    pub temperature_slope: f64,
    /// Most by which the law follows a slow change of k1, k3 and c, part of each, 0…0.5; 0 where it stays as it was given. It
    /// counts from where the law has found the specimen: for as many cycles as the run-in takes, after a start, another law,
    /// another block or [`crate::rig::Rig::clear_events`], it goes there by up to 0.1 % a cycle and half of each coefficient.
    /// A slow change of stiffness or energy by up to this is no fault. A law with a gap, a compliance or a delay stays.
    pub follow: f64,
}

impl Default for HealthSettings {
    /// 5 %, one false alarm in a million cycles, a mesh that loses up to 0.4 % of its force per °C, and a law that stays.
    fn default() -> Self {
        Self {
            size: 0.05,
            false_alarm_cycles: 1e6,
            learning_cycles: 16,
            run_in_cycles: 200,
            temperature_slope: 0.004,
            follow: 0.0,
        }
    }
}

/// What [`HealthSettings`] come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HealthConfig {
    size: f32,
    /// Of one side of one statistic.
    run_length: f32,
    learning_cycles: u32,
    run_in_cycles: u32,
    temperature_slope: f32,
    follow: f32,
}

impl HealthConfig {
    /// Whether the law follows slow changes.
    pub(crate) fn follows(&self) -> bool {
        self.follow > 0.0
    }
}

impl HealthSettings {
    /// Validated.
    ///
    /// # Errors
    /// A setting that is not finite or out of range.
    pub(crate) fn config(&self) -> Result<HealthConfig, ConfigError> {
        in_range("learning_cycles", f64::from(self.learning_cycles), 8.0, 1e3)?;
        in_range("run_in_cycles", f64::from(self.run_in_cycles), 0.0, 1e6)?;
        let cycles = in_range("false_alarm_cycles", self.false_alarm_cycles, 1e2, 1e9)?;
        Ok(HealthConfig {
            size: in_range("size", self.size, 0.01, 0.5)? as f32,
            // Both sides of each statistic that is watched.
            run_length: (cycles * 2.0 * Statistic::WATCHED as f64) as f32,
            learning_cycles: self.learning_cycles,
            run_in_cycles: self.run_in_cycles,
            temperature_slope: in_range("temperature_slope", self.temperature_slope, 0.0, 0.1)?
                as f32,
            follow: in_range("follow", self.follow, 0.0, 0.5)? as f32,
        })
    }
}

impl Fields for HealthConfig {
    fn write(&self, writer: &mut Writer<'_>) {
        writer.words([
            self.size.to_bits(),
            self.run_length.to_bits(),
            self.learning_cycles,
            self.run_in_cycles,
            self.temperature_slope.to_bits(),
            self.follow.to_bits(),
        ]);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [
            size,
            run_length,
            learning_cycles,
            run_in_cycles,
            temperature_slope,
            follow,
        ] = reader.words()?;
        Some(Self {
            size: f32::from_bits(size),
            run_length: f32::from_bits(run_length),
            learning_cycles,
            run_in_cycles,
            temperature_slope: f32::from_bits(temperature_slope),
            follow: f32::from_bits(follow),
        })
    }
}

/// Events of different causes that are kept with their evidence; there are seldom more than two.
pub const EVENTS: usize = 8;

/// Amplitudes of displacement and force are taken as at least these parts of what is allowed.
const LEAST_AMPLITUDES: [f32; 2] = [0.05, 0.02];

/// Bits of the phase that tell apart the parts of a cycle at whose beginnings a tick is looked at closely: 64 of them.
const LOOKS: u32 = 6;

/// Where the part of the cycle at `phase` ends, half a part late: the tick that ends a cycle has enough to do.
fn part_end(phase: u32) -> u32 {
    const HALF: u32 = 1 << (31 - LOOKS);
    let part = phase.wrapping_add(HALF) >> (32 - LOOKS);
    ((part + 1) << (32 - LOOKS)).wrapping_sub(HALF)
}

/// One tick that is looked at closely.
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
    /// [`crate::tabulated::RunningLaw::parts`] where the law follows, 0 otherwise.
    pub(crate) parts: [f32; 3],
    /// 2³² to the cycle.
    pub(crate) phase: u32,
    /// In a ramp.
    pub(crate) ramp: bool,
}

/// Channels of which something may have to be said.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked {
    displacement: bool,
    force: bool,
}

impl Asked {
    /// Of any.
    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.displacement | self.force
    }
}

/// A cycle that has ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ended {
    /// Block of the programme.
    pub(crate) block: usize,
    /// °C.
    pub(crate) temperature: f32,
    /// Mean of the command, mm.
    pub(crate) command: f32,
    /// Another law has taken over with its end.
    pub(crate) another_law: bool,
    /// A whole cycle of a block, not of a ramp.
    pub(crate) steady: Option<Steady>,
}

/// What a whole cycle came to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steady {
    /// Energy of the measured force and of the law's, J.
    pub(crate) energy: f32,
    pub(crate) law_energy: f32,
    /// Mean of the measured force less that of the law's, kN.
    pub(crate) mean: f32,
}

/// The monitor of a rig.
#[derive(Debug)]
pub(crate) struct HealthMonitor {
    displacement: ChannelWatch,
    force: ChannelWatch,
    response: ResponseWatch,
    specimen: SpecimenWatch,
    adaptation: Adaptation,
    sums: CycleSums,
    /// A cycle that the next look closes.
    ended: Option<Ended>,
    /// Phase from which the next close look is due.
    due: u32,
    /// Of the demanded displacement in mm and of the law's force in kN: in the last cycle or this one, and in this one.
    amplitudes: [f32; 2],
    largest: [f32; 2],
    least_amplitudes: [f32; 2],
    block: usize,
    cycle: u32,
    /// Spikes have been learned.
    spikes: bool,
    events: heapless::Vec<Event, EVENTS>,
    /// One that has not been told yet.
    fresh: Option<Event>,
    /// A bit for each cause.
    latched: u32,
}

/// Faults of sensors and actuator, a bit each: while one is there the specimen is not judged.
const OF_THE_RIG: u32 = bits_of(true);
/// All faults: while one is there nothing is followed.
const FAULTS: u32 = bits_of(false);

/// A bit for each cause that is a fault, or only for those `of_the_rig`.
const fn bits_of(of_the_rig: bool) -> u32 {
    let mut bits = 0;
    let mut number = 0;
    while number < Cause::ALL.len() {
        let cause = Cause::ALL[number];
        if cause.is_of_the_rig() || (!of_the_rig && cause.is_fault()) {
            bits |= 1 << number;
        }
        number += 1;
    }
    bits
}

impl HealthMonitor {
    /// With the scales of both channels, and what is allowed of them in mm and kN.
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
            specimen: SpecimenWatch::new(),
            adaptation: Adaptation::new(),
            sums: CycleSums::default(),
            ended: None,
            due: part_end(0),
            amplitudes: least_amplitudes,
            largest: [0.0; 2],
            least_amplitudes,
            block: 0,
            cycle: 0,
            spikes: false,
            events: heapless::Vec::new(),
            fresh: None,
            latched: 0,
        }
    }

    /// The rig starts: learns anew. Events stay.
    pub(crate) fn restart(&mut self) {
        self.response = ResponseWatch::default();
        self.specimen = SpecimenWatch::new();
        self.adaptation = Adaptation::new();
        self.sums = CycleSums::default();
        self.ended = None;
        self.due = part_end(0);
        self.amplitudes = self.least_amplitudes;
        self.largest = [0.0; 2];
        self.block = 0;
        self.cycle = 0;
        self.spikes = false;
        self.displacement.restart();
        self.force.restart();
    }

    /// The first event of each cause since the last [`HealthMonitor::clear`].
    pub(crate) fn events(&self) -> &[Event] {
        &self.events
    }

    /// Forgets all events; what is now shall be normal.
    pub(crate) fn clear(&mut self) {
        self.events.clear();
        self.fresh = None;
        self.latched = 0;
        self.specimen.relearn();
        self.adaptation.find_anew();
        self.response = ResponseWatch::default();
    }

    /// Every tick: which channels [`HealthMonitor::channels`] is to be asked about.
    #[inline(always)]
    pub(crate) fn samples(&mut self, reading: &Reading) -> Asked {
        Asked {
            displacement: self.displacement.update(reading.displacement.value),
            force: self.force.update(reading.force.value),
        }
    }

    /// Looks at the channels asked about, with the demanded displacement in mm and the law's force in kN.
    #[cold]
    #[inline(never)]
    pub(crate) fn channels(&mut self, asked: Asked, demand: f32, law: f32) {
        let [amplitude, force_amplitude] = self.amplitudes;
        let beside = |reference, amplitude_of_it| Beside {
            reference,
            amplitude: amplitude_of_it,
            motion: demand,
            motion_amplitude: amplitude,
        };
        let displacement = if asked.displacement {
            self.displacement.look(&beside(demand, amplitude))
        } else {
            None
        };
        let force = if asked.force {
            self.force.look(&beside(law, force_amplitude))
        } else {
            None
        };
        // Where nothing moves both channels may stand still, and none is to blame.
        let both = 2 * self.force.held() > self.displacement.held();
        let stuck = Cause::SensorStuck(Channel::Displacement);
        for (cause, channel) in [
            (
                displacement.filter(|cause| *cause != stuck || !both),
                self.displacement,
            ),
            (force, self.force),
        ] {
            if let Some(cause) = cause {
                self.sample_event(cause, &channel);
            }
        }
    }

    fn sample_event(&mut self, cause: Cause, channel: &ChannelWatch) {
        self.latch(Event {
            cause,
            statistic: Statistic::Sample,
            value: channel.last(),
            limit: channel.limit(),
            cycle: self.cycle,
        });
    }

    /// The rig has stopped for `fault`: what that says of a channel or of the actuator.
    #[cold]
    #[inline(never)]
    pub(crate) fn stopped(&mut self, fault: Fault) {
        match fault {
            Fault::DisplacementClipped => {
                let channel = self.displacement;
                self.sample_event(Cause::SensorClipped(Channel::Displacement), &channel);
            }
            Fault::ForceClipped => {
                let channel = self.force;
                self.sample_event(Cause::SensorClipped(Channel::Force), &channel);
            }
            Fault::TrackingLimit | Fault::NoResponse
                if self.latched & OF_THE_RIG == 0 && self.response.is_dead() =>
            {
                self.latch(Event {
                    cause: Cause::ActuatorDead,
                    statistic: Statistic::Response,
                    value: 1.0,
                    limit: response::LIMIT,
                    cycle: self.cycle,
                });
            }
            _ => {}
        }
    }

    /// By how much the law differed from the law as it was given in the cycle that has ended last.
    pub(crate) fn followed(&self) -> Followed {
        self.adaptation.reported()
    }

    /// Whether something was found that [`HealthMonitor::take_fresh`] has not told.
    #[inline(always)]
    pub(crate) fn has_fresh(&self) -> bool {
        self.fresh.is_some()
    }

    /// What was found since it was last asked.
    #[cold]
    #[inline(never)]
    pub(crate) fn take_fresh(&mut self) -> Option<Event> {
        self.fresh.take()
    }

    /// Whether a tick at `phase`, 2³² to the cycle, is to be looked at closely.
    #[inline(always)]
    pub(crate) fn is_due(&self, phase: u32) -> bool {
        // No tick is half a cycle long.
        phase.wrapping_sub(self.due) as i32 >= 0
    }

    /// A close look at a tick that is due. What the law is to differ by from here on, where a cycle has ended and it follows.
    #[inline(never)]
    pub(crate) fn look(&mut self, config: &HealthConfig, look: &Look) -> Option<Followed> {
        self.due = part_end(look.phase);
        // The law that it shows is still that of the cycle before, unless another one has taken over.
        let share = if self.ended.is_some_and(|ended| ended.another_law) {
            0.0
        } else {
            self.adaptation.share(look.parts)
        };
        let mut followed = None;
        if let Some(ended) = self.ended.take() {
            self.close_cycle(config, &ended);
            if config.follows() {
                followed = Some(self.adaptation.cycle(ended.steady.is_some()));
            }
        } else if self.specimen.has_work() {
            self.work_on_specimen(config);
        } else if self.adaptation.has_work() {
            self.work_on_adaptation(config);
        }
        let (d, v) = look.demand;
        let all = self.amplitudes.iter_mut().zip(&mut self.largest);
        for ((amplitude, largest), value) in all.zip([d, look.law]) {
            if value.abs() > *largest {
                *largest = value.abs();
            }
            if *largest > *amplitude {
                *amplitude = *largest;
            }
        }
        let given = look.law - share;
        self.sums.add(&Sample {
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
        } else if let Some((cause, distance)) =
            self.response.update(look.measured, d, v, look.phase)
            && self.latched & OF_THE_RIG == 0
        {
            self.latch(Event {
                cause,
                statistic: Statistic::Response,
                value: distance,
                limit: response::LIMIT,
                cycle: self.cycle,
            });
        }
        followed
    }

    /// A cycle has ended before this tick, whose look is not yet taken. The look does the work: this tick has enough to do.
    #[inline(always)]
    pub(crate) fn cycle(&mut self, ended: Ended) {
        self.cycle = self.cycle.saturating_add(1);
        self.adaptation.report();
        self.ended = Some(ended);
    }

    /// What the end of a cycle leaves to the look after it, before that look is taken.
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
            self.specimen.relearn();
            self.adaptation = Adaptation::new();
            return;
        }
        let Some(steady) = ended.steady else {
            return;
        };
        if ended.block != self.block {
            self.block = ended.block;
            self.specimen.relearn();
            self.adaptation.find_anew();
        }
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

    #[inline(never)]
    fn work_on_specimen(&mut self, config: &HealthConfig) {
        if let Some(event) = self.specimen.work(config)
            && (self.latched & OF_THE_RIG == 0 || !event.cause.is_fault())
        {
            self.latch(event);
        }
    }

    #[inline(never)]
    fn work_on_adaptation(&mut self, config: &HealthConfig) {
        if self.latched & FAULTS == 0 && self.specimen.is_sound(config) {
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
            // One that finds no room is still told once.
            let _ = self.events.push(event);
            self.fresh = self.fresh.or(Some(event));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parts end at odd multiples of 1/128 of a cycle: the first of them beyond the phase.
    #[test]
    fn a_part_ends_half_a_part_late() {
        for part in 0..64u64 {
            let end = (2 * part + 1) << 25;
            let next = (end + (1 << 26)) as u32;
            assert_eq!(part_end((end - 1) as u32), end as u32);
            assert_eq!(part_end(end as u32), next);
            assert_eq!(part_end((end + (1 << 25)) as u32), next);
        }
        assert_eq!(part_end(0), 1 << 25);
    }

    #[test]
    fn false_alarms_are_shared_out_among_both_sides_of_what_is_watched() {
        let settings = HealthSettings {
            false_alarm_cycles: 1e4,
            ..HealthSettings::default()
        };
        assert_eq!(settings.config().unwrap().run_length, 8e4);
    }

    #[test]
    fn a_fault_is_of_the_rig_or_of_the_specimen_or_none() {
        for cause in Cause::ALL {
            let bit = 1 << cause.number();
            let (fault, of_the_rig) = match cause {
                Cause::RunIn | Cause::Temperature => (false, false),
                Cause::WireBreakage
                | Cause::FrictionWear
                | Cause::Loosening
                | Cause::PreloadShift
                | Cause::Unexplained => (true, false),
                _ => (true, true),
            };
            assert_eq!(cause.is_fault(), fault);
            assert_eq!(
                (FAULTS & bit != 0, OF_THE_RIG & bit != 0),
                (fault, of_the_rig)
            );
        }
        assert_eq!((FAULTS >> 20, OF_THE_RIG >> 20), (0, 0));
    }
}

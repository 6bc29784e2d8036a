//! The fixed-tick controller: reads the specimen, drives the actuator, runs the law beside it, protects both.
//!
//! [`Rig`] excites a specimen: an [`Exciter`]'s displacement goes out as the actuator's command, corrected for amplitude
//! and phase from cycle to cycle, and the law is evaluated beside the measured force. The exciter is the generator of a
//! [`Programme`] or a [`Stream`] of any motion. [`DamperEmulation`] is the other role: it is the damper, and drives the law's
//! force for the displacement it measures.
//!
//! # Deadline
//! Call `tick()` once per tick, from a timer at the tick rate; it must return before the next. It clocks 64 bits out of
//! the ADC and 24 into the DAC, 5.5 µs at 16 MHz, of the 100 µs at 10 kHz. Its computation is a fixed number of
//! operations without a loop but for the law's effects, and calls nothing of libm; a swap of the law adds a row of its
//! table to each of some hundred ticks, and the tick that ends a cycle the cycle's results, a dozen divisions and one square
//! root. Whoever owns the timer counts ticks that came late.
//!
//! # Stopping
//! A limit exceeded, a bus error, a channel at the end of its range, stuck or dropped out, a cycle without response, a number
//! that is not finite, a tick that came late or a link that is lost stops it: the enable line drops in that very tick, the
//! command goes to 0 in a straight line within [`RigSettings::stop_ticks`] and one, and the cause stays as
//! [`State::Faulted`] until [`Rig::clear`]. What of the rig's states follows on which:
//!
//! ```text
//!                  start                 stop, finish                     at rest
//! Idle or Done, ──────────▶ Running ──────────────────▶ Idle or Done, ───────────────▶ Idle or Done,
//! at rest                      │                        moving                         at rest
//!       │                      │ trip                      │ trip
//!       │ trip                 ▼                           │
//!       │               Faulted, moving ◀──────────────────┘
//!       │                      │ at rest
//!       └─────────────▶ Faulted, at rest ──────────▶ Idle, at rest
//!                                           clear
//! ```

mod comparison;
mod correction;
mod emulator;
mod exciter;
mod fault;
mod output;
mod state;
mod stream;

pub use emulator::{DamperEmulation, DamperEmulationSettings};
pub use exciter::{AnyExciter, Exciter};
pub use fault::TripCause;
pub use state::State;
pub use stream::{Knot, STREAM_QUEUE, Stream, StreamConfig, StreamSettings};

use core::borrow::{Borrow, BorrowMut};

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

use crate::adc::{Ads8688, Reading};
use crate::cycle::Cycle;
use crate::dac::Ad5761;
use crate::effects::Motion;
use crate::error::ConfigError;
use crate::fast_law::{Adaptation, FastLaw, RunningLaw};
use crate::frame::{Fields, Reader, Writer};
use crate::health::{
    Change, Channel, Ended, Event, HealthConfig, HealthMonitor, HealthSettings, Look, Steady,
};
use crate::observer::{Observer, ObserverConfig};
use crate::sine::{Excitation, Programme, SineGenerator};
use comparison::Comparison;
use correction::{Correction, CorrectionConfig};
use fault::{Exceeded, Limits};
use output::Output;

/// Former name of [`TripCause`].
#[deprecated(note = "use TripCause")]
pub type Fault = TripCause;
/// Former name of [`DamperEmulation`].
#[deprecated(note = "use DamperEmulation")]
pub type Emulator<A, D, E, const N: usize> = DamperEmulation<A, D, E, N>;
/// Former name of [`DamperEmulationSettings`].
#[deprecated(note = "use DamperEmulationSettings")]
pub type EmulatorSettings = DamperEmulationSettings;

/// `cargo hil bench` counts the tick without the monitor too: what that costs is the difference. It has the compiler set
/// `unmonitored` for an image of its own; no feature does, so that no crate takes the monitor away from another's rig.
const MONITORED: bool = !cfg!(unmonitored);

/// What a rig is set to. [`Rig::new`] validates it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigSettings {
    /// Largest measured displacement in either direction, mm, 1e-6…1e4.
    pub displacement_limit: f64,
    /// Largest measured force in either direction, kN, 1e-6…1e9.
    pub force_limit: f64,
    /// Largest distance of the measured displacement from the demanded one, mm, 1e-6…1e4.
    pub tracking_limit: f64,
    /// For how many ticks on end one of these must be exceeded to stop the rig, 1…1e6.
    pub trip_ticks: u32,
    /// In how many ticks the command goes to 0 once stopped, 1…1e7.
    pub stop_ticks: u32,
    /// After how many ticks without an exchange over the link it stops, see [`Rig::exchange`], 0…1e7; 0 where nobody is
    /// linked.
    pub link_ticks: u32,
    /// Of the observer, Hz, 1e-3 to a tenth of the tick rate.
    pub observer_bandwidth: f64,
    /// Damping ratio of the observer, 0.3…3.
    pub observer_damping: f64,
    /// Part of the error of amplitude and phase that is corrected at the end of each cycle, 0…1.
    pub correction_gain: f64,
    /// Lead to begin with, s, 0…0.1: what the actuator is known to lag.
    pub lead: f64,
    /// Time constant with which a correction takes effect, s, one tick to 10.
    pub glide: f64,
    /// Integral feedback of the displacement, 1/s, 0 to a hundredth of the tick rate.
    pub feedback: f64,
    /// Of what watches it.
    pub health: HealthSettings,
}

impl Default for RigSettings {
    /// For amplitudes up to 0.3 mm and a few kN, at 0.5–10 Hz.
    fn default() -> Self {
        Self {
            displacement_limit: 0.5,
            force_limit: 4.5,
            tracking_limit: 0.3,
            trip_ticks: 10,
            stop_ticks: 5_000,
            link_ticks: 0,
            observer_bandwidth: 20.0,
            observer_damping: 0.7,
            correction_gain: 0.8,
            lead: 0.0,
            glide: 5e-3,
            feedback: 5.0,
            health: HealthSettings::default(),
        }
    }
}

/// What [`RigSettings`] come to at a tick rate, computed in f64. It goes over a link: a target without f64 takes what
/// a host computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigConfig {
    limits: Limits,
    observer: ObserverConfig,
    correction: CorrectionConfig,
    health: HealthConfig,
    stop_ticks: u32,
    link_ticks: u32,
}

impl Fields for RigConfig {
    fn write(&self, writer: &mut Writer<'_>) {
        self.limits.write(writer);
        self.observer.write(writer);
        self.correction.write(writer);
        self.health.write(writer);
        writer.words([self.stop_ticks, self.link_ticks]);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            limits: Limits::read(reader)?,
            observer: ObserverConfig::read(reader)?,
            correction: CorrectionConfig::read(reader)?,
            health: HealthConfig::read(reader)?,
            stop_ticks: reader.u32()?,
            link_ticks: reader.u32()?,
        })
    }
}

impl RigSettings {
    /// At `tick_rate` Hz, 1…1e6.
    ///
    /// # Errors
    /// A setting that is not finite or out of range.
    pub fn at(&self, tick_rate: f64) -> Result<RigConfig, ConfigError> {
        let limits = Limits::new(
            self.displacement_limit,
            self.force_limit,
            self.tracking_limit,
            self.trip_ticks,
        )?;
        Ok(RigConfig {
            limits,
            observer: ObserverConfig::new(
                tick_rate,
                self.observer_bandwidth,
                self.observer_damping,
            )?,
            correction: CorrectionConfig::new(
                tick_rate,
                self.correction_gain,
                self.lead,
                self.glide,
                self.feedback,
                limits.displacement(),
            )?,
            health: self.health.config()?,
            stop_ticks: output::valid_stop_ticks(self.stop_ticks)?,
            link_ticks: output::valid_link_ticks(self.link_ticks)?,
        })
    }
}

/// One tick, as the rig saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telemetry {
    /// Ticks since construction, this one included.
    pub tick: u64,
    /// Measured displacement, mm. The last one read, where reading failed.
    pub displacement: f32,
    /// Observed velocity, mm/s.
    pub velocity: f32,
    /// Measured force, kN. The last one read, where reading failed.
    pub measured_force: f32,
    /// Force of the law at the observed motion, kN.
    pub model_force: f32,
    /// What the DAC drives: mm, or kN from an emulator. The last one written, where writing failed.
    pub command: f32,
    /// Block of the programme; 0 from an emulator and of a stream.
    pub block: usize,
    /// Cycles completed.
    pub cycle: u32,
    /// Phase of the cycle under way, 2³² to the cycle; 0 of a stream.
    pub phase: u32,
    /// In a ramp of the programme, or following a stream.
    pub ramp: bool,
    /// What the rig is doing after this tick.
    pub state: State,
    /// The cycle that ended with this tick; never of a stream.
    pub report: Option<CycleReport>,
    /// What was found wrong at this tick, or beside something else shortly before, the first time since it was cleared; never by
    /// an emulator.
    pub event: Option<Event>,
}

/// One cycle's results, from the observed displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleReport {
    /// Block of the programme; 0 from an emulator.
    pub block: usize,
    /// Number of the cycle, from 0.
    pub cycle: u32,
    /// A ramp of the programme.
    pub ramp: bool,
    /// With the measured force.
    pub measured: Cycle,
    /// With the law's force.
    pub model: Cycle,
    /// RMS of the law's error over the RMS of the measured force; 0 where there was no force, [`f32::MAX`] where the error's
    /// square is beyond a float.
    pub nrmse: f32,
    /// By how much the law differed from the law as it was given, which slow changes of the specimen had led to; 0 where it
    /// does not follow, and from an emulator.
    pub followed: Adaptation,
}

/// A rig with up to `B` blocks in its programme and up to `N` effects in its law, driven by the [`Exciter`] `X`.
///
/// It owns programme and law, or borrows them: with 2 KiB to sixteen blocks and 6 KiB of law they are what does not fit on a
/// small stack, and firmware keeps them in statics.
#[derive(Debug)]
// What every tick needs comes first, within reach of a load's offset: by the compiler's order a tick takes up to 40
// instructions more or less with the size of any field.
#[repr(C)]
pub struct Rig<A, D, E, const B: usize, const N: usize, X = SineGenerator<B>, L = RunningLaw<N>> {
    limits: Limits,
    reading: Reading,
    tick: u64,
    adc: Ads8688<A>,
    observer_config: ObserverConfig,
    exceeded: Exceeded,
    observer: Observer,
    correction_config: CorrectionConfig,
    correction: Correction,
    comparison: Comparison,
    output: Output<D, E>,
    excitation: Excitation,
    temperature: f32,
    exciter: X,
    law: L,
    health: HealthMonitor,
    health_config: HealthConfig,
}

impl<A, D, E, const B: usize, const N: usize, P, L> Rig<A, D, E, B, N, SineGenerator<B, P>, L>
where
    A: SpiDevice,
    D: SpiDevice,
    E: OutputPin,
    P: Borrow<Programme<B>>,
    L: BorrowMut<RunningLaw<N>>,
{
    /// Idle, enable line low. The DAC's scale is that of the command in mm. Ticks run at the programme's rate. `programme`
    /// and `law` are either what they are called or references to it.
    ///
    /// # Errors
    /// A setting that is not finite or out of range; a programme without blocks.
    pub fn new(
        adc: Ads8688<A>,
        dac: Ad5761<D>,
        enable: E,
        settings: &RigSettings,
        programme: P,
        law: L,
    ) -> Result<Self, ConfigError> {
        let config = settings.at(programme.borrow().tick_rate())?;
        Self::with_config(adc, dac, enable, &config, programme, law)
    }

    /// [`Rig::new`] with settings as they are at the programme's tick rate.
    ///
    /// # Errors
    /// A programme without blocks.
    pub fn with_config(
        adc: Ads8688<A>,
        dac: Ad5761<D>,
        enable: E,
        config: &RigConfig,
        programme: P,
        law: L,
    ) -> Result<Self, ConfigError> {
        // What may fail comes first, so that the rest is built where it will be.
        let generator = SineGenerator::new(programme)?;
        Ok(Self::with_exciter(adc, dac, enable, config, generator, law))
    }

    /// The programme.
    pub fn programme(&self) -> &Programme<B> {
        self.exciter.programme()
    }
}

impl<A, D, E, const B: usize, const N: usize, X, L> Rig<A, D, E, B, N, X, L>
where
    A: SpiDevice,
    D: SpiDevice,
    E: OutputPin,
    X: Exciter,
    L: BorrowMut<RunningLaw<N>>,
{
    /// [`Rig::with_config`] with any exciter in the place of a programme's generator. Ticks run at the exciter's rate, which is
    /// to be that of `config`.
    #[inline]
    pub fn with_exciter(
        adc: Ads8688<A>,
        dac: Ad5761<D>,
        enable: E,
        config: &RigConfig,
        exciter: X,
        law: L,
    ) -> Self {
        let (displacement, force) = adc.scales();
        Self {
            health: HealthMonitor::new(displacement, force, config.limits.allowed()),
            adc,
            output: Output::new(dac, enable, config.stop_ticks, config.link_ticks),
            limits: config.limits,
            observer_config: config.observer,
            correction_config: config.correction,
            health_config: config.health,
            exciter,
            law,
            observer: Observer::default(),
            correction: Correction::new(&config.correction),
            comparison: Comparison::default(),
            exceeded: Exceeded::default(),
            reading: Reading::default(),
            excitation: Excitation::default(),
            temperature: 20.0,
            tick: 0,
        }
    }

    /// What drives it, to give a [`Stream`] its knots. Changing it otherwise while running may demand a step.
    pub fn exciter(&mut self) -> &mut X {
        &mut self.exciter
    }

    /// Begins the programme from its start, with the corrections as they were. Says no, and does nothing, while
    /// running, faulted, or on the way to 0.
    pub fn start(&mut self) -> bool {
        let started = self.output.start();
        if started {
            self.exciter.restart();
            let law = self.law.borrow_mut();
            law.boundary();
            law.follow_nothing();
            law.rest();
            self.comparison = Comparison::default();
            self.exceeded = Exceeded::default();
            self.correction.restart();
            self.health.restart();
        }
        started
    }

    /// Stops without a fault.
    pub fn stop(&mut self) {
        self.output.stop();
    }

    /// Whoever is at the other end of the link has been heard: to be called as often as that is so.
    pub fn exchange(&mut self) {
        self.output.exchange();
    }

    /// A tick came late, or not at all, as whoever owns the timer sees: stops with [`TripCause::TickOverrun`].
    pub fn overrun(&mut self) {
        self.output.overrun();
    }

    /// Forgets the fault. Says no, and does nothing, where there is none or the command is not yet back at 0.
    pub fn clear(&mut self) -> bool {
        self.output.clear()
    }

    /// The first event of each cause since [`Rig::clear_events`].
    pub fn events(&self) -> &[Event] {
        self.health.events()
    }

    /// Forgets all events; what is now counts as normal.
    pub fn clear_events(&mut self) {
        self.health.clear();
    }

    /// Another law from the end of this cycle on, or from the start where not running; see [`Rig::law`]. What its
    /// effects remember is kept where they are of the same kinds in the same order as before. The monitor learns what is
    /// normal beside it anew, and what begins with the swap is normal.
    pub fn swap_law(&mut self, law: FastLaw<N>) {
        self.law.borrow_mut().swap(law);
    }

    /// [`Rig::swap_law`] with a law that `write` writes in place, so that it need not pass through the stack.
    ///
    /// # Errors
    /// That of `write`; no law waits then, and the one in force stays.
    pub fn swap_law_with<F>(
        &mut self,
        write: impl FnOnce(&mut FastLaw<N>) -> Result<(), F>,
    ) -> Result<(), F> {
        self.law.borrow_mut().swap_with(write)
    }

    /// The law in force, as it was given.
    pub fn law(&self) -> &FastLaw<N> {
        self.law.borrow().law()
    }

    /// By how much the law in force differs from that, which slow changes of the specimen have led to.
    pub fn followed(&self) -> Adaptation {
        self.law.borrow().followed()
    }

    /// Temperature for the law's effects, °C; 20 until set.
    pub fn set_temperature(&mut self, temperature: f32) {
        self.temperature = temperature;
    }

    /// What the rig is doing.
    pub fn state(&self) -> State {
        self.output.state()
    }

    /// A channel did what asks for a look, beside the demand of this tick and the law's force of the one before: stops for a
    /// sensor that is lost; whatever else is found, the rig goes on.
    #[cold]
    #[inline(never)]
    fn look_at_channels(&mut self, changes: [Change; 2]) -> Option<Event> {
        let demand = self.excitation.displacement;
        let law = self.comparison.model_force();
        let lost = self.health.channels(&self.reading, &changes, demand, law);
        if let Some(channel) = lost {
            self.output.trip(match channel {
                Channel::Displacement => TripCause::DisplacementLost,
                Channel::Force => TripCause::ForceLost,
            });
        }
        self.health.take_fresh()
    }

    /// A close look at this tick. An `event` of its own is told as soon as there is no other.
    #[cold]
    #[inline(never)]
    fn look(&mut self, motion: &Motion<f32>, model_force: f32, event: &mut Option<Event>) {
        let excitation = &self.excitation;
        let parts = if self.health_config.follows() {
            self.law.borrow().parts(motion)
        } else {
            [0.0; 3]
        };
        let look = Look {
            displacement: motion.displacement,
            velocity: motion.velocity,
            measured: self.reading.displacement.value,
            demand: (excitation.displacement, excitation.velocity),
            force: self.reading.force.value,
            law: model_force,
            parts,
            phase: excitation.phase,
            ramp: excitation.ramp,
        };
        if let Some(followed) = self.health.look(&self.health_config, &look) {
            self.law.borrow_mut().follow(followed);
        }
        if event.is_none() && self.health.has_fresh() {
            *event = self.health.take_fresh();
        }
    }

    /// It does not run: what the fault that it `was_running` into says, and what is left to tell.
    #[cold]
    #[inline(never)]
    fn attend(&mut self, was_running: bool, event: &mut Option<Event>) {
        if was_running && let State::Faulted(fault) = self.output.state() {
            self.health.stopped(fault, &self.reading);
        }
        if event.is_none() {
            *event = self.health.take_fresh();
        }
    }

    /// One tick: see the module for its deadline.
    pub fn tick(&mut self) -> Telemetry {
        self.tick = self.tick.wrapping_add(1);
        let was_running = self.output.is_running();
        self.output.watch_link();
        let last = [self.reading.displacement.code, self.reading.force.code];
        self.output.read(&mut self.adc, &mut self.reading);
        let displacement = self.reading.displacement.value;
        let measured_force = self.reading.force.value;
        // The cycle that ends with this tick is of the block before it.
        let before = self.excitation;
        let mut event = None;
        if self.output.is_running() {
            self.excitation = self.exciter.tick();
            if let Some(cause) = self.exciter.refusal() {
                self.output.trip(cause);
            }
            if MONITORED {
                let changes = self.health.samples(last, &self.reading);
                if changes.iter().any(Change::asks) {
                    event = self.look_at_channels(changes);
                }
            }
        } else {
            // Standing still, for the observer.
            self.excitation.acceleration = 0.0;
            self.excitation.cycle_end = false;
        }
        let excitation = self.excitation;
        let another_law = excitation.cycle_end && self.law.borrow_mut().boundary();
        let estimate =
            self.observer
                .update(&self.observer_config, displacement, excitation.acceleration);
        let motion = Motion {
            displacement: estimate.displacement,
            velocity: estimate.velocity,
            acceleration: estimate.acceleration,
            cycles: excitation.cycle as f32 + excitation.phase as f32 * (1.0 / (1u64 << 32) as f32),
            temperature: self.temperature,
            ..Motion::default()
        };
        let model_force = self.law.borrow_mut().force(&motion);
        if !model_force.is_finite() {
            self.output.trip(TripCause::NotFinite);
        }
        let mut command = 0.0;
        let mut report = None;
        if self.output.is_running() {
            let error = displacement - excitation.displacement;
            if let Some(fault) =
                self.limits
                    .check(&mut self.exceeded, displacement, measured_force, error)
            {
                self.output.trip(fault);
            }
            if excitation.cycle_end
                && let Err(fault) = self.correction.boundary(&self.correction_config)
            {
                self.output.trip(fault);
            }
            command = self
                .correction
                .command(&self.correction_config, &excitation, displacement);
            report = self.comparison.update(
                measured_force,
                model_force,
                excitation.cycle_end,
                |accumulator, forces| {
                    accumulator.update(estimate.displacement, forces, excitation.phase)
                },
            );
            if MONITORED && excitation.cycle_end {
                self.health.cycle(Ended {
                    block: before.block,
                    temperature: self.temperature,
                    command: self.correction.mean_command(),
                    another_law,
                    steady: report.as_ref().filter(|_| !before.ramp).map(
                        |([measured, model], _)| Steady {
                            energy: measured.energy,
                            law_energy: model.energy,
                            mean: measured.mean_force - model.mean_force,
                        },
                    ),
                });
            }
            if MONITORED && self.health.is_due(excitation.phase) {
                self.look(&motion, model_force, &mut event);
            }
            if excitation.done {
                self.output.finish();
            }
        }
        if !self.output.is_running() {
            self.attend(was_running, &mut event);
        }
        self.output.drive(command);
        Telemetry {
            tick: self.tick,
            displacement,
            velocity: estimate.velocity,
            measured_force,
            model_force,
            command: self.output.command(),
            block: excitation.block,
            cycle: excitation.cycle,
            phase: excitation.phase,
            ramp: excitation.ramp,
            state: self.output.state(),
            report: report.map(|results| {
                CycleReport::new(
                    results,
                    before.block,
                    excitation.cycle,
                    before.ramp,
                    self.health.followed(),
                )
            }),
            event,
        }
    }
}

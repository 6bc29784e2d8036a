//! The fixed-tick controllers: they take what the sensors say of the specimen, say what the actuator is to do, run the law beside
//! it, and protect both.
//!
//! [`RigController`] excites a specimen: an [`Exciter`]'s displacement goes out as the actuator's command, corrected for amplitude
//! and phase from cycle to cycle, and the law is evaluated beside the measured force. The exciter is the generator of a
//! [`Programme`](crate::sine::Programme) or a [`Stream`] of any motion. [`EmulationController`] is the other role: it is the damper,
//! and drives the law's force for the displacement it measures.
//!
//! # Who does the I/O
//! A [`Controller`] does none: a [`Reading`] goes in, and the [`Telemetry`] that comes out holds the [`Command`].
//!
//! | the converters | use |
//! |---|---|
//! | an ADS8688 and an AD5761R on SPI | [`Rig::new`], [`DamperEmulation::new`] |
//! | others, read and written in calls that wait | [`Sensors`], [`Actuator`] and [`Blocking::wire`] |
//! | awaited | the feature `async`: `AsyncSensors`, `AsyncActuator` and `Asynchronous::wire` |
//! | DMA, or a link | the [`Controller`] itself, which has an example |
//!
//! # Deadline
//! Call `tick()` once per tick, from a timer at the tick rate; it must return before the next. On the two SPI parts it clocks 64
//! bits out of the ADC and 24 into the DAC, 5.5 µs at 16 MHz, of the 100 µs at 10 kHz. Its computation is a fixed number of
//! operations without a loop but for the law's effects, and calls nothing of libm; a swap of the law adds a row of its
//! table to each of some hundred ticks, and the tick that ends a cycle the cycle's results, a dozen divisions and one square
//! root. Every [`VERIFY_TICKS`] ticks 72 bits more read the DAC back.
//!
//! # Supervision
//! Each tick is given the reading of a clock: one that comes late, not at all or twice stops what runs, see [`Controller::tick`].
//! [`WithTrip`] adds an input from outside that says stop, [`WithReadBack`] a look at the enable line's level, and [`WithAlive`] a
//! signal for a watchdog outside. The DAC is read back, and a clear sets both converters up again.
//!
//! # Stopping
//! A limit exceeded, sensors or an actuator that fail, a channel at the end of its range, stuck or dropped out, a cycle without response, a number
//! that is not finite, a tick that came late or a link that is lost stops it: the enable line drops in that very tick, the
//! command goes to 0 in a straight line within [`RigSettings::stop_ticks`] and one, and the cause stays as
//! [`State::Faulted`] until [`Controller::clear`]. What of the rig's states follows on which:
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

mod approach;
#[cfg(feature = "async")]
mod asynchronous;
mod blend;
mod blocking;
mod comparison;
mod controller;
mod correction;
mod emulation;
mod exciter;
mod fault;
mod guard;
mod io;
mod pace;
mod pins;
mod refusal;
mod rig_controller;
mod spi;
mod standstill;
mod state;
mod stream;
mod temperature;

#[cfg(feature = "async")]
pub use asynchronous::{AsyncActuator, AsyncSensors, Asynchronous};
pub use blocking::{Blocking, VERIFY_TICKS};
pub use controller::Controller;
pub use emulation::{DamperEmulationSettings, EmulationController};
pub use exciter::{AnyExciter, Exciter};
pub use fault::TripCause;
pub use io::{Actuator, Command, Reading, Sensors, Wiring, WithControls};
pub use pins::{PinError, WithAlive, WithReadBack, WithTrip};
pub use refusal::{ClearRefused, StartRefused};
pub use rig_controller::RigController;
pub use spi::{SpiActuator, SpiActuatorError, SpiDamperEmulation, SpiRig};
pub use state::State;
pub use stream::{Knot, STREAM_QUEUE, Stream, StreamConfig, StreamSettings};

use crate::cycle::Cycle;
use crate::effects::CONTROLS;
use crate::error::ConfigError;
use crate::fast_law::{Adaptation, RunningLaw};
use crate::frame::{Fields, Reader, Writer};
use crate::health::{Event, HealthConfig, HealthSettings};
use crate::observer::ObserverConfig;
use correction::CorrectionConfig;
use fault::Limits;
use pace::PaceConfig;
use temperature::TemperatureConfig;

/// A [`RigController`] with its sensors and its actuator. [`SpiRig`] has the two parts of [`crate::adc`] and [`crate::dac`].
pub type Rig<S, A, const N: usize, X, L = RunningLaw<N>> = Blocking<RigController<N, X, L>, S, A>;

/// An [`EmulationController`] with its sensors and its actuator. [`SpiDamperEmulation`] has the two parts of [`crate::adc`] and
/// [`crate::dac`].
pub type DamperEmulation<S, A, L> = Blocking<EmulationController<L>, S, A>;

/// Former name of [`TripCause`].
#[deprecated(note = "use TripCause")]
pub type Fault = TripCause;
/// Former name of [`SpiDamperEmulation`].
#[deprecated(note = "use SpiDamperEmulation")]
pub type Emulator<A, D, E, const N: usize> = SpiDamperEmulation<A, D, E, RunningLaw<N>>;
/// Former name of [`DamperEmulationSettings`].
#[deprecated(note = "use DamperEmulationSettings")]
pub type EmulatorSettings = DamperEmulationSettings;

/// Temperatures that a specimen in its chamber may have, °C.
pub(crate) const TEMPERATURES: [f64; 2] = [-60.0, 200.0];
/// °C/s: a mesh of 50 g takes 250 W for that.
const TEMPERATURE_RATE: f64 = 10.0;

/// What a rig is set to. [`RigController::new`] validates it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct RigSettings {
    /// Largest measured displacement in either direction, mm, 1e-6…1e4.
    pub displacement_limit: f64,
    /// Largest measured force in either direction, kN, 1e-6…1e9.
    pub force_limit: f64,
    /// Largest distance of the measured displacement from the demanded one, mm, 1e-6…1e4.
    pub tracking_limit: f64,
    /// For how many ticks on end one of these must be exceeded to stop the rig, 1…1e6; for a quarter as many by more than a tenth.
    pub trip_ticks: u32,
    /// In how many ticks the command goes to 0 once stopped, 1…1e7.
    pub stop_ticks: u32,
    /// After how many ticks without an exchange over the link it stops, see [`Controller::exchange`], 0…1e7; 0 where nobody is
    /// linked.
    pub link_ticks: u32,
    /// Rate of the counter whose reading each tick is given, Hz: 0, or the tick rate to 4e9 and to 2e9 times the tick rate. At 0 it
    /// counts the ticks of the timer, one each. A clock that is independent of the timer, such as the processor's cycles, also
    /// finds a timer at a wrong rate; give it at least 10 counts to the tick. See [`Controller::tick`].
    pub clock_rate: f64,
    /// Of the observer, Hz, 1e-3 to a tenth of the tick rate.
    pub observer_bandwidth: f64,
    /// Damping ratio of the observer, 0.3…3.
    pub observer_damping: f64,
    /// Part of the error of amplitude and phase that is corrected at the end of each cycle, 0…1.
    pub correction_gain: f64,
    /// Most by which amplitude's correction may have the command grow within a block, once it has settled, part of it, 0.01…10; twice that
    /// before. More stops the rig: what asks for it is a displacement channel that shows too little, or an actuator that becomes weak.
    pub correction_limit: f64,
    /// Lead to begin with, s, 0…0.1: what the actuator is known to lag.
    pub lead: f64,
    /// Time constant with which a correction takes effect, s, one tick to 10.
    pub glide: f64,
    /// Integral feedback of the displacement, 1/s, 0 to a hundredth of the tick rate.
    pub feedback: f64,
    /// Coldest and hottest that a measured temperature can be, °C, −273…2000. What is beyond is no temperature of the specimen.
    pub temperature_range: [f64; 2],
    /// Fastest that it can change, °C/s, 1e-3…1e3: the law is given no faster change while running.
    pub temperature_rate: f64,
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
            clock_rate: 0.0,
            observer_bandwidth: 20.0,
            observer_damping: 0.7,
            correction_gain: 0.8,
            correction_limit: 0.25,
            lead: 0.0,
            glide: 5e-3,
            feedback: 5.0,
            temperature_range: TEMPERATURES,
            temperature_rate: TEMPERATURE_RATE,
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
    temperature: TemperatureConfig,
    health: HealthConfig,
    stop_ticks: u32,
    link_ticks: u32,
    pace: PaceConfig,
}

impl Fields for RigConfig {
    fn write(&self, writer: &mut Writer<'_>) {
        self.limits.write(writer);
        self.observer.write(writer);
        self.correction.write(writer);
        self.temperature.write(writer);
        self.health.write(writer);
        writer.words([self.stop_ticks, self.link_ticks]);
        self.pace.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            limits: Limits::read(reader)?,
            observer: ObserverConfig::read(reader)?,
            correction: CorrectionConfig::read(reader)?,
            temperature: TemperatureConfig::read(reader)?,
            health: HealthConfig::read(reader)?,
            stop_ticks: guard::valid_stop_ticks(reader.u32()?).ok()?,
            link_ticks: guard::valid_link_ticks(reader.u32()?).ok()?,
            pace: PaceConfig::read(reader)?,
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
                self.correction_limit,
                limits.displacement(),
            )?,
            temperature: TemperatureConfig::new(
                tick_rate,
                self.temperature_range,
                self.temperature_rate,
            )?,
            health: self.health.config()?,
            stop_ticks: guard::valid_stop_ticks(self.stop_ticks)?,
            link_ticks: guard::valid_link_ticks(self.link_ticks)?,
            pace: PaceConfig::new(tick_rate, self.clock_rate)?,
        })
    }
}

/// One tick, as the rig saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Telemetry {
    /// Ticks since construction, this one included.
    pub tick: u64,
    /// Measured displacement, mm. The last one read, where reading failed.
    pub displacement: f32,
    /// Observed velocity, mm/s.
    pub velocity: f32,
    /// Measured force, kN. The last one read, where reading failed.
    pub measured_force: f32,
    /// Control inputs as the law was given them, in the units of its effects; 0 where there is none. The last ones read, where
    /// reading failed.
    pub controls: [f32; CONTROLS],
    /// Force of the law at the observed motion, kN.
    pub model_force: f32,
    /// What the actuator drives: mm, or kN from an emulator. The last one that it took, where it fails.
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
    /// What was found wrong at this tick, or beside something else shortly before, the first time since it was cleared; by an
    /// emulator of the temperature alone.
    pub event: Option<Event>,
}

impl Telemetry {
    /// What the actuator is to do until the next tick.
    #[inline(always)]
    pub fn to_drive(&self) -> Command {
        Command {
            value: self.command,
            enabled: self.state == State::Running,
        }
    }
}

/// One cycle's results, from the observed displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

//! The fixed-tick controllers. They take the sensor values, command the actuator, evaluate the law alongside the specimen, and
//! protect both.
//!
//! [`RigController`] excites a specimen: it sends an [`Exciter`]'s displacement to the actuator, corrects amplitude and phase from
//! cycle to cycle, and compares the law's force with the measured one. The exciter is the generator of a
//! [`Programme`](crate::sine::Programme), or a [`Stream`] of any motion. [`EmulationController`] has the opposite role: it replaces
//! the damper, and drives the law's force for the displacement that it measures.
//!
//! # Input and output
//! A [`Controller`] does no I/O: it takes a [`Reading`] and returns the [`Telemetry`], which contains the [`Command`].
//!
//! | the converters | use |
//! |---|---|
//! | an ADS8688 and an AD5761R on SPI | [`Rig::new`], [`DamperEmulation::new`] |
//! | other converters, with blocking calls | [`Sensors`], [`Actuator`] and [`Blocking::wire`] |
//! | other converters, with `async` calls | the feature `async`: `AsyncSensors`, `AsyncActuator` and `Asynchronous::wire` |
//! | DMA, or a link | the [`Controller`] itself; its documentation has an example |
//!
//! # Deadline
//! Call `tick()` once per tick, from a timer at the tick rate. It must return before the next tick. On the two SPI parts it clocks
//! 64 bits out of the ADC and 24 into the DAC: 5.5 µs at 16 MHz, of the 100 µs at 10 kHz. Its computation has a fixed number of
//! operations; only the law's effects contain loops, and it calls nothing of libm. A swap of the law adds one row of its table to
//! each of about a hundred ticks. The tick that ends a cycle adds the cycle's results: a dozen divisions and one square root. Every
//! [`VERIFY_TICKS`] ticks the DAC is read back, which takes 72 bits more.
//!
//! # Supervision
//! Each tick takes the reading of a clock. A tick that is late, missing or called twice trips a running controller, see
//! [`Controller::tick`]. [`WithTrip`] adds an external stop input, [`WithReadBack`] a check of the enable line's level, and
//! [`WithAlive`] a signal for an external watchdog. The DAC is read back, and a clear sets up both converters again.
//!
//! # Trips
//! Each of these trips the rig: a limit exceeded, a failure of sensors or actuator, a channel at the end of its range, stuck or
//! dropped out, a cycle without response, a number that is not finite, a late tick, a lost link. The enable line drops in that very
//! tick. The command goes linearly to 0 within [`RigSettings::stop_ticks`] plus one. The cause stays as [`State::Faulted`] until
//! [`Controller::clear`]. The transitions between the states are:
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
mod blend;
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
mod wired;

pub use controller::Controller;
pub use emulation::{DamperEmulationSettings, EmulationController};
pub use exciter::{AnyExciter, Exciter};
pub use fault::TripCause;
pub use io::{Actuator, Command, Reading, Sensors, Wiring, WithControls};
#[cfg(feature = "async")]
pub use io::{AsyncActuator, AsyncSensors};
pub use pins::{PinError, WithAlive, WithReadBack, WithTrip};
pub use refusal::{ClearRefused, StartRefused};
pub use rig_controller::RigController;
pub use spi::{SpiActuator, SpiActuatorError, SpiDamperEmulation, SpiRig};
pub use state::State;
pub use stream::{Knot, STREAM_QUEUE, Stream, StreamConfig, StreamSettings};
#[cfg(feature = "async")]
pub use wired::Asynchronous;
pub use wired::{Blocking, VERIFY_TICKS};

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

/// Plausible temperatures of a specimen in its chamber, °C.
pub(crate) const TEMPERATURES: [f64; 2] = [-60.0, 200.0];
/// Plausible rate of change, °C/s: a mesh of 50 g needs 250 W for it.
const TEMPERATURE_RATE: f64 = 10.0;

/// Settings of a rig. [`RigController::new`] validates them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct RigSettings {
    /// Largest measured displacement in either direction, mm, 1e-6…1e4.
    pub displacement_limit: f64,
    /// Largest measured force in either direction, kN, 1e-6…1e9.
    pub force_limit: f64,
    /// Largest difference between the measured and the demanded displacement, mm, 1e-6…1e4.
    pub tracking_limit: f64,
    /// Trip time: number of ticks beyond one of these limits until the rig trips, 1…1e6. They need not be in a row: a tick within
    /// the limit takes back only an eighth of one beyond it, so that a limit exceeded for more than a ninth of the time trips the
    /// rig. A quarter of the trip time is enough for an excess of more than a tenth.
    pub trip_ticks: u32,
    /// Number of ticks in which the command goes to 0 after a stop or a trip, 1…1e7.
    pub stop_ticks: u32,
    /// Number of ticks without an exchange over the link after which the rig trips, see [`Controller::exchange`], 0…1e7; 0 without
    /// a link.
    pub link_ticks: u32,
    /// Rate of the counter whose reading each tick takes, Hz: 0, or at least the tick rate, at most 4e9, and at most 2e9 times the tick
    /// rate. With 0 the counter counts the timer's ticks, one each. A clock that is independent of the timer, such as a second
    /// timer, also detects a timer at a wrong rate; it needs at least 10 counts per tick. It must not be the cycle counter (DWT) of
    /// a processor that sleeps in `wfi`, because that counter stands still in sleep. See [`Controller::tick`].
    pub clock_rate: f64,
    /// Bandwidth of the observer, Hz, 1e-3 to a tenth of the tick rate.
    pub observer_bandwidth: f64,
    /// Damping ratio of the observer, 0.3…3.
    pub observer_damping: f64,
    /// Part of the error of amplitude and phase that is corrected at the end of each cycle, 0…1.
    pub correction_gain: f64,
    /// Largest relative growth of the command by the amplitude correction within a block, 0.01…10. It applies after the correction
    /// has settled; before that, twice this value applies. A larger growth trips the rig: the displacement channel shows too little,
    /// or the actuator has become weak.
    pub correction_limit: f64,
    /// Initial lead, s, 0…0.1: the known lag of the actuator.
    pub lead: f64,
    /// Time constant with which a correction takes effect, s, one tick to 10.
    pub glide: f64,
    /// Integral feedback of the displacement, 1/s, 0 to a hundredth of the tick rate.
    pub feedback: f64,
    /// Coldest and hottest plausible temperature, °C, −273…2000. A measured value beyond is not the specimen's temperature.
    pub temperature_range: [f64; 2],
    /// Fastest plausible change of the temperature, °C/s, 1e-3…1e3: a running law gets no faster change.
    pub temperature_rate: f64,
    /// Settings of the health monitor.
    pub health: HealthSettings,
}

impl Default for RigSettings {
    /// Settings for amplitudes up to 0.3 mm and a few kN, at 0.5–10 Hz.
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

/// [`RigSettings`] converted for a tick rate, computed in f64. It goes over a link, so that a target without f64 gets the numbers
/// that a host computed.
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
    /// Converts the settings for `tick_rate` Hz, 1…1e6.
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

/// One tick of the rig.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Telemetry {
    /// Ticks since construction, this one included.
    pub tick: u64,
    /// Measured displacement, mm. If reading failed, the last one read.
    pub displacement: f32,
    /// Observed velocity, mm/s.
    pub velocity: f32,
    /// Measured force, kN. If reading failed, the last one read.
    pub measured_force: f32,
    /// Control inputs given to the law, in the units of its effects; 0 for an input that does not exist. If reading failed, the
    /// last ones read.
    pub controls: [f32; CONTROLS],
    /// Force of the law at the observed motion, kN.
    pub model_force: f32,
    /// Command to the actuator: mm, or kN in a damper emulation. If the actuator fails, the last one that it accepted.
    pub command: f32,
    /// Block of the programme; 0 in a damper emulation and for a stream.
    pub block: usize,
    /// Cycles completed.
    pub cycle: u32,
    /// Phase of the current cycle, 2³² per cycle; 0 for a stream.
    pub phase: u32,
    /// Whether the tick is in a ramp of the programme, or follows a stream.
    pub ramp: bool,
    /// State of the rig after this tick.
    pub state: State,
    /// The cycle that ended with this tick; always `None` for a stream.
    pub report: Option<CycleReport>,
    /// Event of the health monitor found at this tick, or shortly before together with another one. Each cause is reported once,
    /// until events are cleared. A damper emulation has no monitor, and reports only implausible temperatures, each time that they
    /// begin.
    pub event: Option<Event>,
}

impl Telemetry {
    /// Command to the actuator until the next tick.
    #[inline(always)]
    pub fn to_drive(&self) -> Command {
        Command {
            value: self.command,
            enabled: self.state == State::Running,
        }
    }
}

/// Results of one cycle, from the observed displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CycleReport {
    /// Block of the programme; 0 in a damper emulation.
    pub block: usize,
    /// Number of the cycle, from 0.
    pub cycle: u32,
    /// Whether it is a ramp of the programme.
    pub ramp: bool,
    /// Results with the measured force.
    pub measured: Cycle,
    /// Results with the law's force.
    pub model: Cycle,
    /// RMS of the law's error divided by the RMS of the measured force; 0 where there was no force, [`f32::MAX`] where the error's
    /// square exceeds a float.
    pub nrmse: f32,
    /// Adaptation to slow changes of the specimen: relative difference between the running law and the law as given. 0 without
    /// adaptation, and in a damper emulation.
    pub followed: Adaptation,
}

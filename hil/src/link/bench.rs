//! The rig wired up: parts, sensors and actuator on one side, the crate's controller on the other.

use std::cell::Cell;
use std::rc::Rc;

use mesh_damper::adc::Ads8688;
use mesh_damper::converter::Scale;
use mesh_damper::dac::{Ad5761, OUTPUT_RANGE};
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::rig::{Rig, RigSettings, Telemetry};
use mesh_damper::sine::Programme;
use mesh_damper::tabulated::{RunningLaw, TabulatedLaw};

use super::expected::expected;
use crate::actuator::{
    AdcPins, DacPins, InvalidField, Sensor, SensorConfig, Servo, ServoConfig, SimulatedAd5761,
    SimulatedAds8688, SimulatedEnable, enable_line,
};
use crate::specimen::DamperForce;

/// A setup that one of its parts refused.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// By the crate.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// By a simulated part.
    #[error(transparent)]
    Part(#[from] InvalidField),
    /// A simulated converter did not answer its driver.
    #[error("a simulated converter did not answer its driver: {0}")]
    Converter(String),
}

/// A test of a specimen, everything about it public and changeable before it runs.
#[derive(Clone, Debug)]
pub struct RigSetup<S, const B: usize, const N: usize> {
    /// What is tested.
    pub specimen: S,
    /// The law that runs beside it.
    pub law: AugmentedLaw<f32, N>,
    /// Eq 13's coefficients for each block, where they are tabulated over amplitude; the law's own where there is none.
    /// They take over within the ramp into their block.
    pub block_laws: Vec<Law<f32>>,
    /// The excitation; its tick rate is that of everything.
    pub programme: Programme<B>,
    /// Of the sensors' noise. The same seed gives the same run, bit for bit.
    pub seed: u64,
    /// The actuator.
    pub servo: ServoConfig,
    /// The displacement channel.
    pub displacement_sensor: SensorConfig,
    /// The force channel.
    pub force_sensor: SensorConfig,
    /// Command at the DAC's full scale, mm.
    pub command_range: f64,
    /// The controller's settings.
    pub settings: RigSettings,
    /// Every how many ticks a sample is recorded.
    pub record_every: u64,
}

/// Noise of the force channel, as part of the RMS of the largest block's expected force.
const FORCE_NOISE: f64 = 0.004;
/// Lag of both sensors, s: equal, as skew between them would look like damping.
const SENSOR_LAG: f64 = 1.5e-4;
/// The load cell's range is chosen this many times the expected peak.
const FORCE_MARGIN: f64 = 2.0;

impl<S: DamperForce + Clone, const B: usize, const N: usize> RigSetup<S, B, N> {
    /// The usual rig: ±1 mm and 1e-4 mm of noise in displacement, a load cell chosen for the force that the specimen
    /// is expected to give, with 0.4 % of its RMS as noise, one sample in ten recorded.
    pub fn new(specimen: S, law: AugmentedLaw<f32, N>, programme: Programme<B>, seed: u64) -> Self {
        let force = expected(&specimen, &programme);
        let range = (FORCE_MARGIN * force.peak).max(1e-3);
        Self {
            specimen,
            law,
            block_laws: Vec::new(),
            programme,
            seed,
            servo: ServoConfig::default(),
            displacement_sensor: SensorConfig {
                full_scale: 1.0,
                noise: 1e-4,
                offset: 0.0,
                lag: SENSOR_LAG,
            },
            force_sensor: SensorConfig {
                full_scale: range,
                noise: FORCE_NOISE * force.rms,
                offset: 0.0,
                lag: SENSOR_LAG,
            },
            command_range: 1.0,
            settings: RigSettings {
                force_limit: 0.95 * range,
                lead: 9e-3,
                ..RigSettings::default()
            },
            record_every: 10,
        }
    }
}

/// The crate's controller on the simulated parts.
pub type SimulatedRig<const B: usize, const N: usize> =
    Rig<SimulatedAds8688, SimulatedAd5761, SimulatedEnable, B, N>;

/// A rig wired up, at rest. Everything is public, so that a test can have any of it fail.
#[derive(Debug)]
pub struct Bench<S, const B: usize, const N: usize> {
    /// The crate's controller.
    pub rig: SimulatedRig<B, N>,
    /// The actuator with the specimen.
    pub servo: Servo<S>,
    /// The displacement channel.
    pub displacement_sensor: Sensor,
    /// The force channel.
    pub force_sensor: Sensor,
    /// The ADC's analogue side.
    pub adc: Rc<AdcPins>,
    /// The DAC's analogue side.
    pub dac: Rc<DacPins>,
    /// Level of the enable line.
    pub enabled: Rc<Cell<bool>>,
    millimetres_per_volt: f64,
}

impl<S: DamperForce + Clone, const B: usize, const N: usize> Bench<S, B, N> {
    /// Wires up `setup`.
    ///
    /// # Errors
    /// What one of the parts refuses.
    pub fn new(setup: RigSetup<S, B, N>) -> Result<Self, SetupError> {
        let step = 1.0 / setup.programme.tick_rate();
        let (adc, dac) = (Rc::<AdcPins>::default(), Rc::<DacPins>::default());
        let (enable, enabled) = enable_line();
        let rig = Rig::new(
            connect_adc(
                &adc,
                setup.displacement_sensor.full_scale,
                setup.force_sensor.full_scale,
            )?,
            connect_dac(&dac, setup.command_range)?,
            enable,
            &setup.settings,
            setup.programme,
            RunningLaw::new(TabulatedLaw::new(setup.law)),
        )?;
        let sensor = |config, stream| Sensor::new(config, step, setup.seed, stream);
        Ok(Self {
            rig,
            servo: Servo::new(setup.servo, step, setup.specimen)?,
            displacement_sensor: sensor(setup.displacement_sensor, 0)?,
            force_sensor: sensor(setup.force_sensor, 1)?,
            adc,
            dac,
            enabled,
            millimetres_per_volt: setup.command_range / OUTPUT_RANGE,
        })
    }

    /// One tick: the sensors' voltages, the crate's tick, and the actuator's way until the next.
    pub fn tick(&mut self) -> Telemetry {
        let [displacement, force, ..] = &self.adc.volts;
        displacement.set(self.displacement_sensor.sample(self.servo.displacement()));
        force.set(self.force_sensor.sample(self.servo.force()));
        self.rig
            .set_temperature(self.servo.specimen().temperature() as f32);
        let telemetry = self.rig.tick();
        let command = self.dac.volts.get() * self.millimetres_per_volt;
        self.servo.advance(command, self.enabled.get());
        telemetry
    }
}

pub(super) fn connect_adc(
    pins: &Rc<AdcPins>,
    displacement: f64,
    force: f64,
) -> Result<Ads8688<SimulatedAds8688>, SetupError> {
    Ads8688::new(
        SimulatedAds8688::new(pins.clone()),
        Scale::new(displacement, 0.0)?,
        Scale::new(force, 0.0)?,
    )
    .map_err(|error| SetupError::Converter(format!("{error:?}")))
}

pub(super) fn connect_dac(
    pins: &Rc<DacPins>,
    range: f64,
) -> Result<Ad5761<SimulatedAd5761>, SetupError> {
    Ad5761::new(SimulatedAd5761::new(pins.clone()), Scale::new(range, 0.0)?)
        .map_err(|error| SetupError::Converter(format!("{error:?}")))
}

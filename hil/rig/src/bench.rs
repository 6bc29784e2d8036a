//! The rig wired up: parts, sensors and actuator on one side, the crate's controller on the other.

use std::cell::Cell;
use std::rc::Rc;

use mesh_damper::adc::Ads8688;
use mesh_damper::converter::Scale;
use mesh_damper::dac::Ad5761;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::pack::PackError;
use mesh_damper::rig::{Rig, RigSettings, Telemetry};
use mesh_damper::sine::Programme;
use mesh_damper_recording::error::InputError;

use super::expected::expected;
use super::plant::Plant;
use super::run::Controlled;
use crate::actuator::{
    AdcPins, DacPins, InvalidField, SensorConfig, ServoConfig, SimulatedAd5761, SimulatedAds8688,
    SimulatedEnable, enable_line,
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
    /// Of the law no coefficient pack can be made.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// The link to a controller that runs elsewhere.
    #[error(transparent)]
    Link(InputError),
    /// Who watches the run could not go on.
    #[error(transparent)]
    Watch(#[from] InputError),
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
    /// Sensors, actuator and specimen.
    pub plant: Plant<S>,
    /// The ADC's analogue side.
    pub adc: Rc<AdcPins>,
    /// The DAC's analogue side.
    pub dac: Rc<DacPins>,
    /// Level of the enable line.
    pub enabled: Rc<Cell<bool>>,
}

impl<S: DamperForce + Clone, const B: usize, const N: usize> Bench<S, B, N> {
    /// Wires up `setup`.
    ///
    /// # Errors
    /// What one of the parts refuses.
    pub fn new(setup: RigSetup<S, B, N>) -> Result<Self, SetupError> {
        let plant = Plant::new(&setup)?;
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
            RunningLaw::new(FastLaw::new(setup.law)),
        )?;
        Ok(Self {
            rig,
            plant,
            adc,
            dac,
            enabled,
        })
    }

    /// One tick: the sensors' voltages, the crate's tick, and the actuator's way until the next.
    pub fn tick(&mut self) -> Telemetry {
        let (displacement, force) = self.plant.sense();
        self.adc.volts[0].set(displacement);
        self.adc.volts[1].set(force);
        self.rig.set_temperature(self.plant.temperature() as f32);
        let telemetry = self.rig.tick();
        self.plant.advance(self.dac.volts.get(), self.enabled.get());
        telemetry
    }
}

impl<S: DamperForce + Clone, const B: usize, const N: usize> Controlled<S> for Bench<S, B, N> {
    fn plant(&self) -> &Plant<S> {
        &self.plant
    }

    fn plant_mut(&mut self) -> &mut Plant<S> {
        &mut self.plant
    }

    fn is_enabled(&self) -> bool {
        self.enabled.get()
    }

    fn start(&mut self) -> Result<(), SetupError> {
        self.rig.start();
        Ok(())
    }

    fn tick(&mut self) -> Result<Telemetry, SetupError> {
        Ok(Bench::tick(self))
    }

    fn set_law(&mut self, law: Law<f32>) -> Result<(), SetupError> {
        let mut next = self.rig.law().clone();
        next.set_law(law);
        self.rig.swap_law(next);
        Ok(())
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

//! The rig wired up: parts, sensors and actuator on one side, the crate's controller on the other.

use std::cell::Cell;
use std::rc::Rc;

use mesh_damper::adc::Ads8688;
use mesh_damper::converter::Scale;
use mesh_damper::dac::Ad5761;
use mesh_damper::effects::{AugmentedLaw, CONTROLS};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::pack::PackError;
use mesh_damper::rig::{
    AnyExciter, Rig, RigController, RigSettings, SpiActuator, StartRefused, State, Stream,
    StreamConfig, StreamSettings, Telemetry, Wiring, WithAlive, WithControls, WithReadBack,
    WithTrip,
};
use mesh_damper::sine::{Programme, SineGenerator};
use mesh_damper_output::error::InputError;

use super::drive::{Feeder, Motion};
use super::expected::{Expected, expected, expected_along};
use super::plant::Plant;
use super::run::Controlled;
use crate::actuator::{
    AdcPins, DacPins, InvalidField, SensorConfig, ServoConfig, SimulatedAd5761, SimulatedAds8688,
    SimulatedEnable, SimulatedInput, enable_line,
};
use crate::specimen::DamperForce;

/// A setup that one of its parts rejected.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The crate rejected it.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A simulated part rejected it.
    #[error(transparent)]
    Part(#[from] InvalidField),
    /// A simulated converter did not answer its driver.
    #[error("a simulated converter did not answer its driver: {0}")]
    Converter(String),
    /// A motion that demands more than the rig can do.
    #[error(transparent)]
    Drive(InputError),
    /// The law cannot be put into a coefficient pack.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// The rig does not start.
    #[error("the rig does not start: {0}")]
    Start(#[from] StartRefused),
    /// An error of the link to a controller that runs elsewhere.
    #[error(transparent)]
    Link(InputError),
    /// The observer of the run failed.
    #[error(transparent)]
    Watch(#[from] InputError),
}

/// A test of a specimen. Every field is public and can be changed before the test runs.
#[derive(Clone, Debug)]
pub struct RigSetup<S, const B: usize, const N: usize> {
    /// The specimen.
    pub specimen: S,
    /// The law that is evaluated alongside it.
    pub law: AugmentedLaw<f32, N>,
    /// Eq 13's coefficients for each block, if they are tabulated over amplitude; otherwise the law's own. They take over within
    /// the ramp into their block.
    pub block_laws: Vec<Law<f32>>,
    /// The motion on which the law was fitted, if ticks outside it are to be counted.
    pub operating_range: Option<OperatingRange<f32>>,
    /// The excitation. Its tick rate is that of all parts.
    pub programme: Programme<B>,
    /// A motion to follow in place of the programme's blocks, on a grid of the programme's tick rate.
    pub drive: Option<Motion>,
    /// The limits that the rig enforces for a motion; the motion gives the ticks from knot to knot.
    pub stream: StreamSettings,
    /// Seed of the sensors' noise. The same seed gives the same run, bit for bit.
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
    /// Number of ticks between recorded samples.
    pub record_every: u64,
}

/// Noise of the force channel, as a part of the RMS of the largest block's expected force.
const FORCE_NOISE: f64 = 0.004;
/// Lag of both sensors, s: equal, because skew between them would look like damping.
const SENSOR_LAG: f64 = 1.5e-4;
/// Ratio of the load cell's range to the expected peak.
const FORCE_MARGIN: f64 = 2.0;

impl<S: DamperForce + Clone, const B: usize, const N: usize> RigSetup<S, B, N> {
    /// The usual rig: ±1 mm and 1e-4 mm of noise in displacement, a load cell chosen for the specimen's expected force with 0.4 %
    /// of its RMS as noise, and one sample recorded in ten.
    pub fn new(specimen: S, law: AugmentedLaw<f32, N>, programme: Programme<B>, seed: u64) -> Self {
        let force = expected(&specimen, &programme);
        Self::expecting(force, specimen, law, programme, seed)
    }

    /// The same, with `motion` in place of a programme's blocks.
    ///
    /// # Errors
    /// A tick rate that the crate rejects.
    pub fn driven(
        specimen: S,
        law: AugmentedLaw<f32, N>,
        motion: Motion,
        seed: u64,
    ) -> Result<Self, ConfigError> {
        let programme = Programme::new(motion.grid().tick_rate(), 1)?;
        let force = expected_along(&specimen, &motion);
        let mut setup = Self::expecting(force, specimen, law, programme, seed);
        setup.stream.knot_ticks = motion.grid().knot_ticks();
        setup.drive = Some(motion);
        Ok(setup)
    }

    /// The limits and settings of a streamed motion.
    ///
    /// # Errors
    /// A limit that the crate rejects.
    pub fn stream_config(&self) -> Result<StreamConfig, ConfigError> {
        StreamSettings {
            displacement_limit: self.settings.displacement_limit,
            ..self.stream
        }
        .at(self.programme.tick_rate())
    }

    fn expecting(
        force: Expected,
        specimen: S,
        law: AugmentedLaw<f32, N>,
        programme: Programme<B>,
        seed: u64,
    ) -> Self {
        let range = (FORCE_MARGIN * force.peak).max(1e-3);
        Self {
            specimen,
            law,
            block_laws: Vec::new(),
            operating_range: None,
            programme,
            drive: None,
            stream: StreamSettings::default(),
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

/// The sensors of a [`SimulatedRig`], with an active-low stop input.
pub type SimulatedSensors = WithTrip<WithControls<Ads8688<SimulatedAds8688>>, SimulatedInput>;

/// The actuator of a [`SimulatedRig`], with an enable line that is read back and an alive signal.
pub type SimulatedActuator = WithAlive<
    WithReadBack<SpiActuator<SimulatedAd5761, SimulatedEnable>, SimulatedInput>,
    SimulatedEnable,
>;

/// The crate's controller on the simulated parts.
pub type SimulatedRig<const B: usize, const N: usize> =
    Rig<SimulatedSensors, SimulatedActuator, N, AnyExciter<B>>;

/// A wired rig, at rest. Every field is public, so that a test can make any part fail.
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
    /// Level of the enable line, which the rig reads back.
    pub enabled: Rc<Cell<bool>>,
    /// While set, the enable line keeps its level.
    pub stuck: Rc<Cell<bool>>,
    /// Level of the alive signal, for an external watchdog.
    pub alive: Rc<Cell<bool>>,
    /// Level of the stop input, which is active low.
    well: Rc<Cell<bool>>,
    /// The source of the rig's motion; remove it to simulate a host that falls silent.
    pub feeder: Option<Feeder>,
}

impl<S: DamperForce + Clone, const B: usize, const N: usize> Bench<S, B, N> {
    /// Wires up `setup`.
    ///
    /// # Errors
    /// The error of a part that rejects its settings.
    pub fn new(setup: RigSetup<S, B, N>) -> Result<Self, SetupError> {
        let plant = Plant::new(&setup)?;
        let (adc, dac) = (Rc::<AdcPins>::default(), Rc::<DacPins>::default());
        let (enable, enabled) = enable_line();
        let stuck = enable.stuck();
        let (signal, alive) = enable_line();
        let well = Rc::new(Cell::new(true));
        let config = setup.settings.at(setup.programme.tick_rate())?;
        let exciter = match &setup.drive {
            Some(_) => AnyExciter::Stream(Stream::new(setup.stream_config()?)),
            None => AnyExciter::Programme(SineGenerator::new(setup.programme)?),
        };
        let converter = connect_adc(
            &adc,
            setup.displacement_sensor.full_scale,
            setup.force_sensor.full_scale,
        )?;
        let [displacement, force] = converter.scales();
        let wiring = Wiring {
            displacement,
            force,
            command: Scale::new(setup.command_range, 0.0)?,
        };
        let law = RunningLaw::new(FastLaw::new(setup.law));
        let sensors = WithControls {
            sensors: converter,
            controls: [0.0; CONTROLS],
        };
        let actuator = SpiActuator::new(connect_dac(&dac, wiring.command)?, enable);
        let actuator = WithReadBack::new(actuator, SimulatedInput(enabled.clone()));
        let rig = Rig::wire(
            RigController::with_exciter(&config, &wiring, exciter, law),
            WithTrip::new(sensors, SimulatedInput(well.clone())),
            WithAlive::new(actuator, signal),
        );
        Ok(Self {
            rig,
            plant,
            adc,
            dac,
            enabled,
            stuck,
            alive,
            well,
            feeder: setup.drive.as_ref().map(Feeder::new),
        })
    }

    /// One tick: the sensors' voltages and the control inputs, the crate's tick, and the actuator until the next tick.
    pub fn tick(&mut self) -> Telemetry {
        self.feed();
        let (displacement, force) = self.plant.sense();
        self.adc.volts[0].set(displacement);
        self.adc.volts[1].set(force);
        self.wire_trip();
        self.rig.sensors().sensors.controls = self.plant.shown_controls();
        let temperature = self.plant.shown_temperature();
        self.rig.set_temperature(temperature);
        let telemetry = self.rig.tick(self.plant.clock);
        self.plant.drive(self.dac.volts.get(), self.enabled.get());
        telemetry
    }

    /// Sets the level of the emergency stop to that of the plant.
    fn wire_trip(&self) {
        self.well.set(!self.plant.tripped);
    }

    /// Gives the knots that the next tick needs. A stopped rig takes none from its queue.
    fn feed(&mut self) {
        if self.rig.state() != State::Running {
            return;
        }
        if let (Some(feeder), Some(stream)) = (&mut self.feeder, self.rig.exciter().stream()) {
            while let Some(knots) = feeder.due() {
                if knots.is_empty() {
                    stream.complete();
                }
                for knot in knots {
                    stream.push(*knot);
                }
            }
            feeder.tick();
        }
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
        self.wire_trip();
        self.rig.start()?;
        if let Some(feeder) = &mut self.feeder {
            feeder.restart();
        }
        Ok(())
    }

    fn exchange(&mut self) {
        self.rig.exchange();
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
    .map_err(|error| SetupError::Converter(error.to_string()))
}

pub(super) fn connect_dac(
    pins: &Rc<DacPins>,
    scale: Scale,
) -> Result<Ad5761<SimulatedAd5761>, SetupError> {
    Ad5761::new(SimulatedAd5761::new(pins.clone()), scale)
        .map_err(|error| SetupError::Converter(error.to_string()))
}

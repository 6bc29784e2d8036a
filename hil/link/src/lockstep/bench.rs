//! A rig whose controller is an image, and whose sensors and actuator are simulated here.

use mesh_damper::converter::Scale;
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::message::{Sensors, Setup};
use mesh_damper::pack::{LARGEST, PackInfo, encode};
use mesh_damper::rig::{State, Telemetry};
use mesh_damper_rig::Controlled;
use mesh_damper_rig::Plant;
use mesh_damper_rig::actuator::{adc_code, dac_volts};
use mesh_damper_rig::drive::Feeder;
use mesh_damper_rig::specimen::DamperForce;
use mesh_damper_rig::{RigSetup, SetupError};

use super::{Image, LinkError, Wire};

/// A wired rig, at rest.
#[derive(Debug)]
pub struct ImageBench<'i, S, W, const N: usize> {
    plant: Plant<S>,
    image: &'i mut Image<W>,
    enabled: bool,
    /// Source of a motion.
    feeder: Option<Feeder>,
    state: State,
    /// The law given to the image last.
    law: FastLaw<N>,
    /// Description for its packs.
    info: PackInfo,
}

impl<'i, S: DamperForce + Clone, W: Wire, const N: usize> ImageBench<'i, S, W, N> {
    /// Wires up `setup` with `image`, which must not have a rig yet.
    ///
    /// # Errors
    /// The error of a part or of the image that rejects its settings.
    pub fn new<const B: usize>(
        setup: RigSetup<S, B, N>,
        image: &'i mut Image<W>,
    ) -> Result<Self, SetupError> {
        let plant = Plant::new(&setup)?;
        let law = FastLaw::new(setup.law.clone());
        let info = PackInfo::at(setup.programme.tick_rate() as f32);
        send(image, &law, &info)?;
        let wiring = described(&setup)?;
        match &setup.drive {
            Some(_) => image.set_up_stream(setup.stream_config()?, &wiring)?,
            None => image.set_up(&setup.programme, &wiring)?,
        }
        Ok(Self {
            plant,
            image,
            enabled: false,
            feeder: setup.drive.as_ref().map(Feeder::new),
            state: State::Idle,
            law,
            info,
        })
    }
}

impl<S, W, const N: usize> ImageBench<'_, S, W, N> {
    /// The image, for requests other than ticks.
    pub fn image(&mut self) -> &mut Image<W> {
        self.image
    }
}

/// Wiring and settings of the board of `setup`, as sent to it.
///
/// # Errors
/// A scale or a setting that the crate rejects.
pub fn described<S, const B: usize, const N: usize>(
    setup: &RigSetup<S, B, N>,
) -> Result<Setup, ConfigError> {
    let scale = |full_scale| Scale::new(full_scale, 0.0);
    Ok(Setup {
        displacement: scale(setup.displacement_sensor.full_scale)?,
        force: scale(setup.force_sensor.full_scale)?,
        command: scale(setup.command_range)?,
        config: setup.settings.at(setup.programme.tick_rate())?,
    })
}

fn send<W: Wire, const N: usize>(
    image: &mut Image<W>,
    law: &FastLaw<N>,
    info: &PackInfo,
) -> Result<(), SetupError> {
    let mut buffer = [0; LARGEST];
    image.send_pack(encode(law, info, &mut buffer)?)?;
    Ok(())
}

impl<S: DamperForce + Clone, W: Wire, const N: usize> Controlled<S> for ImageBench<'_, S, W, N> {
    fn plant(&self) -> &Plant<S> {
        &self.plant
    }

    fn plant_mut(&mut self) -> &mut Plant<S> {
        &mut self.plant
    }

    fn is_enabled(&self) -> bool {
        self.enabled
    }

    fn start(&mut self) -> Result<(), SetupError> {
        match self.image.start_rig() {
            Err(LinkError::Start(refused)) => return Err(refused.into()),
            started => started?,
        }
        self.state = State::Running;
        if let Some(feeder) = &mut self.feeder {
            feeder.restart();
        }
        Ok(())
    }

    fn tick(&mut self) -> Result<Telemetry, SetupError> {
        // A stopped rig takes no knot from its queue.
        if self.state == State::Running
            && let Some(feeder) = &mut self.feeder
        {
            while let Some(knots) = feeder.due() {
                self.image.knots(knots)?;
            }
            feeder.tick();
        }
        let (displacement, force) = self.plant.sense();
        let outcome = self.image.tick(Sensors {
            displacement: adc_code(displacement),
            force: adc_code(force),
            temperature: self.plant.shown_temperature(),
            controls: self.plant.shown_controls(),
            clock: self.plant.clock,
            tripped: self.plant.tripped,
        })?;
        self.enabled = outcome.enabled;
        self.state = outcome.telemetry.state;
        self.plant.drive(dac_volts(outcome.code), outcome.enabled);
        Ok(outcome.telemetry)
    }

    fn set_law(&mut self, law: Law<f32>) -> Result<(), SetupError> {
        self.law.set_law(law);
        send(self.image, &self.law, &self.info)
    }
}

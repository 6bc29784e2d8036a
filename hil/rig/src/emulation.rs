//! The crate as a damper emulation: a prescribed motion in, its force out.

use std::cell::Cell;
use std::rc::Rc;

use mesh_damper::converter::Scale;
use mesh_damper::dac::OUTPUT_RANGE;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::rig::{DamperEmulation, DamperEmulationSettings, SpiDamperEmulation, Telemetry};

use super::bench::{SetupError, connect_adc, connect_dac};
use crate::actuator::{
    AdcPins, DacPins, Sensor, SensorConfig, SimulatedAd5761, SimulatedAds8688, SimulatedEnable,
    enable_line,
};

/// Setup of a damper emulation.
#[derive(Clone, Debug)]
pub struct EmulatorSetup<const N: usize> {
    /// The law of the damper.
    pub law: AugmentedLaw<f32, N>,
    /// The crate's settings.
    pub settings: DamperEmulationSettings,
    /// The displacement channel.
    pub displacement_sensor: SensorConfig,
    /// Force at the full scale of the DAC and of the force channel, kN.
    pub force_range: f64,
    /// Seed of the sensor's noise.
    pub seed: u64,
}

impl<const N: usize> EmulatorSetup<N> {
    /// With the crate's default settings: ±1 mm, read without noise, offset or lag, and ±5 kN.
    pub fn new(law: AugmentedLaw<f32, N>) -> Self {
        Self {
            law,
            settings: DamperEmulationSettings::default(),
            displacement_sensor: SensorConfig {
                full_scale: 1.0,
                noise: 0.0,
                offset: 0.0,
                lag: 0.0,
            },
            force_range: 5.0,
            seed: 1,
        }
    }
}

/// A wired damper emulation. The force channel measures the DAC's output, as an ideal force actuator would deliver it.
#[derive(Debug)]
pub struct EmulatorBench<const N: usize> {
    /// The crate's controller.
    pub emulator:
        SpiDamperEmulation<SimulatedAds8688, SimulatedAd5761, SimulatedEnable, RunningLaw<N>>,
    /// The displacement channel.
    pub displacement_sensor: Sensor,
    /// The ADC's analogue side.
    pub adc: Rc<AdcPins>,
    /// The DAC's analogue side.
    pub dac: Rc<DacPins>,
    /// Level of the enable line.
    pub enabled: Rc<Cell<bool>>,
    /// Reading of an independent clock, in ticks; wraps.
    pub clock: u32,
    force_range: f64,
}

/// One tick of an emulation.
#[derive(Clone, Copy, Debug)]
pub struct Emulation {
    /// Telemetry of the crate.
    pub telemetry: Telemetry,
    /// Force that the DAC drives after the tick, kN.
    pub force: f64,
}

impl<const N: usize> EmulatorBench<N> {
    /// Wires up `setup`.
    ///
    /// # Errors
    /// The error of a part that rejects its settings.
    pub fn new(setup: EmulatorSetup<N>) -> Result<Self, SetupError> {
        let (adc, dac) = (Rc::<AdcPins>::default(), Rc::<DacPins>::default());
        let (enable, enabled) = enable_line();
        Ok(Self {
            emulator: DamperEmulation::new(
                connect_adc(
                    &adc,
                    setup.displacement_sensor.full_scale,
                    setup.force_range,
                )?,
                connect_dac(&dac, Scale::new(setup.force_range, 0.0)?)?,
                enable,
                &setup.settings,
                RunningLaw::new(FastLaw::new(setup.law)),
            )?,
            displacement_sensor: Sensor::new(
                setup.displacement_sensor,
                1.0 / setup.settings.tick_rate,
                setup.seed,
                0,
            )?,
            adc,
            dac,
            enabled,
            clock: 0,
            force_range: setup.force_range,
        })
    }

    /// One tick at `displacement` mm.
    pub fn tick(&mut self, displacement: f64) -> Emulation {
        let part = self.dac.volts.get() / OUTPUT_RANGE;
        let [displacement_volts, force_volts, ..] = &self.adc.volts;
        displacement_volts.set(self.displacement_sensor.sample(displacement));
        force_volts.set(part * mesh_damper::adc::INPUT_RANGE);
        let telemetry = self.emulator.tick(self.clock);
        self.clock = self.clock.wrapping_add(1);
        Emulation {
            telemetry,
            force: self.dac.volts.get() / OUTPUT_RANGE * self.force_range,
        }
    }
}

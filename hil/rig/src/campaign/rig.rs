//! The rig of a trial.

use std::cell::Cell;
use std::f64::consts::TAU;
use std::rc::Rc;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme};

use super::action::{Action, FULL_SCALE, HealthyRig, Running};
use super::damage::{Condition, Damaged};
use super::hazard::Allowed;
use super::trial::{BLOCKS, Close, RAMP, TRACKING, Trial};
use crate::{RigSetup, SetupError, TICK_RATE};

/// Number of ticks in which the command of a rig with close limits goes to 0 after a stop.
const STOP_TICKS: u32 = 500;
/// Number of ticks after which a silent link stops it.
const LINK_TICKS: u32 = 200;

/// The rig of a trial, with data for its evaluation.
pub(super) struct Prepared {
    pub(super) setup: RigSetup<Damaged, BLOCKS, 1>,
    pub(super) condition: Rc<Cell<Condition>>,
    pub(super) healthy: HealthyRig,
    pub(super) allowed: Allowed,
    pub(super) changes: Vec<Running>,
}

impl Trial {
    pub(super) fn prepare(&self) -> Result<Prepared, SetupError> {
        let (specimen, condition) = Damaged::new(self.density, self.amplitude);
        let force = peak(&specimen, self.amplitude, self.frequency);
        let blocks = self.blocks.iter();
        let blocks: Vec<_> = blocks.map(|&cycles| (self.amplitude, cycles)).collect();
        let settings = (self.noise, self.follow);
        let mut setup = setup(specimen, &blocks, self.frequency, settings, self.seed)?;
        let settings = &mut setup.settings;
        settings.health.run_in_cycles = self.run_in;
        if let Some(Close { headroom, range }) = self.close {
            settings.displacement_limit = headroom.displacement * self.amplitude;
            settings.force_limit = headroom.force * force;
            settings.tracking_limit = headroom.tracking * TRACKING * self.amplitude;
            settings.stop_ticks = STOP_TICKS;
            settings.link_ticks = LINK_TICKS;
            setup.force_sensor.full_scale = range * settings.force_limit;
        }
        let limits = [
            settings.displacement_limit,
            settings.force_limit,
            settings.tracking_limit,
        ];
        let allowed = Allowed {
            limits,
            trip_ticks: settings.trip_ticks,
            cycle_ticks: self.cycle_ticks().round() as usize,
            units: [
                setup.displacement_sensor.full_scale / FULL_SCALE,
                setup.force_sensor.full_scale / FULL_SCALE,
            ],
        };
        let healthy = HealthyRig {
            amplitude: self.amplitude,
            frequency: self.frequency,
            force,
            tick: 1.0 / TICK_RATE,
            units: allowed.units,
            limits: [limits[0], limits[1]],
        };
        let changes = self.changes.iter().map(|&change| {
            let from = self.tick(change.begins);
            let over = change.lasts.map(|lasts| lasts * self.cycle_ticks());
            let to = over.map(|ticks| from + ticks.ceil() as u64);
            Running::new(change, from, to, &healthy)
        });
        let changes: Vec<Running> = changes.collect();
        let scales = changes.iter().filter_map(|change| match change.action {
            Action::Law(scale) => Some(scale),
            _ => None,
        });
        setup.law = law(&setup.specimen, scales.product())?;
        Ok(Prepared {
            setup,
            condition,
            healthy,
            allowed,
            changes,
        })
    }
}

/// Noise of the force channel as [`RigSetup::new`] sets it, divided by the RMS of the force.
const USUAL_NOISE: f64 = 0.004;

/// The rig that tests `specimen` at `frequency` Hz in blocks of these amplitudes in mm and cycles, with `noise` and `follow` as in
/// [`Trial`].
pub(super) fn setup<const B: usize>(
    specimen: Damaged,
    blocks: &[(f64, u32)],
    frequency: f64,
    (noise, follow): (f64, f64),
    seed: u64,
) -> Result<RigSetup<Damaged, B, 1>, SetupError> {
    let law = law(&specimen, 1.0)?;
    let mut programme = Programme::new(TICK_RATE, RAMP)?;
    for &(amplitude, cycles) in blocks {
        programme = programme.with(Block::sine(amplitude, frequency, cycles)?)?;
    }
    let mut setup = RigSetup::new(specimen, law, programme, seed);
    setup.force_sensor.noise *= noise / USUAL_NOISE;
    setup.settings.health.follow = follow;
    Ok(setup)
}

/// The law of a new specimen, with its force multiplied by `scale`.
fn law(specimen: &Damaged, scale: f64) -> Result<AugmentedLaw<f32, 1>, ConfigError> {
    let c = specimen.coefficients();
    let [k1, k3, friction] = [c.k1, c.k3, c.c].map(|value| (scale * value) as f32);
    Ok(AugmentedLaw::new(Law::new(
        k1,
        k3,
        friction,
        c.alpha as f32,
    )?))
}

/// Largest force of a sine, kN.
pub(super) fn peak(specimen: &Damaged, amplitude: f64, frequency: f64) -> f64 {
    let w = TAU * frequency;
    (0..1000)
        .map(|step| {
            let (sin, cos) = (TAU * f64::from(step) / 1000.0).sin_cos();
            let force = specimen
                .coefficients()
                .force(amplitude * sin, amplitude * w * cos);
            force.abs()
        })
        .fold(0.0, f64::max)
}

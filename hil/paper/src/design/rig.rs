//! A design on the simulated rig: a specimen of that density in cycles of that amplitude, and the results of the crate's
//! accumulator.

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::rig::CycleReport;
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{RigRun, RigSetup, SetupError, TICK_RATE, run_rig};
use serde::Serialize;

use super::{DesignError, Point, Source};

/// Cycles at full amplitude.
const CYCLES: u32 = 6;
/// Cycles of each ramp.
const RAMP_CYCLES: u32 = 2;

/// Means over the steady cycles of a run on the rig.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OnRig {
    /// Number of cycles averaged.
    pub cycles: usize,
    /// Amplitude that the actuator reached, mm.
    pub amplitude: f64,
    /// Dynamic stiffness K of the specimen, measured with the sensors' noise, kN/mm.
    pub stiffness: f64,
    /// Loss factor η of the specimen, measured in the same way.
    pub loss_factor: f64,
    /// K of the crate's law on the same measured motion, kN/mm.
    pub model_stiffness: f64,
    /// η of the crate's law on the same measured motion.
    pub model_loss_factor: f64,
}

/// Runs `point` on the rig at `frequency` Hz, a specimen and a law with the coefficients of `source`.
///
/// # Errors
/// The rig cannot be set up, or it stops at a limit.
pub fn on_rig(point: &Point, source: Source, frequency: f64) -> Result<OnRig, DesignError> {
    let law = source.coefficients(point.density, point.amplitude);
    let refused = |error: ConfigError| SetupError::from(error);
    let beside = Law::<f64>::new(law.k1, law.k3, law.c, law.alpha).map_err(refused)?;
    let block = Block::sine(point.amplitude, frequency, CYCLES).map_err(refused)?;
    let programme = Programme::<1>::new(TICK_RATE, RAMP_CYCLES)
        .and_then(|programme| programme.with(block))
        .map_err(refused)?;
    let setup: RigSetup<Specimen, 1, 0> = RigSetup::new(
        Specimen::new(law),
        AugmentedLaw::new(beside.cast()),
        programme,
        1,
    );
    let run = run_rig(setup, |_| ())?;
    match run.faults.first() {
        Some(&(time, fault)) => Err(DesignError::Stopped { time, fault }),
        None => Ok(means(&run)),
    }
}

fn means(run: &RigRun) -> OnRig {
    let cycles: Vec<&CycleReport> = run.steady_cycles(0).collect();
    let mean = |of: fn(&CycleReport) -> f32| {
        cycles
            .iter()
            .map(|&cycle| f64::from(of(cycle)))
            .sum::<f64>()
            / cycles.len() as f64
    };
    OnRig {
        cycles: cycles.len(),
        amplitude: mean(|cycle| cycle.measured.amplitude),
        stiffness: mean(|cycle| cycle.measured.stiffness),
        loss_factor: mean(|cycle| cycle.measured.loss_factor),
        model_stiffness: mean(|cycle| cycle.model.stiffness),
        model_loss_factor: mean(|cycle| cycle.model.loss_factor),
    }
}

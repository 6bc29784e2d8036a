//! Whether a model can belong to the specimen and the motion of `hil run`.

use std::f64::consts::TAU;
use std::path::Path;

use mesh_damper::sine::{Block, Programme};
use mesh_damper_model::extrapolation::Extrapolation;
use mesh_damper_model::file::FittedRange;
use mesh_damper_rig::RigRun;
use schemars::JsonSchema;
use serde::Serialize;

use super::drive::Driven;
use super::programme::MOST_BLOCKS;

/// Largest error of a law, RMS over the RMS of the measured force, at which the model is taken to describe the specimen. Derived: a
/// law with half of the measured force everywhere has this error, and a law with twice the force has twice this error. Laws that
/// lack one effect have errors of up to 0.28 (`docs/errors.md`).
const MOST_ERROR: f64 = 0.5;
/// Number of steady cycles over which the error is averaged. Convention: enough that one disturbed cycle does not decide, and few
/// enough that nothing has changed slowly.
const FIRST_CYCLES: usize = 3;

/// The error of the law at the beginning of the run.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize)]
pub struct FirstError {
    /// Number of steady cycles averaged; 0 if no cycle was separated, and the whole recording is used.
    cycles: usize,
    /// RMS of the law's error over the RMS of the measured force.
    nrmse: f64,
    /// Largest NRMSE at which the model is taken to describe the specimen.
    limit: f64,
}

impl FirstError {
    /// The first error of `run`; `None` if no force was measured.
    pub fn of(run: &RigRun) -> Option<Self> {
        let steady = run.cycles.iter().filter(|cycle| !cycle.ramp);
        let errors: Vec<f64> = steady
            .take(FIRST_CYCLES)
            .map(|cycle| cycle.nrmse.into())
            .collect();
        let nrmse = match errors.len() {
            0 => of_all(run)?,
            count => errors.iter().sum::<f64>() / count as f64,
        };
        Some(Self {
            cycles: errors.len(),
            nrmse,
            limit: MOST_ERROR,
        })
    }

    /// The warning if the law of the file `model` has too large an error.
    pub fn in_words(&self, model: &Path) -> Option<String> {
        let over = match self.cycles {
            0 => "the recording".to_owned(),
            cycles => format!("the first {cycles} steady cycles"),
        };
        (self.nrmse > self.limit).then(|| {
            format!(
                "{} does not fit this specimen: over {over} the error of its force is {:.0} % of the measured force's RMS ({:.0} % means a \
                 factor of 2): give the model that was traced from this specimen",
                model.display(),
                100.0 * self.nrmse,
                100.0 * self.limit
            )
        })
    }
}

/// RMS of the law's error over the RMS of the measured force, over all samples.
fn of_all(run: &RigRun) -> Option<f64> {
    let samples = &run.samples;
    let pairs = samples.model_force.iter().zip(&samples.force);
    let (error, force) = pairs.fold((0.0, 0.0), |(error, force), (law, measured)| {
        (
            error + (law - measured) * (law - measured),
            force + measured * measured,
        )
    });
    (force > 0.0).then(|| f64::sqrt(error / force))
}

/// The part of the requested motion outside the operating range `range`.
pub fn outside(
    range: &FittedRange,
    programme: Option<&Programme<MOST_BLOCKS>>,
    driven: Option<&Driven>,
) -> Extrapolation {
    let blocks = programme
        .into_iter()
        .flat_map(Programme::blocks)
        .map(of_block);
    let knots = driven.into_iter().flat_map(|driven| driven.motion.knots());
    let knots = knots.map(|knot| FittedRange {
        displacement: [knot.displacement.into(); 2],
        velocity: [knot.velocity.into(); 2],
    });
    Extrapolation::of_motions(range, blocks.chain(knots))
}

/// The motion of a block, at the faster of its beginning and end.
fn of_block(block: &Block) -> FittedRange {
    let amplitude = block.amplitude();
    let speed = TAU * block.from().max(block.to()) * amplitude;
    FittedRange {
        displacement: [-amplitude, amplitude],
        velocity: [-speed, speed],
    }
}

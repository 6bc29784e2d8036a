//! Whether a model and what `hil run` tests can be meant for each other.

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

/// A law that errs by more than this, RMS over the measured force's, is taken for that of another specimen. Derived: a law with half of
/// the measured force throughout errs by this much, one with twice the force by twice as much. Laws that lack one effect err by up to
/// 0.28 (`docs/errors.md`).
const MOST_ERROR: f64 = 0.5;
/// Steady cycles over which that is taken. Convention: enough that one that is disturbed does not decide, and before anything has
/// changed slowly.
const FIRST_CYCLES: usize = 3;

/// How far the law was off at first.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize)]
pub struct FirstError {
    /// Steady cycles that it is the mean of; 0 where none was told apart, and all that was recorded counts.
    cycles: usize,
    /// RMS of the law's error over the RMS of the measured force.
    nrmse: f64,
    /// Above this NRMSE the model is taken for that of another specimen.
    limit: f64,
}

impl FirstError {
    /// Of `run`; none where no force was measured.
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

    /// What to warn of, where the law of the file `model` is too far off.
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

/// RMS of the law's error over that of the measured force, over all samples.
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

/// What of the motion that is asked for lies outside the operating range `range`.
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

/// The motion of a block: at its end or its beginning, whichever is faster.
fn of_block(block: &Block) -> FittedRange {
    let amplitude = block.amplitude();
    let speed = TAU * block.from().max(block.to()) * amplitude;
    FittedRange {
        displacement: [-amplitude, amplitude],
        velocity: [-speed, speed],
    }
}

//! How fast the harness runs the crate, on this machine's clock.

use std::time::Instant;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::sine::{Block, Programme};
use mesh_damper::table::PAPER;
use mesh_damper_output::error::InputError;
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{Bench, RigSetup, SetupError, TICK_RATE};

use super::results::Rate;

/// Ticks of a timed batch.
const TICKS: u32 = 300_000;
/// The fastest batch counts: other load on the machine can only slow one down.
const BATCHES: u32 = 10;
/// mm
const AMPLITUDE: f64 = 0.1;
/// g/cm³
const DENSITY: f64 = 3.0;

impl Rate {
    /// A rate: `count` items in the time since `start`.
    pub(super) fn since(name: &'static str, start: Instant, count: u32) -> Self {
        let per_second = f64::from(count) / start.elapsed().as_secs_f64();
        Self {
            name,
            per_second,
            times_real_time: per_second / TICK_RATE,
        }
    }
}

/// Ticks of the rig in this process, with sensors, actuator and specimen.
///
/// # Errors
/// The rig cannot be set up, or it stops.
pub fn in_process() -> Result<Rate, InputError> {
    let failed =
        |problem: String| InputError::new("the rig in this process", problem, "report this");
    let mut bench = bench().map_err(|error| failed(error.to_string()))?;
    bench
        .rig
        .start()
        .map_err(|refused| failed(refused.to_string()))?;
    let mut batch = || {
        let start = Instant::now();
        for _ in 0..TICKS {
            bench.tick();
        }
        Rate::since("ticks in process", start, TICKS)
    };
    let mut rate = batch();
    for _ in 1..BATCHES {
        let other = batch();
        if other.per_second > rate.per_second {
            rate = other;
        }
    }
    match bench.rig.state() {
        mesh_damper::rig::State::Running => Ok(rate),
        state => Err(failed(format!("it is {state:?} and not running"))),
    }
}

fn bench() -> Result<Bench<Specimen, 1, 1>, SetupError> {
    // Longer than the run.
    let block = Block::sine(AMPLITUDE, 5.0, 10 * BATCHES * TICKS)?;
    let programme = Programme::new(TICK_RATE, 1)?.with(block)?;
    let law = AugmentedLaw::new(PAPER.lookup(DENSITY as f32, AMPLITUDE as f32).law);
    Bench::new(RigSetup::new(
        Specimen::of_density(DENSITY, AMPLITUDE),
        law,
        programme,
        1,
    ))
}

//! The size of the firmware's image, and its speed in lockstep.

use std::path::Path;
use std::time::Instant;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme};
use mesh_damper::table::PAPER;
use mesh_damper_firmware::bench::suite::{Refused, effects};
use mesh_damper_link::image::{Board, FIRMWARE, build, sections};
use mesh_damper_link::lockstep::Image;
use mesh_damper_link::lockstep::run_rig_on;
use mesh_damper_model::MAX_EFFECTS;
use mesh_damper_output::error::InputError;
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{RigRun, RigSetup, SetupError, TICK_RATE};

use super::results::{Rate, Size};
use super::sizes;

/// The name of the sizes.
pub const NAME: &str = "firmware";
/// The name of the round trips.
const ROUND_TRIPS: &str = "round trips with the image";

/// g/cm³ and mm
const DENSITY: f64 = 3.0;
const AMPLITUDE: f64 = 0.1;
/// Timed runs. The fastest counts: other load on the machine can only slow one down.
const RUNS: usize = 3;

type Setup = RigSetup<Specimen, 2, MAX_EFFECTS>;

/// Sizes of the image; its stack after a test with ramps, ends of cycles, as many effects as a law holds, and a law swapped; and
/// the round trips of a test with the mixed damping law alone.
///
/// # Errors
/// An error of the compiler or the emulator, or a test that stops.
pub fn measure(board: Board) -> Result<(Vec<Size>, Rate), InputError> {
    let elf = build(&FIRMWARE, board)?;
    let mut sizes = of_image(&elf)?;
    let (_, stack, _) = run(board, every_effect().map_err(|_| failed("it is refused"))?)?;
    sizes.push(size("stack", u64::from(stack)));
    let mut fastest: Option<Rate> = None;
    for _ in 0..RUNS {
        let (ran, _, start) = run(board, eq_13().map_err(|_| failed("it is refused"))?)?;
        let rate = Rate::since(ROUND_TRIPS, start, ran.ticks as u32);
        if fastest
            .as_ref()
            .is_none_or(|fastest| rate.per_second > fastest.per_second)
        {
            fastest = Some(rate);
        }
    }
    Ok((sizes, fastest.ok_or_else(|| failed("it was not run"))?))
}

fn failed(problem: &str) -> InputError {
    InputError::new("the firmware's test", problem, "report this")
}

fn size(of: &'static str, bytes: u64) -> Size {
    Size {
        name: NAME.into(),
        of,
        bytes,
    }
}

fn of_image(elf: &Path) -> Result<Vec<Size>, InputError> {
    let taken = sections(elf)?;
    Ok(vec![
        size("flash", taken.flash),
        size("RAM", taken.ram),
        size("panicking code", sizes::of_panics(elf)?),
    ])
}

/// A test, the stack's high-water mark after it, and its start.
fn run(board: Board, setup: Setup) -> Result<(RigRun, u32, Instant), InputError> {
    let mut image = Image::start(board, Box::new(|_| ()))?;
    let start = Instant::now();
    let run = run_rig_on(&mut image, setup, |_| ()).map_err(|error| match error {
        SetupError::Link(error) => error,
        error => failed(&error.to_string()),
    })?;
    if let Some((_, fault)) = run.faults.first() {
        return Err(failed(&format!("it stopped: {fault:?}")));
    }
    let stack = image.statistics()?.stack;
    Ok((run, stack, start))
}

fn setup(law: AugmentedLaw<f32, MAX_EFFECTS>, cycles: u32) -> Result<Setup, Refused> {
    let programme = Programme::new(TICK_RATE, 1)?
        .with(Block::sine(AMPLITUDE, 10.0, cycles)?)?
        .with(Block::sine(AMPLITUDE / 2.0, 10.0, cycles)?)?;
    let specimen = Specimen::of_density(DENSITY, AMPLITUDE);
    Ok(RigSetup::new(specimen, law, programme, 1))
}

fn published(amplitude: f64) -> Law<f32> {
    PAPER.lookup(DENSITY as f32, amplitude as f32).law
}

fn eq_13() -> Result<Setup, Refused> {
    setup(AugmentedLaw::new(published(AMPLITUDE)), 40)
}

fn every_effect() -> Result<Setup, Refused> {
    let mut law = AugmentedLaw::new(published(AMPLITUDE));
    for (_, effect) in effects::each()?.into_iter().rev().take(MAX_EFFECTS) {
        law = law.with(effect)?;
    }
    let mut setup = setup(law, 3)?;
    setup.block_laws = vec![published(AMPLITUDE), published(AMPLITUDE / 2.0)];
    Ok(setup)
}

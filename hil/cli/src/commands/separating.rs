//! The test that would distinguish rivals, as a file that a rig follows.

use std::path::Path;

use mesh_damper::error::ConfigError;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_output::error::InputError;
use mesh_damper_output::shell;
use mesh_damper_tables::write::{comment_line, decimal};

/// Name of the file in a trace's folder.
pub const FILE: &str = "separating-test.csv";

/// Sampling rate, Hz: a hundred samples in a cycle of the fastest block that a trace asks for, 10 Hz.
const RATE: f64 = 1000.0;
/// More blocks than any trace asks for.
const BLOCKS: usize = 16;
/// Cycles of each ramp, the same as in `hil run --blocks`.
const RAMP_CYCLES: u32 = 2;

/// The command that runs the file at `path`.
pub fn command(path: &Path) -> String {
    format!(
        "cargo hil run --drive {} --out separating-out",
        shell::file(path)
    )
}

/// Creates the file at `path`: time and displacement of the blocks that `result` asks for, from rest to rest, with the same ramps
/// in between as in `hil run --blocks`.
///
/// # Errors
/// Blocks that the crate's generator does not run.
pub fn motion(path: &Path, result: &TraceResult) -> Result<String, InputError> {
    let refused = |error: ConfigError| {
        let remedy = "report this: the trace asks for a test that the rig does not run";
        InputError::new(FILE, error.to_string(), remedy)
    };
    let mut programme = Programme::<BLOCKS>::new(RATE, RAMP_CYCLES).map_err(refused)?;
    for block in &result.separating_blocks {
        programme = Block::sine(block.amplitude, block.frequency, block.cycles)
            .and_then(|block| programme.with(block))
            .map_err(refused)?;
    }
    let mut generator = SineGenerator::new(programme).map_err(refused)?;
    let excitation = format!(
        "excitation: the test that tells apart the effects that explain {} equally well",
        result.recordings.join(", ")
    );
    let run = format!("run: {}", command(path));
    let comments = [excitation, run].map(|comment| comment_line(&comment));
    let mut text = comments.concat() + "time_s,displacement_mm\n";
    for tick in 0u32.. {
        let at = generator.tick();
        text += &format!(
            "{},{}\n",
            decimal(f64::from(tick) / RATE),
            decimal(at.displacement.into())
        );
        if at.done {
            break;
        }
    }
    Ok(text)
}

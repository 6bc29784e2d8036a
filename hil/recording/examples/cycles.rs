//! The blocks of equal cycles in a recording: `cargo run -p mesh-damper-recording --example cycles -- rig-test.csv`.

use mesh_damper_output::error::InputError;
use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;

fn main() -> Result<(), InputError> {
    let Some(path) = std::env::args_os().nth(1) else {
        return Err(InputError::new(
            "the command line",
            "names no recording",
            "name a CSV or CSV.gz file",
        ));
    };
    for block in &Trajectory::of(&Recording::read(path)?)?.blocks {
        println!(
            "{} cycles of {:.3} mm at {:.2} Hz",
            block.cycles.len(),
            block.amplitude,
            block.frequency
        );
    }
    Ok(())
}

//! The density that gives 4 kN/mm with a loss factor of 0.3: `cargo run --release -p mesh-damper-paper --example density`.

use mesh_damper_paper::design::{DesignError, Wanted, design};

fn main() -> Result<(), DesignError> {
    for solution in design(&Wanted::new(4.0, 0.3)?)?.solutions {
        println!(
            "{:.2} g/cm³ in cycles of {:.3} mm",
            solution.point.density, solution.point.amplitude
        );
    }
    Ok(())
}

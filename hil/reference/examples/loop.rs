//! Stiffness and loss factor of the published law at 1 Hz: `cargo run -p mesh-damper-reference --example loop`.

use std::f64::consts::TAU;

use mesh_damper_reference::dynamic_test::characterize;
use mesh_damper_reference::tables::cells;

fn main() {
    for (density, amplitude, law) in cells() {
        let turns = (0..1000).map(|i| TAU * f64::from(i) / 1000.0);
        let (displacement, force): (Vec<f64>, Vec<f64>) = turns
            .map(|turn| {
                let (y, v) = (amplitude * turn.sin(), TAU * amplitude * turn.cos());
                (y, law.force(y, v))
            })
            .unzip();
        let cycle = characterize(&displacement, &force).expect("a motion");
        println!(
            "{density} g/cm³, {amplitude} mm: {:.2} kN/mm, loss factor {:.3}",
            cycle.stiffness, cycle.loss_factor
        );
    }
}

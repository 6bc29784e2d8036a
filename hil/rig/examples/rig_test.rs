//! A test on the simulated rig, cycle by cycle: `cargo run --release -p mesh-damper-rig --example rig_test`.

use std::error::Error;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{RigSetup, TICK_RATE, run_rig};

fn main() -> Result<(), Box<dyn Error>> {
    let specimen = Specimen::of_density(3.0, 0.1);
    let c = specimen.coefficients();
    let law = Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32)?;
    let programme = Programme::<2>::new(TICK_RATE, 1)?
        .with(Block::sine(0.1, 2.0, 4)?)?
        .with(Block::sine(0.05, 5.0, 4)?)?;
    let setup = RigSetup::new(specimen, AugmentedLaw::<f32, 1>::new(law), programme, 1);
    for report in run_rig(setup, |_| {})?.cycles {
        let ramp = if report.ramp { ", in a ramp" } else { "" };
        println!(
            "cycle {}: {:.2} kN/mm{ramp}",
            report.cycle, report.measured.stiffness
        );
    }
    Ok(())
}

//! Finds the effect that the law lacks for a simulated specimen: `cargo run --release -p mesh-damper-identify --example trace`.

use std::error::Error;

use mesh_damper_identify::trace::trace;
use mesh_damper_recording::Recording;
use mesh_damper_reference::protocol::{PROTOCOL, motion};
use mesh_damper_rig::specimen::{DamperForce as _, draw};

const RATE: f64 = 1000.0;

fn main() -> Result<(), Box<dyn Error>> {
    let (mut specimen, hidden) = draw(3);
    let motion = motion(&PROTOCOL, RATE);
    let force = motion
        .iter()
        .map(|m| {
            specimen.force(
                m.time,
                m.displacement,
                m.velocity,
                m.acceleration,
                1.0 / RATE,
            )
        })
        .collect();
    let recording = Recording::new(
        "a simulated test",
        motion.iter().map(|m| m.time).collect(),
        motion.iter().map(|m| m.displacement).collect(),
        force,
    )?;
    let result = trace(&[recording], &[], &|step| eprintln!("{step}"))?.result;
    println!("hidden: {}", hidden.effect.family());
    for effect in &result.effects {
        println!(
            "found: {}, {:.2} % off without it and {:.2} % with it",
            effect.family,
            100.0 * effect.nrmse_without,
            100.0 * effect.nrmse_with
        );
    }
    Ok(())
}

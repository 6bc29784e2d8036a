//! A test whose controller is the firmware in an emulator: `cargo run --release -p mesh-damper-link --example image`.

use std::error::Error;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme};
use mesh_damper_link::image::Board;
use mesh_damper_link::lockstep::{Image, run_rig_on};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{RigSetup, TICK_RATE};

fn main() -> Result<(), Box<dyn Error>> {
    let board = Board::Mps2An386;
    if let Err(missing) = board.check() {
        println!("left out, no image is run: {missing}");
        return Ok(());
    }
    let law: AugmentedLaw<f32, 1> = AugmentedLaw::new(Law::new(1.05, 10.5, 0.11, 0.4)?);
    let programme = Programme::<1>::new(TICK_RATE, 1)?.with(Block::sine(0.1, 5.0, 4)?)?;
    let setup = RigSetup::new(Specimen::of_density(3.0, 0.1), law, programme, 1);
    let mut image = Image::start(board, Box::new(|line| println!("image: {}", line.text)))?;
    let run = run_rig_on(&mut image, setup, |_| {})?;
    println!("{} cycles in {} ticks", run.cycles.len(), run.ticks);
    Ok(())
}

//! Predicts the force of a model for a recording's motion and prints its error:
//! `cargo run -p mesh-damper-model --example predict -- model.json rig-test.csv`.

use std::error::Error;

use mesh_damper_model::file::ModelFile;
use mesh_damper_model::predict::{nrmse, predict, predict_embedded};
use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(model), Some(recording)) = (arguments.next(), arguments.next()) else {
        return Err("name a model and a recording".into());
    };
    let model = ModelFile::read(model)?.model();
    let mut recording = Recording::read(recording)?;
    model.arrange_controls(&mut recording)?;
    let trajectory = Trajectory::of(&recording)?;
    let fitted = predict(&model, &trajectory)?;
    let embedded = predict_embedded(&model, &trajectory)?;
    for (name, force) in [("f64", fitted), ("as the firmware", embedded)] {
        let error = nrmse(&force, &trajectory.force, |_| true);
        println!("{name}: {:.2} % off", 100.0 * error);
    }
    Ok(())
}

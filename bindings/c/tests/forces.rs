//! A law in C gives the force of the crate, bit for bit, on this machine and on an emulated Cortex-M4F. The same holds for a demo's
//! model, from its recording to the image.

mod build;
#[allow(dead_code, reason = "the rate is the trajectory's here")]
#[path = "../../../hil/model/tests/export/motion.rs"]
mod motion;

use std::path::Path;

use build::{On, Program, can, source};
use mesh_damper::effects::{DESCRIPTIONS, Motion};
use mesh_damper_demo::demo;
use mesh_damper_model::export::{Export, ExportSettings};
use mesh_damper_model::file::{FittedRange, ModelFile};
use mesh_damper_model::predict::{motion_at, predict_embedded};
use mesh_damper_model::{AddedEffect, LawNode, MAX_EFFECTS, Model};
use mesh_damper_recording::trajectory::Trajectory;
use motion::two_sines;

/// The forces of a program in C for the motion of `trajectory`.
fn forces_in_c(on: On, file: &ModelFile, trajectory: &Trajectory) -> Vec<f32> {
    let folder = tempfile::tempdir().unwrap();
    let settings = ExportSettings::at(1.0 / trajectory.tick, "mount");
    write(folder.path(), &Export::new(file, &settings).unwrap());
    let motions: Vec<u8> = (0..trajectory.len())
        .flat_map(|tick| record(&motion_at(trajectory, tick)))
        .collect();
    std::fs::write(folder.path().join("motions.bin"), motions).unwrap();
    let said = Program {
        on,
        folder: folder.path(),
        sources: &[source("forces.c")],
        packs: &["mount"],
        map: None,
    }
    .run();
    assert_eq!(said.trim(), format!("{} ticks", trajectory.len()));
    let forces = std::fs::read(folder.path().join("forces.bin")).unwrap();
    let forces = forces.as_chunks::<4>().0.iter();
    forces.map(|bytes| f32::from_le_bytes(*bytes)).collect()
}

fn write(folder: &Path, export: &Export) {
    let [header, source] = export.c("mount").unwrap();
    std::fs::write(folder.join("mount.h"), header).unwrap();
    std::fs::write(folder.join("mount.c"), source).unwrap();
}

/// An `md_motion`.
fn record(motion: &Motion<f32>) -> Vec<u8> {
    let [a, b, c, d] = motion.controls;
    [
        motion.displacement,
        motion.velocity,
        motion.acceleration,
        motion.cycles,
        motion.temperature,
        a,
        b,
        c,
        d,
    ]
    .iter()
    .flat_map(|value| value.to_le_bytes())
    .collect()
}

/// The forces equal those of `predict`, bit for bit, and there is at least one force.
fn are_predicts(on: On, file: &ModelFile, trajectory: &Trajectory) {
    let predicted = predict_embedded(&file.model(), trajectory).unwrap();
    let forces = forces_in_c(on, file, trajectory);
    assert_eq!(forces.len(), predicted.len());
    for (tick, (force, predicted)) in forces.iter().zip(&predicted).enumerate() {
        let force = f64::from(*force);
        assert!(
            force.to_bits() == predicted.to_bits(),
            "{on:?}, tick {tick}: {force}, {predicted}"
        );
    }
    let largest = predicted
        .iter()
        .fold(0.0_f64, |largest, force| largest.max(force.abs()));
    assert!(largest > 0.1, "{largest} kN");
}

#[test]
fn a_demos_model_in_c_gives_the_force_of_predict_bit_for_bit() {
    if !On::BOTH.into_iter().any(can) {
        return;
    }
    let done = demo(4, &|_| ()).unwrap();
    let trajectory = Trajectory::of(&done.recording).unwrap();
    let motion = &trajectory.motion;
    let range = FittedRange::of(motion.displacement.iter(), motion.velocity.iter()).unwrap();
    let file = &ModelFile::new(done.trace.model.clone(), range);
    assert!(file.model().law.len() == 1 && !file.model().effects.is_empty());
    for on in On::BOTH.into_iter().filter(|on| can(*on)) {
        are_predicts(on, file, &trajectory);
    }
}

#[test]
fn every_effect_of_the_crate_gives_the_same_bits_in_c() {
    let trajectory = two_sines();
    for chunk in DESCRIPTIONS.chunks(MAX_EFFECTS) {
        let model = Model {
            law: vec![LawNode {
                amplitude: 0.0,
                k1: 1.0539,
                k3: 10.5,
                c: 0.1114,
                alpha: 0.3969,
            }],
            effects: chunk.iter().map(AddedEffect::typical).collect(),
            correction: None,
            controls: Vec::new(),
        };
        let range = FittedRange {
            displacement: [-0.2, 0.2],
            velocity: [-6.3, 6.3],
        };
        let file = ModelFile::new(model, range);
        for on in On::BOTH.into_iter().filter(|on| can(*on)) {
            are_predicts(on, &file, &trajectory);
        }
    }
}

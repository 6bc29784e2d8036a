//! A recording that is slower than an effect of the model: the crate runs the model in finer steps between its samples.

use std::f64::consts::TAU;

use mesh_damper_model::predict::{nrmse, predict, predict_embedded, predict_in_half_steps};
use mesh_damper_model::{AddedEffect, Family, LawNode, Model};
use mesh_damper_recording::trajectory::Trajectory;

/// A sine of 0.2 mm and 0.5 Hz for 40 s, sampled every `tick` s.
fn slow_sine(tick: f64) -> Trajectory {
    let displacement: Vec<f64> = (0..(40.0 / tick) as usize)
        .map(|sample| 0.2 * (TAU * 0.5 * sample as f64 * tick).sin())
        .collect();
    let force = displacement.clone();
    Trajectory::new("slow", tick, &displacement, force, None, None)
}

#[test]
fn a_fast_branch_and_a_fast_tone_are_predicted_at_slow_samples() {
    let model = Model {
        law: vec![LawNode {
            amplitude: 0.0,
            k1: 1.0,
            k3: 2.0,
            c: 0.05,
            alpha: 0.5,
        }],
        effects: vec![AddedEffect {
            family: Family::named("periodic").unwrap(),
            parameters: [("amplitude", 0.02), ("frequency", 31.0), ("phase", 0.3)]
                .map(|(name, value)| (name.to_owned(), value))
                .into(),
        }],
        correction: None,
        controls: Vec::new(),
    };
    let (fine, coarse) = (slow_sine(1e-3), slow_sine(0.05));
    let every: Vec<f64> = predict(&model, &fine)
        .unwrap()
        .into_iter()
        .step_by(50)
        .collect();
    for predicted in [
        predict(&model, &coarse).unwrap(),
        predict_embedded(&model, &coarse).unwrap(),
        predict_in_half_steps(&model, &coarse).unwrap(),
    ] {
        let error = nrmse(&predicted, &every, |sample| sample > 20);
        assert!(error < 0.01, "{error}");
    }
}

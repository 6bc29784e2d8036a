//! The Bouc–Wen benchmark, smaller: its records, and the criteria for a model.

use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_model::{AddedEffect, Family, LawNode, Model};
use mesh_damper_trials::bouc_wen::{Programme, System, bouc_wen, records, score};

const SMALL: Programme = Programme {
    system: System::BENCHMARK,
    samples: 2048,
    periods: 2,
    sweep_rate: 120.0,
    seed: 3,
};

fn effect(family: &str, parameters: &[(&str, f64)]) -> AddedEffect {
    AddedEffect {
        family: Family::named(family).unwrap(),
        parameters: parameters
            .iter()
            .map(|&(name, value)| (name.to_owned(), value))
            .collect(),
    }
}

/// The oscillator without its hysteresis: its springs, dashpot and mass, in kN, mm and s.
fn spring_and_mass() -> Model {
    Model {
        law: vec![LawNode {
            amplitude: 0.0,
            k1: 0.05,
            k3: 0.0,
            c: 0.0,
            alpha: 0.5,
        }],
        effects: vec![
            effect("viscous", &[("c1", 1e-5)]),
            effect("inertia", &[("mass", 2.0)]),
        ],
        correction: None,
        controls: Vec::new(),
    }
}

#[test]
fn the_records_are_the_benchmarks() {
    let records = records(&SMALL).unwrap();
    let training = &records.training;
    assert_eq!(training.len(), 2 * 2048);
    let rms =
        |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
    // 50 N, and displacements of the order of 50 N over 1e5 N/m.
    assert!((rms(&training.force) - 0.05).abs() < 1e-4);
    assert!((0.3..1.5).contains(&rms(&training.displacement)));
    // Two periods of a steady motion differ by the noise of both alone: √2·8 µm.
    let difference: Vec<f64> = (0..2048)
        .map(|i| training.displacement[i + 2048] - training.displacement[i])
        .collect();
    let noise = rms(&difference) / 2.0_f64.sqrt();
    assert!((noise - 0.008).abs() < 0.001, "{noise}");
    let steady = &records.tests[0].recording;
    for index in 0..2048 {
        let (one, other) = (
            steady.displacement[index],
            steady.displacement[index + 2048],
        );
        assert!((one - other).abs() < 1e-4, "{index}: {one} {other}");
    }
}

/// With γ = δ = ½ the benchmark's hysteresis is the crate's: k = α, slip limit 1/β, sharpness 1. So Runge–Kutta steps of other code
/// at 15 kHz check the motion under a force that `respond` has at 750 samples a second.
#[test]
fn the_motion_of_a_known_hysteresis_is_that_of_another_integrator() {
    let system = System {
        gamma: 0.5,
        delta: 0.5,
        ..System::BENCHMARK
    };
    let mut model = spring_and_mass();
    model.effects.push(effect(
        "stick_slip",
        &[("stiffness", 0.05), ("slip_limit", 1.0), ("sharpness", 1.0)],
    ));
    let records = records(&Programme { system, ..SMALL }).unwrap();
    for test in &records.tests {
        let score = score(&model, test).unwrap();
        let error = score.displacement_error.unwrap();
        // Halving the steps changes the motion by at most 1e-3, and a third of that remains.
        assert!(error < 1e-3 * score.displacement_rms, "{score:?}");
    }
}

/// A model without the hysteresis is clearly worse, and one without the mass has no motion.
#[test]
fn a_model_is_judged_by_force_and_by_motion() {
    let records = records(&SMALL).unwrap();
    for test in &records.tests {
        let good = score(&spring_and_mass(), test).unwrap();
        let error = good.displacement_error.unwrap();
        assert!(error > 0.05 * good.displacement_rms, "{good:?}");
        assert!(good.force_nrmse > 0.02, "{good:?}");
        let mut still = spring_and_mass();
        still.effects.pop();
        let still = score(&still, test).unwrap();
        assert!(still.displacement_error.is_none());
        assert!(still.refused.unwrap().contains("inertia"));
    }
}

/// From force and displacement of a third of the benchmark's record: the parts of the oscillator, and the resulting scores.
#[test]
fn the_trace_finds_the_mass_and_the_hysteresis() {
    let programme = Programme {
        samples: 4096,
        ..SMALL
    };
    let records = records(&programme).unwrap();
    let (found, result) = bouc_wen(&programme, &records, &|_| ()).unwrap();
    assert_eq!(result.scores.len(), 2);
    assert_eq!(result.verdict, Verdict::Found, "{result:?}");
    let mut families = result.families.clone();
    families.sort();
    assert_eq!(families, ["inertia", "stick_slip"]);
    assert!((result.mass.unwrap() - 2.0).abs() < 0.06, "{result:?}");
    let hysteresis = &found.result.effects;
    let hardens = hysteresis
        .iter()
        .any(|effect| effect.parameters.contains_key("hardening"));
    assert!(hardens, "{hysteresis:?}");
    for score in &result.scores {
        assert!(score.force_nrmse < 0.08, "{score:?}");
        assert!(score.displacement_error.unwrap() < 0.1 * score.displacement_rms);
    }
}

//! A value that makes motion impossible is refused by name, with a remedy.

use mesh_damper_model::Model;
use mesh_damper_model::respond::{Excitation, Settings, SweepRange, respond, sweep};

use super::{law, with};

fn refusal(model: &Model, settings: &Settings) -> String {
    let excitation = Excitation::force(1e-3, vec![0.1; 50]);
    respond(model, &excitation, settings)
        .unwrap_err()
        .to_string()
}

#[test]
fn a_mass_that_is_none_is_refused() {
    let model = law(1.0, 0.0, 0.1, 0.5);
    let inertia = |mass| with(model.clone(), "inertia", &[("mass", mass)]);
    for (model, mass, said) in [
        (
            model.clone(),
            0.0,
            "mass = 0 and the model has no effect `inertia`: nothing moves; give a mass",
        ),
        (
            model.clone(),
            -1.0,
            "mass = -1 is outside 0…1000000 kg; give the mass",
        ),
        (model.clone(), f64::NAN, "mass = NaN is outside"),
        (model.clone(), f64::INFINITY, "mass = inf is outside"),
        (
            inertia(-5.0),
            3.0,
            "mass = 3 and the model's effect `inertia` of -5 kg: together no mass moves",
        ),
    ] {
        let error = refusal(&model, &Settings::new(mass));
        assert!(error.starts_with(said), "{error}");
    }
}

#[test]
fn a_tolerance_and_a_start_out_of_range_are_refused() {
    let model = law(1.0, 0.0, 0.1, 0.5);
    for tolerance in [0.0, -1.0, f64::NAN, 2.0] {
        let error = refusal(
            &model,
            &Settings {
                tolerance,
                ..Settings::new(1.0)
            },
        );
        assert!(error.starts_with("tolerance = "), "{error}");
    }
    let error = refusal(
        &model,
        &Settings {
            start: [f64::NAN, 0.0],
            ..Settings::new(1.0)
        },
    );
    assert!(error.starts_with("start displacement = NaN"), "{error}");
}

#[test]
fn an_excitation_that_is_none_is_refused() {
    let model = law(1.0, 0.0, 0.1, 0.5);
    for (excitation, said) in [
        (Excitation::force(1e-3, vec![]), "excitation: has 0 samples"),
        (
            Excitation::base(1e-3, vec![0.1]),
            "excitation: has 1 samples",
        ),
        (Excitation::force(0.0, vec![0.1; 9]), "tick: 0 s "),
        (Excitation::force(f64::NAN, vec![0.1; 9]), "tick: NaN s "),
        (
            Excitation::base(1e-3, vec![0.1, f64::NAN, 0.2]),
            "excitation: sample 1 (counted from 0) is NaN",
        ),
    ] {
        let error = respond(&model, &excitation, &Settings::new(1.0)).unwrap_err();
        assert!(error.to_string().starts_with(said), "{error}");
    }
}

#[test]
fn what_no_step_settles_is_refused_by_name() {
    let soft = with(law(0.1, 0.0, 0.0, 0.5), "compliance", &[("stiffness", 1.0)]);
    let stiff = with(
        soft,
        "stick_slip",
        &[("stiffness", 5.0), ("slip_limit", 0.1)],
    );
    let error = refusal(&stiff, &Settings::new(1.0));
    assert!(
        error.starts_with("effects (compliance).stiffness = 1 "),
        "{error}"
    );
    assert!(error.contains("trace without the compliance"), "{error}");
}

#[test]
fn a_spring_that_pushes_away_is_an_error_and_no_motion() {
    let error = refusal(&law(-50.0, 0.0, 0.0, 0.5), &Settings::new(0.001));
    assert!(error.contains("no velocity below 1e6 mm/s"), "{error}");
}

#[test]
fn a_sweep_without_a_range_is_refused() {
    let model = law(1.0, 0.0, 0.1, 0.5);
    let run = |amplitudes: &[f64], from, to, points| {
        let range = SweepRange { from, to, points };
        let error = sweep(&model, &Settings::new(1.0), amplitudes, range, &mut |_| ());
        error.unwrap_err().to_string()
    };
    assert!(run(&[0.1], 0.0, 10.0, 5).starts_with("from = 0 "));
    assert!(run(&[0.1], 10.0, 10.0, 5).starts_with("to = 10 "));
    assert!(run(&[0.1], 1.0, f64::NAN, 5).starts_with("to = NaN "));
    assert!(run(&[0.1], 1.0, 10.0, 1).starts_with("points = 1 "));
    assert!(run(&[0.0], 1.0, 10.0, 5).starts_with("amplitudes = 0 "));
}

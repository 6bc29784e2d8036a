//! The law of the surfaces in a rig that `hil run` runs.

use mesh_damper_paper::amplitude_independent::Sine;
use mesh_damper_paper::surfaces::{DEGREE, fit};
use mesh_damper_reference::dynamic_test::characterize;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables::interpolate;

use crate::command::{hil, words};

/// K of a steady cycle of the law that `hil run` computes next to the specimen, at 2.75 g/cm³, 0.1 mm, 1 Hz.
fn stiffness_in_the_rig(law: &str) -> f64 {
    let root = tempfile::tempdir().unwrap();
    let line = format!("run --density 2.75 --blocks 0.1:1:3 --json - --law {law}");
    let output = hil(root.path(), &words(&line));
    let summary: serde_json::Value = serde_json::from_str(&output).unwrap();
    let cycles = summary["cycles"].as_array().unwrap();
    let steady = cycles.iter().rfind(|cycle| cycle["ramp"] == false);
    steady.unwrap()["model_stiffness_kn_per_mm"]
        .as_f64()
        .unwrap()
}

#[test]
fn the_rig_runs_the_law_of_the_surfaces_where_it_is_asked_to() {
    let stiffness = |law: Coefficients| {
        let sine = Sine::new(0.1, 1.0, 4000);
        let result = characterize(&sine.displacement, &sine.force(&law)).unwrap();
        result.stiffness
    };
    let of_tables = stiffness(interpolate(2.75, 0.1));
    let of_surfaces = stiffness(fit(DEGREE, None).coefficients(2.75, 0.1));
    assert!(
        (of_tables / of_surfaces - 1.0).abs() > 0.05,
        "{of_tables} {of_surfaces}"
    );
    // The observer's velocity, and the actuator's amplitude.
    for (law, expected) in [("tables", of_tables), ("surfaces", of_surfaces)] {
        let found = stiffness_in_the_rig(law);
        assert!(
            (found / expected - 1.0).abs() < 0.02,
            "{law}: {found}, expected {expected}"
        );
    }
}

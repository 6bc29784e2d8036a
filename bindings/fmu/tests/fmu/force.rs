//! The force equals that of `predict` for the same motion and inputs.

use std::sync::Arc;

use mesh_damper::effects::Motion;
use mesh_damper_fmu::functions::*;
use mesh_damper_fmu::types::ValueReference;
use mesh_damper_fmu::variables::{AMPLITUDE, CYCLES, FIRST_CONTROL, TEMPERATURE};
use mesh_damper_model::predict::{motion_at, predict};
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_tables::control::ControlChannel;

use crate::master::{MOTION, Master, Unpacked};

const TICK: f64 = 1e-4;

/// Two growing tones, with a change of temperature and two control inputs.
fn trajectory(controls: &[&str]) -> Trajectory {
    let count = 8000;
    let time = |index: usize| index as f64 * TICK;
    let displacement: Vec<f64> = (0..count)
        .map(|index| {
            let t = time(index);
            0.15 * (t / 0.4).min(1.0) * (std::f64::consts::TAU * 13.0 * t).sin()
                + 0.02 * (std::f64::consts::TAU * 41.0 * t).sin()
        })
        .collect();
    let force = displacement.iter().map(|y| 8.0 * y).collect();
    let temperature = (0..count).map(|index| 20.0 + 30.0 * time(index)).collect();
    let mut trajectory = Trajectory::new(
        "motion",
        TICK,
        &displacement,
        force,
        None,
        Some(temperature),
    );
    let channel = |(place, name): (usize, &&str)| ControlChannel {
        name: (*name).into(),
        values: (0..count)
            .map(|index| {
                0.5 + 0.4 * (std::f64::consts::TAU * (2.0 + place as f64) * time(index)).cos()
            })
            .collect(),
    };
    trajectory.controls = Arc::new(controls.iter().enumerate().map(channel).collect());
    trajectory
}

/// Largest difference between the forces of the FMU and of `predict`, as a fraction of the largest force.
fn largest_error(json: &str, controls: &[&str]) -> f64 {
    let trajectory = trajectory(controls);
    let unpacked = Unpacked::new(json, 1.0 / TICK);
    let model = unpacked.contents.file.model();
    let predicted = predict(&model, &trajectory).unwrap();
    let peak = predicted
        .iter()
        .fold(0.0, |peak: f64, force| peak.max(force.abs()));
    let master = unpacked.instance();
    master.set_up(0.0);
    let is_over_amplitude = model.law.len() > 1;
    let set = |master: &Master, index: usize| {
        let motion: Motion<f64> = motion_at(&trajectory, index);
        let motion_of = [motion.displacement, motion.velocity, motion.acceleration];
        let mut references = MOTION.to_vec();
        let mut values: Vec<f64> = motion_of.iter().map(|it| it / 1e3).collect();
        let mut also = |is_there: bool, reference: usize, value: f64| {
            if is_there {
                references.push(reference as ValueReference);
                values.push(value);
            }
        };
        also(
            model.depends_on_temperature(),
            TEMPERATURE,
            motion.temperature,
        );
        also(model.depends_on_cycles(), CYCLES, motion.cycles);
        for (place, control) in motion.controls.iter().enumerate().take(controls.len()) {
            also(true, FIRST_CONTROL + place, *control);
        }
        let amplitude = trajectory.amplitude[index].clamp(0.1, 0.2);
        also(is_over_amplitude, AMPLITUDE as usize, amplitude / 1e3);
        master.well(master.set(&references, &values));
    };
    set(&master, 0);
    // The force at the start is available before the first step.
    let at_start = master.force();
    master.well(fmi2ExitInitializationMode(master.handle));
    assert_eq!(at_start, master.force());
    let mut largest = (at_start / 1e3 - predicted[0]).abs();
    for (index, predicted) in predicted.iter().enumerate().skip(1) {
        set(&master, index);
        master.well(master.step((index - 1) as f64 * TICK, TICK));
        largest = largest.max((master.force() / 1e3 - predicted).abs());
    }
    largest / peak
}

fn model(law: &str, effects: &str, controls: &str) -> String {
    format!(
        r#"{{ "format": "mesh-damper-model", "version": 1,
  "units": {{ "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" }},
  "law": [ {law} ], "effects": [ {effects} ], {controls}
  "fitted_range": {{ "displacement": [-0.2, 0.2], "velocity": [-20.0, 20.0] }} }}"#
    )
}

const LAW: &str = r#"{ "amplitude": 0.0, "k1": 8.0, "k3": 180.0, "c": 0.3, "alpha": 0.3 }"#;

#[test]
fn a_law_that_remembers_under_temperature_cycles_and_controls() {
    let effects = r#"
        { "family": "inertia", "parameters": { "mass": 3.0 } },
        { "family": "temperature", "parameters": { "beta": 0.005, "reference": 20.0 } },
        { "family": "drift", "parameters": { "cycles": 3.0, "elastic_change": 0.2, "damping_change": -0.3 } },
        { "family": "relaxation", "parameters": { "stiffness": 0.8, "time": 0.05 } },
        { "family": "stick_slip", "parameters": { "stiffness": 8.0, "slip_limit": 0.04 } },
        { "family": "control_input", "parameters": { "stiffness": 2.0, "yield_stretch": 0.04, "rate": 0.3, "viscosity": 0.01,
            "lag": 0.02, "input": 1 } },
        { "family": "delay", "parameters": { "time": 0.0012 } }"#;
    let controls = r#""controls": [ { "name": "pressure_bar", "range": [0.0, 1.0] }, { "name": "current_A", "range": [0.0, 1.0] } ],"#;
    let error = largest_error(
        &model(LAW, effects, controls),
        &["pressure_bar", "current_A"],
    );
    assert!(error < 1e-12, "{error:e}");
}

/// With the amplitude as a parameter that changes between steps.
#[test]
fn a_law_over_amplitude() {
    let law = r#"{ "amplitude": 0.1, "k1": 8.0, "k3": 180.0, "c": 0.3, "alpha": 0.3 },
        { "amplitude": 0.2, "k1": 7.0, "k3": 150.0, "c": 0.35, "alpha": 0.32 }"#;
    let compliance = r#"{ "family": "compliance", "parameters": { "stiffness": 60.0 } }"#;
    let error = largest_error(&model(law, compliance, ""), &[]);
    assert!(error < 1e-12, "{error:e}");
}

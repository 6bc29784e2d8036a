//! Forces that a current controls: with delay and in steps, constant within a recording, and not at all.

use mesh_damper_identify::known_terms::known_terms;
use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_identify::trace::{Sought, Trace, trace, trace_for};
use mesh_damper_model::predict::{nrmse, predict_embedded};
use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::protocol::{TestBlock, motion};
use mesh_damper_reference::tables;
use mesh_damper_rig::specimen::{CURRENT, DamperForce, HiddenEffect, Schedule, Specimen};
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand_distr::{Distribution, Normal};

use crate::hidden::block;
use crate::support::families;

/// Hz.
const RATE: f64 = 500.0;
/// Calls of the specimen per sample.
const CALLS: usize = 8;
/// Noise of the force over its RMS.
const NOISE: f64 = 4e-3;

/// At one ampere.
const STIFFNESS: f64 = 0.8;
const YIELDS: f64 = 0.03;
const SPEED: f64 = 0.6;
const DASHPOT: f64 = 0.004;
const LAG: f64 = 0.06;

fn controlled(strength: f64, schedule: Schedule) -> HiddenEffect {
    HiddenEffect::ControlInput {
        stiffness: strength * STIFFNESS,
        force: strength * YIELDS,
        rate: SPEED,
        c: strength * DASHPOT,
        lag: LAG,
        schedule,
    }
}

fn steps(seed: u64) -> Schedule {
    Schedule {
        most: 1.0,
        hold: 0.9,
        seed,
    }
}

/// A schedule with one constant current that is longer than any test.
fn held(current: f64) -> Schedule {
    let of_seed = |seed| Schedule {
        most: current,
        hold: 1e6,
        seed,
    };
    let is_highest = |schedule: &Schedule| schedule.at(0.0) == current;
    (0..).map(of_seed).find(is_highest).unwrap()
}

fn blocks() -> [TestBlock; 4] {
    [
        block(0.1, 1.0, 8),
        block(0.1, 4.0, 24),
        block(0.05, 2.0, 10),
        block(0.2, 3.0, 18),
    ]
}

/// A test of a specimen with one set of coefficients, with its current in a column.
fn recorded(effect: HiddenEffect, blocks: &[TestBlock], seed: u64) -> Recording {
    let mut specimen = Specimen::new(tables::interpolate(3.0, 0.1)).with(effect);
    let fine = RATE * CALLS as f64;
    let mut random = StdRng::seed_from_u64(seed);
    let (mut time, mut displacement, mut force) = (Vec::new(), Vec::new(), Vec::new());
    let mut current = Vec::new();
    for (call, m) in motion(blocks, fine).into_iter().enumerate() {
        let answered = specimen.force(
            m.time,
            m.displacement,
            m.velocity,
            m.acceleration,
            1.0 / fine,
        );
        if call % CALLS == 0 {
            time.push(m.time);
            displacement.push(m.displacement);
            force.push(answered);
            current.extend(specimen.control_at(m.time));
        }
    }
    let square: f64 = force.iter().map(|force| force * force).sum();
    let noise = Normal::new(0.0, NOISE * (square / force.len() as f64).sqrt()).unwrap();
    let force = force.iter().map(|force| force + noise.sample(&mut random));
    let force = force.collect();
    Recording::new(format!("test {seed}"), time, displacement, force)
        .and_then(|recording| recording.with_control(CURRENT, current))
        .unwrap()
}

fn traced(fitted: &[Recording], held_out: &[Recording]) -> Trace {
    trace(fitted, held_out, &|_| ()).unwrap()
}

#[test]
fn a_current_in_steps_is_found_with_its_lag() {
    let test = |seed| recorded(controlled(1.0, steps(seed)), &blocks(), seed);
    let found = traced(&[test(1)], &[test(2)]);
    let result = &found.result;
    assert_eq!(result.verdict, Verdict::Found, "{:?}", families(result));
    assert_eq!(families(result), ["control_input"]);
    let value = |name: &str| result.effects[0].parameters[name].value;
    for (name, truth) in [
        ("stiffness", STIFFNESS),
        ("yield_stretch", YIELDS / STIFFNESS),
        ("rate", SPEED),
        ("viscosity", DASHPOT),
        ("lag", LAG),
    ] {
        let part = value(name) / truth;
        assert!((part - 1.0).abs() < 0.1, "{name}: {} {truth}", value(name));
    }
    assert!(result.depends_on.contains(&"control".to_owned()));
    assert!(result.on_target.nrmse_held_out < 1.5 * NOISE);
    assert_eq!(found.model.controls.len(), 1);
    assert_eq!(found.model.controls[0].name, CURRENT);
    assert_eq!(found.model.controls[0].range, [0.0, 1.0]);
}

/// Three currents are fitted, and the fourth, which lies between them, is predicted. The law alone does not use the current.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_current_that_is_steady_in_each_recording_is_the_same_thing() {
    let at = |current: f64, seed| recorded(controlled(1.0, held(current)), &blocks(), seed);
    let fitted = [at(0.0, 1), at(0.4, 2), at(1.0, 3)];
    let found = traced(&fitted, &[at(0.7, 4)]);
    let result = &found.result;
    assert_eq!(families(result), ["control_input"], "{:?}", result.verdict);
    assert!(result.baseline.nrmse_held_out > 10.0 * NOISE);
    assert!(result.on_target.nrmse_held_out < 2.0 * NOISE);
    // Nothing changes within a recording, so no lag can be found.
    assert!(!result.effects[0].parameters.contains_key("lag"));

    let beyond = traced(&fitted, &[at(1.5, 5)]);
    let mut warnings = beyond.result.warnings.iter();
    let said = warnings.any(|each| each.contains("current_A") && each.contains("extrapolated"));
    assert!(said, "{:?}", beyond.result.warnings);
}

#[test]
fn a_current_on_which_nothing_depends_is_none() {
    let test = |seed| recorded(controlled(0.0, steps(seed)), &blocks(), seed);
    let result = traced(&[test(1)], &[test(2)]).result;
    assert_eq!(result.verdict, Verdict::None, "{:?}", families(&result));
}

/// Its index in the model differs from that in the recording: another column precedes it.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_column_is_known_by_its_name() {
    let test = |seed: u64| {
        let mut test = recorded(controlled(1.0, steps(seed)), &blocks(), seed);
        let rows = test.len();
        let supply = (0..rows).map(|row| 24.0 + 1e-3 * ((row * 7919) % 100) as f64);
        test = test.with_control("supply_V", supply.collect()).unwrap();
        test.controls.reverse();
        test
    };
    let found = traced(&[test(1)], &[test(2)]);
    assert_eq!(families(&found.result), ["control_input"]);
    let mut again = test(3);
    again.controls.reverse();
    found.model.arrange_controls(&mut again).unwrap();
    let trajectory = Trajectory::of(&again).unwrap();
    let force = predict_embedded(&found.model, &trajectory).unwrap();
    let error = nrmse(&force, &trajectory.force, |sample| {
        trajectory.measured[sample]
    });
    assert!(error < 2.0 * NOISE, "{error}");

    again.controls.retain(|control| control.name != CURRENT);
    let refused = found.model.arrange_controls(&mut again).unwrap_err();
    assert!(refused.to_string().contains("current_A"), "{refused}");
}

/// A known input has its index in the model, for any order of the columns, and every recording must contain it.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_known_input_stays_and_must_be_there() {
    let test = |seed| recorded(controlled(1.0, steps(seed)), &blocks(), seed);
    let model = traced(&[test(1)], &[test(2)]).model;
    let known = Sought {
        known: known_terms(&model.effects[0]).unwrap(),
        controls: vec![CURRENT.to_owned()],
        ..Sought::default()
    };
    let mut other = test(3);
    let supply = (0..other.len()).map(|row| 24.0 + 1e-3 * ((row * 7919) % 100) as f64);
    other = other.with_control("supply_V", supply.collect()).unwrap();
    other.controls.reverse();
    let found = trace_for(&known, &[other], &[], &|_| ()).unwrap();
    assert_eq!(
        found.result.verdict,
        Verdict::None,
        "{:?}",
        families(&found.result)
    );
    assert_eq!(found.result.baseline.known, ["control_input"]);
    let names = found
        .model
        .controls
        .iter()
        .map(|control| control.name.as_str());
    assert!(names.eq([CURRENT]));
    assert_eq!(found.model.effects[0].parameters["input"], 0.0);

    let mut without = test(4);
    without.controls.clear();
    let refused = trace_for(&known, &[without], &[], &|_| ()).unwrap_err();
    assert!(
        refused.to_string().contains("no column current_A"),
        "{refused}"
    );
}

/// An input that is constant in all fitted recordings shows nothing about other values.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_current_that_was_never_another_is_said_to_be_another() {
    let at = |current: f64, seed| recorded(controlled(1.0, held(current)), &blocks(), seed);
    let result = traced(&[at(0.5, 1)], &[at(1.0, 2)]).result;
    assert!(!families(&result).contains(&"control_input"));
    let mut warnings = result.warnings.iter();
    let said = warnings.any(|each| each.contains("current_A is ignored: it is 0.5"));
    assert!(said, "{:?}", result.warnings);
}

/// An input that is missing in one of the recordings cannot be used, and the trace reports this.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_column_that_a_recording_lacks_is_not_looked_at() {
    let test = |seed| recorded(controlled(1.0, steps(seed)), &blocks(), seed);
    let mut without = test(2);
    without.controls.clear();
    let result = traced(&[test(1)], &[without]).result;
    assert!(!families(&result).contains(&"control_input"));
    let mut warnings = result.warnings.iter();
    let said = warnings.any(|each| each.contains("current_A is ignored"));
    assert!(said, "{:?}", result.warnings);
}

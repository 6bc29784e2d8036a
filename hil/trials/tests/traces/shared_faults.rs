//! A channel fault of a rig is present in all of its recordings.

use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_identify::trace::{Trace, trace};
use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;

use crate::hidden::{self, Hidden, Sample, block, fitted, record};
use crate::support::families;

/// Evenly spread over ±1, like random numbers.
fn noise(index: usize) -> f64 {
    (index as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) as i64 as f64 / i64::MAX as f64
}

/// The channels of a test at 500 Hz, with the displacement `off` by a number of mm and the force `early` by a number of samples.
fn recording(name: &str, clean: &Trajectory, off: f64, early: usize) -> Recording {
    let count = clean.len() - early;
    Recording::new(
        name,
        (0..count)
            .map(|index| index as f64 / hidden::RATE)
            .collect(),
        // With noise of some µm, from which the motion is estimated.
        (0..count)
            .map(|index| clean.motion.displacement[index] + off + 1e-4 * noise(index))
            .collect(),
        clean.force[early..].to_vec(),
    )
    .unwrap()
}

/// A fitted test, and one with other amplitudes and frequencies.
fn tests(hidden: fn() -> Hidden) -> [Trajectory; 2] {
    let other = [block(0.12, 3.0, 8), block(0.18, 1.5, 6)];
    [record(&fitted(), hidden(), 1), record(&other, hidden(), 2)]
}

fn traced(fitted: Recording, held_out: Recording) -> Trace {
    trace(&[fitted], &[held_out], &|_| ()).unwrap()
}

/// The error on the held-out test if nothing is wrong.
fn error_of_clean(fitted: &Trajectory, other: &Trajectory) -> f64 {
    let trace = traced(
        recording("fitted", fitted, 0.0, 0),
        recording("held out", other, 0.0, 0),
    );
    trace.result.on_target.nrmse_held_out
}

fn nothing() -> Hidden {
    Box::new(|_| 0.0)
}

fn asymmetry() -> Hidden {
    Box::new(|s: &Sample| 3.0 * s.displacement.powi(2))
}

/// The law depends on amplitude, and a single recording shows the delay of the force to half a tick at best.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_force_that_is_early_is_moved_alike_in_all() {
    let [fitted, other] = tests(nothing);
    let clean = error_of_clean(&fitted, &other);
    let trace = traced(
        recording("fitted", &fitted, 0.0, 3),
        recording("held out", &other, 0.0, 3),
    );
    let [fitted, held_out] = [0, 1].map(|which| trace.recordings[which].trajectory.late);
    assert_eq!(
        trace.result.verdict,
        Verdict::None,
        "{:?}, {fitted} s",
        families(&trace.result)
    );
    assert_eq!(fitted, held_out);
    assert!((fitted * hidden::RATE + 3.0).abs() < 0.2, "{fitted} s");
    let error = trace.result.on_target.nrmse_held_out;
    assert!(error < 1.25 * clean, "{error}, {clean} without");
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn a_force_that_comes_in_time_is_not_moved_because_another_is_early() {
    let [fitted, other] = tests(nothing);
    let trace = traced(
        recording("fitted", &fitted, 0.0, 3),
        recording("held out", &other, 0.0, 0),
    );
    assert!(trace.recordings[0].trajectory.late < 0.0);
    assert_eq!(trace.recordings[1].trajectory.late, 0.0);
}

/// Asymmetry also has a mean force, which is not due to a zero that was left in.
#[test]
fn a_zero_of_the_displacement_is_no_physics() {
    let [fitted, other] = tests(asymmetry);
    let clean = error_of_clean(&fitted, &other);
    // The smallest offset is in the other test only, which moves less.
    for off in [0.0095, 0.03, -0.08] {
        let trace = traced(
            recording("fitted", &fitted, off, 0),
            recording("held out", &other, off, 0),
        );
        assert_eq!(families(&trace.result), ["asymmetry"], "{off} mm");
        for recording in &trace.recordings {
            let centre = recording.trajectory.centre;
            assert!((centre - off).abs() < 1e-3, "{centre} mm of {off} mm");
        }
        let error = trace.result.on_target.nrmse_held_out;
        assert!(error < 1.05 * clean, "{error}, {clean} without");
    }
}

/// A motion that fades, or that is wider on one side at times, is still about its zero.
#[test]
fn an_uneven_motion_has_no_other_zero() {
    let clean = record(&fitted(), nothing(), 1);
    let count = (2.2 * hidden::RATE) as usize;
    let displacement: Vec<f64> = (0..count)
        .map(|index| {
            let time = index as f64 / hidden::RATE;
            0.2 * (-0.4 * time).exp() * (std::f64::consts::TAU * time).sin()
        })
        .collect();
    let force = displacement.iter().map(|y| 1.5 * y - 0.04).collect();
    let time = (0..count)
        .map(|index| index as f64 / hidden::RATE)
        .collect();
    let fading = Recording::new("fading", time, displacement, force).unwrap();
    let fading = Trajectory::of(&fading).unwrap();
    assert!(fading.middle.abs() > 0.01);
    assert_eq!([clean.centre, fading.centre], [0.0; 2]);
}

/// A specimen that is held away from its rest position has the force of that position.
#[test]
fn a_preload_is_no_zero() {
    let held = record(&fitted(), Box::new(|_| 0.2), 1);
    let trajectory = Trajectory::of(&recording("held", &held, 0.05, 0)).unwrap();
    assert_eq!(trajectory.centre, 0.0);
}

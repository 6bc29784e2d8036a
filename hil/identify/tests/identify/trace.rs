//! The trace on recordings with a known truth: coefficients, effects, verdicts and intervals.

mod confirmed;
mod elements;
mod held_out;
mod hidden_by_motion;
mod known;
mod on_rig;
mod play_and_wear;
mod refused;
mod rules;
mod set_lengths;
mod slow_changes;

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use mesh_damper_identify::base_law::BaseLaw;
use mesh_damper_identify::families::Form;
use mesh_damper_identify::problem::Problem;
use mesh_damper_identify::rows::Rows;
use mesh_damper_identify::shape::Extent;
use mesh_damper_identify::term::Term;
use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_identify::trace::{Sought, Trace, trace, trace_for};
use mesh_damper_identify::uncertainty::Uncertainty;
use mesh_damper_model::Family;
use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

use crate::support::families;

const TICK: f64 = 2e-3;
const K1: f64 = 1.05;
const K3: f64 = 10.5;
const C: f64 = 0.11;
const ALPHA: f64 = 0.4;

/// Amplitude mm, frequency Hz, cycles.
const BLOCKS: [(f64, f64, u32); 6] = [
    (0.1, 1.0, 6),
    (0.1, 5.0, 10),
    (0.2, 1.0, 6),
    (0.2, 5.0, 10),
    (0.05, 1.0, 6),
    (0.1, 10.0, 12),
];

const OTHERS: [(f64, f64, u32); 2] = [(0.12, 2.5, 8), (0.18, 1.25, 6)];

/// One sample of clean motion: time s, displacement mm, velocity mm/s, acceleration mm/s².
type Sample = (f64, f64, f64, f64);

/// Consecutive sines at full amplitude. Every block lasts a whole number of samples.
fn motion(blocks: &[(f64, f64, u32)]) -> Vec<Sample> {
    let mut samples = Vec::new();
    for &(amplitude, frequency, cycles) in blocks {
        let omega = TAU * frequency;
        for n in 0..(f64::from(cycles) / frequency / TICK).round() as usize {
            let (sin, cos) = (omega * (n as f64 + 0.37) * TICK).sin_cos();
            samples.push((
                samples.len() as f64 * TICK,
                amplitude * sin,
                amplitude * omega * cos,
                -amplitude * omega * omega * sin,
            ));
        }
    }
    samples
}

fn law(&(_, y, v, _): &Sample) -> f64 {
    K1 * y + K3 * y.powi(3) + C * v.abs().powf(ALPHA) * v.signum()
}

/// Records the mixed damping law (eq 13) and `effect` with `noise` as a part of the RMS force.
fn record(
    name: &str,
    blocks: &[(f64, f64, u32)],
    noise: f64,
    seed: u64,
    effect: impl FnMut(&Sample) -> f64,
) -> Recording {
    let mut effect = effect;
    let samples = motion(blocks);
    let force: Vec<f64> = samples
        .iter()
        .map(|sample| law(sample) + effect(sample))
        .collect();
    let rms = (force.iter().map(|f| f * f).sum::<f64>() / force.len() as f64).sqrt();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noisy = |value: f64, deviation: f64| {
        value + Normal::new(0.0, deviation).unwrap().sample(&mut random)
    };
    let displacement = samples.iter().map(|sample| noisy(sample.1, 2e-5)).collect();
    let force = force.iter().map(|&f| noisy(f, noise * rms)).collect();
    Recording::new(
        name,
        samples.iter().map(|sample| sample.0).collect(),
        displacement,
        force,
    )
    .unwrap()
}

fn traced<E: FnMut(&Sample) -> f64>(noise: f64, seed: u64, effect: impl Fn() -> E) -> Trace {
    let fitted = record("fitted", &BLOCKS, noise, seed, effect());
    let held = record("held", &OTHERS, noise, seed + 1000, effect());
    // Without the zero of the displacement, an asymmetry is in doubt.
    trace_for(&Sought::at_recorded_zero(), &[fitted], &[held], &|_| ()).unwrap()
}

/// A slider of stiffness `k` and slip limit `x`, written on its own.
fn slider(k: f64, x: f64) -> impl FnMut(&Sample) -> f64 {
    let mut anchor = 0.0_f64;
    move |&(_, y, _, _)| {
        anchor = anchor.clamp(y - x, y + x);
        k * (y - anchor)
    }
}

/// A Maxwell branch of stiffness `k` and time `tau`, by ten Euler steps per tick along a straight line: 1 % of a step of 2 ms
/// against 60 ms is 0.02 %.
fn branch(k: f64, tau: f64) -> impl FnMut(&Sample) -> f64 {
    let (mut force, mut before) = (0.0, None);
    move |&(_, y, _, _)| {
        let change = (y - before.unwrap_or(y)) / 10.0;
        before = Some(y);
        for _ in 0..10 {
            force += k * change - force * TICK / (10.0 * tau);
        }
        force
    }
}

#[test]
fn a_recording_with_nothing_missing_comes_out_none() {
    for seed in 0..8 {
        let trace = traced(0.004, seed, || |_: &Sample| 0.0);
        assert_eq!(
            trace.result.verdict,
            Verdict::None,
            "seed {seed}: {:?}",
            families(&trace.result)
        );
        assert_eq!(
            trace.model.law.len(),
            1,
            "one set of coefficients is enough"
        );
        let rated = trace.result.candidates.iter();
        let rated: BTreeSet<&str> = rated.map(|candidate| &candidate.family[..]).collect();
        let all = Family::all()
            .filter(|family| !family.depends_on_temperature() && !family.depends_on_control());
        assert_eq!(rated, all.map(Family::name).collect());
        let law = trace.model.law[0];
        // Cramér–Rao at 0.4 % noise over 6000 samples: below 0.1 % on each; ten times that.
        for (found, truth) in [(law.k1, K1), (law.k3, K3), (law.c, C), (law.alpha, ALPHA)] {
            assert!(
                (found - truth).abs() < 0.01 * truth,
                "seed {seed}: {found} for {truth}"
            );
        }
    }
}

#[test]
fn each_effect_is_named_and_measured() {
    let check = |family: &str, parameters: &[(&str, f64)], trace: Trace| {
        assert_eq!(
            trace.result.verdict,
            Verdict::Found,
            "{family}: {:?}",
            trace.result
        );
        assert_eq!(families(&trace.result), [family]);
        for (name, truth) in parameters {
            let found = &trace.result.effects[0].parameters[*name];
            assert!(
                (found.value - truth).abs() < 0.03 * truth.abs(),
                "{name}: {} for {truth}",
                found.value
            );
            assert!(found.low < found.high);
        }
        let result = &trace.result;
        assert!(
            result.augmented.nrmse_held_out < 1.3 * 0.004,
            "{family}: {}",
            result.augmented.nrmse_held_out
        );
        assert!((result.on_target.nrmse_held_out - result.augmented.nrmse_held_out).abs() < 1e-5);
        assert!(result.effects[0].nrmse_without > 3.0 * result.effects[0].nrmse_with);
    };
    check(
        "offset",
        &[("force", 0.04)],
        traced(0.004, 1, || |_: &Sample| 0.04),
    );
    check(
        "asymmetry",
        &[("k2", -2.0)],
        traced(0.004, 2, || |s: &Sample| -2.0 * s.1 * s.1),
    );
    check(
        "hardening",
        &[("k5", 900.0)],
        traced(0.004, 3, || |s: &Sample| 900.0 * s.1.powi(5)),
    );
    check(
        "viscous",
        &[("c1", 0.015)],
        traced(0.004, 4, || |s: &Sample| 0.015 * s.2),
    );
    check(
        "inertia",
        &[("mass", 90.0)],
        traced(0.004, 5, || |s: &Sample| 90e-6 * s.3),
    );
    check(
        "stick_slip",
        &[("stiffness", 0.9), ("slip_limit", 0.04)],
        traced(0.004, 6, || slider(0.9, 0.04)),
    );
    check(
        "relaxation",
        &[("stiffness", 0.9), ("time", 0.06)],
        traced(0.004, 7, || branch(0.9, 0.06)),
    );
}

/// The blocks of small amplitude then consist mostly of noise, which is no evidence against an effect that shows in the others.
#[test]
fn an_effect_is_named_in_much_noise() {
    let trace = traced(0.03, 5, || |&(_, y, ..): &Sample| 1500.0 * y.powi(5));
    assert_eq!(
        trace.result.verdict,
        Verdict::Found,
        "{:?}",
        trace.result.baseline
    );
    assert_eq!(families(&trace.result), ["hardening"]);
}

#[test]
fn two_effects_are_both_named() {
    let trace = traced(0.004, 11, || {
        let mut slider = slider(0.9, 0.04);
        move |s: &Sample| slider(s) - 2.5 * s.1 * s.1
    });
    let mut found = families(&trace.result);
    found.sort_unstable();
    assert_eq!(found, ["asymmetry", "stick_slip"]);
    assert!(trace.result.augmented.nrmse_held_out < 1.3 * 0.004);
}

#[test]
fn coefficients_over_amplitude_are_taken_when_the_data_ask_for_them() {
    let trace = traced(0.004, 12, || {
        |s: &Sample| if s.1.abs() > 1.0 { 1.0 } else { 0.0 }
    });
    assert_eq!(trace.model.law.len(), 1);
    // A law whose stiffness falls with the amplitude of the block, as in Table 6.
    let stiffer = |blocks: &[(f64, f64, u32)]| {
        let mut bounds: Vec<(f64, f64)> = Vec::new();
        for &(amplitude, frequency, cycles) in blocks {
            let end = bounds.last().map_or(0.0, |b| b.0) + f64::from(cycles) / frequency;
            bounds.push((end, 0.6 - 3.0 * amplitude));
        }
        move |s: &Sample| {
            bounds
                .iter()
                .find(|b| s.0 < b.0 - 1e-9)
                .map_or(0.0, |b| b.1 * s.1)
        }
    };
    let fitted = record("fitted", &BLOCKS, 0.004, 13, stiffer(&BLOCKS));
    let held = record("held", &OTHERS, 0.004, 14, stiffer(&OTHERS));
    let trace = trace_of(fitted, held);
    assert_eq!(trace.model.law.len(), 3);
    assert_eq!(trace.result.verdict, Verdict::None);
    assert!(
        trace.result.augmented.nrmse_held_out < 1.3 * 0.004,
        "{}",
        trace.result.augmented.nrmse_held_out
    );
}

fn trace_of(fitted: Recording, held: Recording) -> Trace {
    trace(&[fitted], &[held], &|_| ()).unwrap()
}

/// A test that sets out downwards instead of upwards is the same test.
#[test]
fn the_verdict_does_not_depend_on_the_direction() {
    let mirrored = |recording: &Recording| {
        let turned = |channel: &[f64]| channel.iter().map(|x| -x).collect();
        let (time, force) = (recording.time.clone(), turned(&recording.force));
        Recording::new("mirrored", time, turned(&recording.displacement), force).unwrap()
    };
    let fitted = record("fitted", &BLOCKS, 0.004, 44, slider(0.9, 0.04));
    let held = record("held", &OTHERS, 0.004, 45, slider(0.9, 0.04));
    let turned = trace_of(mirrored(&fitted), mirrored(&held));
    let known = trace_of(fitted, held);
    assert_eq!(families(&turned.result), ["stick_slip"]);
    let of = |trace: &Trace| trace.result.augmented.nrmse_held_out;
    assert!(
        (of(&turned) / of(&known) - 1.0).abs() < 0.02,
        "{} {}",
        of(&turned),
        of(&known)
    );
    let blocks = |trace: &Trace| trace.recordings[0].trajectory.blocks.len();
    assert_eq!(blocks(&turned), BLOCKS.len());
}

/// The answer does not depend on the units: with everything scaled, the trace finds the same family and the scaled parameter.
#[test]
fn the_verdict_does_not_depend_on_the_scale() {
    let scaled = |recording: &Recording| {
        Recording::new(
            "scaled",
            recording.time.clone(),
            recording.displacement.iter().map(|y| 40.0 * y).collect(),
            recording.force.iter().map(|f| 0.02 * f).collect(),
        )
        .unwrap()
    };
    let fitted = record("fitted", &BLOCKS, 0.004, 41, slider(0.9, 0.04));
    let held = record("held", &OTHERS, 0.004, 42, slider(0.9, 0.04));
    let trace = trace_of(scaled(&fitted), scaled(&held));
    assert_eq!(families(&trace.result), ["stick_slip"]);
    let limit = trace.result.effects[0].parameters["slip_limit"].value;
    assert!((limit - 40.0 * 0.04).abs() < 0.03 * 1.6, "{limit}");
}

/// 90 % intervals of an effect's parameters contain the truth about nine times in ten.
#[test]
#[ignore = "half a minute: in the full tier"]
fn intervals_hold_the_truth() {
    let runs = 100;
    let term = Term::sought(Form::named("jenkins").unwrap(), 0.0);
    let (mut sizes, mut shapes) = (0, 0);
    for seed in 0..runs {
        let recording = record("fitted", &BLOCKS, 0.01, 100 + seed, slider(0.9, 0.04));
        let trajectories = [Trajectory::of(&recording).unwrap()];
        let extent = Extent::of(&trajectories);
        let rows = Rows::gather(
            &trajectories,
            BaseLaw::Mixed,
            vec![0.0],
            usize::MAX,
            |_, _| true,
        );
        let found = Problem::new(&rows, &extent, &[term]).solve();
        let Uncertainty { terms, .. } = Uncertainty::of(&rows, &extent, &found);
        let value = &found.terms[0];
        sizes += usize::from((value.sizes[0] - 0.9).abs() < terms[0].sizes[0]);
        shapes += usize::from((value.shapes[0] / 0.04).ln().abs() < terms[0].shapes[0].ln());
    }
    // 90 of 100 are expected, with a deviation of 3; beyond three deviations either way the intervals are wrong.
    assert!((80..=99).contains(&sizes), "stiffness: {sizes} of {runs}");
    assert!(
        (80..=99).contains(&shapes),
        "slip limit: {shapes} of {runs}"
    );
}

/// Two or three cycles are few, but they are judged and held out like any others.
#[test]
fn a_short_recording_still_has_errors_that_are_numbers() {
    for cycles in [2, 3] {
        let short = record("short", &[(0.1, 1.0, cycles)], 0.004, 55, |_| 0.0);
        let result = trace(&[short], &[], &|_| ()).unwrap().result;
        assert_eq!(result.verdict, Verdict::None, "{cycles} cycles");
        assert!(
            result.augmented.nrmse_held_out < 1.3 * 0.004,
            "{}",
            result.augmented.nrmse_held_out
        );
    }
}

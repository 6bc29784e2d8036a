//! The 90 % intervals contain the true values about as often as stated.

use std::collections::BTreeMap;

use mesh_damper_identify::base_law::BaseLaw;
use mesh_damper_identify::families::Form;
use mesh_damper_identify::problem::Problem;
use mesh_damper_identify::rows::Rows;
use mesh_damper_identify::screen::Screen;
use mesh_damper_identify::shape::Extent;
use mesh_damper_identify::term::Term;
use mesh_damper_identify::uncertainty::{Interval, Uncertainty};
use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::protocol::TestBlock;
use mesh_damper_rig::specimen::{HiddenEffect, SlipShape};
use mesh_damper_trials::blind::{Sensors, answer, record};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Hz.
const RATE: f64 = 1000.0;
/// Two amplitudes, four frequencies, 5 s.
const TEST: [(f64, f64, u32); 5] = [
    (0.1, 2.0, 3),
    (0.2, 5.0, 5),
    (0.1, 10.0, 8),
    (0.2, 2.5, 3),
    (0.1, 8.0, 6),
];
/// One condition for a change over time.
const LONG_TEST: [(f64, f64, u32); 1] = [(0.1, 5.0, 40)];
/// Recordings of each effect.
const EACH: u64 = 17;
/// All rows are fitted.
const MOST_ROWS: usize = 100_000;

/// An effect with 0.05–0.3 of eq 13's force, the form that is fitted to it, and its parameters in that form.
struct Case {
    form: Form,
    effect: HiddenEffect,
    truth: Vec<(&'static str, f64)>,
}

fn case(which: usize, rng: &mut impl Rng) -> Case {
    let size = rng.random_range(0.5..2.0);
    let mut near = |value: f64| value * rng.random_range(0.7..1.4);
    let (form, effect, truth) = match which {
        0 => {
            let force = 0.02 * size;
            let truth = vec![("force", force)];
            ("offset", HiddenEffect::Offset { force }, truth)
        }
        1 => {
            let k2 = 2.0 * size;
            let truth = vec![("k2", k2)];
            ("asymmetry", HiddenEffect::Asymmetry { k2 }, truth)
        }
        2 => {
            let k5 = 500.0 * size;
            let truth = vec![("k5", k5)];
            ("hardening", HiddenEffect::Hardening { k5 }, truth)
        }
        3 => {
            let c = 0.01 * size;
            let truth = vec![("c1", c)];
            ("viscous", HiddenEffect::Viscous { c }, truth)
        }
        4 => {
            let (stiffness, time) = (0.6 * size, near(0.04));
            let effect = HiddenEffect::Relaxation { stiffness, time };
            let truth = vec![("stiffness", stiffness), ("time", time)];
            ("relaxation", effect, truth)
        }
        5 => {
            let mass = 60.0 * size;
            let truth = vec![("mass", mass)];
            ("inertia", HiddenEffect::Inertia { mass }, truth)
        }
        6 => {
            let (stiffness, slip_limit) = (0.8 * size, near(0.03));
            let effect = HiddenEffect::StickSlip {
                stiffness,
                slip_limit,
                shape: SlipShape::Sharp,
            };
            let truth = vec![("stiffness", stiffness), ("slip_limit", slip_limit)];
            ("jenkins", effect, truth)
        }
        7 => {
            let (stiffness, gap) = (3.0 * size, near(0.1));
            let effect = HiddenEffect::Stop { stiffness, gap };
            let truth = vec![("stiffness", stiffness), ("gap", gap)];
            ("stop_above", effect, truth)
        }
        8 => {
            let half_width = near(0.01);
            let effect = HiddenEffect::Gap {
                half_width,
                loose: false,
            };
            ("damped_gap", effect, vec![("half_width", half_width)])
        }
        9 => {
            let (stiffness, cycles) = (0.2 * size, near(12.0));
            let effect = HiddenEffect::Drift { stiffness, cycles };
            let truth = vec![("stiffness", stiffness), ("cycles", cycles)];
            ("drift", effect, truth)
        }
        10 => {
            let (beta, rise, time) = (0.004 * size, near(20.0), near(3.0));
            let effect = HiddenEffect::Temperature { beta, rise, time };
            ("temperature", effect, vec![("beta", beta)])
        }
        DELAY => {
            let time = near(3.3e-3);
            let effect = HiddenEffect::Delay { time };
            ("delay", effect, vec![("time", time)])
        }
        SPRING => {
            let compliance = near(0.06);
            let effect = HiddenEffect::Compliance { compliance };
            let truth = vec![("stiffness", 1.0 / compliance)];
            ("compliance", effect, truth)
        }
        _ => {
            let (force, frequency, phase) = (0.02 * size, near(40.0), near(1.0));
            let effect = HiddenEffect::Periodic {
                force,
                frequency,
                phase,
            };
            let truth = vec![
                ("amplitude", force),
                ("frequency", frequency),
                ("phase", phase),
            ];
            ("periodic", effect, truth)
        }
    };
    Case {
        form: Form::named(form).unwrap(),
        effect,
        truth,
    }
}
const CASES: usize = 14;
const SPRING: usize = 12;
const DELAY: usize = 13;

/// A recording with displacement noise of 1e-4 mm and force noise of 0.4–2 % of its RMS.
fn recorded(case: &Case, rng: &mut impl Rng) -> Recording {
    let blocks = match case.form.name {
        "drift" | "temperature" => &LONG_TEST[..],
        _ => &TEST[..],
    };
    let blocks: Vec<TestBlock> = blocks
        .iter()
        .map(|&(amplitude, frequency, cycles)| TestBlock::new(amplitude, frequency, cycles))
        .collect();
    let density = rng.random_range(2.2..3.6);
    // Between its own ticks, the delay of the specimen is interpolated linearly.
    let each = if case.form.name == "delay" { 64.0 } else { 4.0 };
    let truth = answer(density, &[case.effect], &blocks, RATE, each * RATE);
    let squares: f64 = truth.force.iter().map(|f| f * f).sum();
    let rms = (squares / truth.force.len() as f64).sqrt();
    let sensors = Sensors {
        force_noise: rms * rng.random_range(0.004..0.02),
        thermometer: case.form.name == "temperature",
        seed: rng.random(),
    };
    record(format!("{:?}", case.form), &truth, &sensors)
}

/// Eq 13 has separate coefficients at each amplitude of the test.
fn nodes(case: &Case) -> Vec<f64> {
    match case.form.name {
        "drift" | "temperature" => vec![0.1],
        _ => vec![0.1, 0.2],
    }
}

/// The intervals of the effect's parameters, fitted together with eq 13 from the start that the screen gives.
fn intervals(case: &Case, recording: &Recording) -> Vec<(&'static str, Interval)> {
    let trajectories = [Trajectory::of(recording).unwrap()];
    let rows = Rows::gather(
        &trajectories,
        BaseLaw::Mixed,
        nodes(case),
        MOST_ROWS,
        |_, _| true,
    );
    let mut extent = Extent::of(&trajectories);
    if let HiddenEffect::Periodic { frequency, .. } = case.effect {
        // A spectrum would show it; this test does not cover the search for the line.
        extent = extent.with_tones(vec![frequency]);
    }
    let term = Term::sought(case.form, 20.0);
    let law = Problem::new(&rows, &extent, &[]).solve();
    let terms = [term];
    let problem = Problem::new(&rows, &extent, &terms);
    let starts = Screen::at(&rows, &extent, &law).starts(term);
    let solution = starts
        .iter()
        .take(3)
        .map(|start| problem.solve_from(&law, &start.shapes))
        .min_by(|a, b| a.squares.total_cmp(&b.squares))
        .unwrap();
    let uncertainty = Uncertainty::of(&rows, &extent, &solution);
    uncertainty.terms[0]
        .elements(&solution.terms[0])
        .swap_remove(0)
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn intervals_of_90_percent_hold_80_to_97_percent() {
    let runs: Vec<(usize, u64)> = (0..CASES)
        .flat_map(|which| (0..EACH).map(move |seed| (which, seed)))
        .collect();
    assert!(runs.len() >= 200);
    let found: Vec<(String, f64, Interval)> = runs
        .into_par_iter()
        .flat_map_iter(|(which, seed)| {
            let mut rng = ChaCha8Rng::seed_from_u64(1000 * seed + which as u64);
            let case = case(which, &mut rng);
            let intervals = intervals(&case, &recorded(&case, &mut rng));
            case.truth
                .into_iter()
                .map(|(name, truth)| {
                    let interval = intervals
                        .iter()
                        .find(|(other, _)| *other == name)
                        .unwrap()
                        .1;
                    (format!("{:?} {name}", case.form), truth, interval)
                })
                .collect::<Vec<_>>()
        })
        .collect();
    let mut table: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for (name, truth, interval) in &found {
        let row = table.entry(name.clone()).or_default();
        row.0 += usize::from((interval.low..=interval.high).contains(truth));
        row.1 += 1;
        if std::env::var("SHOW").is_ok() {
            let half = 0.5 * (interval.high - interval.low);
            println!(
                "{name}: {truth:.5} by {:+.2} half widths of {:.2} %",
                (interval.value - truth) / half,
                100.0 * half / truth
            );
        }
    }
    let text: Vec<String> = table
        .iter()
        .map(|(name, (held, of))| format!("{name}: {held} of {of}"))
        .collect();
    println!("{}", text.join("\n"));
    // Of 17 with 0.9 each, 11 or fewer hold once in 200.
    for (name, (held, of)) in &table {
        assert!(*held >= 12, "{name}: {held} of {of}\n{}", text.join("\n"));
    }
    let held: usize = table.values().map(|row| row.0).sum();
    let part = held as f64 / found.len() as f64;
    println!("all: {held} of {}", found.len());
    assert!((0.80..=0.97).contains(&part), "{part}\n{}", text.join("\n"));
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn stiffness_of_a_spring_in_series_is_found_within_one_percent() {
    for seed in 0..4 {
        let mut rng = ChaCha8Rng::seed_from_u64(1000 * seed + SPRING as u64);
        let case = case(SPRING, &mut rng);
        let found = intervals(&case, &recorded(&case, &mut rng))[0].1;
        let truth = case.truth[0].1;
        let error = found.value / truth - 1.0;
        assert!(error.abs() < 0.01, "{truth} kN/mm by {error}");
        assert!((found.high - found.low) / truth < 0.02, "{found:?}");
    }
}

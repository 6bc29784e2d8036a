//! Characterization of recordings of loops with stiffness and loss factor known in closed form.

use std::f64::consts::{PI, TAU};

use mesh_damper_characterize::{dynamic_test, dynamic_test_on, static_test};
use mesh_damper_recording::Recording;
use mesh_damper_recording::rig::RigFacts;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables;
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_distr::{Distribution as _, Normal};

fn close(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{value} is not within {tolerance} of {expected}"
    );
}

/// A press that loads and unloads a spring of 2 kN/mm with 0.05 kN of friction, to 0.5 mm.
#[derive(Clone, Copy, Debug)]
struct Press {
    cycles: usize,
    /// Samples of a loading and of an unloading.
    samples: (usize, usize),
    /// Samples of the hold at the top, in which the friction relaxes.
    hold: usize,
    /// Displacement and force at the start of the loading.
    offset: (f64, f64),
    signs: (f64, f64),
    /// As a fraction of the largest displacement and force.
    noise: f64,
}

const PRESS: Press = Press {
    cycles: 1,
    samples: (400, 400),
    hold: 0,
    offset: (0.0, 0.0),
    signs: (1.0, 1.0),
    noise: 0.0,
};
const STIFFNESS: f64 = 2.0;
const FRICTION: f64 = 0.05;
const TRAVEL: f64 = 0.5;

/// ΔW = 2·f·x_max and U = k·x_max²/2.
fn loss_factor() -> f64 {
    2.0 * FRICTION * TRAVEL / (PI * 0.5 * STIFFNESS * TRAVEL * TRAVEL)
}

impl Press {
    fn points(&self) -> Vec<(f64, f64)> {
        let mut points = Vec::new();
        for _ in 0..self.cycles {
            let (up, down) = self.samples;
            points.extend((0..=up).map(|i| (TRAVEL * i as f64 / up as f64, FRICTION)));
            points.extend(
                (1..=self.hold)
                    .map(|i| (TRAVEL, FRICTION * (1.0 - 2.0 * i as f64 / self.hold as f64))),
            );
            points.extend((1..down).map(|i| (TRAVEL * (1.0 - i as f64 / down as f64), -FRICTION)));
        }
        points.push((0.0, -FRICTION));
        points
            .into_iter()
            .map(|(x, f)| (x, STIFFNESS * x + f))
            .collect()
    }

    fn record(&self, samples: impl Fn(usize) -> std::ops::Range<usize>) -> Recording {
        let points = self.points();
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let normal = Normal::new(0.0, self.noise).unwrap();
        let mut noisy = |value: f64, size: f64| value + size * normal.sample(&mut random);
        let (x, f): (Vec<f64>, Vec<f64>) = points[samples(points.len())]
            .iter()
            .map(|&(x, f)| {
                let x = noisy(x, TRAVEL) + self.offset.0;
                let f = noisy(f, STIFFNESS * TRAVEL) + self.offset.1;
                (self.signs.0 * x, self.signs.1 * f)
            })
            .unzip();
        let time = (0..x.len()).map(|i| 0.1 * i as f64).collect();
        Recording::new("press", time, x, f).unwrap()
    }

    fn whole(&self) -> Recording {
        self.record(|count| 0..count)
    }
}

proptest! {
    /// The result does not depend on the branches' numbers of samples, the hold, the preload, the zero and the signs. The loop's
    /// corners are cut by up to one step: 1/(2·120) of ΔW at each.
    #[test]
    fn a_friction_loop_is_the_same_however_it_is_recorded(
        cycles in 1..4_usize, up in 120..900_usize, down in 120..900_usize, hold in 0..50_usize,
        x in -0.4..0.4_f64, f in 0.0..0.3_f64, turned in any::<(bool, bool)>(),
    ) {
        let sign = |turned| if turned { -1.0 } else { 1.0 };
        let press = Press {
            cycles,
            samples: (up, down),
            hold,
            offset: (x, f),
            signs: (sign(turned.0), sign(turned.1)),
            ..PRESS
        };
        let test = static_test(&press.whole()).unwrap();
        prop_assert_eq!(test.cycles.len(), cycles);
        for cycle in &test.cycles {
            prop_assert!((cycle.equivalent_stiffness / STIFFNESS - 1.0).abs() < 5e-3, "{cycle:?}");
            prop_assert!((cycle.loss_factor / loss_factor() - 1.0).abs() < 1e-2, "{cycle:?}");
            prop_assert!((cycle.displacement_max - TRAVEL).abs() < 1e-9);
            prop_assert!((cycle.start - x).abs() < 1e-9);
            // The middle line begins at the offset: half of each jump is due to friction.
            prop_assert!((cycle.preload - f).abs() < 2e-3, "{cycle:?}");
        }
        prop_assert_eq!(test.notes.len(), usize::from(turned.0) + usize::from(turned.1));
    }
}

#[test]
fn what_the_recording_cuts_off_is_left_out_and_said() {
    let press = Press { cycles: 3, ..PRESS };
    // 800 samples per cycle: from the middle of the first loading to the middle of the last unloading.
    let test = static_test(&press.record(|_| 200..2200)).unwrap();
    assert_eq!(test.cycles.len(), 1);
    close(test.cycles[0].equivalent_stiffness, STIFFNESS, 0.01);
    close(test.cycles[0].times[0], 60.0, 0.11);
    assert_eq!(
        test.notes,
        ["cycles that the recording cuts off, left out: 2"]
    );
    // Starting in the middle of an unloading.
    let test = static_test(&press.record(|count| 600..count)).unwrap();
    assert_eq!(test.cycles.len(), 2);
}

#[test]
fn noise_of_a_hundredth_leaves_the_figures() {
    let press = Press {
        cycles: 4,
        samples: (1000, 700),
        hold: 100,
        noise: 0.01,
        ..PRESS
    };
    let test = static_test(&press.whole()).unwrap();
    assert_eq!(test.cycles.len(), 4);
    // A turning point is found to 1 % of the travel, which enters eq 1 squared.
    close(test.equivalent_stiffness.mean / STIFFNESS, 1.0, 0.02);
    close(test.loss_factor.mean / loss_factor(), 1.0, 0.03);
    assert!(test.equivalent_stiffness.deviation.unwrap() < 0.02 * STIFFNESS);
}

/// Branches k·x ± b·x·(x_max − x), from zero force to zero force: U = k·x_max²/2 and ΔW = b·x_max³/3.
#[test]
fn a_closed_loop_has_its_closed_form() {
    let (k, b, x_max) = (2.0, 0.8, 0.5);
    let branch = |i: usize, steps: usize, sign: f64| {
        let x = x_max * i as f64 / steps as f64;
        (x, k * x + sign * b * x * (x_max - x))
    };
    let up = (0..=3000).map(|i| branch(i, 3000, 1.0));
    let down = (0..150).rev().map(|i| branch(i, 150, -1.0));
    let (x, f): (Vec<f64>, Vec<f64>) = up.chain(down).unzip();
    let time = (0..x.len()).map(|i| i as f64).collect();
    let test = static_test(&Recording::new("loop", time, x, f).unwrap()).unwrap();
    let cycle = &test.cycles[0];
    // The straight line through the beginning of a branch ignores its curvature, b·(0.02·x_max)², 8e-5 kN.
    close(cycle.preload, 0.0, 1e-4);
    close(cycle.equivalent_stiffness, k, 1e-3);
    close(cycle.loss_factor, b * x_max / 3.0 / (PI * k / 2.0), 1e-4);
    close(cycle.middle[50].1, k * x_max / 2.0, 2e-4);
}

/// Straight lines through these displacements (mm) and forces (kN), 400 samples each, shifted by a zero of each channel.
fn lines(corners: &[(f64, f64)], offset: (f64, f64)) -> Recording {
    let between = |from: f64, to: f64, i: u32| from + (to - from) * f64::from(i) / 400.0;
    let mut points = vec![corners[0]];
    for pair in corners.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        points.extend((1..=400).map(|i| (between(from.0, to.0, i), between(from.1, to.1, i))));
    }
    let (x, f) = points
        .iter()
        .map(|(x, f)| (x + offset.0, f + offset.1))
        .unzip();
    let time = (0..points.len()).map(|i| 0.1 * i as f64).collect();
    Recording::new("press", time, x, f).unwrap()
}

/// Loaded along 2 kN/mm to 0.5 mm, the specimen loses its force at 0.1 mm: U is the mean of ½·1·0.5 and ½·1·0.4, and ΔW is their
/// difference. Loaded again from the residual set it is a spring of 2.5 kN/mm over 0.4 mm.
#[test]
fn a_residual_set_has_its_closed_form_and_the_next_cycle_begins_from_it() {
    for offset in [(0.0, 0.0), (-0.3, 0.2)] {
        let corners = [(0.0, 0.0), (0.5, 1.0), (0.1, 0.0), (0.5, 1.0), (0.1, 0.0)];
        let test = static_test(&lines(&corners, offset)).unwrap();
        assert_eq!(test.notes, [""; 0]);
        let [first, second] = &test.cycles[..] else {
            panic!("two cycles: {:?}", test.cycles.len());
        };
        close(first.preload, offset.1, 1e-9);
        close(first.displacement_max, 0.5, 1e-9);
        close(first.elastic_potential, 0.225, 1e-6);
        close(first.dissipated, 0.05, 1e-6);
        close(first.equivalent_stiffness, 1.8, 1e-5);
        close(first.loss_factor, 0.05 / (PI * 0.225), 1e-5);
        close(second.start, 0.1 + offset.0, 1e-9);
        close(second.displacement_max, 0.4, 1e-9);
        close(second.equivalent_stiffness, 2.5, 1e-5);
        close(second.loss_factor, 0.0, 1e-6);
    }
}

/// A specimen pulled beyond the start of the loading counts from the start on only.
#[test]
fn an_unloading_below_its_start_counts_down_to_the_start() {
    let beyond = -0.02;
    let corners = [
        (0.0, FRICTION),
        (TRAVEL, STIFFNESS * TRAVEL + FRICTION),
        (TRAVEL, STIFFNESS * TRAVEL - FRICTION),
        (beyond, STIFFNESS * beyond - FRICTION),
    ];
    let test = static_test(&lines(&corners, (0.1, 0.0))).unwrap();
    let [cycle] = &test.cycles[..] else {
        panic!("one cycle: {:?}", test.cycles.len());
    };
    close(cycle.start, 0.1, 1e-9);
    close(cycle.curve.last().unwrap().0, 0.0, 1e-12);
    close(cycle.equivalent_stiffness / STIFFNESS, 1.0, 1e-3);
    close(cycle.loss_factor / loss_factor(), 1.0, 2e-3);
}

#[test]
fn a_motion_that_does_not_come_back_is_no_cycle() {
    let refused = |samples: std::ops::Range<usize>| {
        let error = static_test(&PRESS.record(|_| samples.clone())).unwrap_err();
        error.to_string()
    };
    assert!(refused(0..390).contains("does not go there and back"));
    assert!(refused(0..600).contains("no load–unload cycle is whole"));
}

/// Blocks of cycles (amplitude mm, frequency Hz, cycles) at `rate` Hz, each continuing from the phase at the end of the previous
/// one.
fn cycles(law: Coefficients, blocks: &[(f64, f64, f64)], rate: f64, noise: f64) -> Recording {
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(2);
    let normal = Normal::new(0.0, 1.0).unwrap();
    let (mut time, mut x, mut f) = (Vec::new(), Vec::new(), Vec::new());
    for &(amplitude, frequency, count) in blocks {
        let samples = (count * rate / frequency).round() as usize;
        for i in 0..samples {
            // Except at the reversals, where rounding decides the sign of the velocity.
            let (sin, cos) = (TAU * frequency * (i as f64 + 0.37) / rate).sin_cos();
            let (y, v) = (amplitude * sin, TAU * frequency * amplitude * cos);
            time.push(time.len() as f64 / rate);
            x.push(y + 1e-3 * noise * amplitude * normal.sample(&mut random));
            let force = law.force(y, v);
            f.push(force + noise * law.k1 * amplitude * normal.sample(&mut random));
        }
    }
    Recording::new("cycles", time, x, f).unwrap()
}

/// F = k·y + c·v: K = √(k² + (cω)²), ΔW = π·c·ω·X², η = c·ω/K, at 333.3 samples per cycle.
#[test]
fn an_ellipse_has_its_closed_form_in_every_cycle_and_on_average() {
    let law = Coefficients::new(1.5, 0.0, 0.03, 1.0);
    let test = dynamic_test(&cycles(law, &[(0.1, 3.0, 8.0)], 1000.0, 0.0)).unwrap();
    let [block] = &test.blocks[..] else {
        panic!("one block: {:?}", test.blocks.len());
    };
    assert!(block.cycles.len() >= 6);
    assert_eq!(test.notes, [""; 0]);
    let c_omega = law.c * TAU * 3.0;
    let k = law.k1.hypot(c_omega);
    let measured = block.cycles.iter().map(|cycle| &cycle.result);
    for (index, figures) in measured.chain([&block.averaged]).enumerate() {
        // An extreme between samples: (π/333)²/2 = 4.4e-5, for force and amplitude. The first cycle begins with the recording,
        // which lacks 0.37 of its 333 samples.
        let tolerance = if index == 0 { 1.2e-3 } else { 2e-4 };
        close(figures.stiffness / k, 1.0, tolerance);
        close(figures.dissipated / (PI * c_omega * 0.01), 1.0, tolerance);
        close(figures.loop_area / figures.dissipated, 1.0, tolerance);
        close(figures.loss_factor / (c_omega / k), 1.0, tolerance);
    }
    // The first cycle's 1.1e-3, averaged over eight or seven.
    close(block.frequency / 3.0, 1.0, 2e-4);
}

/// Eq 13 with the tables' coefficients: ΔW = 4X·c·(ωX)^α·(√π/2)·Γ(1 + α/2)/Γ(3/2 + α/2), block by block.
#[test]
fn every_block_has_the_energy_of_eq_13() {
    let law = tables::cell(1, 3);
    let blocks = [(0.1, 1.0, 6.0), (0.2, 1.0, 6.0), (0.2, 4.0, 8.0)];
    let test = dynamic_test(&cycles(law, &blocks, 1000.0, 0.0)).unwrap();
    assert_eq!(test.blocks.len(), 3);
    let half = law.alpha / 2.0;
    let integral = PI.sqrt() / 2.0 * libm::tgamma(1.0 + half) / libm::tgamma(1.5 + half);
    for (block, (amplitude, frequency, _)) in test.blocks.iter().zip(blocks) {
        let force = law.damping_force(TAU * frequency * amplitude);
        let expected = 4.0 * amplitude * force * integral;
        close(block.averaged.amplitude / amplitude, 1.0, 1e-3);
        close(block.averaged.dissipated / expected, 1.0, 3e-3);
        close(block.averaged.loop_area / expected, 1.0, 1e-2);
        close(
            block.averaged.loss_factor,
            expected / (PI * block.averaged.stiffness * amplitude * amplitude),
            2e-3,
        );
    }
}

/// Noise widens the extremes of each cycle; the average of twenty cycles has less noise, and the harmonics have none of that.
#[test]
fn the_averaged_cycle_is_nearer_than_the_cycles() {
    let law = Coefficients::new(1.5, 0.0, 0.03, 1.0);
    let test = dynamic_test(&cycles(law, &[(0.1, 2.0, 22.0)], 500.0, 0.02)).unwrap();
    let block = &test.blocks[0];
    let k = law.k1.hypot(law.c * TAU * 2.0);
    let cycles = block.cycles.iter().map(|cycle| cycle.result.stiffness);
    let of_extremes = cycles.sum::<f64>() / block.cycles.len() as f64;
    assert!(of_extremes > 1.01 * k);
    close(block.stiffness.mean / k, 1.0, 0.005);
    close(block.averaged.stiffness / k, 1.0, 0.01);
    assert!(block.stiffness.deviation.unwrap() > 0.0);
}

/// x = X·(sin θ + 0.2·sin 3θ) with c·v: ∮F dx is π·c·ω·X²·(1 + 0.04·9), while eq 5 gives π·X0·c·ω·X with half the range X0 =
/// 0.8710·X, where cos²θ = 1/3.
#[test]
fn a_motion_that_is_no_sine_is_said_to_be_none() {
    let (amplitude, c, frequency) = (0.1, 0.3, 1.0);
    let omega = TAU * frequency;
    let time: Vec<f64> = (0..6000).map(|i| f64::from(i) / 1000.0).collect();
    let phase = |t: f64| omega * t + 1e-3;
    let of_x = |t: &f64| amplitude * (phase(*t).sin() + 0.2 * (3.0 * phase(*t)).sin());
    let of_v = |t: &f64| amplitude * omega * (phase(*t).cos() + 0.6 * (3.0 * phase(*t)).cos());
    let x: Vec<f64> = time.iter().map(of_x).collect();
    let f = time.iter().map(|t| of_x(t) + c * of_v(t)).collect();
    let test = dynamic_test(&Recording::new("bent", time, x, f).unwrap()).unwrap();
    let averaged = &test.blocks[0].averaged;
    let of_sine = PI * c * omega * amplitude * amplitude;
    close(averaged.loop_area / (1.36 * of_sine), 1.0, 5e-3);
    close(averaged.dissipated / (0.8710 * of_sine), 1.0, 5e-3);
    assert!(test.notes[0].contains("no sine"), "{:?}", test.notes);
}

/// A ramp of amplitude, a block, and one cycle in transition to the next block: only cycles of the blocks count.
#[test]
fn ramps_and_ways_between_blocks_are_left_out() {
    let law = tables::cell(1, 2);
    let ways = [
        (0.05, 1.0, 1.0),
        (0.1, 1.0, 5.0),
        (0.12, 2.0, 1.0),
        (0.15, 4.0, 6.0),
    ];
    let test = dynamic_test(&cycles(law, &ways, 1000.0, 0.0)).unwrap();
    let found: Vec<(f64, f64)> = test
        .blocks
        .iter()
        .map(|block| (block.averaged.amplitude, block.frequency))
        .collect();
    assert_eq!(found.len(), 2, "{found:?}");
    for ((amplitude, frequency), expected) in found.into_iter().zip([(0.1, 1.0), (0.15, 4.0)]) {
        close(amplitude / expected.0, 1.0, 2e-3);
        close(frequency / expected.1, 1.0, 2e-3);
    }
}

#[test]
fn too_few_samples_or_cycles_are_refused() {
    let law = tables::cell(0, 0);
    let refused = |recording: Recording| dynamic_test(&recording).unwrap_err().to_string();
    assert!(refused(cycles(law, &[(0.1, 10.0, 20.0)], 100.0, 0.0)).contains("samples only"));
    assert!(refused(PRESS.whole()).contains("no whole cycle"));
}

/// A Maxwell branch beside a spring and a slider, in blocks that a seed draws, after a ramp and with a change of amplitude between blocks;
/// `noise` relative to the force's RMS.
fn bushing(seed: u64, noise: f64) -> Recording {
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let conditions: Vec<(f64, f64)> = (0..4)
        .map(|_| {
            (
                random.random_range(0.08..1.0),
                random.random_range(3.0..15.0),
            )
        })
        .collect();
    let rate = 500.0;
    let (mut x, mut f) = (Vec::new(), Vec::new());
    let (mut branch, mut anchor, mut before) = (0.0, 0.0_f64, 0.0);
    for (amplitude, frequency) in conditions {
        for i in 0..(8.0 * rate / frequency) as usize {
            let cycles = i as f64 / rate * frequency;
            let envelope = 0.5 - 0.5 * (PI * cycles.min(1.0).min(8.0 - cycles)).cos();
            let y = amplitude * envelope * (TAU * cycles).sin();
            branch = (branch + 0.3 * (y - before)) * (-1.0 / (rate * 0.012_f64)).exp();
            before = y;
            anchor = anchor.clamp(y - 0.02, y + 0.02);
            x.push(y);
            f.push(0.8 * y + 0.25 * y.powi(3) + branch + 1.5 * (y - anchor));
        }
    }
    let rms = (f.iter().map(|f| f * f).sum::<f64>() / f.len() as f64).sqrt();
    let normal = Normal::new(0.0, 1.0).unwrap();
    let time = (0..x.len()).map(|i| i as f64 / rate).collect();
    x.iter_mut()
        .for_each(|y| *y += 1e-4 * normal.sample(&mut random));
    f.iter_mut()
        .for_each(|f| *f += noise * rms * normal.sample(&mut random));
    Recording::new("bushing", time, x, f).unwrap()
}

/// The interval of the mean stiffness holds the value without noise in 90 % of the blocks, less three deviations of that number; the mean
/// of the deviations from it is within its own error.
#[test]
#[ignore = "half a minute: in the full tier"]
fn the_stiffness_has_no_noise_in_it() {
    let (mut blocks, mut held, mut deviations) = (0, 0, Vec::new());
    for seed in 0..50 {
        let noise = 0.005 * 6.0_f64.powf(seed as f64 / 49.0);
        let clean = dynamic_test(&bushing(seed, 0.0)).unwrap().blocks;
        let noisy = dynamic_test(&bushing(seed, noise)).unwrap().blocks;
        assert_eq!((clean.len(), noisy.len()), (4, 4), "seed {seed}");
        for (clean, noisy) in clean.iter().zip(&noisy) {
            let truth = clean.stiffness.mean;
            let [low, high] = noisy.stiffness_interval;
            blocks += 1;
            held += usize::from((low..=high).contains(&truth));
            deviations.push((noisy.stiffness.mean - truth) / (0.5 * (high - low) / 1.645));
            // Eq 3 of the cycle without noise, between samples and with a first cycle less.
            close(truth / clean.averaged.stiffness, 1.0, 0.01);
        }
    }
    assert_eq!(blocks, 200);
    let least = 180.0 - 3.0 * (200.0 * 0.9 * 0.1_f64).sqrt();
    assert!(held as f64 >= least, "{held} of {blocks}");
    let mean = deviations.iter().sum::<f64>() / 200.0;
    assert!(mean.abs() < 0.35, "{mean} deviations");
}

/// A row or a note for each condition, and the first cycle after a change of amplitude does not count.
#[test]
fn every_condition_has_a_row_or_a_note() {
    let law = Coefficients::new(1.5, 0.0, 0.03, 1.0);
    let mut conditions = Vec::new();
    for amplitude in [0.05, 0.2, 1.0] {
        for frequency in [1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0] {
            conditions.push((amplitude, frequency, 8.0));
        }
    }
    for rate in [500.0, 300.0] {
        let test = dynamic_test(&cycles(law, &conditions, rate, 0.01)).unwrap();
        let has = |(amplitude, frequency, _): (f64, f64, f64)| {
            let is_row = test.blocks.iter().any(|block| {
                (block.averaged.amplitude / amplitude - 1.0).abs() < 0.03
                    && (block.frequency / frequency - 1.0).abs() < 0.03
            });
            // The samples of a short cycle miss its extremes.
            let named = |note: &String| {
                let mut words = note.strip_prefix("left out: ")?.split(' ');
                let mut number = || words.find_map(|word| word.parse::<f64>().ok());
                let (a, f) = (number()? / amplitude, number()? / frequency);
                Some((0.8..1.05).contains(&a) && (f - 1.0).abs() < 0.03)
            };
            is_row || test.notes.iter().any(|note| named(note) == Some(true))
        };
        for condition in conditions.clone() {
            assert!(has(condition), "{rate} Hz: {condition:?}: {:?}", test.notes);
        }
        for block in test.blocks.iter().filter(|block| block.cycles.len() > 2) {
            assert!(!block.cycles[0].steady, "{}", block.frequency);
        }
    }
}

/// Of a spring and a dashpot with a mass before them, and a force that is late.
#[test]
fn what_is_known_about_the_rig_is_taken_out_of_the_force() {
    let (stiffness, loss, mass, late, rate) = (1.2, 0.5, 20.0, 3e-3, 1000.0);
    let omega = TAU * 8.0;
    let time: Vec<f64> = (0..2000).map(|i| f64::from(i) / rate).collect();
    let x = time.iter().map(|t| 0.5 * (omega * t).sin()).collect();
    let felt = stiffness - 1e-6 * mass * omega * omega;
    let force = |t: &f64| {
        let (sin, cos) = (omega * (t - late)).sin_cos();
        0.5 * (felt * sin + loss * cos)
    };
    let f = time.iter().map(force).collect();
    let recording = Recording::new("known", time, x, f).unwrap();
    let facts = RigFacts {
        fixture_mass: Some(mass),
        force_delay: Some(late),
        zero: None,
    };
    let known = dynamic_test_on(&recording, &facts).unwrap();
    let dynamic = stiffness.hypot(loss);
    close(known.blocks[0].stiffness.mean, dynamic, 2e-3);
    close(known.blocks[0].averaged.loss_factor, loss / dynamic, 2e-3);
    assert_eq!(known.notes.len(), 2, "{:?}", known.notes);
    let unknown = dynamic_test(&recording).unwrap();
    close(unknown.blocks[0].stiffness.mean, felt.hypot(loss), 2e-3);
}

/// The last cycle may end with the last sample.
#[test]
fn a_recording_may_end_anywhere_in_a_cycle() {
    for samples in 200..240 {
        let angle = |n: usize| TAU * n as f64 / 40.0;
        let time = (0..samples).map(|n| n as f64 / 40.0).collect();
        let displacement = (0..samples).map(|n| 0.1 * angle(n).sin()).collect();
        let force = (0..samples).map(|n| 0.2 * (angle(n) + 0.1).sin()).collect();
        let recording = Recording::new("end", time, displacement, force).unwrap();
        let found = dynamic_test(&recording).unwrap();
        let [block] = &found.blocks[..] else {
            panic!("{samples} samples: {} blocks", found.blocks.len())
        };
        close(block.frequency, 1.0, 2e-3);
        close(block.stiffness.mean, 2.0, 0.01);
    }
}

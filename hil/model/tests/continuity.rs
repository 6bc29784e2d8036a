//! A predicted force is as continuous as the law and the motion: no single tick stands out in a smooth motion.

use std::f64::consts::TAU;

use mesh_damper_model::predict::{predict, predict_embedded};
use mesh_damper_model::{LawNode, Model};
use mesh_damper_recording::trajectory::Trajectory;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// s
const TICK: f64 = 1e-3;
const SAMPLES: usize = 6000;
/// Noise of the displacement sensor, mm.
const NOISE: f64 = 5e-5;
/// Samples at each end, where a window has only one side.
const ENDS: usize = 100;
/// Tolerated error of the velocity, as a fraction of its RMS: the estimate has a bias where the motion bends.
const TOLERATED: f64 = 0.1;

const LAW: LawNode = LawNode {
    amplitude: 0.0,
    k1: 1.2,
    k3: 8.0,
    c: 0.1,
    alpha: 0.3,
};

/// True displacement in mm and velocity in mm/s.
type Truth = (Vec<f64>, Vec<f64>);

/// Sines of `lines`, amplitude mm, frequency Hz and phase rad.
fn sum_of(lines: &[(f64, f64, f64)]) -> Truth {
    let at = |n: usize| {
        let t = n as f64 * TICK;
        lines.iter().fold((0.0, 0.0), |(y, v), (a, f, phase)| {
            let (sin, cos) = (TAU * f * t + phase).sin_cos();
            (y + a * sin, v + a * TAU * f * cos)
        })
    };
    (0..SAMPLES).map(at).unzip()
}

/// Twelve lines of equal amplitude, from a fundamental of 0.5 Hz up to 15 Hz.
fn multisine(seed: u64) -> Truth {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let lines: Vec<_> = [1, 2, 3, 5, 7, 9, 11, 14, 17, 21, 25, 30]
        .into_iter()
        .map(|line| (0.05, 0.5 * f64::from(line), random.random_range(0.0..TAU)))
        .collect();
    sum_of(&lines)
}

/// Gaussian motion up to 10 Hz whose amplitude falls with the frequency.
fn random_motion(seed: u64) -> Truth {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let lines: Vec<_> = (0..150)
        .map(|_| {
            let f: f64 = random.random_range(0.3..10.0);
            (0.04 / (1.0 + f), f, random.random_range(0.0..TAU))
        })
        .collect();
    sum_of(&lines)
}

fn elastic(y: f64) -> f64 {
    LAW.k1 * y + LAW.k3 * y.powi(3)
}

fn damping(v: f64) -> f64 {
    LAW.c * v.abs().powf(LAW.alpha) * v.signum()
}

/// Ticks whose force belongs to none of the velocities between the tick before and the tick after, with the tolerated errors
/// included.
fn outliers(truth: &Truth, forces: &[f64]) -> Vec<usize> {
    let (displacement, velocity) = truth;
    let rms = (velocity.iter().map(|v| v * v).sum::<f64>() / velocity.len() as f64).sqrt();
    // Noise and bias of the displacement affect the elastic force; these limits are ten times the noise.
    let slack = 10.0 * NOISE * LAW.k1;
    (ENDS..SAMPLES - ENDS)
        .filter(|&n| {
            let around = &velocity[n - 1..=n + 1];
            let low = around.iter().fold(f64::MAX, |a, b| a.min(*b)) - TOLERATED * rms;
            let high = around.iter().fold(f64::MIN, |a, b| a.max(*b)) + TOLERATED * rms;
            let y = displacement[n];
            let felt = forces[n] - elastic(y);
            felt < damping(low) - slack || felt > damping(high) + slack
        })
        .collect()
}

fn check(truth: &Truth, seed: u64) -> Result<(), TestCaseError> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, NOISE).unwrap();
    let recorded: Vec<f64> = truth
        .0
        .iter()
        .map(|y| y + noise.sample(&mut random))
        .collect();
    // The middle of a motion is its zero if the force shows it.
    let felt = |(y, v): (&f64, &f64)| elastic(*y) + damping(*v);
    let force = truth.0.iter().zip(&truth.1).map(felt).collect();
    let trajectory = Trajectory::new("smooth", TICK, &recorded, force, None, None);
    let model = Model {
        law: vec![LAW],
        effects: Vec::new(),
        correction: None,
        controls: Vec::new(),
    };
    // The estimate finds no kink in it.
    prop_assert_eq!(&trajectory.motion.kinks, &Vec::<usize>::new());
    for forces in [
        predict(&model, &trajectory).unwrap(),
        predict_embedded(&model, &trajectory).unwrap(),
    ] {
        prop_assert_eq!(outliers(truth, &forces), Vec::<usize>::new());
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(29), ..ProptestConfig::with_cases(64) })]

    #[test]
    fn the_force_under_a_multisine_is_continuous(seed in any::<u64>()) {
        check(&multisine(seed), seed)?;
    }

    #[test]
    #[ignore = "half a minute: in the full tier"]
    fn the_force_under_random_motion_is_continuous(seed in any::<u64>()) {
        check(&random_motion(seed), seed)?;
    }
}

//! Motions that are no blocks of sines: nothing is called missing from a law that is the specimen's.

use std::f64::consts::{PI, TAU};

use mesh_damper_identify::trace::result::{TraceResult, Verdict};
use mesh_damper_identify::trace::trace;
use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Normal};

const RATE: f64 = 500.0;
const DURATION: f64 = 30.0;

fn law() -> Coefficients {
    tables::interpolate(3.0, 0.1)
}

/// Displacement and velocity of noise up to 12 Hz.
fn random(seed: u64) -> impl Fn(f64) -> [f64; 2] {
    let mut random = StdRng::seed_from_u64(seed);
    let tones: Vec<[f64; 3]> = (0..40)
        .map(|_| {
            let turn = TAU * random.random_range(0.3..12.0);
            [
                0.03 / (turn / TAU).max(1.0),
                turn,
                random.random_range(0.0..TAU),
            ]
        })
        .collect();
    move |time| {
        tones.iter().fold([0.0; 2], |[y, v], [size, turn, phase]| {
            let (sin, cos) = (turn * time + phase).sin_cos();
            [y + size * sin, v + size * turn * cos]
        })
    }
}

/// Steps to and fro, each along half a wave of a cosine, with holds of two seconds.
fn steps(seed: u64) -> impl Fn(f64) -> [f64; 2] {
    let mut random = StdRng::seed_from_u64(seed);
    let mut places = vec![0.0];
    places.extend((0..20).map(|_| random.random_range(-0.15..0.15)));
    move |time| {
        let step = (time / 2.2) as usize;
        let since = time - 2.2 * step as f64 - 2.0;
        let (from, to): (f64, f64) = (places[step], places[step + 1]);
        if since <= 0.0 {
            return [from, 0.0];
        }
        let (sin, cos) = (PI * since / 0.2).sin_cos();
        let way = to - from;
        [from + 0.5 * way * (1.0 - cos), 0.5 * way * PI / 0.2 * sin]
    }
}

/// The law's force with noise over its RMS, along a motion whose displacement has noise in mm.
fn recorded(
    motion: impl Fn(f64) -> [f64; 2],
    noise: f64,
    of_displacement: f64,
    seed: u64,
) -> Recording {
    let mut random = StdRng::seed_from_u64(seed);
    let mut noisy = |deviation: f64| Normal::new(0.0, deviation).unwrap().sample(&mut random);
    let time: Vec<f64> = (0..(RATE * DURATION) as usize)
        .map(|index| index as f64 / RATE)
        .collect();
    let law = law();
    let force: Vec<f64> = time
        .iter()
        .map(|time| {
            let [y, v] = motion(*time);
            law.force(y, v)
        })
        .collect();
    let rms = (force.iter().map(|force| force * force).sum::<f64>() / force.len() as f64).sqrt();
    let displacement = time
        .iter()
        .map(|time| motion(*time)[0] + noisy(of_displacement))
        .collect();
    let force = force
        .iter()
        .map(|force| force + noisy(noise * rms))
        .collect();
    Recording::new("any motion", time, displacement, force).unwrap()
}

fn traced(training: Recording, held_out: Recording) -> TraceResult {
    trace(&[training], &[held_out], &|_| ()).unwrap().result
}

/// A little noise of the displacement is much force near a standstill, where |v|^α is steep: what it makes of the force is allowed
/// for, however quiet the force is and however shaky the displacement.
#[test]
fn noise_of_the_displacement_is_no_missing_effect() {
    for (noise, of_displacement) in [(1e-3, 5e-5), (5e-3, 5e-4), (1e-2, 1e-4)] {
        let test = |seed| recorded(random(seed), noise, of_displacement, seed);
        let result = traced(test(1), test(2));
        assert_eq!(result.verdict, Verdict::None, "{noise} {of_displacement}");
        let (found, law) = (&result.law[0], law());
        for (found, true_value) in [
            (&found.k1, law.k1),
            (&found.c, law.c),
            (&found.alpha, law.alpha),
        ] {
            assert!(
                (found.value / true_value - 1.0).abs() < 0.03,
                "{} {true_value}",
                found.value
            );
        }
    }
}

/// What stands still has no velocity whose sign noise could give.
#[test]
fn holds_between_steps_are_no_missing_effect() {
    let test = |seed| recorded(steps(seed), 5e-3, 5e-5, seed);
    let (training, held_out) = (test(3), test(4));
    // What the true law leaves along the estimated motion, which a fitted one is nearly as good as.
    let trajectory = Trajectory::of(&held_out).unwrap();
    let (motion, law) = (&trajectory.motion, law());
    assert!(motion.rests.len() > 10, "{:?}", motion.rests);
    let left = motion
        .displacement
        .iter()
        .zip(&motion.velocity)
        .zip(&trajectory.force);
    let left = left
        .map(|((y, v), force)| (force - law.force(*y, *v)).powi(2))
        .sum::<f64>();
    let of_truth = left.sqrt() / trajectory.force.iter().map(|f| f * f).sum::<f64>().sqrt();
    let result = traced(training, held_out);
    assert_eq!(result.verdict, Verdict::None);
    let error = result.augmented.nrmse_held_out;
    assert!(error < 1.1 * of_truth, "{error} {of_truth}");
}

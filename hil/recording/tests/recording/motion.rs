//! Motion, cycles and blocks estimated from displacements with a known truth.

use std::f64::consts::TAU;

use mesh_damper_recording::noise::noise_deviation;
use mesh_damper_recording::trajectory::Trajectory;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

const TICK: f64 = 2e-3;

/// Amplitude mm, frequency Hz, cycles.
type SineBlock = (f64, f64, u32);

/// Displacement and velocity of blocks of sines. The amplitude changes smoothly over the first half cycle of each block, and the
/// frequency changes at once, so the velocity jumps.
fn programme(blocks: &[SineBlock]) -> (Vec<f64>, Vec<f64>) {
    let (mut displacement, mut velocity) = (Vec::new(), Vec::new());
    let mut before = 0.0;
    for &(amplitude, frequency, cycles) in blocks {
        let count = (f64::from(cycles) / frequency / TICK).round() as usize;
        for n in 0..count {
            let turns = n as f64 * TICK * frequency;
            let s = (2.0 * turns).min(1.0);
            let (ramp, slope) = (s * s * (3.0 - 2.0 * s), 12.0 * frequency * s * (1.0 - s));
            let (envelope, change) = (
                before + (amplitude - before) * ramp,
                (amplitude - before) * slope,
            );
            let (sin, cos) = (TAU * turns).sin_cos();
            displacement.push(envelope * sin);
            velocity.push(change * sin + envelope * TAU * frequency * cos);
        }
        before = amplitude;
    }
    (displacement, velocity)
}

fn noisy(clean: &[f64], deviation: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, deviation).unwrap();
    clean
        .iter()
        .map(|y| y + noise.sample(&mut random))
        .collect()
}

fn trajectory(displacement: &[f64]) -> Trajectory {
    Trajectory::new(
        "test",
        TICK,
        displacement,
        vec![0.0; displacement.len()],
        None,
        None,
    )
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
    f64::sqrt(sum / count)
}

const BLOCKS: [SineBlock; 4] = [
    (0.05, 1.0, 6),
    (0.05, 5.0, 10),
    (0.2, 1.0, 6),
    (0.1, 10.0, 20),
];

/// Differences would turn displacement noise of 1e-4 mm into 0.035 mm/s.
#[test]
fn velocity_is_known_a_hundred_times_better_than_by_differences() {
    let (clean, truth) = programme(&BLOCKS);
    let trajectory = trajectory(&noisy(&clean, 1e-4, 1));
    let error = |range: std::ops::Range<usize>| {
        rms(range.map(|n| trajectory.motion.velocity[n] - truth[n]))
    };
    // Steady cycles, from the second of each block. Ten coefficients over at least three half cycles of n samples have a mean
    // deviation of 1e-4·ω·√(10/1.5n), and twice that at the ends of a block. The test allows four times.
    for (range, omega, samples) in [
        (500..3000, TAU, 1000.0),
        (3100..4000, 5.0 * TAU, 200.0),
        (4500..7000, TAU, 1000.0),
        (7050..8000, 10.0 * TAU, 100.0),
    ] {
        let allowed = 4e-4 * omega * f64::sqrt(10.0 / (1.5 * samples));
        let found = error(range.clone());
        assert!(
            found < allowed,
            "samples {range:?}: {found} mm/s, allowed {allowed}"
        );
    }
    // Ramps: a few thousandths of the peak velocity.
    assert!(error(4000..4500) < 0.01, "{}", error(4000..4500));
}

/// |v|^0.4 distinguishes 1e-3 mm/s from 0: a start from rest must stay at rest.
#[test]
fn a_start_from_rest_begins_with_no_velocity() {
    let (clean, truth) = programme(&BLOCKS);
    for seed in 0..20 {
        let motion = trajectory(&noisy(&clean, 1e-4, seed)).motion;
        for (n, (found, truth)) in motion.velocity.iter().zip(&truth).take(10).enumerate() {
            let error = (found - truth).abs();
            assert!(error < 2e-3, "seed {seed}, sample {n}: off by {error} mm/s");
        }
    }
}

/// Friction has its full force from the first of them on, and noise of 1e-4 mm hides a motion of 1e-7 mm.
#[test]
fn a_start_from_rest_goes_one_way() {
    let (clean, _) = programme(&BLOCKS);
    for seed in 0..20 {
        for way in [1.0, -1.0] {
            let moved: Vec<f64> = clean.iter().map(|y| way * y).collect();
            let motion = trajectory(&noisy(&moved, 1e-4, seed)).motion;
            let mut first = motion.velocity[1..=20].iter();
            assert!(first.all(|v| way * v > 0.0), "seed {seed}, way {way}");
        }
    }
}

/// Where the specimen is at rest before it moves, the estimate invents no direction. One in 22 samples exceeds 2 deviations.
#[test]
fn a_standstill_before_the_motion_has_no_direction() {
    let (clean, _) = programme(&BLOCKS);
    let still: Vec<f64> = std::iter::repeat_n(0.0, 600).chain(clean).collect();
    let moving = (0..20).map(|seed| {
        let motion = trajectory(&noisy(&still, 1e-4, seed)).motion;
        motion.velocity[..500].iter().filter(|v| **v != 0.0).count()
    });
    let moving: usize = moving.sum();
    assert!(moving < 20 * 500 / 10, "{moving}");
}

#[test]
fn kinks_are_found_to_the_sample_and_nowhere_else() {
    let (clean, _) = programme(&BLOCKS);
    for seed in 0..40 {
        let trajectory = trajectory(&noisy(&clean, 1e-4, seed));
        assert_eq!(trajectory.motion.kinks, [3000, 4000, 7000], "seed {seed}");
    }
}

#[test]
fn blocks_are_those_of_the_programme() {
    let (clean, _) = programme(&BLOCKS);
    let trajectory = trajectory(&noisy(&clean, 1e-4, 3));
    let starts: Vec<usize> = trajectory
        .blocks
        .iter()
        .map(|block| block.samples.start)
        .collect();
    assert_eq!(starts, [0, 3000, 4000, 7000]);
    for (block, (amplitude, frequency, cycles)) in trajectory.blocks.iter().zip(BLOCKS) {
        assert!(
            (block.amplitude - amplitude).abs() < 0.01 * amplitude,
            "{} mm",
            block.amplitude
        );
        assert!(
            (block.frequency - frequency).abs() < 0.01 * frequency,
            "{} Hz",
            block.frequency
        );
        // The last cycle may lack the crossing that would end it.
        assert!(
            cycles as usize - block.cycles.len() <= 1,
            "{} cycles",
            block.cycles.len()
        );
    }
    assert!(
        (trajectory.cycles[7999] - 42.0).abs() < 0.05,
        "{}",
        trajectory.cycles[7999]
    );
}

/// A triangle has a kink at every turn, and a constant velocity in between.
#[test]
fn a_triangle_keeps_its_corners() {
    let wave: Vec<f64> = (0..4000)
        .map(|n| {
            let turn = (n as f64 + 0.5) / 400.0;
            0.4 * (2.0 * (turn - (turn + 0.5).floor())).abs() - 0.2
        })
        .collect();
    let motion = trajectory(&noisy(&wave, 1e-4, 5)).motion;
    assert!(motion.kinks.len() >= 18, "{} corners", motion.kinks.len());
    let speed = 0.8 / (400.0 * TICK);
    let wrong = (300..3700)
        .filter(|&n| (motion.velocity[n].abs() - speed).abs() > 0.02 * speed)
        .count();
    assert!(wrong < 20, "{wrong} samples");
}

/// Corners that are two windows of a 20th of a period apart are both found.
#[test]
fn a_trapezoid_keeps_its_corners() {
    for dwell in [60, 45] {
        let (rise, half) = (200 - dwell, 200);
        let wave = |n: usize| {
            let part = ((n % half) as f64 / rise as f64).min(1.0);
            (if (n / half).is_multiple_of(2) {
                part
            } else {
                1.0 - part
            }) * 0.4
                - 0.2
        };
        let wave: Vec<f64> = (0..4000).map(wave).collect();
        let kinks = trajectory(&noisy(&wave, 1e-4, 6)).motion.kinks;
        let corners = (1..19).flat_map(|turn| [turn * half, turn * half + rise]);
        let is_found = |corner: &usize| kinks.iter().any(|kink| kink.abs_diff(*corner) <= 2);
        let found = corners.filter(is_found).count();
        assert_eq!(found, 36, "{dwell}: {kinks:?}");
    }
}

#[test]
fn the_noise_is_read_off_the_samples() {
    let (clean, _) = programme(&BLOCKS);
    for deviation in [1e-5, 1e-4, 1e-3] {
        let found = noise_deviation(&noisy(&clean, deviation, 9));
        // A median of 8000 magnitudes of correlated differences: 3 %.
        assert!(
            (found - deviation).abs() < 0.05 * deviation,
            "{found} for {deviation}"
        );
    }
    assert!(noise_deviation(&clean) < 2e-6);
}

/// The same motion on a shifted and scaled axis has the same blocks: the result does not depend on the unit or the zero.
#[test]
fn blocks_do_not_depend_on_the_axis() {
    let (clean, _) = programme(&BLOCKS);
    let recorded = noisy(&clean, 1e-4, 4);
    let moved: Vec<f64> = recorded.iter().map(|y| 30.0 * y + 7.0).collect();
    let spans =
        |t: &Trajectory| -> Vec<_> { t.blocks.iter().map(|block| block.samples.clone()).collect() };
    assert_eq!(spans(&trajectory(&recorded)), spans(&trajectory(&moved)));
}

/// Sums of tones up to 10 Hz, with and without holds: displacement and velocity.
fn tones_with_holds(holds: bool) -> (Vec<f64>, Vec<f64>) {
    let at = |index: usize| {
        let time = index as f64 * TICK;
        let (gate, slope) = match (time % 8.0, holds) {
            (since, true) if since > 5.0 => (0.0, 0.0),
            (since, true) => {
                let (sin, cos) = (TAU * since / 5.0).sin_cos();
                (0.5 * (1.0 - cos), 0.5 * sin * TAU / 5.0)
            }
            (_, false) => (1.0, 0.0),
        };
        let tones = (1..25).map(|tone| {
            let turn = TAU * (0.4 * f64::from(tone) + 0.013 * f64::from(tone * tone % 7));
            let (sin, cos) = (turn * time + f64::from(tone * tone)).sin_cos();
            let size = 0.05 / f64::from(tone);
            (size * sin, size * turn * cos)
        });
        let (y, v) = tones.fold((0.0, 0.0), |(y, v), (a, b)| (y + a, v + b));
        (gate * y, gate * v + slope * y)
    };
    (0..10_000).map(at).unzip()
}

/// The stated error of a motion equals its true error, whatever the noise and the motion. The variance of a window's slope alone is
/// smaller: it does not include the part that smoothing removed.
#[test]
fn the_error_of_a_motion_is_as_large_as_is_said() {
    for (holds, deviation, seed) in [(false, 5e-5, 1), (false, 5e-4, 2), (true, 1e-4, 3)] {
        let (clean, velocity) = tones_with_holds(holds);
        let trajectory = trajectory(&noisy(&clean, deviation, seed));
        let (motion, said) = (&trajectory.motion, &trajectory.motion_error);
        let off =
            |estimated: &[f64], truth: &[f64]| rms(estimated.iter().zip(truth).map(|(a, b)| a - b));
        let of_velocity = off(&motion.velocity, &velocity);
        let of_displacement = off(&motion.displacement, &clean);
        let ratios = [
            rms(said.velocity.iter().copied()) / of_velocity,
            rms(said.displacement.iter().copied()) / of_displacement,
        ];
        assert!(
            ratios.iter().all(|ratio| (0.7..1.4).contains(ratio)),
            "{deviation}: {ratios:?}"
        );
        if holds {
            let held =
                (0..clean.len()).filter(|index| (5.2..7.8).contains(&(*index as f64 * TICK % 8.0)));
            assert!(held.clone().all(|index| motion.velocity[index] == 0.0));
        }
    }
}

/// A velocity differentiated from the displacement makes the motion no worse, and a good velocity channel makes it better.
#[test]
fn a_measured_velocity_counts_by_its_noise() {
    let (clean, velocity) = tones_with_holds(false);
    let displacement = noisy(&clean, 1e-4, 5);
    let last = displacement.len() - 1;
    let differentiated: Vec<f64> = (0..=last)
        .map(|index| {
            let (a, b) = (index.saturating_sub(1), (index + 1).min(last));
            (displacement[b] - displacement[a]) / ((b - a) as f64 * TICK)
        })
        .collect();
    let error = |measured: Option<Vec<f64>>| {
        let force = vec![0.0; displacement.len()];
        let trajectory = Trajectory::new("test", TICK, &displacement, force, measured, None);
        rms(trajectory
            .motion
            .velocity
            .iter()
            .zip(&velocity)
            .map(|(a, b)| a - b))
    };
    let without = error(None);
    assert!(error(Some(differentiated)) < 1.02 * without);
    assert!(error(Some(noisy(&velocity, 1e-4, 6))) < 0.1 * without);
}

/// Tones of random phase at every line between two frequencies in cycles a sample, with sizes falling as 1/f and an RMS of 1 mm in
/// displacement: displacement, slope and curvature per sample.
fn random_phases(count: usize, band: [f64; 2], seed: u64) -> [Vec<f64>; 3] {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let phase = rand::distr::Uniform::new(0.0, TAU).unwrap();
    // Longer than the record, so that the record is not a whole number of periods.
    let period = 1.37 * count as f64;
    let lines = (band[0] * period) as usize..(band[1] * period) as usize;
    let mut all = [vec![0.0; count], vec![0.0; count], vec![0.0; count]];
    for line in lines.step_by(5) {
        let turn = TAU * line as f64 / period;
        let start = phase.sample(&mut random);
        let [y, slope, curvature] = &mut all;
        let channels = y.iter_mut().zip(slope).zip(curvature);
        for (index, ((y, slope), curvature)) in channels.enumerate() {
            let (sin, cos) = (turn * index as f64 + start).sin_cos();
            *y += cos / turn;
            *slope -= sin;
            *curvature -= turn * cos;
        }
    }
    let scale = 1.0 / rms(all[0].iter().copied());
    all.map(|values| values.into_iter().map(|value| scale * value).collect())
}

/// Five samples in the fastest period. A cubic cannot follow this motion; differentiation reaches the noise within the band.
///
/// White noise of deviation σ leaves at least σ·√(2B) of a motion of band B known exactly, and σ·√(∫₀ᴮ 2(2πf)² df) of its slope.
#[test]
fn few_samples_to_the_cycle_are_differentiated_to_the_noise() {
    let (low, high) = (0.01, 0.2);
    let [clean, slope, curvature] = random_phases(20_000, [low, high], 1);
    let off = |estimated: &[f64], truth: &[f64], scale: f64| {
        // The ends have samples on one side only.
        let inner = 100..truth.len() - 100;
        rms(inner.map(|index| estimated[index] * scale - truth[index]))
    };
    for deviation in [3e-3, 3e-2] {
        let motion = trajectory(&noisy(&clean, deviation, 2)).motion;
        let moment = |power: i32| {
            let power = 2 * power + 1;
            2.0 * (high.powi(power) - low.powi(power)) / f64::from(power)
        };
        for (derivative, error) in [
            off(&motion.displacement, &clean, 1.0),
            off(&motion.velocity, &slope, TICK),
            off(&motion.acceleration, &curvature, TICK * TICK),
        ]
        .into_iter()
        .enumerate()
        {
            let order = derivative as i32;
            let least = deviation * TAU.powi(order) * moment(order).sqrt();
            assert!(
                (0.8..1.5).contains(&(error / least)),
                "{deviation}: derivative {derivative} is off by {error}, the least is {least}"
            );
        }
        assert!(motion.kinks.is_empty());
        assert!((motion.noise / deviation - 1.0).abs() < 0.1);
    }
    // Without noise the error is below a thousandth. A cubic over nine samples, with five in a period, is off by a third.
    let motion = trajectory(&clean).motion;
    assert!(off(&motion.velocity, &slope, TICK) < 2e-3 * rms(slope.iter().copied()));
}

/// The true error is as large as the stated one, for each derivative.
#[test]
fn the_error_of_a_motion_of_few_samples_is_as_large_as_is_said() {
    let [clean, slope, curvature] = random_phases(20_000, [0.01, 0.15], 3);
    let trajectory = trajectory(&noisy(&clean, 1e-2, 4));
    let (motion, said) = (&trajectory.motion, &trajectory.motion_error);
    let off = |estimated: &[f64], truth: &[f64], scale: f64| {
        rms((0..truth.len()).map(|index| estimated[index] * scale - truth[index]))
    };
    let ratios = [
        rms(said.displacement.iter().copied()) / off(&motion.displacement, &clean, 1.0),
        rms(said.velocity.iter().copied()) * TICK / off(&motion.velocity, &slope, TICK),
        rms(said.acceleration.iter().copied()) * TICK * TICK
            / off(&motion.acceleration, &curvature, TICK * TICK),
    ];
    assert!(
        ratios.iter().all(|ratio| (0.8..1.25).contains(ratio)),
        "{ratios:?}"
    );
}

/// A triangle of a hundred samples in a period has a spectrum too, but its corners remain corners.
#[test]
fn corners_of_a_fast_triangle_stay_corners() {
    let triangle = |index: usize| {
        let turn = index as f64 / 100.0 + 0.013;
        1.0 - 4.0 * ((turn - turn.floor()) - 0.5).abs()
    };
    let clean: Vec<f64> = (0..20_000).map(triangle).collect();
    let motion = trajectory(&noisy(&clean, 1e-3, 5)).motion;
    // One every half period.
    assert!(motion.kinks.len() > 380, "{}", motion.kinks.len());
    let speed = 4.0 / 100.0 / TICK;
    let close = motion
        .velocity
        .iter()
        .filter(|v| (v.abs() / speed - 1.0).abs() < 0.02);
    assert!(close.count() > 16_000);
}

/// What a law leaves beyond the tolerance of each sample, whose motion may be as uncertain as it likes: the variance of what it lacks,
/// and nothing for a perfect law.
#[test]
fn what_a_law_leaves_is_what_it_lacks() {
    let (clean, _) = programme(&[(0.1, 2.0, 8), (0.2, 5.0, 20)]);
    for lacking in [0.0, 0.02] {
        let mut found = trajectory(&noisy(&clean, 1e-4, 5));
        // Up to a hundred times the noise of the force.
        found.force_noise = 1e-3;
        found.carried = (0..found.len())
            .map(|sample| 1e-6 * f64::from(sample as u32 % 100).powi(2))
            .collect();
        let mut random = ChaCha8Rng::seed_from_u64(6);
        let mut draw = |deviation: f64| Normal::new(0.0, deviation).unwrap().sample(&mut random);
        let left = (0..found.len())
            .map(|sample| draw((found.tolerance(sample) + lacking * lacking).sqrt()));
        let left: Vec<f64> = left.collect();
        let deviation = found.left_beyond_tolerance(&left, |_| true).sqrt();
        // A standard deviation of n samples is known to 1/√(2n) at best.
        let certain = 4.0 / (found.len() as f64).sqrt();
        assert!(
            (deviation - lacking).abs() < 0.02 * certain + 1e-3,
            "{deviation} for {lacking}"
        );
    }
}

//! Recordings whose channels were smoothed by a moving average before they were written.

use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_identify::trace::trace;
use mesh_damper_recording::Recording;
use mesh_damper_recording::averaging::MovingAverage;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_trials::blind::{Draw, Version};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// For a specimen with Bouc–Wen friction, 2000 samples a second, by the first version of the draw.
const SEED: u64 = 367;
const AVERAGE: MovingAverage = MovingAverage { window: 21.0 };

fn averaged(recording: &Recording) -> Recording {
    let mut averaged = recording.clone();
    averaged.displacement = AVERAGE.of(&recording.displacement);
    averaged.force = AVERAGE.of(&recording.force);
    averaged
}

/// The smoothing of the channels is reported and taken into account. Friction is still found, and predicts motion that was not
/// fitted as well as from channels without smoothing. If the smoothing is not known, the same law is far off.
#[test]
#[ignore = "half a minute: in the full tier"]
fn friction_is_found_behind_a_moving_average() {
    let version = Version::new(1).unwrap();
    let trial = Draw::Specimens.trial(version, SEED).unwrap();
    let recordings = [averaged(&trial.training)];
    let held_out = [averaged(&trial.held_out)];
    let found = trace(&recordings, &held_out, &|_| ()).expect("a trace");
    let result = &found.result;
    assert_eq!(result.verdict, Verdict::Found, "{:?}", result.warnings);
    assert_eq!(result.effects[0].family, "stick_slip");
    assert!(
        result
            .warnings
            .iter()
            .any(|text| text.contains("moving averages over 0.011 s")),
        "{:?}",
        result.warnings
    );
    let plain = trace(&[trial.training], &[trial.held_out], &|_| ()).expect("a trace");
    let (own, before) = (
        result.augmented.nrmse_held_out,
        result.baseline.nrmse_held_out,
    );
    assert!(own < 0.1 * before, "{own} {before}");
    assert!(own < 1.1 * plain.result.augmented.nrmse_held_out, "{own}");

    let mut unaware = Trajectory::of(&held_out[0]).expect("a trajectory");
    unaware.average = None;
    let force = mesh_damper_model::predict::predict(&found.model, &unaware).expect("a force");
    let unaware = mesh_damper_model::predict::nrmse(&force, &unaware.force, |_| true);
    assert!(unaware > 2.0 * own, "{unaware} {own}");
}

/// Triangles have corners that no average would leave, in one block and in two, with few cycles and many.
#[test]
fn a_motion_with_corners_was_not_averaged() {
    for cycles in [5, 8, 20, 40] {
        for blocks in [&[(0.1, 1.0)][..], &[(0.1, 1.0), (0.2, 2.0)]] {
            let mut random = ChaCha8Rng::seed_from_u64(cycles);
            let mut noise = || 2e-4 * (random.random::<f64>() - 0.5);
            let (mut time, mut displacement, mut force) = (Vec::new(), Vec::new(), Vec::new());
            for &(amplitude, frequency) in blocks {
                for sample in 0..(500.0 * cycles as f64 / frequency) as usize {
                    let turn = std::f64::consts::TAU * frequency * sample as f64 / 500.0;
                    let y = amplitude * turn.sin().asin() * std::f64::consts::FRAC_2_PI;
                    time.push(time.len() as f64 / 500.0);
                    displacement.push(y + noise());
                    force.push(y + 0.05 * turn.cos().signum() + noise());
                }
            }
            let recording = Recording::new("triangles", time, displacement, force).unwrap();
            let trajectory = Trajectory::of(&recording).unwrap();
            assert_eq!(trajectory.average, None, "{cycles} {blocks:?}");
        }
    }
}

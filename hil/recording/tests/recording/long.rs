//! What is found of a long recording without a trace takes time in proportion to its samples.

use std::time::Instant;

use mesh_damper_recording::Recording;
use rand::rngs::StdRng;
use rand::{RngExt as _, SeedableRng as _};

/// A recording whose displacement has one of `levels` for 500 samples each, with `noise`, and a force with two spikes in 31.
fn recording(samples: usize, levels: usize, noise: f64) -> Recording {
    let mut random = StdRng::seed_from_u64(3);
    let mut about = |value: f64, noise: f64| value + noise * random.random_range(-1.0..1.0);
    let time = (0..samples).map(|index| 1e-3 * index as f64).collect();
    let level = |index: usize| (index / 500 % levels) as f64;
    let displacement = (0..samples).map(|index| about(level(index), noise));
    let displacement = displacement.collect();
    // Not at equal steps: those would be new values of a slower channel.
    let spike = |index: usize| if index * index % 31 == 7 { 9.0 } else { 0.0 };
    let force = (0..samples).map(|index| about(spike(index), 0.01));
    let force = force.collect();
    Recording::new("long", time, displacement, force).unwrap()
}

/// The shortest time of `times` checks of a recording, s.
fn least(times: usize, recording: &Recording) -> f64 {
    let once = || {
        let start = Instant::now();
        (0..times).for_each(|_| drop(recording.check_traceable()));
        start.elapsed()
    };
    (0..3).map(|_| once()).min().unwrap().as_secs_f64()
}

/// One of 2¹⁷ samples takes about as long as 32 of 2¹²: noise without a cycle, and spikes in few states of the motion.
#[test]
fn a_check_takes_time_as_there_are_samples() {
    for (levels, noise) in [(1, 1.0), (2, 1e-3)] {
        let whole = least(1, &recording(1 << 17, levels, noise));
        let ratio = whole / least(32, &recording(1 << 12, levels, noise));
        assert!(ratio < 3.0, "{levels} levels: {ratio}");
    }
}

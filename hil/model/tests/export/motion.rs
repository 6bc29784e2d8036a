//! A motion for the effects of the crate. `bindings/c/tests/forces.rs` reads this file too.

use std::f64::consts::TAU;
use std::sync::Arc;

use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_tables::control::ControlChannel;

/// Ticks per second of [`two_sines`], Hz.
pub const TICK_RATE: f64 = 2000.0;

/// The control input of [`two_sines`].
pub const CURRENT: &str = "current_A";

/// Two sines at [`TICK_RATE`], beyond the range of any slider, under a current in steps.
pub fn two_sines() -> Trajectory {
    let time: Vec<f64> = (0..4000).map(|i| f64::from(i) / TICK_RATE).collect();
    let displacement = |t: &f64| 0.1 * (TAU * 3.0 * t).sin() + 0.05 * (TAU * 11.0 * t).sin();
    let moved: Vec<f64> = time.iter().map(displacement).collect();
    let force = moved.iter().map(|y| 2.0 * y).collect();
    let recording = Recording::new("two sines", time, moved, force).unwrap();
    let mut trajectory = Trajectory::of(&recording).unwrap();
    // The recording's times are rounded: the export is for this rate to the last bit.
    trajectory.tick = 1.0 / TICK_RATE;
    let current = (0..trajectory.len()).map(|i| (i / 500 % 3) as f64);
    trajectory.controls = Arc::new(vec![ControlChannel {
        name: CURRENT.into(),
        values: current.collect(),
    }]);
    trajectory
}

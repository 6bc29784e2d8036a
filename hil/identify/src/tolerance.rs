//! The error that a perfect law leaves: what a law is held to, and how much each sample counts.

use mesh_damper_recording::trajectory::Trajectory;

use crate::policy::policy;

mesh_damper_recording::numbers! {
    /// The smallest error that a law is expected to reach.
    TolerancePolicy {
        /// The noise of the force is assumed to be at least this fraction of its RMS. The estimated motion has an error too, and a
        /// recording that was filtered looks quieter than it is.
        quiet: f64 = 1e-3, Tuned("the estimated motions");
    }
}

/// The noise of the force over its RMS; of several recordings the root of the mean square.
pub fn noise_floor(trajectories: &[Trajectory]) -> f64 {
    let squares = trajectories.iter().map(|t| noise_of(t).powi(2));
    (squares.sum::<f64>() / trajectories.len() as f64).sqrt()
}

/// The same of one recording.
pub fn noise_of(trajectory: &Trajectory) -> f64 {
    trajectory.force_noise / trajectory.force_rms
}

/// The error that a law is held to: the noise, or [`TolerancePolicy::quiet`] where the recording is quieter.
pub fn goal(noise_floor: f64) -> f64 {
    noise_floor.max(policy().tolerance.quiet)
}

/// Variance of the error that a law is held to where the motion is certain, kN².
pub fn least(trajectory: &Trajectory) -> f64 {
    (goal(noise_of(trajectory)) * trajectory.force_rms).powi(2)
}

/// Variance of the error that a law is held to at a sample of `trajectory`, kN²: as [`Trajectory::tolerance`] has it, or
/// [`TolerancePolicy::quiet`] where the recording is quieter.
pub fn held_to(trajectory: &Trajectory, sample: usize) -> f64 {
    let quiet = policy().tolerance.quiet * trajectory.force_rms;
    trajectory.tolerance(sample).max(quiet * quiet)
}

/// How much the squared error at a sample counts, 0…1: by the inverse of what a perfect law leaves there. Near a standstill that is
/// many times the noise of the force, and a few such samples would be all that a sum of squares shows.
pub fn certainty(trajectory: &Trajectory, sample: usize) -> f64 {
    let held_to = held_to(trajectory, sample);
    if held_to > 0.0 {
        least(trajectory) / held_to
    } else {
        1.0
    }
}

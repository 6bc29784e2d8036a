//! The error of a perfect law: the limit for a law's error, and the weight of each sample.

use mesh_damper_recording::trajectory::Trajectory;

mesh_damper_recording::numbers! {
    /// The smallest error that a law is expected to reach.
    TolerancePolicy {
        /// The noise of the force is assumed to be at least this fraction of its RMS. The estimated motion has an error too, and a
        /// recording that was filtered looks quieter than it is.
        quiet: f64 = 1e-3, Tuned("the estimated motions");
    }
}

/// The noise of the force over its RMS; for several recordings, the root of the mean square.
pub fn noise_floor(trajectories: &[Trajectory]) -> f64 {
    let squares = trajectories.iter().map(|t| noise_of(t).powi(2));
    (squares.sum::<f64>() / trajectories.len() as f64).sqrt()
}

/// The noise of one recording.
pub fn noise_of(trajectory: &Trajectory) -> f64 {
    trajectory.force_noise / trajectory.force_rms
}

/// The tolerated error: the noise, or [`TolerancePolicy::quiet`] if the recording is quieter.
pub fn goal(noise_floor: f64) -> f64 {
    noise_floor.max(TolerancePolicy::in_use().quiet)
}

/// Variance of the tolerated error where the motion is certain, kN².
pub fn least(trajectory: &Trajectory) -> f64 {
    (goal(noise_of(trajectory)) * trajectory.force_rms).powi(2)
}

/// Variance of the tolerated error at a sample of `trajectory`, kN²: from [`Trajectory::tolerance`], or [`TolerancePolicy::quiet`]
/// if the recording is quieter.
pub fn held_to(trajectory: &Trajectory, sample: usize) -> f64 {
    let quiet = TolerancePolicy::in_use().quiet * trajectory.force_rms;
    trajectory.tolerance(sample).max(quiet * quiet)
}

/// Squared error of a perfect law at a sample after it is weighted by its [`certainty`], kN².
pub fn expected(trajectory: &Trajectory, sample: usize) -> f64 {
    expected_beside(trajectory.unexplained, trajectory, sample)
}

/// The same beside a law that [leaves](Trajectory::left_beyond_tolerance) the variance `left`, kN².
pub fn expected_beside(left: f64, trajectory: &Trajectory, sample: usize) -> f64 {
    certainty_beside(left, trajectory, sample) * held_to(trajectory, sample)
}

/// Weight of the squared error at a sample, 0…1: the inverse of a law's squared error there. Near a standstill that error is many times
/// the noise of the force, and without the weight a few such samples would dominate a sum of squares.
///
/// A law that lacks something errs by more than the [tolerance](held_to), and by about as much everywhere. The weight says so: otherwise
/// a few samples with a certain motion would decide alone between laws that are all wrong there.
pub fn certainty(trajectory: &Trajectory, sample: usize) -> f64 {
    certainty_beside(trajectory.unexplained, trajectory, sample)
}

/// The same beside a law that [leaves](Trajectory::left_beyond_tolerance) the variance `left`, kN².
pub fn certainty_beside(left: f64, trajectory: &Trajectory, sample: usize) -> f64 {
    let of_a_law = held_to(trajectory, sample) + left;
    if of_a_law > 0.0 {
        (least(trajectory) + left) / of_a_law
    } else {
        1.0
    }
}

//! The error of a law beyond the noise. Laws are compared by it where their errors are mostly noise.

mesh_damper_recording::numbers! {
    /// The error of a law beyond the noise.
    BeyondNoisePolicy {
        /// Chance may change a squared error by this fraction of the squared noise, which is therefore added to each squared error beyond
        /// the noise.
        uncertain: f64 = 0.3, Tuned("the blind trial");
    }
}

/// Root of a sum: the mean square error beyond that of the noise, and a small part of the noise, below which no law can get.
pub(crate) fn beyond_noise(error_squared: f64, noise_squared: f64) -> f64 {
    ((error_squared - noise_squared).max(0.0)
        + BeyondNoisePolicy::in_use().uncertain * noise_squared)
        .sqrt()
}

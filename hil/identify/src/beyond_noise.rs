//! What a law leaves beyond the noise, by which laws are compared where little but noise is left.

use crate::policy::policy;

mesh_damper_recording::numbers! {
    /// What a law leaves beyond the noise.
    BeyondNoisePolicy {
        /// The part of the noise, in squares, by which an error may differ from it by chance.
        uncertain: f64 = 0.3, Tuned("the blind trial");
    }
}

/// The root of what the mean square of an error is beyond that of the noise, and of a little of the noise: nobody leaves less.
pub(crate) fn beyond_noise(error_squared: f64, noise_squared: f64) -> f64 {
    ((error_squared - noise_squared).max(0.0) + policy().beyond_noise.uncertain * noise_squared)
        .sqrt()
}

//! What a law leaves beyond the noise, by which laws are compared where little but noise is left.

/// The part of the noise, in squares, by which an error may differ from it by chance.
const UNCERTAIN: f64 = 0.3;

/// The root of what the mean square of an error is beyond that of the noise, and of a little of the noise: nobody leaves less.
pub(crate) fn beyond_noise(error_squared: f64, noise_squared: f64) -> f64 {
    ((error_squared - noise_squared).max(0.0) + UNCERTAIN * noise_squared).sqrt()
}

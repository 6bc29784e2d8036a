//! What a law leaves beyond the noise, by which laws are compared where little but noise is left.

/// The part of the noise, in squares, by which an error may differ from it by chance.
const UNCERTAIN: f64 = 0.3;

/// The root of the squared error beyond the noise's, and of a little of the noise: nobody leaves less.
pub(crate) fn beyond_noise(error: f64, noise: f64) -> f64 {
    ((error - noise).max(0.0) + UNCERTAIN * noise).sqrt()
}

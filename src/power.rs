//! |v|^α for the hot path.

/// `|v|^alpha`.
pub fn abs_pow(v: f32, alpha: f32) -> f32 {
    libm::powf(v.abs(), alpha)
}

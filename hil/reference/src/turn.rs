//! The phase of a motion without the rounding to which the law is sensitive.

use std::f64::consts::TAU;

/// sin and cos of 2π·n/count, exact where they are 0 or ±1. With rounding the cosine of a quarter turn is 6e-17, which the law
/// would turn into 0.3 % of its peak.
pub fn sin_cos_of_turn(n: u64, count: u64) -> (f64, f64) {
    let eighths = 8 * (n % count);
    // The nearest multiple of a quarter turn, and the rest within ±π/4.
    let quarter = (eighths + count) / (2 * count);
    let rest = eighths as i64 - (2 * count * quarter) as i64;
    let (sin, cos) = (rest as f64 / count as f64 * (TAU / 8.0)).sin_cos();
    match quarter % 4 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

//! The motion's phase without the rounding that the law is sensitive to.

use std::f64::consts::TAU;

/// sin and cos of 2π·n/count, exact where they are 0 or ±1: by rounding alone the cosine of a quarter of a turn is
/// 6e-17, of which the law would make 0.3 % of its peak.
pub fn sin_cos_of_turn(n: u64, count: u64) -> (f64, f64) {
    let eighths = 8 * (n % count);
    // The nearest multiple of a quarter of a turn, and the rest within ±π/4.
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

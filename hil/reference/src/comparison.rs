//! Measures of the difference between a simulated and a measured force: eq 21, and the one that the project uses instead. Also the
//! difference between a loop and an ellipse.

use std::f64::consts::TAU;

/// Eq 21, and the share of the record to which it could be applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeError {
    /// σ = √(1/N·Σ((F_sim − F_exp)/F_exp)²) over the samples kept.
    pub sigma: f64,
    /// Share of the samples kept, 0…1.
    pub kept: f64,
}

/// Eq 21 over the samples whose measured force is at least `guard` times its largest magnitude.
///
/// The equation divides by the measured force, which passes through 0 twice a cycle. Without a guard (0) its value depends on the
/// few samples next to those zeros. The paper states no guard.
///
/// `None` if the lengths differ or no sample is kept.
pub fn relative_error(simulated: &[f64], measured: &[f64], guard: f64) -> Option<RelativeError> {
    if simulated.len() != measured.len() {
        return None;
    }
    let least = guard * measured.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    let mut sum = 0.0;
    let mut kept = 0_usize;
    for (s, m) in simulated.iter().zip(measured) {
        if m.abs() >= least && *m != 0.0 {
            sum += ((s - m) / m).powi(2);
            kept += 1;
        }
    }
    (kept > 0).then(|| RelativeError {
        sigma: (sum / kept as f64).sqrt(),
        kept: kept as f64 / measured.len() as f64,
    })
}

/// NRMSE: RMS of the error divided by RMS of the measured force.
///
/// `None` if the lengths differ or all measured values are zero.
pub fn nrmse(simulated: &[f64], measured: &[f64]) -> Option<f64> {
    let error: f64 = simulated
        .iter()
        .zip(measured)
        .map(|(s, m)| (s - m).powi(2))
        .sum();
    let size: f64 = measured.iter().map(|m| m * m).sum();
    (simulated.len() == measured.len() && size > 0.0).then(|| (error / size).sqrt())
}

/// R² = 1 − Σ(value − fitted)² / Σ(value − mean)², over pairs of value and fitted.
pub fn r_squared(pairs: &[(f64, f64)]) -> f64 {
    let mean = pairs.iter().map(|(value, _)| value).sum::<f64>() / pairs.len() as f64;
    let left: f64 = pairs
        .iter()
        .map(|(value, fitted)| (value - fitted).powi(2))
        .sum();
    let total: f64 = pairs.iter().map(|(value, _)| (value - mean).powi(2)).sum();
    1.0 - left / total
}

/// Deviation of a loop from the nearest ellipse: RMS of a cycle under a sine without its mean and first harmonic, divided by the
/// RMS of the cycle. Samples are equally spaced.
pub fn beside_ellipse(force: &[f64]) -> f64 {
    let count = force.len() as f64;
    let mean = force.iter().sum::<f64>() / count;
    let phase = |i: usize| TAU * i as f64 / count;
    let part = |of: fn(f64) -> f64| -> f64 {
        let products = force.iter().enumerate().map(|(i, f)| f * of(phase(i)));
        2.0 / count * products.sum::<f64>()
    };
    let (sin, cos) = (part(f64::sin), part(f64::cos));
    let ellipse: Vec<f64> = (0..force.len())
        .map(|i| mean + sin * phase(i).sin() + cos * phase(i).cos())
        .collect();
    nrmse(&ellipse, force).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ellipse_leaves_nothing_and_a_third_harmonic_all_of_itself() {
        let wave = |third: f64| -> Vec<f64> {
            (0..64)
                .map(|i| {
                    let phase = TAU * f64::from(i) / 64.0;
                    0.2 + (phase + 0.4).sin() + third * (3.0 * phase).cos()
                })
                .collect()
        };
        assert!(beside_ellipse(&wave(0.0)) < 1e-14);
        // Mean squares: 0.04, 0.5 and 0.5·third².
        let expected = (0.5_f64 * 0.09 / (0.04 + 0.5 + 0.5 * 0.09)).sqrt();
        assert!((beside_ellipse(&wave(0.3)) - expected).abs() < 1e-12);
    }
}

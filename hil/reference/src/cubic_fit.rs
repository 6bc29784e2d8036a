//! The paper's identification: eq 14, then eq 15.

use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};

use super::law::Coefficients;

/// Eq 14: F_k(y) = a0 + a1·y + a2·y² + a3·y³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    /// kN.
    pub a0: f64,
    /// kN/mm: k1.
    pub a1: f64,
    /// kN/mm²; the paper drops it together with a0.
    pub a2: f64,
    /// kN/mm³: k3.
    pub a3: f64,
}

/// The least-squares cubic through the loop: displacement in mm, force in kN.
///
/// `None` if the lengths differ, or the displacement takes fewer than four values.
pub fn cubic(displacement: &[f64], force: &[f64]) -> Option<Cubic> {
    if displacement.len() != force.len() {
        return None;
    }
    // Normal equations in y/scale, so that all powers have a similar size and the matrix is well conditioned (about 1e3).
    let scale = displacement.iter().fold(0.0_f64, |s, y| s.max(y.abs()));
    let mut matrix = Matrix4::zeros();
    let mut right = Vector4::zeros();
    for (y, f) in displacement.iter().zip(force) {
        let s = y / scale;
        let row = Vector4::new(1.0, s, s * s, s * s * s);
        matrix += row * row.transpose();
        right += row * *f;
    }
    let solution = matrix.cholesky()?.solve(&right);
    let cubic = Cubic {
        a0: solution[0],
        a1: solution[1] / scale,
        a2: solution[2] / scale.powi(2),
        a3: solution[3] / scale.powi(3),
    };
    [cubic.a0, cubic.a1, cubic.a2, cubic.a3]
        .iter()
        .all(|a| a.is_finite())
        .then_some(cubic)
}

/// Eq 15: the damping force F_c = f − k1·y − k3·y³, kN, which remains after an elastic fit.
pub fn remainder(displacement: &[f64], force: &[f64], k1: f64, k3: f64) -> Vec<f64> {
    displacement
        .iter()
        .zip(force)
        .map(|(y, f)| f - k1 * y - k3 * y.powi(3))
        .collect()
}

/// c in kN·(s/mm)^α and α by Gauss–Newton on F_c ≈ c·|v|^α·sgn v, velocity in mm/s, starting from the given c, α.
///
/// A step that increases the squared error is halved. Samples at v = 0 give no information and are left out.
///
/// `None` if it has not converged to 1e-12 relative after 100 steps, or the data cannot separate c and α.
pub fn damping(velocity: &[f64], remainder: &[f64], start: (f64, f64)) -> Option<(f64, f64)> {
    let samples: Vec<(f64, f64)> = velocity
        .iter()
        .zip(remainder)
        .filter(|(v, _)| **v != 0.0)
        .map(|(v, f)| (v.abs(), f * v.signum()))
        .collect();
    let squared_error = |(c, alpha): (f64, f64)| -> f64 {
        samples
            .iter()
            .map(|(v, f)| (f - c * v.powf(alpha)).powi(2))
            .sum()
    };
    let mut at = start;
    let mut error = squared_error(at);
    for _ in 0..100 {
        let mut matrix = Matrix2::zeros();
        let mut right = Vector2::zeros();
        for (v, f) in &samples {
            let power = v.powf(at.1);
            let gradient = Vector2::new(power, at.0 * power * v.ln());
            matrix += gradient * gradient.transpose();
            right += gradient * (f - at.0 * power);
        }
        // Parallel gradients: the data has only one speed.
        if matrix.determinant() <= 1e-10 * matrix[(0, 0)] * matrix[(1, 1)] {
            return None;
        }
        let full = matrix.cholesky()?.solve(&right);
        let mut step = full;
        let mut next = (at.0 + step[0], at.1 + step[1]);
        let mut next_error = squared_error(next);
        for _ in 0..30 {
            if next_error <= error {
                break;
            }
            step *= 0.5;
            next = (at.0 + step[0], at.1 + step[1]);
            next_error = squared_error(next);
        }
        let small = |step: f64, value: f64| step.abs() <= 1e-12 * value.abs().max(1e-3);
        let converged = small(full[0], at.0) && small(full[1], at.1);
        let improved = next_error < error;
        if improved {
            (at, error) = (next, next_error);
        }
        // If no shorter step is an improvement, the rest is rounding.
        if converged || !improved {
            return (at.0.is_finite() && at.1.is_finite()).then_some(at);
        }
    }
    None
}

/// Eqs 14 and 15 in sequence, as in the paper: a0 and a2 are fitted and dropped. mm, mm/s, kN.
///
/// `None` if either step fails.
pub fn identify(displacement: &[f64], velocity: &[f64], force: &[f64]) -> Option<Coefficients> {
    let cubic = cubic(displacement, force)?;
    let rest = remainder(displacement, force, cubic.a1, cubic.a3);
    let largest = rest.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    let (c, alpha) = damping(velocity, &rest, (largest.max(f64::MIN_POSITIVE), 0.5))?;
    Some(Coefficients::new(cubic.a1, cubic.a3, c, alpha))
}

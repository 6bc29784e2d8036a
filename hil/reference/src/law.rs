//! The mixed damping law, eq 13: F = k1·y + k3·y³ + c·|v|^α·sgn v.

use serde::Serialize;

/// The four coefficients of eq 13.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Coefficients {
    /// Linear stiffness, kN/mm.
    pub k1: f64,
    /// Cubic stiffness, kN/mm³.
    pub k3: f64,
    /// Damping, kN·(s/mm)^α.
    pub c: f64,
    /// Damping exponent, 0…1.
    pub alpha: f64,
}

impl Coefficients {
    /// In the order of the law.
    pub const fn new(k1: f64, k3: f64, c: f64, alpha: f64) -> Self {
        Self { k1, k3, c, alpha }
    }

    /// F = k1·y + k3·y³ + c·|v|^α·sgn v, kN, at displacement `y` mm and velocity `v` mm/s; sgn 0 = 0.
    pub fn force(&self, y: f64, v: f64) -> f64 {
        self.elastic_force(y) + self.damping_force(v)
    }

    /// k1·y + k3·y³, kN.
    pub fn elastic_force(&self, y: f64) -> f64 {
        self.k1 * y + self.k3 * y.powi(3)
    }

    /// c·|v|^α·sgn v, kN.
    pub fn damping_force(&self, v: f64) -> f64 {
        if v == 0.0 {
            0.0
        } else {
            self.c * v.abs().powf(self.alpha) * v.signum()
        }
    }
}

//! The mixed damping law of the metal mesh damper (eq 13 of the paper).
//!
//! F(y, v) = k1·y + k3·y³ + c·|v|^α·sgn v
//!
//! y displacement in mm, v velocity in mm/s, F in kN. α = 0 is Coulomb friction, α = 1 a linear dashpot.

use crate::effects::description::Growth;
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient, in_range};

/// The four coefficients of the mixed damping law, validated.
///
/// The paper's Tables 6–9 hold k1 0.22…9.35 kN/mm, k3 4.7…186 kN/mm³, c 0.024…0.66 kN·(s/mm)^α, α 0.16…0.56.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law<R> {
    k1: R,
    k3: R,
    c: R,
    alpha: R,
}

impl<R> Law<R> {
    /// How its force grows outside the operating range: with k3·y³.
    pub const OUTSIDE: Growth = Growth::Cubic;

    /// From coefficients that are known to be in range.
    pub(crate) const fn from_valid(k1: R, k3: R, c: R, alpha: R) -> Self
    where
        R: Copy,
    {
        Self { k1, k3, c, alpha }
    }
}

impl<R: Real> Law<R> {
    /// * `k1`: linear stiffness, kN/mm, −1e9…1e9
    /// * `k3`: cubic stiffness, kN/mm³, −1e9…1e9
    /// * `c`: damping, kN·(s/mm)^α, 0…1e9: a negative value would generate energy
    /// * `alpha`: damping exponent, 0…1
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(k1: R, k3: R, c: R, alpha: R) -> Result<Self, ConfigError> {
        Ok(Self {
            k1: coefficient("k1", k1)?,
            k3: coefficient("k3", k3)?,
            c: in_range("c", c, 0.0, limits::COEFFICIENT)?,
            alpha: in_range("alpha", alpha, 0.0, 1.0)?,
        })
    }

    /// Force in kN at displacement `y` mm and velocity `v` mm/s.
    ///
    /// Finite for every input: an input beyond [`limits::DISPLACEMENT`] or [`limits::VELOCITY`] is treated as the limit, NaN as 0.
    /// At v = 0 the damping term is 0 for every α, Coulomb friction included. As v → 0 the term follows |v|^α, whose slope is
    /// infinite there. A velocity must therefore be accurate, relative to its size, near its zero crossings.
    #[inline(always)]
    pub fn force(&self, y: R, v: R) -> R {
        self.elastic_force(y) + self.damping_force(v)
    }

    /// k1·y + k3·y³, kN.
    #[inline(always)]
    pub fn elastic_force(&self, y: R) -> R {
        self.elastic_force_within(y.clamped(R::from_f64(limits::DISPLACEMENT)))
    }

    /// The same for a `y` that is already within the limit.
    #[inline(always)]
    pub(crate) fn elastic_force_within(&self, y: R) -> R {
        (self.k1 + self.k3 * (y * y)) * y
    }

    /// c·|v|^α·sgn v, kN.
    #[inline(always)]
    pub fn damping_force(&self, v: R) -> R {
        let v = v.clamped(R::from_f64(limits::VELOCITY));
        let magnitude = self.c * v.abs_pow(self.alpha);
        if v > R::ZERO {
            magnitude
        } else if v < R::ZERO {
            -magnitude
        } else {
            R::ZERO
        }
    }

    /// Linear stiffness, kN/mm.
    pub fn k1(&self) -> R {
        self.k1
    }
    /// Cubic stiffness, kN/mm³.
    pub fn k3(&self) -> R {
        self.k3
    }
    /// Damping, kN·(s/mm)^α.
    pub fn c(&self) -> R {
        self.c
    }
    /// Damping exponent.
    pub fn alpha(&self) -> R {
        self.alpha
    }

    /// The same law over another float.
    pub fn cast<S: Real>(&self) -> Law<S> {
        let to = |value: R| S::from_f64(value.to_f64());
        Law {
            k1: to(self.k1),
            k3: to(self.k3),
            c: to(self.c),
            alpha: to(self.alpha),
        }
    }
}

//! Odd stiffness above the cubic: wires that come to lie against each other towards the end of the stroke.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::real::{Real, coefficient};

/// F = k5·y⁵.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hardening<R> {
    pub(super) k5: R,
}

impl<R: Real> Hardening<R> {
    pub(super) const NONE: Self = Self { k5: R::ZERO };

    /// * `k5`: kN/mm⁵, −1e9…1e9
    ///
    /// # Errors
    /// `k5` not finite or out of range.
    pub fn new(k5: R) -> Result<Self, ConfigError> {
        let new = Self { k5 };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> EffectForce<R> for Hardening<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("k5", self.k5).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        let square = y * y;
        self.k5 * (square * square) * y
    }
}

//! Even stiffness: a damper that is stiffer one way than the other, as a preloaded ring is. Eq 14 fits it as a2 and
//! then drops it.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::real::{Real, coefficient};

/// F = k2·y².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymmetry<R> {
    pub(super) k2: R,
}

impl<R: Real> Asymmetry<R> {
    pub(super) const NONE: Self = Self { k2: R::ZERO };

    /// * `k2`: kN/mm², −1e9…1e9
    ///
    /// # Errors
    /// `k2` not finite or out of range.
    pub fn new(k2: R) -> Result<Self, ConfigError> {
        let new = Self { k2 };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> EffectForce<R> for Asymmetry<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("k2", self.k2).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        self.k2 * (y * y)
    }
}

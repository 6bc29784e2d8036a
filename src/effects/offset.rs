//! A constant force: a preload, or a load cell that was not zeroed.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::real::{Real, coefficient};

/// F = f0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset<R> {
    pub(super) force: R,
}

impl<R: Real> Offset<R> {
    pub(super) const NONE: Self = Self { force: R::ZERO };

    /// * `force`: kN, −1e9…1e9
    ///
    /// # Errors
    /// `force` not finite or out of range.
    pub fn new(force: R) -> Result<Self, ConfigError> {
        let new = Self { force };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> EffectForce<R> for Offset<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("force", self.force).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), _: &ConfinedMotion<R>, _: LawForce<R>) -> R {
        self.force
    }
}

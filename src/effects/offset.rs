//! A constant force: a preload, or a load cell that was not zeroed.

use super::{ConfinedMotion, EffectForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// F = f0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset<R> {
    force: R,
}

impl<R: Real> Offset<R> {
    /// * `force`: kN, −1e9…1e9
    ///
    /// # Errors
    /// `force` not finite or out of range.
    pub fn new(force: R) -> Result<Self, ConfigError> {
        Ok(Self {
            force: in_range("force", force, -limits::COEFFICIENT, limits::COEFFICIENT)?,
        })
    }
}

impl<R: Real> EffectForce<R> for Offset<R> {
    type State = ();

    #[inline(always)]
    fn force(&self, _: &mut (), _: &ConfinedMotion<R>, _: R) -> R {
        self.force
    }
}

//! A linear dashpot beside the |v|^α damping: a fluid, or the film between wires.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::real::{Real, coefficient};

/// F = c1·v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous<R> {
    pub(super) c1: R,
}

impl<R: Real> Viscous<R> {
    pub(super) const NONE: Self = Self { c1: R::ZERO };

    /// * `c1`: kN·s/mm, −1e9…1e9. A negative one is allowed: it may take back what |v|^α gives too much of.
    ///
    /// # Errors
    /// `c1` not finite or out of range.
    pub fn new(c1: R) -> Result<Self, ConfigError> {
        let new = Self { c1 };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> EffectForce<R> for Viscous<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("c1", self.c1).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, _: LawForce<R>) -> R {
        self.c1 * motion.velocity()
    }
}

//! Friction that grows with the load on the contacts: wires that are pressed together by the displacement slide harder.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// F = λ·|y|·c·|v|^α·sgn v: the law's own friction, by the part λ·|y| more.
///
/// It remembers nothing and never drives the motion: F·v ≥ 0 whatever the motion, as c ≥ 0 and λ ≥ 0. Under a sine of
/// amplitude X and angular frequency ω it dissipates 4·λ·c·ω^α·X^(2+α)/(2 + α) J a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadFriction<R> {
    pub(super) load: R,
}

impl<R: Real> LoadFriction<R> {
    pub(super) const NONE: Self = Self { load: R::ZERO };

    /// * `load`: λ, what a mm of displacement adds to the friction as a part of it, 1/mm, 0…1e6
    ///
    /// # Errors
    /// `load` not finite or out of range.
    pub fn new(load: R) -> Result<Self, ConfigError> {
        let new = Self { load };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> EffectForce<R> for LoadFriction<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        in_range("load", self.load, 0.0, limits::LOAD).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, law: LawForce<R>) -> R {
        self.load * motion.displacement().abs() * law.damping
    }
}

//! A stiffness that settles with the cycles: run-in, or wires that break one after another.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient, in_range};

/// F = k·(1 − e^(−n/N))·y, n the cycles since the test began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift<R> {
    pub(super) stiffness: R,
    /// −log₂ e/N
    pub(super) rate: R,
}

impl<R: Real> Drift<R> {
    pub(super) const NONE: Self = Self {
        stiffness: R::ZERO,
        rate: R::ZERO,
    };

    /// * `stiffness`: what the stiffness has changed by in the end, kN/mm, −1e9…1e9
    /// * `cycles`: N, after which 63 % of the change is done, 0.1…1e9
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(stiffness: R, cycles: R) -> Result<Self, ConfigError> {
        let cycles = in_range("cycles", cycles, 0.1, limits::CYCLES)?;
        Ok(Self {
            stiffness: coefficient("stiffness", stiffness)?,
            rate: R::from_f64(-core::f64::consts::LOG2_E) / cycles,
        })
    }
}

impl<R: Real> EffectForce<R> for Drift<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("stiffness", self.stiffness)?;
        // A little beyond −log₂ e/0.1, which rounds to more of itself in f32.
        in_range("rate", self.rate, -15.0, 0.0).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, _: LawForce<R>) -> R {
        let change = self.stiffness * motion.displacement();
        change - change * (motion.cycles() * self.rate).exp2_of_negative()
    }
}

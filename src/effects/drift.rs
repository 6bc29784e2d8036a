//! A force that settles with the cycles: run-in, friction that wears, or wires that break one after another.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient, in_range};

/// F = (1 − e^(−n/N))·(k·y + a·F_elastic + b·F_damping), n the cycles since the test began: in the end the stiffness has
/// changed by k, eq 13's elastic force by the fraction a of itself, and its damping force by b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift<R> {
    pub(super) stiffness: R,
    /// a
    pub(super) elastic: R,
    /// b − a
    pub(super) beyond: R,
    /// −log₂ e/N
    pub(super) rate: R,
}

impl<R: Real> Drift<R> {
    pub(super) const NONE: Self = Self {
        stiffness: R::ZERO,
        elastic: R::ZERO,
        beyond: R::ZERO,
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
            elastic: R::ZERO,
            beyond: R::ZERO,
            rate: R::from_f64(-core::f64::consts::LOG2_E) / cycles,
        })
    }

    /// The same with a change of eq 13's forces.
    ///
    /// * `elastic_change`: a, −1…1e3: no force turns round, and what a slow change comes to in the end may be far beyond what a
    ///   test sees of it
    /// * `damping_change`: b, −1…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn with_forces(self, elastic_change: R, damping_change: R) -> Result<Self, ConfigError> {
        let elastic = in_range("elastic_change", elastic_change, -1.0, limits::CHANGE)?;
        let damping = in_range("damping_change", damping_change, -1.0, limits::CHANGE)?;
        Ok(Self {
            elastic,
            beyond: damping - elastic,
            ..self
        })
    }

    /// Its part of eq 13's `law`, kN: all but the stiffness.
    pub(super) fn force_of_law(&self, motion: &ConfinedMotion<R>, law: LawForce<R>) -> R {
        self.done(self.change_of_law(law), motion)
    }

    /// What of `law` has changed in the end.
    #[inline(always)]
    fn change_of_law(&self, law: LawForce<R>) -> R {
        self.elastic * law.total + self.beyond * law.damping
    }

    /// As much of a change as is done.
    #[inline(always)]
    fn done(&self, change: R, motion: &ConfinedMotion<R>) -> R {
        change - change * (motion.cycles() * self.rate).exp2_of_negative()
    }
}

impl<R: Real> EffectForce<R> for Drift<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("stiffness", self.stiffness)?;
        in_range("elastic_change", self.elastic, -1.0, limits::CHANGE)?;
        // A little beyond the range, as the sum of what was rounded, and likewise −log₂ e/0.1.
        let damping = self.elastic + self.beyond;
        in_range("damping_change", damping, -1.001, 1.001 * limits::CHANGE)?;
        in_range("rate", self.rate, -15.0, 0.0).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, law: LawForce<R>) -> R {
        let change = self.stiffness * motion.displacement() + self.change_of_law(law);
        self.done(change, motion)
    }
}

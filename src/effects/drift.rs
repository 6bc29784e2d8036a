//! A force that settles with the cycles: run-in, friction that wears, or wires that break one after another.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient, in_range};

/// Changes of eq 13's forces are within ± this part of themselves.
pub const LARGEST_CHANGE: f64 = 1e3;

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
    /// * `elastic_change`: a, −1e3…1e3: what a slow change comes to in the end may be far beyond what a test sees of it
    /// * `damping_change`: b, −1e3…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn with_forces(self, elastic_change: R, damping_change: R) -> Result<Self, ConfigError> {
        let change = |field, value: R| in_range(field, value, -LARGEST_CHANGE, LARGEST_CHANGE);
        let elastic = change("elastic_change", elastic_change)?;
        Ok(Self {
            elastic,
            beyond: change("damping_change", damping_change)? - elastic,
            ..self
        })
    }
}

impl<R: Real> EffectForce<R> for Drift<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("stiffness", self.stiffness)?;
        in_range(
            "elastic_change",
            self.elastic,
            -LARGEST_CHANGE,
            LARGEST_CHANGE,
        )?;
        in_range(
            "beyond",
            self.beyond,
            -2.0 * LARGEST_CHANGE,
            2.0 * LARGEST_CHANGE,
        )?;
        // A little beyond −log₂ e/0.1, which rounds to more of itself in f32.
        in_range("rate", self.rate, -15.0, 0.0).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, law: LawForce<R>) -> R {
        let of_law = self.elastic * law.total + self.beyond * law.damping;
        let change = self.stiffness * motion.displacement() + of_law;
        change - change * (motion.cycles() * self.rate).exp2_of_negative()
    }
}

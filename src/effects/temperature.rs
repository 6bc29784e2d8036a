//! A force that scales with temperature: the wire's modulus and its friction change, together or each in its own way.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// F = −(T − T0)·(β·F_elastic + β_damping·F_damping): for each °C above T0 eq 13's elastic force falls by the fraction β, and
/// its damping force by β_damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Temperature<R> {
    pub(super) beta: R,
    /// β_damping − β
    pub(super) beyond: R,
    /// T0
    pub(super) reference: R,
}

impl<R: Real> Temperature<R> {
    pub(super) const NONE: Self = Self {
        beta: R::ZERO,
        beyond: R::ZERO,
        reference: R::ZERO,
    };

    /// With the same β for both forces.
    ///
    /// * `beta`: loss of force per degree, 1/°C, −1…1
    /// * `reference`: T0, the temperature at which the law's coefficients hold, °C, −273.15…1e4
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(beta: R, reference: R) -> Result<Self, ConfigError> {
        let beta = in_range("beta", beta, -1.0, 1.0)?;
        let reference = in_range("reference", reference, -273.15, limits::TEMPERATURE)?;
        Ok(Self {
            beta,
            beyond: R::ZERO,
            reference,
        })
    }

    /// The same with another β for the damping force.
    ///
    /// * `beta_damping`: its loss per degree, 1/°C, −1…1
    ///
    /// # Errors
    /// It is not finite or out of range.
    pub fn with_damping(self, beta_damping: R) -> Result<Self, ConfigError> {
        let beta_damping = in_range("beta_damping", beta_damping, -1.0, 1.0)?;
        Ok(Self {
            beyond: beta_damping - self.beta,
            ..self
        })
    }
}

impl<R: Real> EffectForce<R> for Temperature<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        in_range("beta", self.beta, -1.0, 1.0)?;
        in_range("beyond", self.beyond, -2.0, 2.0)?;
        let reference = in_range("reference", self.reference, -273.15, limits::TEMPERATURE);
        reference.map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, law: LawForce<R>) -> R {
        let lost = self.beta * law.total + self.beyond * law.damping;
        (self.reference - motion.temperature()) * lost
    }
}

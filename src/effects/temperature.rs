//! A force that scales with temperature: the wire's modulus and its friction change together.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// F = −β·(T − T0)·F_law: the law's force falls by the fraction β for each °C above T0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Temperature<R> {
    pub(super) beta: R,
    /// β·T0
    pub(super) rise: R,
}

impl<R: Real> Temperature<R> {
    pub(super) const NONE: Self = Self {
        beta: R::ZERO,
        rise: R::ZERO,
    };

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
            rise: beta * reference,
        })
    }
}

impl<R: Real> EffectForce<R> for Temperature<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        in_range("beta", self.beta, -1.0, 1.0)?;
        in_range("rise", self.rise, -limits::TEMPERATURE, limits::TEMPERATURE).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, law: LawForce<R>) -> R {
        (self.rise - self.beta * motion.temperature()) * law.total
    }
}

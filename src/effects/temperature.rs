//! A force that scales with temperature: the wire's modulus and its friction change, together or separately.

use super::description::{Absent, Cost, Dependence, Description, EffectKind, Energy, Growth};
use super::{ClampedMotion, Equations, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};
use crate::rig;

/// F = −(T − T0)·(β·F_elastic + β_damping·F_damping): per °C above T0 the elastic force of the mixed damping
/// law (eq 13) falls by the fraction β, and its damping force by β_damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Temperature<R> {
    beta: R,
    /// β_damping − β
    beyond: R,
    /// T0
    reference: R,
}

numbers! {
    Temperature { beta, beyond, reference } of {
        beta: "1/degC" in [-1.0, 1.0],
        reference: "degC" in [-273.15, limits::TEMPERATURE],
        beta_damping: "1/degC" in [-1.0, 1.0] => Absent::As(0),
    }
}

impl<R: Real> Temperature<R> {
    /// With the same β for both forces.
    ///
    /// * `beta`: relative loss of force per degree, 1/°C, −1…1
    /// * `reference`: T0, the temperature for which the law's coefficients are valid, °C, −273.15…1e4
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(beta: R, reference: R) -> Result<Self, ConfigError> {
        let new = Self {
            beta,
            beyond: R::ZERO,
            reference,
        };
        new.check()?;
        Ok(new)
    }

    /// The same with a separate β for the damping force.
    ///
    /// * `beta_damping`: its relative loss per degree, 1/°C, −1…1
    ///
    /// # Errors
    /// `beta_damping` is not finite or out of range.
    pub fn with_damping(self, beta_damping: R) -> Result<Self, ConfigError> {
        let beta_damping = in_range("beta_damping", beta_damping, -1.0, 1.0)?;
        let new = Self {
            beyond: beta_damping - self.beta,
            ..self
        };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for Temperature<R> {
    const DESCRIPTION: Description = Description {
        name: "temperature",
        family: "temperature",
        number: 6,
        kind: EffectKind::Modulator,
        cost: Cost::Light,
        parameters: Self::PARAMETERS,
        typical: &[0.005, 20.0, -0.002],
        depends_on: &[Dependence::Temperature],
        outside: Growth::OfLaw,
        energy: Energy::ScalesDamping,
        scales_law: true,
        sentence: "A force that scales with the temperature, as the modulus and the friction of wire do.",
        ..Description::PLAIN
    };
    const NONE: Self = Self::ABSENT;

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [beta, reference, beta_damping] = super::numbers::exactly(parameters)?.map(R::from_f64);
        Self::new(beta, reference)?.with_damping(beta_damping)
    }

    fn check(&self) -> Result<(), ConfigError> {
        in_range("beta", self.beta, -1.0, 1.0)?;
        // A little beyond the range, because it is a sum of rounded numbers.
        let damping = self.beta + self.beyond;
        in_range("beta_damping", damping, -1.001, 1.001)?;
        let reference = in_range("reference", self.reference, -273.15, limits::TEMPERATURE);
        reference.map(|_| ())
    }

    /// Over the temperatures that a rig accepts by default. The change is linear in the temperature.
    fn least_damping(&self) -> (&'static str, R, R) {
        let beta = self.beta + self.beyond;
        let change = |temperature| (self.reference - R::from_f64(temperature)) * beta;
        let [cold, hot] = rig::TEMPERATURES.map(change);
        ("beta_damping", beta, if cold < hot { cold } else { hot })
    }

    #[inline(always)]
    fn force_of_law(&self, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
        let lost = self.beta * law.total + self.beyond * law.damping;
        (self.reference - motion.temperature()) * lost
    }
}

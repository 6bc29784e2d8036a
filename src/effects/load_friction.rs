//! Friction that grows with the load on the contacts: the displacement presses the wires together.

use super::description::{Cost, Dependence, Description, EffectKind, Energy, Growth, Parameter};
use super::{ClampedMotion, Equations, LawForce, Packed};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// F = λ·|y|·c·|v|^α·sgn v: adds the part λ·|y| of the law's own friction.
///
/// It has no state and never drives the motion: F·v ≥ 0 for every motion, because c ≥ 0 and λ ≥ 0. Under a sine of amplitude X and
/// angular frequency ω it dissipates 4·λ·c·ω^α·X^(2+α)/(2 + α) J per cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadFriction<R> {
    load: R,
}

impl<R: Real> LoadFriction<R> {
    /// * `load`: λ, relative increase of the friction per mm of displacement, 1/mm, 0…1e6
    ///
    /// # Errors
    /// `load` not finite or out of range.
    pub fn new(load: R) -> Result<Self, ConfigError> {
        let new = Self { load };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for LoadFriction<R> {
    const DESCRIPTION: Description = Description {
        name: "load_friction",
        family: "load_friction",
        number: 15,
        kind: EffectKind::Modulator,
        cost: Cost::Light,
        parameters: &[Parameter::new("load", "1/mm", 0.0, limits::LOAD)],
        most: 1,
        typical: &[4.0],
        depends_on: &[Dependence::Displacement, Dependence::Velocity],
        outside: Growth::LinearTimesDamping,
        energy: Energy::Passive,
        scales_law: true,
        sentence: "Friction that grows with the displacement, which presses the wires together.",
    };
    const NONE: Self = Self { load: R::ZERO };

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [load] = super::exactly(parameters)?;
        Self::new(R::from_f64(load))
    }

    fn check(&self) -> Result<(), ConfigError> {
        in_range("load", self.load, 0.0, limits::LOAD).map(|_| ())
    }

    #[inline(always)]
    fn force_of_law(&self, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
        self.load * motion.displacement().abs() * law.damping
    }
}

impl Packed for LoadFriction<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        put(self.load);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let &[load] = words else { return None };
        Some(Self { load })
    }
}

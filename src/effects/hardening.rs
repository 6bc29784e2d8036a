//! Stiffness of the fifth order: wires that come into contact with each other towards the end of the stroke.

use super::description::{Cost, Dependence, Description, EffectKind, Energy, Growth, Parameter};
use super::{ClampedMotion, Equations, LawForce, Packed};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient};

/// F = k5·y⁵.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hardening<R> {
    k5: R,
}

impl<R: Real> Hardening<R> {
    /// * `k5`: kN/mm⁵, −1e9…1e9
    ///
    /// # Errors
    /// `k5` not finite or out of range.
    pub fn new(k5: R) -> Result<Self, ConfigError> {
        let new = Self { k5 };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for Hardening<R> {
    const DESCRIPTION: Description = Description {
        name: "hardening",
        family: "hardening",
        number: 2,
        kind: EffectKind::Force,
        cost: Cost::Light,
        parameters: &[Parameter::new(
            "k5",
            "kN/mm^5",
            -limits::COEFFICIENT,
            limits::COEFFICIENT,
        )],
        most: 1,
        typical: &[90.0],
        depends_on: &[Dependence::Displacement],
        outside: Growth::FifthPower,
        energy: Energy::Passive,
        scales_law: false,
        sentence: "Stiffness of the fifth order: wires that come to lie against each other.",
    };
    const NONE: Self = Self { k5: R::ZERO };

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [k5] = super::exactly(parameters)?;
        Self::new(R::from_f64(k5))
    }

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("k5", self.k5).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        let square = y * y;
        self.k5 * (square * square) * y
    }
}

impl Packed for Hardening<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        put(self.k5);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let &[k5] = words else { return None };
        Some(Self { k5 })
    }
}

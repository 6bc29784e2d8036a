//! Even stiffness: a damper that is stiffer in one direction, such as a preloaded ring. The paper's eq 14 contains it as a2 and
//! then drops it.

use super::description::{Cost, Dependence, Description, EffectKind, Energy, Growth, Parameter};
use super::{ClampedMotion, Equations, LawForce, Packed};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient};

/// F = k2·y².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymmetry<R> {
    k2: R,
}

impl<R: Real> Asymmetry<R> {
    /// * `k2`: kN/mm², −1e9…1e9
    ///
    /// # Errors
    /// `k2` not finite or out of range.
    pub fn new(k2: R) -> Result<Self, ConfigError> {
        let new = Self { k2 };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for Asymmetry<R> {
    const DESCRIPTION: Description = Description {
        name: "asymmetry",
        family: "asymmetry",
        number: 1,
        kind: EffectKind::Force,
        cost: Cost::Light,
        parameters: &[Parameter::new(
            "k2",
            "kN/mm^2",
            -limits::COEFFICIENT,
            limits::COEFFICIENT,
        )],
        most: 1,
        typical: &[2.0],
        depends_on: &[Dependence::Displacement],
        outside: Growth::Quadratic,
        energy: Energy::Passive,
        scales_law: false,
        sentence: "Even stiffness: a damper that is stiffer one way than the other.",
    };
    const NONE: Self = Self { k2: R::ZERO };

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [k2] = super::exactly(parameters)?;
        Self::new(R::from_f64(k2))
    }

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("k2", self.k2).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        self.k2 * (y * y)
    }
}

impl Packed for Asymmetry<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        put(self.k2);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let &[k2] = words else { return None };
        Some(Self { k2 })
    }
}

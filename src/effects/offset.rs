//! A constant force: a preload, or a load cell that was not zeroed.

use super::description::{Cost, Description, EffectKind, Energy, Growth, Parameter};
use super::{ClampedMotion, Equations, LawForce, Packed};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient};

/// F = f0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset<R> {
    force: R,
}

impl<R: Real> Offset<R> {
    /// * `force`: kN, −1e9…1e9
    ///
    /// # Errors
    /// `force` not finite or out of range.
    pub fn new(force: R) -> Result<Self, ConfigError> {
        let new = Self { force };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for Offset<R> {
    const DESCRIPTION: Description = Description {
        name: "offset",
        family: "offset",
        number: 0,
        kind: EffectKind::Force,
        cost: Cost::Light,
        parameters: &[Parameter::new(
            "force",
            "kN",
            -limits::COEFFICIENT,
            limits::COEFFICIENT,
        )],
        most: 1,
        typical: &[0.05],
        depends_on: &[],
        outside: Growth::Constant,
        energy: Energy::Passive,
        scales_law: false,
        sentence: "A constant force: a preload, or a load cell that was not zeroed.",
    };
    const NONE: Self = Self { force: R::ZERO };

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [force] = super::exactly(parameters)?;
        Self::new(R::from_f64(force))
    }

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("force", self.force).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), _: &ClampedMotion<R>, _: LawForce<R>) -> R {
        self.force
    }
}

impl Packed for Offset<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        put(self.force);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let &[force] = words else { return None };
        Some(Self { force })
    }
}

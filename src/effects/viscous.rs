//! A linear dashpot parallel to the |v|^α damping: a fluid, or the film between wires.

use super::description::{Cost, Dependence, Description, EffectKind, Energy, Growth, Parameter};
use super::{ClampedMotion, Equations, LawForce, Packed, below_0};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient};

/// F = c1·v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous<R> {
    c1: R,
}

impl<R: Real> Viscous<R> {
    /// * `c1`: kN·s/mm, −1e9…1e9. A negative value is allowed: it may compensate for too much damping by |v|^α.
    ///
    /// # Errors
    /// `c1` not finite or out of range.
    pub fn new(c1: R) -> Result<Self, ConfigError> {
        let new = Self { c1 };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for Viscous<R> {
    const DESCRIPTION: Description = Description {
        name: "viscous",
        family: "viscous",
        number: 3,
        kind: EffectKind::Force,
        cost: Cost::Light,
        parameters: &[Parameter::new(
            "c1",
            "kN*s/mm",
            -limits::COEFFICIENT,
            limits::COEFFICIENT,
        )],
        most: 1,
        typical: &[0.02],
        depends_on: &[Dependence::Velocity],
        outside: Growth::Linear,
        energy: Energy::Below0(&["c1"]),
        scales_law: false,
        sentence: "A linear dashpot: a fluid, or the film between wires.",
    };
    const NONE: Self = Self { c1: R::ZERO };

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [c1] = super::exactly(parameters)?;
        Self::new(R::from_f64(c1))
    }

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("c1", self.c1).map(|_| ())
    }

    fn supplies(&self) -> Option<(&'static str, R)> {
        below_0("c1", self.c1)
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        self.c1 * motion.velocity()
    }

    #[inline(always)]
    fn viscous(&self) -> R {
        self.c1
    }
}

impl Packed for Viscous<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        put(self.c1);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let &[c1] = words else { return None };
        Some(Self { c1 })
    }
}

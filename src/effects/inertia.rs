//! The force that accelerates a mass between the load cell and the specimen.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// kN per kg·mm/s².
const KILONEWTON: f64 = 1e-6;

/// F = m·a.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia<R> {
    /// kN·s²/mm
    pub(super) mass: R,
}

impl<R: Real> Inertia<R> {
    pub(super) const NONE: Self = Self { mass: R::ZERO };

    /// * `mass`: kg, −1e6…1e6. A negative one is what a load cell shows that was compensated for too much mass.
    ///
    /// # Errors
    /// `mass` not finite or out of range.
    pub fn new(mass: R) -> Result<Self, ConfigError> {
        let mass = in_range("mass", mass, -limits::MASS, limits::MASS)?;
        Ok(Self {
            mass: mass * R::from_f64(KILONEWTON),
        })
    }
}

impl<R: Real> EffectForce<R> for Inertia<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        const MOST: f64 = limits::MASS * KILONEWTON;
        in_range("mass", self.mass, -MOST, MOST).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, _: LawForce<R>) -> R {
        self.mass * motion.acceleration()
    }
}

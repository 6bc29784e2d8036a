//! The force that accelerates a mass between the load cell and the specimen.

use super::description::{Cost, Dependence, Description, Growth};
use super::{ClampedMotion, Equations, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// kN per kg·mm/s².
const KILONEWTON: f64 = 1e-6;

/// F = m·a. The mass moves with the sensors, whatever yields behind it: a spring in series, or a play.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia<R> {
    /// kN·s²/mm
    mass: R,
}

numbers! {
    Inertia { mass } of {
        mass: "kg" in [-limits::MASS, limits::MASS],
    }
}

impl<R: Real> Inertia<R> {
    /// * `mass`: kg, −1e6…1e6. A negative mass results from a load cell that is compensated for too large a mass.
    ///
    /// # Errors
    /// `mass` not finite or out of range.
    pub fn new(mass: R) -> Result<Self, ConfigError> {
        let mass = in_range("mass", mass, -limits::MASS, limits::MASS)?;
        let new = Self {
            mass: mass * R::from_f64(KILONEWTON),
        };
        new.check()?;
        Ok(new)
    }

    /// Force in kN at an acceleration in mm/s².
    #[inline(always)]
    pub fn force_at(&self, acceleration: R) -> R {
        self.mass * acceleration
    }
}

impl<R: Real> Equations<R> for Inertia<R> {
    const DESCRIPTION: Description = Description {
        name: "inertia",
        family: "inertia",
        number: 4,
        cost: Cost::Light,
        parameters: Self::PARAMETERS,
        typical: &[50.0],
        depends_on: &[Dependence::Displacement, Dependence::Frequency],
        outside: Growth::Linear,
        sentence: "A mass that moves between the load cell and the specimen.",
        ..Description::PLAIN
    };
    const NONE: Self = Self::ABSENT;

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [mass] = super::numbers::exactly(parameters)?;
        Self::new(R::from_f64(mass))
    }

    fn check(&self) -> Result<(), ConfigError> {
        const MOST: f64 = limits::MASS * KILONEWTON;
        in_range("mass", self.mass, -MOST, MOST).map(|_| ())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        self.outside(motion)
    }

    #[inline(always)]
    fn outside(&self, motion: &ClampedMotion<R>) -> R {
        self.force_at(motion.acceleration())
    }
}

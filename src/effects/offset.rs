//! A constant force: a preload, or a load cell that was not zeroed.

use super::description::{Cost, Description};
use super::numbers::COEFFICIENTS;
use super::{ClampedMotion, Equations, LawForce};
use crate::real::Real;

numbers! {
    /// F = f0.
    pub struct Offset {
        /// kN, −1e9…1e9
        force: "kN" in COEFFICIENTS,
    }
}

impl<R: Real> Equations<R> for Offset<R> {
    const DESCRIPTION: Description = Description {
        name: "offset",
        family: "offset",
        number: 0,
        cost: Cost::Light,
        parameters: Self::PARAMETERS,
        typical: &[0.05],
        sentence: "A constant force: a preload, or a load cell that was not zeroed.",
        ..Description::PLAIN
    };
    listed!();

    type State = ();
    const AT_REST: () = ();

    #[inline(always)]
    fn force(&self, _: &mut (), _: &ClampedMotion<R>, _: LawForce<R>) -> R {
        self.force
    }
}

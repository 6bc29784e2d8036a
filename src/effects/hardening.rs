//! Stiffness of the fifth order: wires that come into contact with each other towards the end of the stroke.

use super::description::{Cost, Dependence, Description, Growth};
use super::numbers::COEFFICIENTS;
use super::{ClampedMotion, Equations, LawForce};
use crate::real::Real;

numbers! {
    /// F = k5·y⁵.
    pub struct Hardening {
        /// kN/mm⁵, −1e9…1e9
        k5: "kN/mm^5" in COEFFICIENTS,
    }
}

impl<R: Real> Equations<R> for Hardening<R> {
    const DESCRIPTION: Description = Description {
        name: "hardening",
        family: "hardening",
        number: 2,
        cost: Cost::Light,
        parameters: Self::PARAMETERS,
        typical: &[90.0],
        depends_on: &[Dependence::Displacement],
        outside: Growth::FifthPower,
        sentence: "Stiffness of the fifth order: wires that come to lie against each other.",
        ..Description::PLAIN
    };
    listed!();

    type State = ();
    const AT_REST: () = ();

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        let square = y * y;
        self.k5 * (square * square) * y
    }
}

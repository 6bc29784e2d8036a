//! Even stiffness: a damper that is stiffer in one direction, such as a preloaded ring. The paper's eq 14 contains it as a2 and
//! then drops it.

use super::description::{Cost, Dependence, Description, Growth};
use super::numbers::COEFFICIENTS;
use super::{ClampedMotion, Equations, LawForce};
use crate::real::Real;

numbers! {
    /// F = k2·y².
    pub struct Asymmetry {
        /// kN/mm², −1e9…1e9
        k2: "kN/mm^2" in COEFFICIENTS,
    }
}

impl<R: Real> Equations<R> for Asymmetry<R> {
    const DESCRIPTION: Description = Description {
        name: "asymmetry",
        family: "asymmetry",
        number: 1,
        cost: Cost::Light,
        parameters: Self::PARAMETERS,
        typical: &[2.0],
        depends_on: &[Dependence::Displacement],
        outside: Growth::Quadratic,
        sentence: "Even stiffness: a damper that is stiffer one way than the other.",
        ..Description::PLAIN
    };
    listed!();

    type State = ();
    const AT_REST: () = ();

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        self.k2 * (y * y)
    }
}

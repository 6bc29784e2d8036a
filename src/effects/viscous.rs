//! A linear dashpot parallel to the |v|^α damping: a fluid, or the film between wires.

use super::description::{Cost, Dependence, Description, Energy, Growth};
use super::numbers::COEFFICIENTS;
use super::{ClampedMotion, Equations, LawForce, below_0};
use crate::real::Real;

numbers! {
    /// F = c1·v.
    pub struct Viscous {
        /// kN·s/mm, −1e9…1e9. A negative value is allowed: it may compensate for too much damping by |v|^α.
        c1: "kN*s/mm" in COEFFICIENTS,
    }
}

impl<R: Real> Equations<R> for Viscous<R> {
    const DESCRIPTION: Description = Description {
        name: "viscous",
        family: "viscous",
        number: 3,
        cost: Cost::Light,
        parameters: Self::PARAMETERS,
        typical: &[0.02],
        depends_on: &[Dependence::Velocity],
        outside: Growth::Linear,
        energy: Energy::Below0(&["c1"]),
        sentence: "A linear dashpot: a fluid, or the film between wires.",
        ..Description::PLAIN
    };
    listed!();

    type State = ();
    const AT_REST: () = ();

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

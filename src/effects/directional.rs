//! Damping that differs between the directions: valves with different openings, wires with a drawing direction.

use super::description::{Dependence, Description, EffectKind, Energy, Growth};
use super::{ClampedMotion, Equations, LawForce};
use crate::real::Real;

numbers! {
    /// F = d·c·|v|^α: adds the part d of the law's own damping where the displacement rises, and subtracts it where it falls.
    ///
    /// It has no state. With |d| ≤ 1 the law's damping and this force together are (1 + d·sgn v)·c·|v|^α·sgn v, which never drives the
    /// motion. It dissipates nothing in a cycle that is symmetric in velocity: it shifts the loop by d times the damping, and a rig may
    /// take that for a preload.
    pub struct Directional {
        /// d, relative increase of the damping where the displacement rises, −1…1
        difference: "1" in [-1.0, 1.0],
    }
}

impl<R: Real> Equations<R> for Directional<R> {
    const DESCRIPTION: Description = Description {
        name: "directional",
        family: "directional",
        number: 20,
        kind: EffectKind::Modulator,
        parameters: Self::PARAMETERS,
        typical: &[0.3],
        depends_on: &[Dependence::Velocity],
        outside: Growth::OfDamping,
        energy: Energy::ScalesDamping,
        scales_law: true,
        sentence: "Damping that is stronger one way than the other.",
        ..Description::PLAIN
    };
    listed!();

    type State = ();
    const AT_REST: () = ();

    fn least_damping(&self) -> (&'static str, R, R) {
        ("difference", self.difference, -self.difference.abs())
    }

    /// At rest the law has no damping, and so this force is 0.
    #[inline(always)]
    fn force_of_law(&self, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
        let rising = self.difference * law.damping;
        if motion.velocity() < R::ZERO {
            -rising
        } else {
            rising
        }
    }
}

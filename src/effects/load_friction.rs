//! Friction that grows with the load on the contacts: the displacement presses the wires together.

use super::description::{Cost, Dependence, Description, EffectKind, Growth};
use super::{ClampedMotion, Equations, LawForce};
use crate::limits;
use crate::real::Real;

numbers! {
    /// F = λ·|y|·c·|v|^α·sgn v: adds the part λ·|y| of the law's own friction.
    ///
    /// It has no state and never drives the motion: F·v ≥ 0 for every motion, because c ≥ 0 and λ ≥ 0. Under a sine of amplitude X and
    /// angular frequency ω it dissipates 4·λ·c·ω^α·X^(2+α)/(2 + α) J per cycle.
    pub struct LoadFriction {
        /// λ, relative increase of the friction per mm of displacement, 1/mm, 0…1e6
        load: "1/mm" in [0.0, limits::LOAD],
    }
}

impl<R: Real> Equations<R> for LoadFriction<R> {
    const DESCRIPTION: Description = Description {
        name: "load_friction",
        family: "load_friction",
        number: 15,
        kind: EffectKind::Modulator,
        cost: Cost::Light,
        parameters: Self::PARAMETERS,
        typical: &[4.0],
        depends_on: &[Dependence::Displacement, Dependence::Velocity],
        outside: Growth::LinearTimesDamping,
        scales_law: true,
        sentence: "Friction that grows with the displacement, which presses the wires together.",
        ..Description::PLAIN
    };
    listed!();

    type State = ();
    const AT_REST: () = ();

    #[inline(always)]
    fn force_of_law(&self, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
        self.load * motion.displacement().abs() * law.damping
    }
}

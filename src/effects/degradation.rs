//! A spring that loses stiffness with the largest displacement so far, optionally with pinching: the first form of degradation.
//!
//! Examples are rubber on its first strokes (Mullins effect), and joints and wires that bend loose. A motion within the largest one
//! so far meets a softer damper than the first motion did.

use super::description::{Absent, Dependence, Description, Energy, Growth};
use super::numbers::COEFFICIENTS;
use super::{ClampedMotion, Equations, LawForce, below_0};
use crate::limits;
use crate::real::Real;

/// Range of the softening, mm: at the upper end no displacement takes more than a thousandth of the stiffness.
const SOFTENING: [f64; 2] = [1e-9, 1e3 * limits::DISPLACEMENT];

numbers! {
    /// F = k·y·(1 − p + p·|y|/m)/(1 + m/m₀), m the largest |y| so far.
    ///
    /// At y = ±m the secant stiffness is k/(1 + m/m₀), and it never recovers. In between, the force is linear for p = 0; with pinching
    /// it is softer about 0, by the part p. A first stroke follows k·y/(1 + |y|/m₀), and |F| stays below k·m₀ for every displacement.
    ///
    /// It is passive for k ≥ 0: at constant m it is elastic, and the energy stored at y, k·y²·((1 − p)/2 + p·|y|/(3·m))/(1 + m/m₀),
    /// falls when m grows.
    pub struct Degradation {
        /// k, kN/mm, −1e9…1e9
        stiffness: "kN/mm" in COEFFICIENTS,
        /// m₀, the largest displacement so far at which half of the stiffness remains, mm, 1e-9…1e7
        softening: "mm" in SOFTENING,
        /// p, 0…1
        pinching: "1" in [0.0, 1.0] => Absent::Is(0.0),
    }
}

impl<R: Real> Equations<R> for Degradation<R> {
    const DESCRIPTION: Description = Description {
        name: "degradation",
        family: "degradation",
        number: 22,
        parameters: Self::PARAMETERS,
        typical: &[1.5, 0.08, 0.3],
        depends_on: &[Dependence::Displacement, Dependence::History],
        outside: Growth::Saturates,
        energy: Energy::Below0(&["stiffness"]),
        sentence: "A spring that loses stiffness with the largest displacement so far, and may be softer about 0.",
        ..Description::PLAIN
    };
    listed!();

    /// m, mm.
    type State = R;
    const AT_REST: R = R::ZERO;

    fn supplies(&self) -> Option<(&'static str, R)> {
        below_0("stiffness", self.stiffness)
    }

    // Not inlined on a target, so that a tick without this effect does not save its registers.
    #[cfg_attr(not(feature = "std"), inline(never))]
    fn force(&self, largest: &mut R, motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        let size = y.abs();
        if size > *largest {
            *largest = size;
        }
        let largest = *largest;
        if largest == R::ZERO {
            return R::ZERO;
        }
        let shape = R::ONE - self.pinching + self.pinching * (size / largest);
        let left = self.softening / (self.softening + largest);
        self.stiffness * y * shape * left
    }
}

//! Rate-independent friction with smooth yielding (Bouc 1967, Wen 1976): the second form of stick-slip.

use super::description::{Dependence, Description, Energy, Growth};
use super::numbers::{COEFFICIENTS, SLIP_LIMITS};
use super::stretch::{SHARPNESS, Stretch, power, taken};
use super::{ClampedMotion, Equations, LawForce, below_0};
use crate::real::Real;

numbers! {
    /// F = k·z, dz = dy·(1 − (|z|/x)ⁿ·(1 + sgn(dy·z))/2).
    ///
    /// A branch towards 0 is straight, with stiffness k. Away from 0 it bends towards ±x and never passes it: as 1 − e^(−y/x) for n =
    /// 1, as tanh y/x for n = 2, and later for a larger n, approaching a Jenkins element.
    ///
    /// # Step
    /// With δ = 1 − |z|/x the bent branch is dδ = −m·δ·|dy|/x. Here m = (1 − (1 − δ)ⁿ)/δ lies between 1 and n and changes little. A
    /// step with a = m·|dy|/x therefore subtracts 1 − e⁻ᵃ of δ, with m from the middle of the step. The step is of second order, exact
    /// for n = 1, and bounded for any length, because the approximation of eᵃ, 1 + a + a²/2 + a³/6, is at least 1.
    pub struct BoucWen {
        /// k, kN/mm, −1e9…1e9
        stiffness: "kN/mm" in COEFFICIENTS,
        /// x, mm, 1e-9…1e4
        slip_limit: "mm" in SLIP_LIMITS,
        /// n, 0.5…8
        sharpness: "1" in SHARPNESS,
    }
}

impl<R: Real> BoucWen<R> {
    /// m at |z|/x = `part`. Not inlined, because it is called twice.
    #[inline(never)]
    fn bend(&self, part: R) -> R {
        let bend = (R::ONE - power(part, self.sharpness)) / (R::ONE - part);
        // Next to the limit it is a quotient of rounding errors.
        let (low, high) = if self.sharpness > R::ONE {
            (R::ONE, self.sharpness)
        } else {
            (self.sharpness, R::ONE)
        };
        if bend < low {
            low
        } else if bend < high {
            bend
        } else {
            high
        }
    }
}

impl<R: Real> Equations<R> for BoucWen<R> {
    const DESCRIPTION: Description = Description {
        name: "bouc_wen",
        family: "stick_slip",
        number: 11,
        parameters: Self::PARAMETERS,
        typical: &[0.9, 0.02, 1.5],
        depends_on: &[Dependence::Displacement, Dependence::History],
        outside: Growth::Saturates,
        energy: Energy::Below0(&["stiffness"]),
        sentence: "Rate-independent friction that gives way smoothly.",
        ..Description::PLAIN
    };
    listed!();

    type State = Option<Stretch<R>>;
    const AT_REST: Self::State = None;

    fn supplies(&self) -> Option<(&'static str, R)> {
        below_0("stiffness", self.stiffness)
    }

    // Not inlined on a target, so that ticks without this effect do not load its registers and constants.
    #[cfg_attr(not(feature = "std"), inline(never))]
    fn force(&self, state: &mut Self::State, motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let stretch = Stretch::after(state, motion, |stretch, way| {
            // Straight up to 0, and bent from there.
            let sum = stretch + way;
            let (start, bent) = if stretch >= R::ZERO {
                (stretch, way)
            } else if sum > R::ZERO {
                (R::ZERO, sum)
            } else {
                (sum, R::ZERO)
            };
            let moved = if bent > R::ZERO {
                let part = start / self.slip_limit;
                let left = R::ONE - part;
                let length = bent / self.slip_limit;
                let half = R::from_f64(0.5) * length;
                let middle = part + left * taken(half * self.bend(part));
                start + self.slip_limit * (left * taken(length * self.bend(middle)))
            } else {
                start
            };
            moved.clipped(self.slip_limit)
        });
        self.stiffness * stretch
    }
}

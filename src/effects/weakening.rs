//! A slider that loses strength with the energy that it has dissipated: the second form of degradation.
//!
//! Examples are contacts that become polished and asperities that wear off. The friction with elastic pre-sliding fades as the
//! damper works.

use super::description::{Dependence, Description, Energy, Growth};
use super::numbers::{COEFFICIENTS, SLIP_LIMITS};
use super::{ClampedMotion, Equations, LawForce, below_0};
use crate::real::Real;

/// The energy beyond which the sum stops, J: all but a billionth of the loss is complete.
const MOST_ENERGY: f64 = 1e18;

numbers! {
    /// F = k·z·(1 − d·E/(E + E₀)), z ← z + Δy clamped to ±x.
    ///
    /// E is the energy in J that the slider has dissipated so far: |F| times its sliding distance, kN·mm. At E₀ half of the loss is
    /// complete, and in the end 1 − d of the friction remains. A steady loop of amplitude X > x dissipates dE/dn = 4·k·x·(X − x)·(1 −
    /// d·E/(E + E₀)) J per cycle, if E hardly changes within it; n is the number of cycles. With d = 0 it is a Jenkins element of
    /// [`StickSlip`](super::StickSlip).
    ///
    /// It is passive for k ≥ 0: the stored energy is k·z²·(1 − d·E/(E + E₀))/2, which falls when E grows.
    ///
    /// # Step
    /// Within a tick E grows with the mean of the strengths before and after (Heun), which is of second order. A tick that dissipates
    /// many times E₀ dissipates too much of it rather than too little. The sum is compensated (Kahan 1965), so that in `f32` too it
    /// grows by increments of a billionth of it.
    pub struct Weakening {
        /// k, kN/mm, −1e9…1e9
        stiffness: "kN/mm" in COEFFICIENTS,
        /// x, mm, 1e-9…1e4
        slip_limit: "mm" in SLIP_LIMITS,
        /// d, the part of the friction that is lost in the end, 0…1
        loss: "1" in [0.0, 1.0],
        /// E₀, after which half of that is lost, J, 1e-9…1e9
        energy: "J" in [1e-9, 1e9],
    }
}

/// State of a [`Weakening`].
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WeakeningState<R> {
    /// z, mm.
    stretch: R,
    /// Displacement of the tick before, mm.
    previous: R,
    /// E, J.
    dissipated: R,
    /// Rounding error by which E is too large, J.
    rounded_up: R,
}

impl<R: Real> Weakening<R> {
    /// 1 − d·E/(E + E₀) at E = `dissipated`.
    #[inline(always)]
    fn left(&self, dissipated: R) -> R {
        R::ONE - self.loss * (dissipated / (dissipated + self.energy))
    }

    /// Adds the energy that sliding by `way` mm at the slip limit dissipates, J. Not inlined, because a tick without sliding does
    /// not call it.
    #[inline(never)]
    fn slide(&self, state: &mut WeakeningState<R>, way: R) {
        let whole = self.stiffness.abs() * self.slip_limit * way;
        let before = self.left(state.dissipated);
        let after = self.left(state.dissipated + whole * before);
        let added = whole * R::from_f64(0.5) * (before + after) - state.rounded_up;
        let sum = state.dissipated + added;
        state.rounded_up = (sum - state.dissipated) - added;
        state.dissipated = sum;
        let most = R::from_f64(MOST_ENERGY);
        if sum > most {
            state.dissipated = most;
            state.rounded_up = R::ZERO;
        }
    }
}

impl<R: Real> Equations<R> for Weakening<R> {
    const DESCRIPTION: Description = Description {
        name: "weakening",
        family: "degradation",
        number: 23,
        parameters: Self::PARAMETERS,
        typical: &[2.0, 0.03, 0.6, 0.2],
        depends_on: &[Dependence::Displacement, Dependence::History],
        outside: Growth::Saturates,
        energy: Energy::Below0(&["stiffness"]),
        sentence: "Friction with elastic pre-sliding that fades with the energy that it has dissipated.",
        ..Description::PLAIN
    };
    listed!();

    type State = Option<WeakeningState<R>>;
    const AT_REST: Self::State = None;

    fn supplies(&self) -> Option<(&'static str, R)> {
        below_0("stiffness", self.stiffness)
    }

    // Not inlined on a target, so that a tick without this effect does not save its registers.
    #[cfg_attr(not(feature = "std"), inline(never))]
    fn force(&self, state: &mut Self::State, motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        let state = state.get_or_insert(WeakeningState {
            stretch: R::ZERO,
            previous: y,
            dissipated: R::ZERO,
            rounded_up: R::ZERO,
        });
        let step = y - state.previous;
        state.previous = y;
        let tried = state.stretch + step;
        let stretch = tried.clipped(self.slip_limit);
        if stretch != tried {
            // From differences: otherwise the rounding of a sum next to the limit would count as sliding on every tick.
            let way = (step - (stretch - state.stretch)).abs();
            self.slide(state, way);
        }
        state.stretch = stretch;
        self.stiffness * stretch * self.left(state.dissipated)
    }
}

//! Friction behind free play: after each reversal the damper moves some distance before the friction holds it again.
//!
//! Examples are pins in worn holes, and wires that lie loosely against their contacts. The sliding part is pushed from one side; on
//! the way back it stays where it is until it is pushed from the other side.

use super::description::{Dependence, Description, Energy, Growth};
use super::numbers::{COEFFICIENTS, SLIP_LIMITS};
use super::stretch::Stretch;
use super::{ClampedMotion, Equations, LawForce, below_0};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient, in_range};

/// F = k·(p − p clipped to ±s/2), p ← p + Δy clamped to ±(s/2 + x).
///
/// p is the position of the damper in a play of width s that moves with a Coulomb slider, including the stretch of the spring
/// beyond the play. The slider holds until the spring is stretched by x. After a reversal the force falls to 0 over x, stays 0 over
/// s, and rises over x until the slider moves again. The initial position is the middle of the play.
///
/// Under a steady sine of amplitude X it dissipates 4·k·x·(X − x − s/2) J per cycle if X > x + s/2, and nothing otherwise. With s =
/// 0 it is a Jenkins element of [`StickSlip`](super::StickSlip).
///
/// It is passive for k ≥ 0: the spring stores k·(F/k)²/2, and the slider dissipates the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backlash<R> {
    stiffness: R,
    slip_limit: R,
    /// s/2, mm.
    half_slack: R,
}

numbers! {
    Backlash { stiffness, slip_limit, half_slack } of {
        stiffness: "kN/mm" in COEFFICIENTS,
        slip_limit: "mm" in SLIP_LIMITS,
        slack: "mm" in [0.0, limits::DISPLACEMENT],
    }
}

impl<R: Real> Backlash<R> {
    /// * `stiffness`: k, kN/mm, −1e9…1e9
    /// * `slip_limit`: x, mm, 1e-9…1e4
    /// * `slack`: s, the whole play, mm, 0…1e4
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(stiffness: R, slip_limit: R, slack: R) -> Result<Self, ConfigError> {
        let slack = in_range("slack", slack, 0.0, limits::DISPLACEMENT)?;
        let new = Self {
            stiffness,
            slip_limit,
            half_slack: R::from_f64(0.5) * slack,
        };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for Backlash<R> {
    const DESCRIPTION: Description = Description {
        name: "backlash",
        family: "backlash",
        number: 21,
        parameters: Self::PARAMETERS,
        typical: &[2.0, 0.02, 0.04],
        depends_on: &[Dependence::Displacement, Dependence::History],
        outside: Growth::Saturates,
        energy: Energy::Below0(&["stiffness"]),
        sentence: "Friction with elastic pre-sliding behind free play: after each reversal the damper moves through the play before \
                   friction holds it.",
        ..Description::PLAIN
    };
    const NONE: Self = Self::ABSENT;

    type State = Option<Stretch<R>>;
    const AT_REST: Self::State = None;

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [stiffness, slip_limit, slack] = super::numbers::exactly(parameters)?.map(R::from_f64);
        Self::new(stiffness, slip_limit, slack)
    }

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("stiffness", self.stiffness)?;
        in_range("slip_limit", self.slip_limit, 1e-9, limits::DISPLACEMENT)?;
        in_range("slack", self.half_slack, 0.0, 0.5 * limits::DISPLACEMENT).map(|_| ())
    }

    fn supplies(&self) -> Option<(&'static str, R)> {
        below_0("stiffness", self.stiffness)
    }

    // Not inlined on a target, so that a tick without this effect does not save its registers.
    #[cfg_attr(not(feature = "std"), inline(never))]
    fn force(&self, state: &mut Self::State, motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let reach = self.half_slack + self.slip_limit;
        let place = Stretch::after(state, motion, |place, way| (place + way).clipped(reach));
        let beyond = place.abs() - self.half_slack;
        if beyond <= R::ZERO {
            return R::ZERO;
        }
        // Next to a wide play the sum that gives its reach is rounded.
        let force = self.stiffness * beyond.clipped(self.slip_limit);
        if place < R::ZERO { -force } else { force }
    }
}

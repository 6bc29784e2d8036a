//! A spring and a dashpot in series (a Maxwell branch) beside the law: a force that fades when the motion stops.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::real::{Real, coefficient, in_range};

/// dz/dt = k·v − z/τ, F = z.
///
/// With the displacement a straight line within a tick of Δt the step is exact:
/// z ← z − loss·z + gain·Δy, loss = 1 − e^(−Δt/τ), gain = k·loss·τ/Δt.
/// Storage modulus k·(ωτ)²/(1 + (ωτ)²), loss modulus k·ωτ/(1 + (ωτ)²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation<R> {
    pub(super) gain: R,
    /// Kept instead of 1 − loss: near 1, f32 would round the time constant.
    pub(super) loss: R,
}

/// What a [`Relaxation`] remembers.
#[derive(Clone, Copy, Debug, Default)]
pub struct RelaxationState<R> {
    force: R,
    /// What rounding has kept from the force: a tick's change is far smaller than an f32 can add when τ is long.
    carry: R,
    /// Displacement of the tick before, mm.
    previous: R,
}

impl<R: Real> Relaxation<R> {
    pub(super) const NONE: Self = Self {
        gain: R::ZERO,
        loss: R::ZERO,
    };

    /// * `stiffness`: k, kN/mm, −1e9…1e9
    /// * `time`: τ, s, 1e-6…1e6
    /// * `tick`: Δt, s, 1e-7…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(stiffness: R, time: R, tick: R) -> Result<Self, ConfigError> {
        let stiffness = coefficient("stiffness", stiffness)?.to_f64();
        let time = in_range("time", time, 1e-6, 1e6)?.to_f64();
        let tick = in_range("tick", tick, 1e-7, 1e3)?.to_f64();
        let loss = -libm::expm1(-tick / time);
        Ok(Self {
            gain: R::from_f64(stiffness * loss * time / tick),
            loss: R::from_f64(loss),
        })
    }
}

impl<R: Real> EffectForce<R> for Relaxation<R> {
    type State = RelaxationState<R>;

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("gain", self.gain)?;
        in_range("loss", self.loss, 0.0, 1.0).map(|_| ())
    }

    fn begin(&self, motion: &ConfinedMotion<R>) -> Self::State {
        RelaxationState {
            previous: motion.displacement(),
            ..RelaxationState::default()
        }
    }

    #[inline(always)]
    fn force(&self, state: &mut Self::State, motion: &ConfinedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        let step = y - state.previous;
        state.previous = y;
        let change = self.gain * step - self.loss * state.force + state.carry;
        let force = state.force + change;
        state.carry = change - (force - state.force);
        state.force = force;
        force
    }
}

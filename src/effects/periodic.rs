//! A tone: a force of its own frequency, whatever the motion. A pump, a shaker's neighbour, mains hum in the load cell.

use core::f64::consts::TAU;

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::frame::{halves, whole};
use crate::real::{Real, coefficient, in_range};
use crate::sine::{FREQUENCY_MIN, increment};

/// F = F0·sin(2πf·t + φ), t = 0 at the first tick.
///
/// The phase is an integer of 64 bits, so that a million ticks later it is as far as it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periodic<R> {
    pub(super) amplitude: R,
    /// Of a tick, 2⁶⁴ to the cycle, in halves: aligned as all else that a law is made of.
    pub(super) increment: [u32; 2],
    /// At the first tick.
    pub(super) phase: [u32; 2],
}

impl<R: Real> Periodic<R> {
    pub(super) const NONE: Self = Self {
        amplitude: R::ZERO,
        increment: [0; 2],
        phase: [0; 2],
    };

    /// The time's parameters are `f64` whatever the float: rounded to `f32` they would be a cycle apart after 10⁷ cycles.
    ///
    /// * `amplitude`: F0, kN, −1e9…1e9
    /// * `frequency`: f, Hz, 1e-6 to 0.499 of the tick rate
    /// * `phase`: φ, rad, −1e3…1e3
    /// * `tick`: s, 1e-6…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(amplitude: R, frequency: f64, phase: f64, tick: f64) -> Result<Self, ConfigError> {
        let tick_rate = 1.0 / in_range("tick", tick, 1e-6, 1e3)?;
        in_range("frequency", frequency, FREQUENCY_MIN, 0.499 * tick_rate)?;
        let turns = in_range("phase", phase, -1e3, 1e3)? / TAU;
        let new = Self {
            amplitude,
            increment: halves((increment(frequency, tick_rate) >> 64) as u64),
            phase: halves(((turns - libm::floor(turns)) * (1u128 << 64) as f64) as u64),
        };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> EffectForce<R> for Periodic<R> {
    /// Phase of the next tick.
    type State = [u32; 2];

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("amplitude", self.amplitude).map(|_| ())
    }

    fn begin(&self, _: &ConfinedMotion<R>) -> [u32; 2] {
        self.phase
    }

    #[inline(always)]
    fn force(&self, state: &mut [u32; 2], _: &ConfinedMotion<R>, _: LawForce<R>) -> R {
        let phase = whole(*state);
        *state = halves(phase.wrapping_add(whole(self.increment)));
        self.amplitude * R::sine(phase)
    }
}

//! Tones: forces of their own frequencies, whatever the motion. A pump, a shaker's neighbour, mains hum in the load cell and
//! its harmonics.

use core::f64::consts::TAU;

use super::{ConfinedMotion, EffectForce, LawForce, some};
use crate::error::ConfigError;
use crate::frame::{halves, whole};
use crate::real::{Real, coefficient, in_range};
use crate::sine::{FREQUENCY_MIN, increment};

/// Most tones in one [`Periodic`].
pub const MAX_TONES: usize = 3;

/// F = Σ Fᵢ·sin(2πfᵢ·t + φᵢ), t = 0 at the first tick.
///
/// A phase is an integer of 64 bits, so that a million ticks later it is as far as it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periodic<R> {
    pub(super) tones: [Tone<R>; MAX_TONES],
    pub(super) used: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tone<R> {
    pub(super) amplitude: R,
    /// Of a tick, 2⁶⁴ to the cycle, in halves: aligned as all else that a law is made of.
    pub(super) increment: [u32; 2],
    /// At the first tick.
    pub(super) phase: [u32; 2],
}

impl<R: Real> Tone<R> {
    pub(super) const NONE: Self = Self {
        amplitude: R::ZERO,
        increment: [0; 2],
        phase: [0; 2],
    };

    #[inline(always)]
    fn force(&self, state: &mut [u32; 2]) -> R {
        let phase = whole(*state);
        *state = halves(phase.wrapping_add(whole(self.increment)));
        self.amplitude * R::sine(phase)
    }

    /// The sum of `tones`' forces; one that is not there has none.
    // Not inlined: its registers are no matter of a single tone.
    #[inline(never)]
    fn force_of(tones: &[Self], states: &mut [[u32; 2]]) -> R {
        let pairs = tones.iter().zip(states);
        pairs.fold(R::ZERO, |sum, (tone, state)| sum + tone.force(state))
    }
}

impl<R: Real> Periodic<R> {
    pub(super) const NONE: Self = Self {
        tones: [Tone::NONE; MAX_TONES],
        used: 0,
    };

    /// The time's parameters are `f64` whatever the float: rounded to `f32` they would be a cycle apart after 10⁷ cycles.
    ///
    /// * `tones`: 1…3, each of an amplitude F, kN, −1e9…1e9, a frequency f, Hz, 1e-6 to 0.499 of the tick rate, and a phase φ,
    ///   rad, −1e3…1e3
    /// * `tick`: s, 1e-6…1e3
    ///
    /// # Errors
    /// No tones, too many, or the field that is not finite or out of range.
    pub fn new(tones: &[(R, f64, f64)], tick: f64) -> Result<Self, ConfigError> {
        let tick_rate = 1.0 / in_range("tick", tick, 1e-6, 1e3)?;
        let mut new = Self {
            used: tones.len(),
            ..Self::NONE
        };
        for (slot, &(amplitude, frequency, phase)) in new.tones.iter_mut().zip(tones) {
            in_range("frequency", frequency, FREQUENCY_MIN, 0.499 * tick_rate)?;
            let turns = in_range("phase", phase, -1e3, 1e3)? / TAU;
            *slot = Tone {
                amplitude,
                increment: halves((increment(frequency, tick_rate) >> 64) as u64),
                phase: halves(((turns - libm::floor(turns)) * (1u128 << 64) as f64) as u64),
            };
        }
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> EffectForce<R> for Periodic<R> {
    /// Phases of the next tick.
    type State = [[u32; 2]; MAX_TONES];

    fn check(&self) -> Result<(), ConfigError> {
        let used = some("tones", &self.tones, self.used)?;
        used.iter()
            .try_for_each(|tone| coefficient("amplitude", tone.amplitude).map(|_| ()))
    }

    fn begin(&self, _: &ConfinedMotion<R>) -> Self::State {
        self.tones.map(|tone| tone.phase)
    }

    #[inline(always)]
    fn force(&self, state: &mut Self::State, _: &ConfinedMotion<R>, _: LawForce<R>) -> R {
        let ([tone, tones @ ..], [first, others @ ..]) = (&self.tones, state);
        let force = tone.force(first);
        if self.used > 1 {
            return force + Tone::force_of(tones, others);
        }
        force
    }
}

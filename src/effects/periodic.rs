//! Tones: forces with their own frequencies, independent of the motion. Examples are a pump, a neighbouring shaker, and mains hum
//! in the load cell with its harmonics.

use core::f64::consts::TAU;

use super::description::{Dependence, Description, Energy};
use super::numbers::{COEFFICIENTS, Elements};
use super::{ClampedMotion, Equations, LawForce, Packed};
use crate::error::ConfigError;
use crate::frame::{halves, whole};
use crate::real::{Real, coefficient, in_range};
use crate::sine::{FREQUENCY_MIN, increment};

/// Highest frequency, cycles per tick: below half a cycle.
const HIGHEST: f64 = 0.499;
/// Highest frequency, Hz: that of the highest tick rate.
const FREQUENCY_MAX: f64 = 1e6 * HIGHEST;
/// Range of a phase, rad.
const PHASES: [f64; 2] = [-1e3, 1e3];

/// Most tones in one [`Periodic`].
pub const MAX_TONES: usize = 3;

/// F = Σ Fᵢ·sin(2πfᵢ·t + φᵢ), t = 0 at the first tick.
///
/// A phase is an integer of 64 bits, so that it is still exact after a million ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periodic<R> {
    tones: Elements<Tone<R>, MAX_TONES>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Tone<R> {
    amplitude: R,
    /// Increment of the phase per tick, 2⁶⁴ per cycle, in halves: aligned like all other parts of a law.
    increment: [u32; 2],
    /// Phase at the first tick.
    phase: [u32; 2],
}

numbers! {
    Tone of {
        amplitude: "kN" in COEFFICIENTS,
        frequency: "Hz" in [FREQUENCY_MIN, FREQUENCY_MAX],
        phase: "rad" in PHASES,
    }
}

impl<R: Real> Tone<R> {
    const ABSENT: Self = Self {
        amplitude: R::ZERO,
        increment: [0; 2],
        phase: [0; 2],
    };

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("amplitude", self.amplitude)?;
        // In cycles per tick, with a margin for the rounding of a rate. 2⁶⁴ are a cycle.
        let [low, high] = [FREQUENCY_MIN * 1e-6, HIGHEST];
        let [least, most] = [(1.0 - 1e-9) * low, (1.0 + 1e-9) * high]
            .map(|part| (part * (1u128 << 64) as f64) as u64);
        let increment = whole(self.increment);
        if (least..=most).contains(&increment) {
            return Ok(());
        }
        Err(ConfigError::OutOfRange {
            field: "frequency",
            value: increment as f64 / (1u128 << 64) as f64,
            low,
            high,
        })
    }

    #[inline(always)]
    fn force(&self, state: &mut [u32; 2]) -> R {
        let phase = whole(*state);
        *state = halves(phase.wrapping_add(whole(self.increment)));
        self.amplitude * R::sine(phase)
    }

    /// Sum of the forces of `tones`; an absent tone has none.
    // Not inlined, so that a single tone does not load its registers.
    #[inline(never)]
    fn force_of(tones: &[Self], states: &mut [[u32; 2]]) -> R {
        let pairs = tones.iter().zip(states);
        pairs.fold(R::ZERO, |sum, (tone, state)| sum + tone.force(state))
    }
}

impl<R: Real> Periodic<R> {
    /// The parameters of time are `f64` for every float: rounded to `f32` they would be off by a cycle after 10⁷ cycles.
    ///
    /// * `tones`: 1…3, each of an amplitude F, kN, −1e9…1e9, a frequency f, Hz, 1e-6 to 0.499 of the tick rate, and a phase φ,
    ///   rad, −1e3…1e3
    /// * `tick`: s, 1e-6…1e3
    ///
    /// # Errors
    /// No tones, too many, or the field that is not finite or out of range.
    pub fn new(tones: &[(R, f64, f64)], tick: f64) -> Result<Self, ConfigError> {
        let tick_rate = 1.0 / in_range("tick", tick, 1e-6, 1e3)?;
        let tone = |&(amplitude, frequency, phase): &(R, f64, f64)| {
            in_range("frequency", frequency, FREQUENCY_MIN, HIGHEST * tick_rate)?;
            let turns = in_range("phase", phase, PHASES[0], PHASES[1])? / TAU;
            Ok(Tone {
                amplitude,
                increment: halves((increment(frequency, tick_rate) >> 64) as u64),
                phase: halves(((turns - libm::floor(turns)) * (1u128 << 64) as f64) as u64),
            })
        };
        let new = Self {
            tones: Elements::of(tones, Tone::ABSENT, tone)?,
        };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for Periodic<R> {
    const DESCRIPTION: Description = Description {
        name: "periodic",
        family: "periodic",
        number: 12,
        parameters: Tone::<R>::PARAMETERS,
        most: MAX_TONES,
        typical: &[0.02, 50.0, 0.3],
        depends_on: &[Dependence::Time],
        energy: Energy::Active,
        sentence: "Tones: forces of their own frequencies, whatever the motion.",
        ..Description::PLAIN
    };
    const NONE: Self = Self {
        tones: Elements::absent(Tone::ABSENT),
    };

    /// Phases of the next tick.
    type State = Option<[[u32; 2]; MAX_TONES]>;
    const AT_REST: Self::State = None;

    fn from_parameters(parameters: &[f64], tick: f64) -> Result<Self, ConfigError> {
        let tones = super::numbers::elements::<3, MAX_TONES, _>(
            "tones",
            parameters,
            |[amplitude, frequency, phase]| (R::from_f64(amplitude), frequency, phase),
        )?;
        Self::new(&tones, tick)
    }

    fn check(&self) -> Result<(), ConfigError> {
        self.tones.check("tones", Tone::check)
    }

    #[inline(always)]
    fn force(&self, state: &mut Self::State, _: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let state = state.get_or_insert_with(|| self.tones.all.map(|tone| tone.phase));
        let ([tone, tones @ ..], [first, others @ ..]) = (&self.tones.all, state);
        let force = tone.force(first);
        if self.tones.count > 1 {
            return force + Tone::force_of(tones, others);
        }
        force
    }
}

impl Packed for Tone<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        put(self.amplitude);
        for half in self.increment.into_iter().chain(self.phase) {
            put(f32::from_bits(half));
        }
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let &[amplitude, a, b, c, d] = words else {
            return None;
        };
        Some(Self {
            amplitude,
            increment: [a, b].map(f32::to_bits),
            phase: [c, d].map(f32::to_bits),
        })
    }
}

impl Packed for Periodic<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        self.tones.pack(put);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let tones = Elements::unpack::<5>(words, Tone::ABSENT)?;
        Some(Self { tones })
    }
}

//! A segment computes the motion of whole cycles with one function for amplitude and one for frequency.

use super::excitation::{CYCLES_PER_UNIT, Excitation, ROUNDING};
use super::increment::{fraction, increment};
use crate::frame::{Fields, Reader, Writer, halves, whole};

/// Whole cycles with one function for amplitude and one for frequency, as the generator runs through them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment {
    pub(super) cycles: u32,
    /// Cycles per tick at θ = 0, 2¹²⁸ per cycle.
    pub(super) increment: u128,
    /// eᵏʰ − 1, 2⁶⁴ per 1: each completed cycle adds this to the increment.
    growth: i64,
    /// Frequency at θ = 0, Hz.
    pub(super) frequency: f32,
    /// Frequency at the end, Hz.
    frequency_end: f32,
    /// k, Hz per cycle travelled.
    pub(super) chirp: f32,
    /// Amplitude at θ = 0, mm.
    pub(super) amplitude: f32,
    /// Amplitude at the end minus amplitude at the start, mm.
    rise: f32,
    /// 1 / cycles.
    inverse_length: f32,
    /// ω at θ = 0, rad/s.
    pub(super) angular: f32,
    /// Neither amplitude nor frequency changes.
    pub(super) steady: bool,
}

impl Segment {
    pub(super) const EMPTY: Self = Self {
        cycles: 0,
        increment: 0,
        growth: 0,
        frequency: 0.0,
        frequency_end: 0.0,
        chirp: 0.0,
        amplitude: 0.0,
        rise: 0.0,
        inverse_length: 0.0,
        angular: 0.0,
        steady: false,
    };

    pub(super) fn new(
        amplitude: (f64, f64),
        frequency: (f64, f64),
        cycles: u32,
        tick_rate: f64,
    ) -> Self {
        let chirp = (frequency.1 - frequency.0) / f64::from(cycles);
        let kh = chirp / tick_rate;
        let factor = libm::expm1(kh);
        Self {
            cycles,
            increment: if kh == 0.0 {
                increment(frequency.0, tick_rate)
            } else {
                let step = frequency.0 / tick_rate * (factor / kh);
                fraction(step)
            },
            growth: (factor * (1u128 << 64) as f64) as i64,
            frequency: frequency.0 as f32,
            frequency_end: frequency.1 as f32,
            chirp: chirp as f32,
            amplitude: amplitude.0 as f32,
            rise: (amplitude.1 - amplitude.0) as f32,
            inverse_length: (1.0 / f64::from(cycles)) as f32,
            angular: (core::f64::consts::TAU * frequency.0) as f32,
            steady: kh == 0.0 && amplitude.0 == amplitude.1,
        }
    }

    /// Phase increment of one tick after `travelled` cycles and `phase`.
    #[inline(always)]
    pub(super) fn step(&self, travelled: u32, phase: u128) -> u128 {
        if self.growth == 0 {
            return self.increment;
        }
        // The product of 2⁶⁴ per cycle and 2⁶⁴ per 1. Whole turns of it drop out, because the step is less than half a cycle.
        let theta = ((i128::from(travelled) << 64) | i128::from((phase >> 64) as u64))
            - (ROUNDING >> 64) as i128;
        self.increment
            .wrapping_add(i128::from(self.growth).wrapping_mul(theta) as u128)
    }

    /// Frequency in Hz, computed from the end with the lower frequency: a sum of positive terms, each with the relative accuracy of
    /// a float. From the higher end the low frequencies would be small differences.
    #[inline(always)]
    fn frequency(&self, travelled: u32, phase: u32) -> f32 {
        if self.chirp < 0.0 {
            // One whole cycle minus the phase, as an integer, so that no digits are lost.
            let rest = (!phase as f32 + 1.0) * CYCLES_PER_UNIT;
            let ahead = self.cycles.wrapping_sub(travelled).wrapping_sub(1) as f32 + rest;
            self.frequency_end - self.chirp * ahead
        } else {
            self.frequency + self.chirp * (travelled as f32 + phase as f32 * CYCLES_PER_UNIT)
        }
    }

    /// Position, velocity and acceleration where amplitude or frequency changes, after `travelled` cycles and the phase in
    /// `excitation`.
    #[inline]
    pub(super) fn changing(&self, travelled: u32, sin: f32, cos: f32, excitation: &mut Excitation) {
        use core::f32::consts::TAU;
        let theta = travelled as f32 + excitation.phase as f32 * CYCLES_PER_UNIT;
        let frequency = self.frequency(travelled, excitation.phase);
        let angular = TAU * frequency;
        let angular_rate = TAU * self.chirp * frequency;
        // s and its first two time derivatives.
        let part = theta * self.inverse_length;
        let part = if part > 1.0 { 1.0 } else { part };
        let part_rate = frequency * self.inverse_length;
        let part_acceleration = self.chirp * part_rate;
        // 10s³ − 15s⁴ + 6s⁵ and its first two derivatives.
        let rest = 1.0 - part;
        let lower_half = |s: f32| s * s * s * (10.0 - s * (15.0 - 6.0 * s));
        // Above one half by symmetry, where the difference of the terms would lose digits.
        let step = if part > 0.5 {
            1.0 - lower_half(rest)
        } else {
            lower_half(part)
        };
        let slope = 30.0 * part * part * rest * rest;
        let curvature = 60.0 * part * rest * (rest - part);
        let a = self.amplitude + self.rise * step;
        let a_rate = self.rise * slope * part_rate;
        let a_acceleration =
            self.rise * (curvature * part_rate * part_rate + slope * part_acceleration);
        excitation.displacement = a * sin;
        excitation.velocity = a_rate * sin + a * angular * cos;
        excitation.acceleration = (a_acceleration - a * angular * angular) * sin
            + (2.0 * a_rate * angular + a * angular_rate) * cos;
    }
}

/// Duration of `cycles` in s while the frequency changes from `from` to `to`.
pub(super) fn duration(from: f64, to: f64, cycles: u32) -> f64 {
    let change = (to - from) / from;
    // ln(1 + x)/x, which is 1 for a constant frequency.
    let slowing = if change == 0.0 {
        1.0
    } else {
        libm::log1p(change) / change
    };
    f64::from(cycles) / from * slowing
}

impl Fields for Segment {
    fn write(&self, writer: &mut Writer<'_>) {
        let [low, high] = [self.increment as u64, (self.increment >> 64) as u64].map(halves);
        let growth = halves(self.growth as u64);
        writer.words([
            self.cycles,
            low[0],
            low[1],
            high[0],
            high[1],
            growth[0],
            growth[1],
        ]);
        let floats = [
            self.frequency,
            self.frequency_end,
            self.chirp,
            self.amplitude,
            self.rise,
            self.inverse_length,
            self.angular,
        ];
        writer.words(floats.map(f32::to_bits));
        writer.words([u32::from(self.steady)]);
    }

    #[inline(never)]
    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [cycles, a, b, c, d, growth_low, growth_high] = reader.words()?;
        let floats = reader.words()?.map(f32::from_bits);
        let [
            frequency,
            frequency_end,
            chirp,
            amplitude,
            rise,
            inverse_length,
            angular,
        ] = floats;
        if !floats.iter().all(|value| value.is_finite()) {
            return None;
        }
        Some(Self {
            cycles,
            increment: u128::from(whole([a, b])) | u128::from(whole([c, d])) << 64,
            growth: whole([growth_low, growth_high]) as i64,
            frequency,
            frequency_end,
            chirp,
            amplitude,
            rise,
            inverse_length,
            angular,
            steady: reader.u32()? != 0,
        })
    }
}

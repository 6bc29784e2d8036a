//! A sine with its ramps, in integers.

use super::scales::rounded;
use super::sine::sin_cos;
use super::{Part, Scales, times};
use crate::error::ConfigError;
use crate::real::in_range;
use crate::sine::{FREQUENCY_MIN, TICK_RATE_MAX, increment};

/// Most cycles of a ramp.
pub const RAMP_CYCLES_MAX: u32 = 10_000;

/// One sine from rest to rest: whole cycles at full amplitude, and a ramp of whole cycles before and after them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    /// Amplitude, mm, from 0 to below the full scale of displacement
    pub amplitude: f64,
    /// Frequency, Hz, [`FREQUENCY_MIN`] to a quarter of the tick rate
    pub frequency: f64,
    /// Cycles at full amplitude, at least 1
    pub cycles: u32,
    /// Cycles of each ramp, 1…[`RAMP_CYCLES_MAX`]
    pub ramp_cycles: u32,
}

/// Demand of the generator at one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation {
    /// Position.
    pub displacement: Part,
    /// Velocity, the derivative of the position, also in ramps.
    pub velocity: Part,
    /// Cycles completed since the start, ramps included.
    pub cycle: u32,
    /// Whether the tick is in a ramp.
    pub ramp: bool,
    /// Whether a cycle ended since the tick before, so that this tick is the first of the next cycle.
    pub cycle_end: bool,
}

/// A factor below 1 with 16 bits of mantissa, so that a small amplitude is as accurate as a large one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Factor {
    /// Mantissa from ½, 2¹⁶ per 1.
    mantissa: u32,
    shift: u32,
}

impl Factor {
    /// `value` in units of `scale`; the error names `field` where it exceeds 1 − 2⁻¹⁶.
    fn new(field: &'static str, value: f64, scale: f64) -> Result<Self, ConfigError> {
        in_range(field, value, 0.0, scale * (65_535.0 / 65_536.0))?;
        let (mantissa, exponent) = libm::frexp(value / scale);
        let mantissa = rounded(mantissa, 16) as u32;
        let shift = exponent.unsigned_abs().min(31);
        Ok(if mantissa > 65_535 && shift > 0 {
            Self {
                mantissa: mantissa / 2,
                shift: shift - 1,
            }
        } else {
            Self {
                mantissa: mantissa.min(65_535),
                shift,
            }
        })
    }

    /// `value` times this factor, 2³⁰ per 1.
    #[inline(always)]
    fn part(self, value: i32) -> Part {
        Part::from_bits((times(value, self.mantissa) << 1) >> self.shift)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Ramp,
    Steady,
    ToRest,
    Done,
}

/// Runs through a [`Sine`], tick by tick.
///
/// The phase is an integer, 2⁶⁴ per cycle. After n ticks it is within n units of the exact phase: after 10¹⁰ ticks within 5e-10 of
/// a cycle.
#[derive(Clone, Debug)]
pub struct SineGenerator {
    increment: u64,
    amplitude: Factor,
    speed: Factor,
    cycles: u32,
    ramp: Ramp,
    /// Phase, with [`ROUNDING`] added.
    phase: u64,
    stage: Stage,
    /// Cycles completed in this stage.
    travelled: u32,
    cycle: u32,
    cycle_end: bool,
}

/// Half a unit of the phase's upper 32 bits, so that they are rounded to the nearest. A tick that misses the end of a cycle only by
/// the rounding of a decimal frequency thus belongs to the next cycle.
const ROUNDING: u64 = 1 << 31;

impl SineGenerator {
    /// A generator at rest, at the start of `sine`.
    ///
    /// * `tick_rate`: Hz, 1…[`TICK_RATE_MAX`]
    ///
    /// # Errors
    /// The field that is not finite or out of range; `velocity` if 2π·frequency·amplitude exceeds its full scale.
    pub fn new(sine: Sine, tick_rate: f64, scales: &Scales) -> Result<Self, ConfigError> {
        in_range("tick_rate", tick_rate, 1.0, TICK_RATE_MAX)?;
        in_range("frequency", sine.frequency, FREQUENCY_MIN, tick_rate / 4.0)?;
        in_range("cycles", f64::from(sine.cycles), 1.0, f64::from(u32::MAX))?;
        let amplitude = Factor::new("amplitude", sine.amplitude, scales.displacement())?;
        let speed = core::f64::consts::TAU * sine.frequency * sine.amplitude;
        Ok(Self {
            increment: (increment(sine.frequency, tick_rate) >> 64) as u64,
            amplitude,
            speed: Factor::new("velocity", speed, scales.velocity())?,
            cycles: sine.cycles,
            ramp: Ramp::new(sine.ramp_cycles)?,
            phase: ROUNDING,
            stage: Stage::Ramp,
            travelled: 0,
            cycle: 0,
            cycle_end: false,
        })
    }

    /// The excitation at this tick; the first call gives the start, at rest. `None` after the end.
    #[inline(always)]
    pub fn tick(&mut self) -> Option<Excitation> {
        let phase = (self.phase >> 32) as u32;
        let (mut sin, mut cos) = sin_cos(phase);
        if self.stage != Stage::Steady {
            if self.stage == Stage::Done {
                return None;
            }
            (sin, cos) = self
                .ramp
                .scaled(self.travelled, phase, sin, cos, self.stage);
        }
        let excitation = Excitation {
            displacement: self.amplitude.part(sin),
            velocity: self.speed.part(cos),
            cycle: self.cycle,
            ramp: self.stage != Stage::Steady,
            cycle_end: self.cycle_end,
        };
        let (phase, wrapped) = self.phase.overflowing_add(self.increment);
        self.phase = phase;
        self.cycle_end = wrapped;
        if wrapped {
            self.next_cycle();
        }
        Some(excitation)
    }

    #[cold]
    fn next_cycle(&mut self) {
        self.cycle = self.cycle.wrapping_add(1);
        self.travelled += 1;
        let (cycles, next) = match self.stage {
            Stage::Ramp => (self.ramp.cycles, Stage::Steady),
            Stage::Steady => (self.cycles, Stage::ToRest),
            _ => (self.ramp.cycles, Stage::Done),
        };
        if self.travelled >= cycles {
            self.stage = next;
            self.travelled = 0;
        }
    }
}

/// The amplitude in a ramp: the quintic 10s³ − 15s⁴ + 6s⁵ of its completed part s, as in [`crate::sine`].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ramp {
    cycles: u32,
    /// 1/cycles rounded down, so that no part reaches 1. This field and the following have 2³⁰ per 1.
    inverse: i32,
    /// 30/(2π·cycles)/16.
    steepness: i32,
}

const ONE: i32 = 1 << 30;

impl Ramp {
    fn new(cycles: u32) -> Result<Self, ConfigError> {
        let length = f64::from(cycles);
        in_range("ramp_cycles", length, 1.0, f64::from(RAMP_CYCLES_MAX))?;
        Ok(Self {
            cycles,
            inverse: (f64::from(ONE) / length) as i32,
            steepness: rounded(30.0 / 16.0 / (core::f64::consts::TAU * length), 30) as i32,
        })
    }

    /// a·sin and its derivative divided by ω, with a the part of the amplitude after `travelled` cycles and `phase` of the ramp.
    #[inline(never)]
    fn scaled(&self, travelled: u32, phase: u32, sin: i32, cos: i32, stage: Stage) -> (i32, i32) {
        let part = travelled as i32 * self.inverse + product(self.inverse, (phase >> 2) as i32);
        let rest = ONE - part;
        let square = product(part, part);
        // (10 − 15s + 6s²)/16
        let polynomial = 10 * (ONE >> 4) - 15 * (part >> 4) + 6 * (square >> 4);
        let step = product(product(square, part), polynomial) << 4;
        // da/dθ = 30·s²·(1 − s)²/cycles, in which s²·(1 − s)² is at most 1/16.
        let slope = product(product(square, product(rest, rest)) << 4, self.steepness);
        let (step, slope) = if stage == Stage::ToRest {
            (ONE - step, -slope)
        } else {
            (step, slope)
        };
        (product(step, sin), product(step, cos) + product(slope, sin))
    }
}

/// `a`·`b` for magnitudes of up to 1, 2³⁰ per 1, with an error below 3 units: the products of the halves, without that of the two
/// low ones.
#[inline(always)]
fn product(a: i32, b: i32) -> i32 {
    let (a_high, a_low) = (a >> 15, a & 0x7fff);
    let (b_high, b_low) = (b >> 15, b & 0x7fff);
    a_high * b_high + ((a_high * b_low + a_low * b_high) >> 15)
}

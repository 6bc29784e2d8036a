//! The motion of a condition.

use std::f64::consts::{PI, TAU};

use mesh_damper_reference::protocol::MotionSample;
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};
use serde::Serialize;

use super::programme::{Condition, Kind};
use crate::blind::log_uniform;

/// The shape of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Wave {
    /// A sine.
    Sine,
    /// Ramps between two ends, with rounded corners.
    Triangle {
        /// Rounding of the corners, 0…1, dimensionless: the ramp is the arcsine of (1 − rounding) times a sine; 0 is sharp.
        rounding: f64,
    },
    /// Ramps with holds at both ends.
    Trapezoid {
        /// The ramps would go this much further than the ends, as a multiple of the amplitude.
        beyond: f64,
    },
    /// Random with frequencies from 0.2 to 1.5 times that of the condition.
    Random,
    /// A sine that grows evenly to the amplitude.
    Growing,
}

/// Tones of a random motion: enough that no period shows within 20 cycles.
const TONES: usize = 24;
/// Width of the rounded corners of a trapezoid over its amplitude.
const CORNER: f64 = 0.03;
/// A growing motion begins with this part of its amplitude.
const BEGIN: f64 = 0.1;
/// Cycles over which a motion starts from rest.
const START: f64 = 1.0;
/// Cycles before a recording that begins during the motion.
const BEFORE: f64 = 2.0;
/// Steps of the device in a cycle, at least: its explicit parts are then accurate to about a per cent.
const STEPS: f64 = 800.0;

impl Wave {
    /// A shape for conditions of `kind`; ramps for speeds, and most often sines for the others.
    pub fn draw(kind: Kind, rng: &mut impl Rng) -> Self {
        let triangle = Self::Triangle {
            rounding: log_uniform(0.001, 0.03, rng),
        };
        let trapezoid = Self::Trapezoid {
            beyond: rng.random_range(0.2..1.0),
        };
        let (sine, random, growing) = (Self::Sine, Self::Random, Self::Growing);
        let shapes: &[Self] = match kind {
            Kind::Speed => &[triangle, trapezoid],
            Kind::Frequency => &[sine, sine, sine, sine, triangle, growing],
            Kind::Amplitude | Kind::Level => &[
                sine, sine, sine, sine, triangle, trapezoid, random, random, growing,
            ],
        };
        *shapes.choose(rng).unwrap_or(&sine)
    }

    /// The displacement over the amplitude as a function of cycles, without its start.
    fn shape(self, cycles: f64, rng: &mut impl Rng) -> Box<dyn Fn(f64) -> f64> {
        let ramp = |x: f64, rounding: f64| {
            let sharp = 1.0 - rounding;
            (sharp * (TAU * x).sin()).asin() / sharp.asin()
        };
        match self {
            Self::Sine => Box::new(|x| (TAU * x).sin()),
            Self::Triangle { rounding } => Box::new(move |x| ramp(x, rounding)),
            Self::Trapezoid { beyond } => Box::new(move |x| {
                // The ramp's own corners are beyond the ends.
                let ramped = (1.0 + beyond) * ramp(x, 0.001);
                let bent = |x: f64| CORNER * (x / CORNER).cosh().ln();
                0.5 * (bent(ramped + 1.0) - bent(ramped - 1.0))
            }),
            Self::Growing => {
                Box::new(move |x| (BEGIN + (1.0 - BEGIN) * x / cycles) * (TAU * x).sin())
            }
            Self::Random => {
                let tones: Vec<[f64; 2]> = (0..TONES)
                    .map(|i| {
                        let within = (i as f64 + rng.random_range(0.0..1.0)) / TONES as f64;
                        [0.2 + 1.3 * within, rng.random_range(0.0..2.0 * PI)]
                    })
                    .collect();
                Box::new(move |x| {
                    tones
                        .iter()
                        .map(|[f, phase]| (TAU * f * x + phase).sin())
                        .sum()
                })
            }
        }
    }
}

/// A motion in steps fine enough for a device.
pub struct Motion {
    /// Each step's end.
    pub steps: Vec<MotionSample>,
    /// Steps from a sample to the next.
    pub stride: usize,
    /// The first sample's step.
    pub first: usize,
}

impl Motion {
    /// The motion of `condition`, from rest at displacement 0.
    pub fn of(condition: &Condition, wave: Wave, is_under_way: bool, rng: &mut impl Rng) -> Self {
        let stride = (STEPS * condition.frequency / condition.rate)
            .ceil()
            .max(1.0);
        let fine = condition.rate * stride;
        // A growing motion has no state that lasts.
        let before = match wave {
            Wave::Growing => 0.0,
            _ if is_under_way => BEFORE + rng.random_range(0.0..1.0),
            _ => 0.0,
        };
        let first = (before / condition.frequency * fine) as usize;
        let count = first + condition.samples() * stride as usize;
        let shape = wave.shape(condition.cycles, rng);
        let at = |x: f64| {
            let s = (x / START).clamp(0.0, 1.0);
            s.powi(3) * (10.0 + s * (6.0 * s - 15.0)) * shape(x)
        };
        // Differences over a ten-thousandth of a cycle: their error is below 1e-7 of the largest value.
        let h = 1e-4;
        let mut steps: Vec<MotionSample> = (0..count)
            .map(|step| {
                let x = step as f64 / fine * condition.frequency;
                let [back, here, forth] = [at(x - h), at(x), at(x + h)];
                MotionSample {
                    time: step as f64 / fine,
                    displacement: here,
                    velocity: (forth - back) / (2.0 * h) * condition.frequency,
                    acceleration: (forth - 2.0 * here + back) / h.powi(2)
                        * condition.frequency.powi(2),
                }
            })
            .collect();
        let most = steps
            .iter()
            .fold(0.0, |most: f64, step| most.max(step.displacement.abs()));
        let factor = condition.amplitude / if wave == Wave::Random { most } else { 1.0 };
        for step in &mut steps {
            step.displacement *= factor;
            step.velocity *= factor;
            step.acceleration *= factor;
        }
        Self {
            steps,
            stride: stride as usize,
            first,
        }
    }
}

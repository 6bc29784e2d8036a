//! The conditions of a trial, and which of them are held out.

use rand::seq::{IndexedRandom, index};
use rand::{Rng, RngExt};
use serde::Serialize;

use super::waves::Wave;
use crate::blind::log_uniform;

/// The quantity by which conditions differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Amplitude, at one frequency.
    Amplitude,
    /// Frequency, at one amplitude.
    Frequency,
    /// Speed of ramps, at one amplitude.
    Speed,
    /// Level of the control input, under one motion.
    Level,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Amplitude, Self::Frequency, Self::Speed, Self::Level];
}

/// A condition: one recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Condition {
    /// Largest displacement, mm.
    pub amplitude: f64,
    /// Frequency of the cycles, Hz.
    pub frequency: f64,
    /// The control input over the largest one of the trial.
    pub level: f64,
    /// Number of cycles.
    pub cycles: f64,
    /// Sampling rate, Hz.
    pub rate: f64,
}

impl Condition {
    /// Number of samples.
    pub fn samples(&self) -> usize {
        (self.cycles / self.frequency * self.rate) as usize
    }

    /// Its value of the quantity `kind`; the speed of a triangle in mm/s.
    pub fn value(&self, kind: Kind) -> f64 {
        match kind {
            Kind::Amplitude => self.amplitude,
            Kind::Frequency => self.frequency,
            Kind::Speed => 4.0 * self.amplitude * self.frequency,
            Kind::Level => self.level,
        }
    }
}

/// The tests of a device.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Programme {
    /// The quantity by which conditions differ.
    pub kind: Kind,
    /// The motion.
    pub wave: Wave,
    /// Whether the recordings begin during the motion, not at rest.
    pub is_under_way: bool,
    /// Whether the held-out conditions are outside the range of the fitted ones.
    pub is_outside: bool,
    /// The fitted conditions.
    pub training: Vec<Condition>,
    /// The others.
    pub held_out: Vec<Condition>,
}

/// Largest distance of a held-out condition from the range of training, and the least one, as factors.
const OUTSIDE: (f64, f64) = (1.15, 1.6);
/// Part of the trials with conditions outside.
const PART_OUTSIDE: f64 = 1.0 / 3.0;
/// Samples of all recordings, about; more would take longer than some seconds a trial.
const MOST_SAMPLES: f64 = 12_000.0;
/// Samples in a cycle, at least and at most.
const SAMPLES: (f64, f64) = (20.0, 400.0);
/// Range of frequencies, Hz, and of amplitudes, mm: from slow large dampers to small fast ones.
const FREQUENCIES: (f64, f64) = (0.01, 30.0);
const AMPLITUDES: (f64, f64) = (0.02, 60.0);
/// The fastest testing machines, mm/s.
const FASTEST: f64 = 2000.0;

impl Programme {
    /// A draw of conditions of `kind`.
    pub fn draw(kind: Kind, rng: &mut impl Rng) -> Self {
        let is_outside = rng.random_bool(PART_OUTSIDE);
        let (values, held) = values(kind, is_outside, rng);
        let amplitude = log_uniform(AMPLITUDES.0, AMPLITUDES.1, rng);
        let lowest = values[0];
        // The values of a frequency or speed are over the largest.
        let spread = match kind {
            Kind::Frequency | Kind::Speed => lowest,
            Kind::Amplitude | Kind::Level => 1.0,
        };
        let fastest = FREQUENCIES
            .1
            .min(FASTEST / (std::f64::consts::TAU * amplitude));
        let top = log_uniform(FREQUENCIES.0 / spread, fastest, rng);
        let wave = Wave::draw(kind, rng);
        let cycles = rng.random_range(4..=20);
        let mut all: Vec<Condition> = values
            .iter()
            .map(|&value| {
                let mut condition = Condition {
                    amplitude,
                    frequency: top,
                    level: 1.0,
                    cycles: f64::from(cycles),
                    rate: 0.0,
                };
                match kind {
                    Kind::Amplitude => condition.amplitude *= value,
                    Kind::Frequency | Kind::Speed => condition.frequency *= value,
                    Kind::Level => condition.level = value,
                }
                condition
            })
            .collect();
        sample(&mut all, rng);
        let of = |is_held: bool| {
            let each = all.iter().enumerate();
            let each = each.filter(|(index, _)| held.contains(index) == is_held);
            each.map(|(_, condition)| *condition).collect()
        };
        Self {
            kind,
            wave,
            is_under_way: rng.random_bool(0.5),
            is_outside,
            training: of(false),
            held_out: of(true),
        }
    }

    /// All conditions.
    pub fn all(&self) -> impl Iterator<Item = &Condition> {
        self.training.iter().chain(&self.held_out)
    }
}

/// Values over the largest one, in order, and the places of those held out.
fn values(kind: Kind, is_outside: bool, rng: &mut impl Rng) -> (Vec<f64>, Vec<usize>) {
    let count: usize = rng.random_range(3..=8);
    // Two fitted conditions at the ends show a range; of four, one more is held out only if three stay.
    let held = if count > 4 && rng.random_bool(0.5) {
        2
    } else {
        1
    };
    let ratio = match kind {
        Kind::Amplitude => log_uniform(2.5, 10.0, rng),
        Kind::Frequency => log_uniform(3.0, 30.0, rng),
        Kind::Speed => log_uniform(4.0, 100.0, rng),
        Kind::Level => log_uniform(2.5, 10.0, rng),
    };
    let is_from_zero = kind == Kind::Level && rng.random_bool(0.6);
    let steps = (count - 1) as f64;
    let mut values: Vec<f64> = (0..count)
        .map(|place| {
            let is_end = place == 0 || place == count - 1;
            let shift = if is_end {
                0.0
            } else {
                rng.random_range(-0.25..0.25)
            };
            let part = (place as f64 + shift) / steps;
            match is_from_zero {
                true => part,
                false => ratio.powf(part - 1.0),
            }
        })
        .collect();
    let places = match (is_outside, held) {
        (false, _) => index::sample(rng, count - 2, held)
            .iter()
            .map(|i| i + 1)
            .collect(),
        (true, 2) if !is_from_zero => vec![0, count - 1],
        // Above the range more often than below it: so a device is used.
        (true, _) if is_from_zero || rng.random_bool(0.6) => vec![count - 1],
        (true, _) => vec![0],
    };
    if is_outside {
        for &place in &places {
            let factor = log_uniform(OUTSIDE.0, OUTSIDE.1, rng);
            values[place] = match place {
                0 => values[1] / factor,
                _ => values[place - 1] * factor,
            };
        }
    }
    let most = values[count - 1];
    values.iter_mut().for_each(|value| *value /= most);
    (values, places)
}

/// Chooses the sampling rates: as many samples in each cycle, or one rate if that is not too many samples.
fn sample(conditions: &mut [Condition], rng: &mut impl Rng) {
    let a_cycle = log_uniform(SAMPLES.0, SAMPLES.1, rng);
    let fastest = conditions
        .iter()
        .fold(0.0, |most: f64, c| most.max(c.frequency));
    let is_one_rate = *[true, false, false].choose(rng).unwrap_or(&false);
    let mut set = |is_one: bool, a_cycle: f64| {
        for condition in conditions.iter_mut() {
            let frequency = if is_one { fastest } else { condition.frequency };
            condition.rate = rounded(a_cycle * frequency);
        }
        conditions.iter().map(Condition::samples).sum::<usize>() as f64
    };
    if is_one_rate && set(true, a_cycle) <= MOST_SAMPLES {
        return;
    }
    let count = set(false, a_cycle);
    if count > MOST_SAMPLES {
        set(false, (a_cycle * MOST_SAMPLES / count).max(SAMPLES.0));
    }
}

/// To two digits, as a laboratory sets it.
fn rounded(rate: f64) -> f64 {
    let digit = 10.0_f64.powf(rate.log10().floor() - 1.0);
    (rate / digit).round() * digit
}

//! Recordings that a seed draws: a specimen, its motion, its sensors, and at most one kind of trouble, written as text.
//!
//! Nothing here is shared with the readers: the specimen is integrated in fine steps, and the text is written cell by cell.

mod channels;

use std::f64::consts::{PI, TAU};

use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use channels::Channels;

/// Where a wrong value stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Start,
    End,
    BesideGap,
}

/// The channel that is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrong {
    Displacement,
    Force,
    /// All channels and the time are 0.
    Row,
}

/// What stands in the rows without a new force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filled {
    Held,
    Interpolated,
    Blank,
}

/// What is unusual about a recording, with its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    WrongValue {
        place: Place,
        wrong: Wrong,
        rows: usize,
        zeros: bool,
    },
    RoundedTimes {
        decimals: usize,
    },
    UnevenSteps {
        times: usize,
    },
    Joined {
        pause: f64,
    },
    ClockSet {
        by: f64,
    },
    WholeSeconds {
        dates: bool,
    },
    TimeCounter {
        range: f64,
        lowest: f64,
        micro: bool,
    },
    DisplacementCounter {
        range: f64,
    },
    SlowForce {
        rows: usize,
        filled: Filled,
    },
    ChangesOnly {
        digits: [f64; 2],
    },
    Exchanged,
    LateDisplacement {
        by: f64,
    },
    LowPass {
        wrong: Wrong,
        corner: f64,
    },
    Mass {
        kg: f64,
    },
    BlankCell {
        wrong: Wrong,
        cell: &'static str,
    },
}

/// The rows of the table of results, in the order in which seeds draw them.
pub const LABELS: [&str; 20] = [
    "a wrong value at the start",
    "a wrong value at the end",
    "a wrong value beside a gap",
    "times rounded to about a step",
    "steps that differ by design",
    "a pause in a joined file",
    "a clock set by an hour",
    "stamps of whole seconds",
    "a counter of time that begins again",
    "a counter of displacement that begins again",
    "force held for some rows",
    "force interpolated from a slower rate",
    "force blank in half of the rows or more",
    "rows only where a value changed",
    "displacement and force exchanged",
    "displacement late",
    "displacement behind a low-pass",
    "force behind a low-pass",
    "a mass of the fixture",
    "one empty cell",
];

/// F = k·y + c·v + stick-slip, in kN, mm, s.
#[derive(Clone, Copy, Debug)]
pub struct Specimen {
    pub stiffness: f64,
    pub damping: f64,
    pub slip_stiffness: f64,
    pub slip_limit: f64,
}

/// A recording as text, and the truth about it.
pub struct Drawn {
    pub kind: Option<Kind>,
    pub specimen: Specimen,
    /// Samples per second.
    pub rate: f64,
    /// Highest frequency of the motion, Hz.
    pub highest: f64,
    /// Standard deviation of the force's noise over the RMS of the force.
    pub noise: f64,
    /// Whether it begins at rest. Otherwise it begins in the first cycles, with a slider that is stretched by an unknown length.
    pub begins_at_rest: bool,
    pub text: String,
}

/// Sines whose amplitude grows and falls in a cycle, with rests between them.
struct Motion {
    /// Begin s, cycles, amplitude mm, frequency Hz.
    blocks: Vec<[f64; 4]>,
    duration: f64,
}

impl Motion {
    /// Two amplitudes at two frequencies each, so that neither stands for the other.
    fn drawn(highest: f64, random: &mut ChaCha8Rng) -> Self {
        let large = random.random_range(0.2..0.6);
        let small = large * random.random_range(0.4..0.6);
        let slow = random.random_range(0.25..0.4);
        let between = random.random_range(0.45..0.7);
        let mut conditions = [(large, 1.0), (large, slow), (small, 1.0), (small, between)];
        conditions.shuffle(random);
        let mut now = 0.3 / highest;
        let mut blocks = Vec::new();
        for (amplitude, part) in conditions {
            let frequency = highest * part;
            let cycles = f64::from(random.random_range(6..9));
            blocks.push([now, cycles, amplitude, frequency]);
            now += cycles / frequency + random.random_range(0.5..2.0) / highest;
        }
        Self {
            blocks,
            duration: now,
        }
    }

    fn smallest(&self) -> f64 {
        let amplitudes = self.blocks.iter().map(|block| block[2]);
        amplitudes.fold(f64::INFINITY, f64::min)
    }

    fn largest(&self) -> f64 {
        let amplitudes = self.blocks.iter().map(|block| block[2]);
        amplitudes.fold(0.0, f64::max)
    }

    fn highest(&self) -> f64 {
        let frequencies = self.blocks.iter().map(|block| block[3]);
        frequencies.fold(0.0, f64::max)
    }

    /// Displacement, velocity and acceleration.
    fn at(&self, time: f64) -> [f64; 3] {
        for &[begin, cycles, amplitude, frequency] in &self.blocks {
            let cycle = (time - begin) * frequency;
            if !(0.0..cycles).contains(&cycle) {
                continue;
            }
            let turn = TAU * frequency;
            let (sin, cos) = (TAU * cycle).sin_cos();
            // Size of the sine and its derivatives.
            let ramp = |part: f64, sign: f64| {
                let slope = PI * frequency;
                let (up, along) = (PI * part).sin_cos();
                [
                    0.5 * (1.0 - along),
                    0.5 * sign * slope * up,
                    0.5 * slope * slope * along,
                ]
            };
            let [e, de, dde] = match cycle {
                c if c < 1.0 => ramp(c, 1.0),
                c if c > cycles - 1.0 => ramp(cycles - c, -1.0),
                _ => [1.0, 0.0, 0.0],
            };
            return [
                amplitude * e * sin,
                amplitude * (de * sin + e * turn * cos),
                amplitude * (dde * sin + 2.0 * de * turn * cos - e * turn * turn * sin),
            ];
        }
        [0.0; 3]
    }
}

/// A kind of the row `label` of [`LABELS`], as far as it does not depend on the motion.
fn kind(label: usize, random: &mut ChaCha8Rng) -> Kind {
    let either = random.random::<bool>();
    let channel = [Wrong::Displacement, Wrong::Force][usize::from(either)];
    match label {
        0..3 => {
            let place = [Place::Start, Place::End, Place::BesideGap][label];
            let is_row = place == Place::End && random.random_range(0..4) == 0;
            Kind::WrongValue {
                place,
                wrong: if is_row { Wrong::Row } else { channel },
                rows: random.random_range(1..4),
                zeros: is_row || random.random_range(0..3) == 0,
            }
        }
        3 => Kind::RoundedTimes {
            decimals: if either { 2 } else { 3 },
        },
        4 => Kind::UnevenSteps {
            times: random.random_range(4..7),
        },
        5 => Kind::Joined {
            pause: random.random_range(1.0..20.0),
        },
        6 => Kind::ClockSet {
            by: if either { 3600.0 } else { -3600.0 },
        },
        7 => Kind::WholeSeconds { dates: either },
        8 => {
            // 16 bits of ms; 24 and 32 bits of µs, the last with a sign or without.
            let (range, micro) = [
                (65.536, false),
                (16.777_216, true),
                (4_294.967_296, true),
                (4_294.967_296, true),
            ][random.random_range(0..4)];
            let signed = either && range > 100.0;
            Kind::TimeCounter {
                range,
                lowest: if signed { -0.5 * range } else { 0.0 },
                micro,
            }
        }
        9 => Kind::DisplacementCounter {
            range: [4.096, 6.5536, 10.0][random.random_range(0..3)],
        },
        10..13 => Kind::SlowForce {
            rows: random.random_range(2..7),
            filled: [Filled::Held, Filled::Interpolated, Filled::Blank][label - 10],
        },
        13 => Kind::ChangesOnly { digits: [0.0; 2] },
        14 => Kind::Exchanged,
        15 => Kind::LateDisplacement {
            by: random.random_range(0.5e-3..2.5e-3),
        },
        16 => Kind::LowPass {
            wrong: Wrong::Displacement,
            corner: 0.0,
        },
        17 => Kind::LowPass {
            wrong: Wrong::Force,
            corner: 0.0,
        },
        18 => Kind::Mass { kg: 0.0 },
        _ => Kind::BlankCell {
            wrong: channel,
            cell: ["", "NaN", "#N/A"][random.random_range(0..3)],
        },
    }
}

impl Drawn {
    /// With a kind of the row `label` of [`LABELS`], or none.
    pub fn of(seed: u64, label: Option<usize>) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut kind = label.map(|label| kind(label, &mut random));
        let rate = rate(kind, &mut random);
        let per_cycle = match kind {
            Some(Kind::ChangesOnly { .. }) => random.random_range(150.0..300.0),
            // So that a cycle has as many samples where they are fewer.
            Some(Kind::UnevenSteps { .. }) => random.random_range(60.0..90.0),
            Some(Kind::SlowForce { rows, .. }) => rows as f64 * random.random_range(25.0..40.0),
            _ => random.random_range(25.0..40.0),
        };
        let highest = rate / per_cycle;
        let motion = Motion::drawn(highest, &mut random);
        let stiffness = random.random_range(1.0..4.0);
        let specimen = Specimen {
            stiffness,
            damping: stiffness * random.random_range(0.05..0.3) / (TAU * highest),
            slip_stiffness: stiffness * random.random_range(0.4..1.5),
            slip_limit: motion.smallest() * random.random_range(0.2..0.6),
        };
        match &mut kind {
            // Its force at the highest frequency is a part of the spring's.
            Some(Kind::Mass { kg }) => {
                let sign = if random.random() { 1.0 } else { -1.0 };
                let part = random.random_range(0.03..0.3);
                *kg = 1e6 * sign * part * stiffness / (TAU * highest).powi(2);
            }
            Some(Kind::LowPass { corner, .. }) => {
                *corner = highest * random.random_range(4.0..10.0)
            }
            Some(Kind::ChangesOnly { digits }) => {
                let steps = random.random_range(40.0..80.0);
                *digits = [1.0, stiffness * 1.3].map(|of| of * motion.largest() / steps);
            }
            _ => {}
        }
        let noise = random.random_range(0.002..0.008);
        let channels = Channels::measured(kind, &motion, &specimen, rate, noise, &mut random);
        let (begins_at_rest, text) = channels.text(kind, &motion, rate, &mut random);
        Self {
            kind,
            specimen,
            rate,
            highest,
            noise,
            begins_at_rest,
            text,
        }
    }
}

fn rate(kind: Option<Kind>, random: &mut ChaCha8Rng) -> f64 {
    let mut one_of = |rates: &[f64]| rates[random.random_range(0..rates.len())];
    match kind {
        Some(Kind::RoundedTimes { decimals: 2 }) => match one_of(&[0.0, 1.0, 2.0]) {
            0.0 => random.random_range(60.0..180.0),
            _ => one_of(&[64.0, 75.0, 80.0, 96.0, 120.0, 128.0, 150.0]),
        },
        Some(Kind::RoundedTimes { .. }) => match one_of(&[0.0, 1.0, 2.0]) {
            0.0 => random.random_range(600.0..1800.0),
            _ => one_of(&[640.0, 750.0, 800.0, 960.0, 1024.0, 1200.0, 1280.0]),
        },
        Some(Kind::WholeSeconds { .. }) => random.random_range(15.0..50.0_f64).round(),
        // Its counts are whole steps.
        Some(Kind::TimeCounter { micro: false, .. }) => one_of(&[250.0, 500.0]),
        Some(Kind::LateDisplacement { .. }) => one_of(&[400.0, 500.0]),
        _ => match one_of(&[0.0, 1.0]) {
            0.0 => random.random_range(250.0..500.0),
            _ => one_of(&[250.0, 256.0, 300.0, 400.0, 500.0]),
        },
    }
}

//! Recordings that a seed draws: a specimen, its motion, its sensors, and at most one kind of trouble, written as text.
//!
//! Nothing here is shared with the readers: the specimen is integrated in fine steps, and the text is written cell by cell.

use std::f64::consts::{PI, SQRT_2, TAU};

use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

/// Steps of the simulation in one sample.
const FINE: usize = 8;

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

/// A Butterworth low-pass of the second order, for one sample after another.
struct LowPass {
    b: [f64; 3],
    a: [f64; 2],
    state: [f64; 2],
}

impl LowPass {
    fn new(corner: f64, rate: f64) -> Self {
        let w = (PI * corner / rate).tan();
        let scale = 1.0 / (1.0 + SQRT_2 * w + w * w);
        let b = w * w * scale;
        Self {
            b: [b, 2.0 * b, b],
            a: [
                2.0 * (w * w - 1.0) * scale,
                (1.0 - SQRT_2 * w + w * w) * scale,
            ],
            state: [0.0; 2],
        }
    }

    fn next(&mut self, x: f64) -> f64 {
        let y = self.b[0] * x + self.state[0];
        self.state = [
            self.b[1] * x - self.a[0] * y + self.state[1],
            self.b[2] * x - self.a[1] * y,
        ];
        y
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

/// The channels as the sensors show them, sample by sample.
struct Channels {
    displacement: Vec<f64>,
    force: Vec<f64>,
}

impl Channels {
    fn measured(
        kind: Option<Kind>,
        motion: &Motion,
        specimen: &Specimen,
        rate: f64,
        noise: f64,
        random: &mut ChaCha8Rng,
    ) -> Self {
        let count = (motion.duration * rate) as usize;
        let step = 1.0 / (rate * FINE as f64);
        let late = match kind {
            Some(Kind::LateDisplacement { by }) => by,
            _ => 0.0,
        };
        let mass = match kind {
            Some(Kind::Mass { kg }) => 1e-6 * kg,
            _ => 0.0,
        };
        let (mut displacement, mut force) = (Vec::new(), Vec::new());
        let (mut before, mut stretch) = (0.0, 0.0_f64);
        for index in 0..count * FINE {
            let now = index as f64 * step;
            let [y, v, a] = motion.at(now);
            stretch = (stretch + y - before).clamp(-specimen.slip_limit, specimen.slip_limit);
            before = y;
            let slip = specimen.slip_stiffness * stretch;
            force.push(specimen.stiffness * y + specimen.damping * v + mass * a + slip);
            displacement.push(motion.at(now - late)[0]);
        }
        let sum: f64 = force.iter().map(|force| force * force).sum();
        let noises = [
            2e-4 * motion.largest(),
            noise * (sum / force.len() as f64).sqrt(),
        ];
        for (values, (deviation, wrong)) in [&mut displacement, &mut force]
            .into_iter()
            .zip(noises.into_iter().zip([Wrong::Displacement, Wrong::Force]))
        {
            let mut noisy = || -> f64 { StandardNormal.sample(random) };
            match kind {
                // The amplifier has a filter, and the converter after it has a little noise of its own.
                Some(Kind::LowPass { wrong: of, corner }) if of == wrong => {
                    let mut filter = LowPass::new(corner, rate * FINE as f64);
                    for value in values {
                        *value =
                            filter.next(*value + deviation * noisy()) + 0.3 * deviation * noisy();
                    }
                }
                _ => values
                    .iter_mut()
                    .for_each(|value| *value += deviation * noisy()),
            }
        }
        let samples = |fine: &[f64]| fine.iter().step_by(FINE).copied().collect();
        Self {
            displacement: samples(&displacement),
            force: samples(&force),
        }
    }

    /// Whether the recording begins at rest, and its text. It begins at rest, or anywhere in the first cycles, and ends at rest or in the last ones.
    fn text(
        mut self,
        kind: Option<Kind>,
        motion: &Motion,
        rate: f64,
        random: &mut ChaCha8Rng,
    ) -> (bool, String) {
        let count = self.force.len();
        let sample = |time: f64| ((time * rate) as usize).min(count - 1);
        let [begin, _, _, first] = motion.blocks[0];
        let &[last_begin, cycles, _, last] = &motion.blocks[motion.blocks.len() - 1];
        let is_cut = match kind {
            Some(Kind::WrongValue { .. }) => [true; 2],
            _ => [random.random(), random.random()],
        };
        let [off, early] = [0, 1].map(|_| random.random_range(0.5..2.0));
        let from = if is_cut[0] {
            sample(begin + off / first)
        } else {
            0
        };
        let to = if is_cut[1] {
            sample(last_begin + (cycles - early) / last)
        } else {
            count
        };
        let inside = |random: &mut ChaCha8Rng| {
            from + (random.random_range(0.15..0.85) * (to - from) as f64) as usize
        };
        let mut rows: Vec<usize> = (from..to).collect();
        let mut time: Vec<f64> = (0..count)
            .map(|n| (n - n.min(from)) as f64 / rate)
            .collect();
        let mut header = "time_s,displacement_mm,force_kN".to_owned();
        let mut blank = vec![[false; 2]; count];
        let mut cell = "";
        let mut stamp: Box<dyn Fn(f64) -> String> = Box::new(|time| format!("{time:.6}"));
        let mut zeros = 0;
        match kind {
            None => match random.random_range(0..4) {
                0 => {
                    header = header.replace("time_s", "time_ms");
                    stamp = Box::new(|time| format!("{:.3}", 1e3 * time));
                }
                1 => stamp = Box::new(|time| date(36_000.25 + time, 6)),
                _ => {}
            },
            Some(Kind::WrongValue {
                place,
                wrong,
                rows: length,
                zeros: are_zeros,
            }) => {
                let run = match place {
                    Place::Start => from..from + length,
                    Place::End => to - length..to,
                    Place::BesideGap => {
                        let gap = inside(random);
                        let gap = gap..gap + random.random_range(5..40);
                        rows.retain(|row| !gap.contains(row));
                        if random.random() {
                            gap.start - length..gap.start
                        } else {
                            gap.end..gap.end + length
                        }
                    }
                };
                let values = match wrong {
                    Wrong::Displacement => &mut self.displacement,
                    _ => &mut self.force,
                };
                let rms = (values.iter().map(|x| x * x).sum::<f64>() / count as f64).sqrt();
                // A zero is wrong only where the channel is not near it.
                let near = values[run.clone()].iter().any(|x| x.abs() < 0.6 * rms);
                let size = rms * random.random_range(1.5..8.0);
                let size = if random.random() { size } else { -size };
                match wrong {
                    Wrong::Row => zeros = length,
                    _ if are_zeros && !near => values[run].fill(0.0),
                    _ => values[run].iter_mut().for_each(|value| *value += size),
                }
            }
            Some(Kind::RoundedTimes { decimals }) => {
                let begin = random.random_range(0.0..1.0);
                stamp = Box::new(move |time| format!("{:.decimals$}", begin + time));
            }
            Some(Kind::UnevenSteps { times }) => {
                // The slow blocks and the rests are sampled at a slower rate.
                let is_fast = |n: usize| {
                    let now = n as f64 / rate;
                    motion.blocks.iter().any(|&[begin, cycles, _, frequency]| {
                        let fast = frequency > 0.8 * motion.highest();
                        fast && (begin..begin + cycles / frequency).contains(&now)
                    })
                };
                let mut next = from;
                rows.retain(|&row| {
                    let is_kept = row >= next;
                    if is_kept {
                        next = row + if is_fast(row) { 1 } else { times };
                    }
                    is_kept
                });
            }
            Some(Kind::Joined { pause }) => {
                let at = inside(random);
                let unseen = random.random_range(0..(0.5 * rate) as usize);
                rows.retain(|row| !(at..at + unseen).contains(row));
                time[at + unseen..]
                    .iter_mut()
                    .for_each(|time| *time += pause);
            }
            Some(Kind::ClockSet { by }) => {
                let at = time[inside(random)];
                let begin = 9000.0 + random.random_range(0.0..1.0);
                stamp =
                    Box::new(move |time| date(begin + time + if time < at { 0.0 } else { by }, 6));
            }
            Some(Kind::WholeSeconds { dates }) => {
                let begin = 36_000.0 + random.random_range(0.0..1.0);
                stamp = Box::new(move |time| match dates {
                    true => date((begin + time).floor(), 0),
                    false => format!("{:.0}", (begin + time).floor()),
                });
            }
            Some(Kind::TimeCounter {
                range,
                lowest,
                micro,
            }) => {
                let begin = range + lowest - time[inside(random)];
                let (name, per_second) = if micro {
                    ("time_us", 1e6)
                } else {
                    ("time_ms", 1e3)
                };
                header = header.replace("time_s", name);
                let [range, lowest, begin] =
                    [range, lowest, begin].map(|s| (s * per_second).round());
                stamp = Box::new(move |time| {
                    let counted = (begin + time * per_second).round();
                    format!("{:.0}", (counted - lowest).rem_euclid(range) + lowest)
                });
            }
            Some(Kind::DisplacementCounter { range }) => {
                let resolution = 1e-4;
                // The end of the range lies within the motion.
                let edge = random.random_range(-0.7..0.7) * motion.largest();
                for y in &mut self.displacement {
                    let counted = ((*y - edge) / resolution).round() * resolution;
                    *y = counted.rem_euclid(range);
                }
            }
            Some(Kind::SlowForce {
                rows: every,
                filled,
            }) => {
                // From the first new value to the last.
                let phase = random.random_range(0..every);
                let end = count - 1 - (count - 1 - phase) % every;
                rows.retain(|row| (phase..=end).contains(row));
                let of = self.force.clone();
                for &n in &rows {
                    let last = n - (n - phase) % every;
                    let part = (n - last) as f64 / every as f64;
                    match filled {
                        Filled::Held => self.force[n] = of[last],
                        Filled::Interpolated => {
                            let next = of.get(last + every).unwrap_or(&of[last]);
                            self.force[n] = of[last] + part * (next - of[last]);
                        }
                        Filled::Blank => blank[n][1] = n != last,
                    }
                }
            }
            Some(Kind::ChangesOnly {
                digits: [of_displacement, of_force],
            }) => {
                let round = |value: &mut f64, digit: f64| *value = (*value / digit).round() * digit;
                for (y, f) in self.displacement.iter_mut().zip(&mut self.force) {
                    round(y, of_displacement);
                    round(f, of_force);
                }
                let (y, f) = (&self.displacement, &self.force);
                rows.retain(|&n| n == from || y[n] != y[n - 1] || f[n] != f[n - 1]);
            }
            Some(Kind::Exchanged) => std::mem::swap(&mut self.displacement, &mut self.force),
            Some(Kind::LateDisplacement { .. } | Kind::LowPass { .. } | Kind::Mass { .. }) => {}
            Some(Kind::BlankCell { wrong, cell: of }) => {
                blank[inside(random)][usize::from(wrong == Wrong::Force)] = true;
                cell = of;
            }
        }
        let mut text = header + "\n";
        for n in rows {
            let value = |value: f64, blank: bool| match blank {
                true => cell.to_owned(),
                false => format!("{value:.6}"),
            };
            text += &format!(
                "{},{},{}\n",
                stamp(time[n]),
                value(self.displacement[n], blank[n][0]),
                value(self.force[n], blank[n][1])
            );
        }
        for _ in 0..zeros {
            text += "0.000000,0.000000,0.000000\n";
        }
        (!is_cut[0], text)
    }
}

/// Seconds of a day as a date.
fn date(seconds: f64, decimals: usize) -> String {
    let scale = 10_u64.pow(decimals as u32);
    let parts = (seconds * scale as f64).round() as u64;
    let (whole, part) = (parts / scale, parts % scale);
    let (h, m, s) = (whole / 3600, whole / 60 % 60, whole % 60);
    let fraction = match decimals {
        0 => String::new(),
        _ => format!(".{part:0decimals$}"),
    };
    format!("2026-10-25 {h:02}:{m:02}:{s:02}{fraction}")
}

//! What sensors and a recorder make of a specimen's motion and force: delays, filters, noise, and the text of the file.

use std::f64::consts::{PI, SQRT_2};

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

use super::{Filled, Kind, Motion, Place, Specimen, Wrong};

/// Steps of the simulation in one sample.
const FINE: usize = 8;

/// The channels as the sensors show them, sample by sample.
pub(super) struct Channels {
    displacement: Vec<f64>,
    force: Vec<f64>,
}

impl Channels {
    pub fn measured(
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
    pub fn text(
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

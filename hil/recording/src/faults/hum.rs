//! Hum of the mains on the channels: a tone of 50 or 60 Hz or a multiple, unrelated to the motion.
//!
//! A displacement of a ten-thousandth of the range at 50 Hz has a velocity that reverses the sign of friction. The tone is a
//! channel fault, rather than a motion, under two conditions. It stands alone in the spectrum, unlike a harmonic of the motion,
//! which has others near it. And it has the same amplitude and phase from beginning to end, unlike a test at that frequency.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use mesh_damper_tables::channel::Channel;

use super::kind::{ChannelFault, ChannelFaultKind};
use crate::resample::Uniform;
use crate::spectrum::{place_of_line, powers};

crate::numbers! {
    /// How hum of the mains is recognized.
    HumPolicy {
        /// Frequencies of the mains at which hum is searched for, Hz.
        mains: [f64; 2] = [50.0, 60.0], Convention("the two that are in use in the world");
        /// Hum is searched for at multiples of the mains frequency up to this one.
        multiples: usize = 3, Convention("higher harmonics are small");
        /// The frequency of a hum may differ from a multiple of the mains frequency by up to this fraction. It includes an error of the
        /// recording's clock.
        off: f64 = 0.01, Convention("half a hertz, beyond which grids shed load");
        /// A hum is compared with the bins of the spectrum within this fraction of its frequency to either side.
        alone: f64 = 0.25, Derived("the harmonics of a motion, except the first five, have neighbours nearer than that");
        /// A hum has at least this many times the median power of the bins around it (see `alone`).
        stands_out: f64 = 100.0, Derived("of some 1000 bins of noise none has 20 times the median");
        /// A hum has at least this many times the largest power of the other bins around it (see `alone`).
        above_others: f64 = 8.0, Tuned("the blind trial over any motion");
        /// A tone is a hum only if its RMS is below this fraction of the RMS of the channel.
        largest: f64 = 0.05, Convention("a larger tone is a motion in its own right");
        /// A tone is a hum only if its phasor in each quarter of the recording differs from that of the whole by less than this fraction of
        /// its amplitude.
        steady: f64 = 0.35, Tuned("the blind trial over any motion");
    }
}

/// Bins of a line on either side with a Hann window.
const LINE: usize = 4;

/// Removes hum from the displacement, and from the force if it has any.
pub(crate) fn find(uniform: &mut Uniform, faults: &mut Vec<ChannelFault>) {
    let spectrum = powers(uniform.displacement.clone());
    for mains in HumPolicy::in_use().mains {
        for multiple in 1..=HumPolicy::in_use().multiples {
            let frequency = mains * multiple as f64;
            let Some(turn) = tone(&uniform.displacement, &spectrum, frequency * uniform.period)
            else {
                continue;
            };
            let of_force = powers(uniform.force.clone());
            let on_force = tone(&uniform.force, &of_force, turn / TAU);
            let channels = [
                (Channel::Displacement, &mut uniform.displacement, Some(turn)),
                (Channel::Force, &mut uniform.force, on_force),
            ];
            for (channel, samples, turn) in channels {
                let Some(turn) = turn else { continue };
                let hum = Phasor::of(samples, 0..samples.len(), turn);
                hum.take_off(samples);
                faults.push(ChannelFault {
                    channel,
                    kind: ChannelFaultKind::Hum {
                        frequency: turn / TAU / uniform.period,
                        amplitude: hum.size(),
                    },
                });
            }
        }
    }
}

/// The tone near this many cycles per sample that stands alone, in rad per sample.
fn tone(samples: &[f64], spectrum: &[f64], about: f64) -> Option<f64> {
    let count = samples.len() as f64;
    let bins = |low: f64, high: f64| -> Range<usize> {
        let last = spectrum.len().saturating_sub(1);
        (low * about * count).floor().max(1.0) as usize
            ..((high * about * count).ceil() as usize + 1).min(last)
    };
    let (off, alone) = (HumPolicy::in_use().off, HumPolicy::in_use().alone);
    let around = bins(1.0 - alone, 1.0 + alone);
    let near = bins(1.0 - off, 1.0 + off);
    // A frequency above half the sampling rate, or a recording too short to separate lines.
    if (1.0 + off) * about >= 0.5 || around.len() < 16 * LINE {
        return None;
    }
    let peak = near.max_by(|&a, &b| spectrum[a].total_cmp(&spectrum[b]))?;
    let others = around.filter(|bin| bin.abs_diff(peak) > LINE);
    let mut others: Vec<f64> = others.map(|bin| spectrum[bin]).collect();
    others.sort_by(f64::total_cmp);
    let (median, largest) = (others[others.len() / 2], others[others.len() - 1]);
    if spectrum[peak] < HumPolicy::in_use().stands_out * median
        || spectrum[peak] < HumPolicy::in_use().above_others * largest
    {
        return None;
    }
    let mut turn = place_of_line(spectrum, peak) / count * TAU;
    // The change of its phase from one half to the other gives its frequency more accurately than the spectrum.
    let middle = samples.len() / 2;
    let [first, second] =
        [0..middle, middle..samples.len()].map(|half| Phasor::of(samples, half, turn));
    let gained = (second.phase() - first.phase() + PI).rem_euclid(TAU) - PI;
    turn += gained / (0.5 * count);
    let whole = Phasor::of(samples, 0..samples.len(), turn);
    let mean = samples.iter().sum::<f64>() / count;
    let power = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    let is_small = whole.size().powi(2) / 2.0 < HumPolicy::in_use().largest.powi(2) * power;
    let quarter = samples.len() / 4;
    let is_steady = (0..4).all(|part| {
        let own = Phasor::of(samples, part * quarter..(part + 1) * quarter, turn);
        (own.sine - whole.sine).hypot(own.cosine - whole.cosine)
            < HumPolicy::in_use().steady * whole.size()
    });
    (is_small && is_steady).then_some(turn)
}

/// a·sin ωn + b·cos ωn
struct Phasor {
    turn: f64,
    sine: f64,
    cosine: f64,
}

impl Phasor {
    /// Phasor of the samples of `range`, with a Hann window, so that a large motion at other frequencies has no influence.
    fn of(samples: &[f64], range: Range<usize>, turn: f64) -> Self {
        let (mut sine, mut cosine) = (0.0, 0.0);
        let count = range.len() as f64;
        for (place, index) in range.enumerate() {
            let window = 1.0 - (TAU * (place as f64 + 0.5) / count).cos();
            let (sin, cos) = (turn * index as f64).sin_cos();
            sine += window * samples[index] * sin;
            cosine += window * samples[index] * cos;
        }
        Self {
            turn,
            sine: 2.0 * sine / count,
            cosine: 2.0 * cosine / count,
        }
    }

    fn size(&self) -> f64 {
        self.sine.hypot(self.cosine)
    }

    fn phase(&self) -> f64 {
        self.cosine.atan2(self.sine)
    }

    fn take_off(&self, samples: &mut [f64]) {
        for (index, sample) in samples.iter_mut().enumerate() {
            let (sin, cos) = (self.turn * index as f64).sin_cos();
            *sample -= self.sine * sin + self.cosine * cos;
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const RATE: f64 = 500.0;
    const NOISE: f64 = 1e-4;

    /// 20 s of a displacement in mm over time in s, with noise.
    fn recorded(seed: u64, displacement: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let noise = move || -> f64 { StandardNormal.sample(&mut random) };
        let time = (0..10_000).map(|index| f64::from(index) / RATE);
        time.zip(std::iter::repeat_with(noise))
            .map(|(time, noise)| displacement(time) + NOISE * noise)
            .collect()
    }

    fn found(samples: &[f64]) -> Option<(f64, f64)> {
        let turn = tone(samples, &powers(samples.to_vec()), 50.0 / RATE)?;
        let size = Phasor::of(samples, 0..samples.len(), turn).size();
        Some((turn / TAU * RATE, size))
    }

    fn random(time: f64) -> f64 {
        let tones = (1..40).map(|n| 0.3 * f64::from(n) + 0.07 * f64::from(n * n % 7));
        tones.map(|f| 0.02 * (TAU * f * time + f * f).sin()).sum()
    }

    /// To a part of the noise, for any motion; a bin of the spectrum is 0.05 Hz wide.
    #[test]
    fn a_hum_is_found_with_frequency_and_size() {
        let sine = |time: f64| 0.2 * (TAU * 2.0 * time).sin();
        let steps = |time: f64| 0.1 * (0.5 * time).sin().powi(3);
        let motions: [&dyn Fn(f64) -> f64; 3] = [&random, &sine, &steps];
        for (seed, motion) in (0..).zip(motions) {
            for frequency in [49.97, 50.0, 50.013] {
                let samples = recorded(seed, |time| {
                    motion(time) + 5.0 * NOISE * (TAU * frequency * time + 1.0).sin()
                });
                let Some((at, size)) = found(&samples) else {
                    panic!("motion {seed}: none of {frequency} Hz");
                };
                assert!(
                    (at - frequency).abs() < 1e-3,
                    "motion {seed}: {at} Hz of {frequency} Hz"
                );
                assert!((size / NOISE - 5.0).abs() < 0.3, "motion {seed}: {size} mm");
            }
        }
    }

    /// Neither the harmonics of a motion with corners, which pass through 50 Hz, nor a test at 50 Hz or a sweep across it.
    #[test]
    fn a_motion_is_no_hum() {
        for seed in 0..8 {
            let saw = |time: f64| 0.2 * (TAU * (2.0 + f64::from(seed as u32)) * time).sin().asin();
            let blocks = |time: f64| match time {
                0.0..12.0 => 0.2 * (TAU * time).sin(),
                _ => 2e-3 * (TAU * 50.0 * time).sin(),
            };
            let sweep = |time: f64| 0.1 * (TAU * (20.0 + time) * time).sin();
            let alone = |time: f64| 0.1 * (TAU * 50.0 * time).sin();
            assert_eq!(found(&recorded(seed, saw)), None);
            assert_eq!(found(&recorded(seed, blocks)), None);
            assert_eq!(found(&recorded(seed, sweep)), None);
            assert_eq!(found(&recorded(seed, alone)), None);
            assert_eq!(found(&recorded(seed, random)), None);
        }
    }
}

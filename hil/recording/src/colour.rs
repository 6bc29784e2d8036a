//! Noise that has as much power in every octave.
//!
//! Amplifiers and load cells have pink noise beside the white: its power per hertz goes with 1/f. Sixth differences show what is near half
//! the sampling rate, where there is least of it. The same differences of means over 2 and 4 samples show one octave after the other: white
//! noise has half the variance in each, pink noise as much. What a law leaves is asked and not the force itself, and the octaves have to
//! agree: what the law lacks grows much faster from one to the next. Tones would look like such noise, and so the median power of the
//! octaves of a spectrum, which is blind to lines, has to agree too.

use std::f64::consts::PI;
use std::ops::Range;

use super::cycles::median;
use super::noise::{POWER, deviation, sixth_differences};
use super::spectrum::powers;
use crate::policy::policy;

crate::numbers! {
    /// Noise that is not white.
    ColourPolicy {
        /// Pink noise is there where each octave shows more than this many deviations of it.
        certain: f64 = 3.0, Convention("once in 700 times by chance, and all octaves have to");
        /// Fewest differences that show an octave.
        fewest: usize = 200, Derived("they give a variance to a quarter");
        /// The variance from the median magnitude of n differences errs by this part over √n.
        error: f64 = 3.5, Derived("of 600 draws of white noise with 200, 1000 and 5000 differences each");
    }
}

/// Of so many samples each the means are taken.
const SCALES: [usize; 3] = [1, 2, 4];

/// Deviation of the noise in `left`, which a law leaves of a force, when some of it is pink; `None` where an octave says otherwise or too
/// few samples do. Nothing outside of `runs` is looked at; `between` are their parts between the reversals, at which a force may jump.
pub fn pink_deviation(
    left: &[f64],
    runs: &[Range<usize>],
    between: &[Range<usize>],
) -> Option<f64> {
    let octaves: Vec<Octave> = SCALES
        .into_iter()
        .map(|scale| Octave::of(left, between, scale))
        .take_while(|octave| octave.count >= policy().colour.fewest)
        .collect();
    let longest = runs.iter().max_by_key(|run| run.len())?;
    let pairs = octaves.windows(2).map(|pair| pair[0].pink_beside(&pair[1]));
    let in_spectrum = (octaves.len() > 1).then(|| beside_lines(&left[longest.clone()]));
    let pink = pairs
        .chain([in_spectrum])
        .try_fold(f64::INFINITY, |least, pink| {
            pink.map(|pink| least.min(pink))
        })?;
    if pink <= 0.0 {
        return None;
    }
    let white = (octaves[0].variance - pink * octaves[0].gain).max(0.0);
    let count: usize = runs.iter().map(Range::len).sum();
    // From one cycle in all samples to one in two of them.
    Some((white + pink * (0.5 * count as f64).ln()).sqrt())
}

/// The least power of pink noise at one cycle per sample that two of the upper three octaves of the spectrum have between them, by the median
/// of their bins.
fn beside_lines(left: &[f64]) -> f64 {
    let powers = powers(left.to_vec());
    // Of white noise of variance 1 the bins under a Hann window of mean 1 have 1.5 each a sample, and the median is ln 2 of the mean.
    let density = |octave: u32| {
        let first = powers.len() >> (octave + 1);
        let bins = powers[first..2 * first].iter().copied();
        2.0 * median(bins).unwrap_or(0.0) / (1.5 * left.len() as f64 * std::f64::consts::LN_2)
    };
    let pair = |octave: u32| {
        // The middle of an octave is √2 times its lowest frequency: beside white noise P/f leaves P/(√2·lowest) from one to the next.
        let lowest = 0.5 / f64::from(2_u32 << octave);
        (density(octave + 1) - density(octave)) * std::f64::consts::SQRT_2 * lowest
    };
    pair(0).min(pair(1))
}

/// What the sixth differences of means over so many samples show.
struct Octave {
    /// As of white noise that had such means.
    variance: f64,
    count: usize,
    /// The same of pink noise whose power is 1/f, f in cycles per sample.
    gain: f64,
}

impl Octave {
    fn of(left: &[f64], runs: &[Range<usize>], scale: usize) -> Self {
        let mean = |samples: &[f64]| samples.iter().sum::<f64>() / scale as f64;
        let differences: Vec<f64> = runs
            .iter()
            .flat_map(|run| {
                let means = left[run.clone()].chunks_exact(scale).map(mean);
                sixth_differences(&means.collect::<Vec<_>>()).collect::<Vec<_>>()
            })
            .collect();
        Self {
            variance: deviation(&differences).powi(2),
            count: differences.len(),
            gain: gain(scale),
        }
    }

    /// The power of pink noise at one cycle per sample, from two octaves of which `lower` shows means over twice as many samples: white
    /// noise falls out of twice its variance less this one's. `None` where that is not certain.
    fn pink_beside(&self, lower: &Self) -> Option<f64> {
        let beyond = 2.0 * lower.variance - self.variance;
        let error =
            |octave: &Self| policy().colour.error * octave.variance / (octave.count as f64).sqrt();
        let error = (2.0 * error(lower)).hypot(error(self));
        (beyond > policy().colour.certain * error).then(|| beyond / (2.0 * lower.gain - self.gain))
    }
}

/// ∫ 1/f·(sin πmf/(m·sin πf))²·(2·sin πmf)¹²/924 df over 0…½: means over m samples, and their sixth differences.
fn gain(scale: usize) -> f64 {
    const STEPS: usize = 4000;
    let scale = scale as f64;
    let at = |step: usize| {
        let f = 0.5 * (step as f64 + 0.5) / STEPS as f64;
        let sin = (PI * scale * f).sin();
        (sin / (scale * (PI * f).sin())).powi(2) * (2.0 * sin).powi(12) / (POWER * f)
    };
    (0..STEPS).map(at).sum::<f64>() * 0.5 / STEPS as f64
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    fn white(count: usize, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..count)
            .map(|_| StandardNormal.sample(&mut random))
            .collect()
    }

    /// A sum of tones of random phase whose amplitudes go with 1/√f, one at every bin: of power 1/f per cycle a sample.
    fn pink(count: usize, seed: u64) -> Vec<f64> {
        let phases = white(count / 2, seed);
        let mut samples = vec![0.0; count];
        for (bin, phase) in (1..count / 2).zip(phases) {
            let turn = TAU * bin as f64 / count as f64;
            let amplitude = (2.0 / bin as f64).sqrt();
            let (sin, cos) = turn.sin_cos();
            let (mut s, mut c) = (1e3 * phase).sin_cos();
            for sample in &mut samples {
                *sample += amplitude * s;
                (s, c) = (s * cos + c * sin, c * cos - s * sin);
            }
        }
        samples
    }

    fn rms(samples: &[f64]) -> f64 {
        (samples.iter().map(|x| x * x).sum::<f64>() / samples.len() as f64).sqrt()
    }

    /// Alone or beside white noise.
    #[test]
    fn pink_noise_is_seen_whole() {
        for seed in 0..6 {
            for beside in [0.0, 0.5, 1.0] {
                let mut samples = pink(8000, seed);
                for (sample, white) in samples.iter_mut().zip(white(8000, 100 + seed)) {
                    *sample += beside * white;
                }
                let all = std::slice::from_ref(&(0..8000));
                let found = pink_deviation(&samples, all, all);
                let ratio = found.map(|found| found / rms(&samples));
                assert!(
                    ratio.is_some_and(|ratio| (0.75..1.3).contains(&ratio)),
                    "{seed}, {beside}: {ratio:?}"
                );
            }
        }
    }

    /// Neither white noise is taken for it nor a tone of any frequency.
    #[test]
    fn a_tone_is_not_taken_for_it() {
        for seed in 0..6 {
            for part in [0.02, 0.05, 0.11, 0.17, 0.23, 0.37] {
                let tone = |index: usize| 3.0 * (TAU * part * index as f64).sin();
                let noise = white(6000, seed);
                let samples: Vec<f64> = noise
                    .iter()
                    .enumerate()
                    .map(|(i, white)| white + tone(i))
                    .collect();
                let all = std::slice::from_ref(&(0..6000));
                let found = pink_deviation(&samples, all, all);
                assert!(
                    found.is_none_or(|found| found < 1.4),
                    "{seed}, {part}: {found:?}"
                );
            }
        }
    }

    /// Nor what a law lacks, a sine or a jump at each reversal.
    #[test]
    fn what_is_not_pink_is_not_taken_for_it() {
        for seed in 0..40 {
            for (size, period) in [
                (0.0, 100.0),
                (3.0, 60.0),
                (3.0, 200.0),
                (30.0, 200.0),
                (30.0, 1000.0),
            ] {
                for corner in [false, true] {
                    let wave = |index: usize| {
                        let wave = (TAU * index as f64 / period).sin();
                        size * if corner { wave.signum() } else { wave }
                    };
                    let samples: Vec<f64> = white(6000, seed)
                        .iter()
                        .enumerate()
                        .map(|(i, white)| white + wave(i))
                        .collect();
                    let half = (period / 2.0) as usize;
                    let runs: Vec<Range<usize>> = (0..6000)
                        .step_by(half)
                        .map(|start| start + 1..(start + half - 1).min(6000))
                        .collect();
                    let found = pink_deviation(&samples, &[0..2500, 2500..6000], &runs);
                    assert!(
                        found.is_none_or(|found| found < 1.5),
                        "{seed}, {size}, {period}, {corner}: {found:?}"
                    );
                }
            }
        }
    }
}

//! Standard deviation of a channel's noise.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use super::cycles::median;
use super::spectrum::{place_of_line, powers};

/// The weights of the samples of a sixth difference.
pub const SIXTH_DIFFERENCE: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
/// The sum of their squares, Σ binomial(6, k)².
const POWER: f64 = 924.0;

crate::numbers! {
    /// Which part of a channel is noise. Noise is estimated from sixth differences of the samples.
    NoisePolicy {
        /// Tones are searched for only above this many cycles per sample; a slower tone hardly changes the estimate of the noise.
        lowest: f64 = 0.1, Derived("there a sixth difference has the gain (2 sin 0.1π)⁶, a twentieth");
        /// A tone has more than this many times the median power of the bins around it.
        stands_out: f64 = 40.0, Tuned("the injected channel faults");
        /// The median power around a tone is taken over this many bins of the spectrum, of which a tone fills only four.
        around: usize = 32, Convention("enough bins for a median that a tone does not change");
        /// A sixth difference of more than this many standard deviations is a jump: neither noise nor a tone.
        jump: f64 = 4.0, Tuned("the injected channel faults");
        /// At most this many tones are removed before the noise is estimated.
        most_tones: usize = 12, Convention("mains hum and its harmonics");
        /// The frequency of a tone, which the spectrum gives to within a fiftieth of a bin, is refined this many times.
        rounds: usize = 2, Derived("each time the remaining error is squared");
        /// Tones are accepted only if removing them reduces the standard deviation of the noise below this fraction.
        left: f64 = 0.85, Tuned("the injected channel faults");
    }
}

/// Standard deviation of white noise on a smooth signal, from its sixth differences: those of a smooth signal vanish, and those of
/// white noise have the variance Σ binomial(6, k)² = 924. The median magnitude ignores a few jumps.
pub fn noise_deviation(samples: &[f64]) -> f64 {
    deviation(&sixth_differences(samples).collect::<Vec<_>>())
}

/// The same if there may be tones in addition to the noise. Sixth differences take tones above a sixth of the sampling rate for
/// noise.
pub fn noise_beside_tones(samples: &[f64]) -> f64 {
    let mut rest: Vec<f64> = sixth_differences(samples).collect();
    let seen = deviation(&rest);
    let mut beside = seen;
    for _ in 0..NoisePolicy::in_use().most_tones {
        let quiet = without_jumps(&rest, beside);
        let powers = powers(quiet.clone());
        let Some(bin) = strongest_tone(&powers, rest.len()) else {
            break;
        };
        let turn = place_of_line(&powers, bin) / rest.len() as f64 * TAU;
        take_off(&mut rest, &quiet, turn);
        beside = deviation(&rest).min(beside);
    }
    if beside < NoisePolicy::in_use().left * seen {
        beside
    } else {
        seen
    }
}

/// The same over several runs of samples; tones are those of the longest. 0 if none is long enough for a difference.
pub fn noise_of_runs(samples: &[f64], runs: &[Range<usize>]) -> f64 {
    let each = runs
        .iter()
        .flat_map(|run| sixth_differences(&samples[run.clone()]));
    let seen = deviation(&each.collect::<Vec<_>>());
    let Some(longest) = runs.iter().max_by_key(|run| run.len()) else {
        return 0.0;
    };
    let longest = &samples[longest.clone()];
    let with_tones = noise_deviation(longest);
    if with_tones > 0.0 {
        seen * (noise_beside_tones(longest) / with_tones)
    } else {
        seen
    }
}

/// Deviation of the noise with these sixth differences.
fn deviation(differences: &[f64]) -> f64 {
    let magnitudes = differences.iter().map(|d| d.abs());
    // The median magnitude of a normal variable is 0.6745 of its deviation.
    median(magnitudes).unwrap_or(0.0) / (0.6745 * POWER.sqrt())
}

/// Root mean square of values; 0 of none.
pub(crate) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0_f64), |(sum, count), value| {
        (sum + value * value, count + 1.0)
    });
    (sum / count.max(1.0)).sqrt()
}

/// `differences` with 0 in place of those that are too large for noise of this deviation or a tone: a force that jumps at reversals
/// has spectral lines too, which would hide a tone's.
fn without_jumps(differences: &[f64], deviation: f64) -> Vec<f64> {
    let most = NoisePolicy::in_use().jump * deviation * POWER.sqrt();
    let quiet = |d: &f64| if d.abs() > most { 0.0 } else { *d };
    differences.iter().map(quiet).collect()
}

/// The most prominent bin in these powers of this many sixth differences.
fn strongest_tone(powers: &[f64], count: usize) -> Option<usize> {
    // For white noise they are proportional to (2 sin(ω/2))¹².
    let half_turn = |bin: usize| bin as f64 / count as f64 * PI;
    let flat = |bin: usize| powers[bin] / (2.0 * half_turn(bin).sin()).powi(12);
    let first = ((NoisePolicy::in_use().lowest * count as f64) as usize).max(1);
    let flat: Vec<f64> = (first..powers.len()).map(flat).collect();
    let medians = flat.chunks(NoisePolicy::in_use().around);
    let medians: Vec<f64> = medians
        .filter_map(|bins| median(bins.iter().copied()))
        .collect();
    let ratio = |bin: usize| {
        let place = bin - first;
        flat[place] / medians[place / NoisePolicy::in_use().around].max(f64::MIN_POSITIVE)
    };
    (first..powers.len().saturating_sub(1))
        .max_by(|&a, &b| ratio(a).total_cmp(&ratio(b)))
        .filter(|&bin| ratio(bin) > NoisePolicy::in_use().stands_out)
}

/// Removes the tone of about this many radians per sample from `rest`, as `samples` contain it, by least squares.
fn take_off(rest: &mut [f64], samples: &[f64], turn: f64) {
    let mut turn = turn;
    let mut tone = Tone::fitted(samples, turn);
    for _ in 0..NoisePolicy::in_use().rounds {
        // With a slightly wrong frequency the residual grows to either side of the middle.
        let (mut product, mut square) = (0.0, 0.0);
        let mut time = -0.5 * samples.len() as f64;
        for (y, at) in samples.iter().zip(turning(turn)) {
            let slope = time * tone.slope(at);
            product += slope * (y - tone.value(at));
            square += slope * slope;
            time += 1.0;
        }
        turn += product / square;
        tone = Tone::fitted(samples, turn);
    }
    for (y, at) in rest.iter_mut().zip(turning(turn)) {
        *y -= tone.value(at);
    }
}

/// a·sin x + b·cos x
struct Tone {
    sine: f64,
    cosine: f64,
}

impl Tone {
    fn fitted(samples: &[f64], turn: f64) -> Self {
        let [mut ss, mut cc, mut sc, mut s_y, mut c_y] = [0.0; 5];
        for (y, [s, c]) in samples.iter().zip(turning(turn)) {
            ss += s * s;
            cc += c * c;
            sc += s * c;
            s_y += s * y;
            c_y += c * y;
        }
        let determinant = ss * cc - sc * sc;
        Self {
            sine: (cc * s_y - sc * c_y) / determinant,
            cosine: (ss * c_y - sc * s_y) / determinant,
        }
    }

    fn value(&self, [sin, cos]: [f64; 2]) -> f64 {
        self.sine * sin + self.cosine * cos
    }

    /// Its derivative by x.
    fn slope(&self, [sin, cos]: [f64; 2]) -> f64 {
        self.sine * cos - self.cosine * sin
    }
}

/// Sine and cosine of x, which grows by a fixed number of radians per sample. Each is rotated from the one before, because
/// computing a million sines would take longer than everything else here.
fn turning(turn: f64) -> impl Iterator<Item = [f64; 2]> {
    let (sin, cos) = turn.sin_cos();
    std::iter::successors(Some([0.0, 1.0]), move |&[s, c]| {
        Some([s * cos + c * sin, c * cos - s * sin])
    })
}

fn sixth_differences(samples: &[f64]) -> impl Iterator<Item = f64> {
    let weighted = |window: &[f64]| -> f64 {
        let pairs = window.iter().zip(SIXTH_DIFFERENCE);
        pairs.map(|(sample, weight)| weight * sample).sum()
    };
    samples.windows(SIXTH_DIFFERENCE.len()).map(weighted)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    use super::{TAU, noise_beside_tones, noise_deviation, noise_of_runs};

    fn noise(count: usize, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let normal = Normal::new(0.0, 1.0).unwrap();
        (0..count).map(|_| normal.sample(&mut random)).collect()
    }

    fn with(noise: &[f64], signal: impl Fn(f64) -> f64) -> Vec<f64> {
        let samples = noise.iter().enumerate();
        samples.map(|(n, value)| value + signal(n as f64)).collect()
    }

    /// Neither louder parts between the runs nor the joints count, nor a short run that is loud.
    #[test]
    fn noise_between_runs_is_not_seen() {
        let mut samples = noise(6000, 4);
        samples[2000..3500].iter_mut().for_each(|y| *y *= 50.0);
        samples[3500..].iter_mut().for_each(|y| *y += 100.0);
        let found = noise_of_runs(&samples, &[0..2000, 2000..2100, 3500..5997, 5997..6000]);
        assert!((0.9..1.1).contains(&found), "{found}");
        assert_eq!(
            noise_of_runs(&samples, std::slice::from_ref(&(0..6000))),
            noise_beside_tones(&samples)
        );
        assert_eq!(noise_of_runs(&samples, std::slice::from_ref(&(0..3))), 0.0);
    }

    /// For any frequency and strength, between bins and on them.
    #[test]
    fn tones_are_no_noise() {
        for (seed, count) in [(1, 1500), (2, 6000), (3, 14_000)] {
            let noise = noise(count, seed);
            for part in [0.05, 0.17, 0.2503, 0.3, 0.4, 0.49] {
                for size in [0.5, 5.0, 50.0] {
                    let tones = with(&noise, |n| {
                        size * ((TAU * part * n).sin() + 0.3 * (TAU * 0.371 * n).cos())
                    });
                    let found = noise_beside_tones(&tones);
                    assert!(
                        (0.9..1.2).contains(&found),
                        "{count}, {part}, {size}: {found}"
                    );
                }
            }
            // Sixth differences alone take them for noise.
            let strong = with(&noise, |n| 5.0 * (TAU * 0.4 * n).sin());
            assert!(noise_deviation(&strong) > 4.0);
        }
    }

    /// A force that jumps at every reversal, as friction does, does not hide a tone.
    #[test]
    fn a_tone_shows_beside_jumps() {
        let noise = noise(6000, 7);
        for (period, size) in [(250.0, 60.0), (100.0, 60.0), (250.0, 200.0), (100.0, 200.0)] {
            let force = with(&noise, |n| {
                size * (TAU * (n + 0.5) / period).sin().signum() + 5.0 * (TAU * 0.37 * n).sin()
            });
            let found = noise_beside_tones(&force);
            assert!((0.9..1.3).contains(&found), "{period}, {size}: {found}");
            assert!(noise_deviation(&force) > 3.0);
        }
    }

    #[test]
    fn too_few_samples_or_none_that_change_have_no_noise() {
        for count in 0..40 {
            assert!(noise_beside_tones(&vec![1.0; count]) < 1e-12);
            let found = noise_beside_tones(&noise(count, 1));
            assert!((0.0..3.0).contains(&found), "{count}: {found}");
        }
    }

    /// Without tones it equals the estimate by sixth differences, to the bit: a motion with corners, or with jumps, has no tones.
    #[test]
    fn what_has_no_tones_is_judged_as_before() {
        for seed in 0..40 {
            let noise = noise(300 + 300 * seed as usize, seed);
            for size in [1.0, 100.0] {
                let turns = |n: f64| TAU * n / 250.0;
                for signal in [
                    with(&noise, |n| size * turns(n).sin()),
                    with(&noise, |n| size * turns(n).sin().asin()),
                    with(&noise, |n| size * turns(n).sin().signum()),
                ] {
                    assert_eq!(
                        noise_beside_tones(&signal),
                        noise_deviation(&signal),
                        "{seed}"
                    );
                }
            }
        }
    }
}

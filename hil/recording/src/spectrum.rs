//! The power of a channel over frequency.

use realfft::RealFftPlanner;

/// |X|² of each bin from 0 to half the sampling rate, X the transform of `samples` with a Hann window of mean 1, which
/// keeps a line within four bins.
pub fn powers(mut samples: Vec<f64>) -> Vec<f64> {
    let count = samples.len();
    if count == 0 {
        return Vec::new();
    }
    for (index, value) in samples.iter_mut().enumerate() {
        let turn = (index as f64 + 0.5) / count as f64 * std::f64::consts::TAU;
        *value *= 1.0 - turn.cos();
    }
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(count);
    let mut spectrum = plan.make_output_vec();
    match plan.process(&mut samples, &mut spectrum) {
        Ok(()) => spectrum.iter().map(|bin| bin.norm_sqr()).collect(),
        Err(_) => Vec::new(),
    }
}

/// Power of each bin from 0 to half the sampling rate, scaled so that white noise has its variance in each. It is the mean of
/// stretches of `length` samples that overlap by half (Welch 1967), so that each part of a record counts.
pub fn density(samples: &[f64], length: usize) -> Vec<f64> {
    let mut sum = vec![0.0; length / 2 + 1];
    let (mut start, mut count) = (0, 0.0);
    while start + length <= samples.len() {
        let powers = powers(samples[start..start + length].to_vec());
        sum.iter_mut()
            .zip(powers)
            .for_each(|(sum, power)| *sum += power);
        start += (length / 2).max(1);
        count += 1.0;
    }
    // The squares of a Hann window of mean 1 have the mean 3/2.
    let scale = 1.0 / (1.5 * length as f64 * f64::max(count, 1.0));
    sum.iter_mut().for_each(|sum| *sum *= scale);
    sum
}

/// The position in bins of the line whose peak is at bin `peak`, which is neither the first nor the last. With a = |X(k+1)|/|X(k)|
/// of its two largest bins it is k + (2a − 1)/(a + 1) (Grandke 1983).
pub fn place_of_line(powers: &[f64], peak: usize) -> f64 {
    let (below, above) = (powers[peak - 1], powers[peak + 1]);
    let (side, sign) = if above > below {
        (above, 1.0)
    } else {
        (below, -1.0)
    };
    let ratio = (side / powers[peak]).sqrt();
    peak as f64 + sign * (2.0 * ratio - 1.0) / (ratio + 1.0)
}

/// Number of parts of the upper half of a spectrum, of which the quietest is noise. Convention: a part is narrow compared with a
/// band of motion, and wide enough for a mean.
const PARTS: usize = 8;

/// The power of white noise next to a motion with a limited band: the mean of the quietest part of the upper half of `powers`.
pub fn floor(powers: &[f64]) -> f64 {
    let upper = &powers[powers.len() / 2..];
    let parts = upper.chunks(upper.len().div_ceil(PARTS).max(1));
    let means = parts.map(|part| part.iter().sum::<f64>() / part.len() as f64);
    means.min_by(f64::total_cmp).unwrap_or_default()
}

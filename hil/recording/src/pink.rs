//! Noise that grows towards low frequencies as 1/f, of which fast changes show little.
//!
//! It is searched for in the residual of a law, which no longer contains the motion. The residual of a missing effect follows the
//! motion and has its band, so it does not lie on one line over all octaves.

use mesh_damper_tables::channel::Channel;

use super::spectrum::density;
use crate::faults::kind::{ChannelFault, ChannelFaultKind};
use crate::trajectory::Trajectory;

crate::numbers! {
    /// How pink noise is recognized: noise that grows towards low frequencies.
    PinkPolicy {
        /// Pink noise is searched for in spectra of stretches with at most this many samples.
        longest: usize = 16_384, Convention("twelve octaves");
        /// The spectra of at least this many stretches of a recording are averaged to find pink noise.
        stretches: usize = 8,
            Derived("the lowest octave then has four bins in each of fifteen overlapping stretches, and is certain to an eighth");
        /// Pink noise must exceed the white noise in at least this many octaves.
        octaves: usize = 5, Convention("a factor of thirty in frequency");
        /// The power of each octave, as log₂, differs from the sum of pink and white noise by less than this.
        straight: f64 = 0.5, Derived("three standard deviations of the lowest octave");
    }
}

/// Standard deviation of the residual `left`, if it is noise of this kind together with white noise; `None` if it is not, or is too
/// short.
pub fn pink_deviation(left: &[f64]) -> Option<f64> {
    let PinkPolicy {
        longest,
        stretches,
        octaves: fewest,
        straight,
    } = *PinkPolicy::in_use();
    let mut length = longest;
    while length * stretches > left.len() {
        length /= 2;
    }
    // The lowest has the four bins that a constant does not affect.
    let octaves = (length / 8).checked_ilog2()? as usize;
    if octaves < fewest {
        return None;
    }
    let density = density(left, length);
    let mean = |bins: &[f64]| bins.iter().sum::<f64>() / bins.len() as f64;
    let powers: Vec<f64> = (2..2 + octaves)
        .map(|octave| mean(&density[1 << octave..2 << octave]).log2())
        .collect();
    // 2^−octave + white, with the level that fits best.
    let fit = |white: f64| {
        let shape = (0..octaves).map(|octave| (0.5_f64.powi(octave as i32) + white).log2());
        let off: Vec<f64> = powers.iter().zip(shape).map(|(p, s)| p - s).collect();
        let level = mean(&off);
        off.iter()
            .map(|off| (off - level).abs())
            .fold(0.0, f64::max)
    };
    // White noise up to that of the highest octaves, in quarters of octaves.
    let highest = 0.5_f64.powi(fewest as i32 - 1);
    let worst = (0..4 * octaves)
        .map(|quarters| fit(highest * 0.5_f64.powf(0.25 * quarters as f64)))
        .fold(f64::INFINITY, f64::min);
    // A constant affects the first two bins.
    let noise = density[2..].iter().sum::<f64>() / density.len() as f64;
    (worst < straight).then(|| noise.sqrt())
}

impl Trajectory {
    /// Sets the deviation of the force's noise to `noise` kN, of which fast changes show only a part.
    pub fn take_pink_noise(&mut self, noise: f64) {
        let times = noise / self.force_noise;
        self.noise_beside = times;
        self.force_noise = noise;
        self.faults.push(ChannelFault {
            channel: Channel::Force,
            kind: ChannelFaultKind::Pink { times },
        });
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const COUNT: usize = 40_000;

    fn white(seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..COUNT)
            .map(|_| StandardNormal.sample(&mut random))
            .collect()
    }

    /// White noise through poles an octave apart, whose powers add up to nearly 1/f.
    fn pink(seed: u64) -> Vec<f64> {
        let mut sum = vec![0.0; COUNT];
        for pole in 0..16 {
            let kept = (-(2.0_f64.powi(1 - pole))).exp();
            let mut state = 0.0;
            for (sum, white) in sum.iter_mut().zip(white(seed * 100 + pole as u64)) {
                state = kept * state + (1.0 - kept * kept).sqrt() * white;
                *sum += state;
            }
        }
        sum
    }

    #[test]
    fn pink_noise_has_the_size_that_it_has() {
        for seed in 1..6 {
            let noise = pink(seed);
            let rms = (noise.iter().map(|x| x * x).sum::<f64>() / COUNT as f64).sqrt();
            let found = pink_deviation(&noise).unwrap();
            // Its slowest part moves by less than a period in a stretch.
            assert!((found / rms - 1.0).abs() < 0.25, "{found} {rms}");
        }
    }

    #[test]
    fn what_is_no_pink_noise_is_not_taken_for_it() {
        assert!(pink_deviation(&white(1)).is_none());
        // A force that jumps, as friction does at a reversal, and a motion's band above white noise.
        let mut level = 1.0;
        let jumps: Vec<f64> = white(2)
            .iter()
            .map(|x| {
                level = if *x > 2.0 { -level } else { level };
                level + 0.01 * x
            })
            .collect();
        assert!(pink_deviation(&jumps).is_none());
        let tones: Vec<f64> = white(3)
            .iter()
            .enumerate()
            .map(|(index, x)| {
                let tone = |period: f64| (index as f64 * std::f64::consts::TAU / period).sin();
                tone(37.0) + tone(91.0) + tone(230.0) + 0.3 * x
            })
            .collect();
        assert!(pink_deviation(&tones).is_none());
        // Pink noise below a tone that a law lacks.
        let both: Vec<f64> = pink(4)
            .iter()
            .enumerate()
            .map(|(index, x)| x + 3.0 * (index as f64 * std::f64::consts::TAU / 60.0).sin())
            .collect();
        assert!(pink_deviation(&both).is_none());
    }
}

//! The load–unload cycles of a quasistatic recording: where loading begins, turns and ends.

use std::ops::Range;

use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_recording::noise::noise_deviation;

/// A reversal counts if the displacement then moves on by this fraction of its range,
const REVERSAL: f64 = 0.05;
/// and by this many deviations of the noise after smoothing.
const NOISE_MARGIN: f64 = 6.0;
/// A cycle is whole if it begins and ends within this fraction of its height from its lowest point, or of its force from the
/// lowest. The rest is a hold, or a residual set.
const OPEN: f64 = 0.05;
/// Longest moving mean, as a fraction of a cycle.
const LONGEST_MEAN: f64 = 0.02;

/// Displacement and force of a compression, both positive, smoothed according to their noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// mm
    pub displacement: Vec<f64>,
    /// kN
    pub force: Vec<f64>,
    /// Whether displacement and force were recorded with the opposite sign.
    pub turned: (bool, bool),
}

/// One loading and the unloading after it, as samples of a [`Curve`].
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// The first sample of the loading, and the last of the unloading.
    pub samples: Range<usize>,
    /// The sample of the largest displacement.
    pub peak: usize,
    /// Whether both branches are complete from their lowest point on.
    pub is_whole: bool,
}

impl Curve {
    /// Reverses the sign of channels that were recorded with negative compression. Takes a moving mean of both channels over the
    /// same samples, which keeps the line that they lie on.
    ///
    /// A mean over m samples lowers a turning point by s·m/4, where s is the travel from sample to sample, and leaves the noise
    /// σ/√m. The two have equal size for m = (4σ/s)^(2/3). Without noise nothing is smoothed.
    pub fn new(displacement: &[f64], force: &[f64]) -> Self {
        let turned = signs(displacement, force);
        let sign = |turned| if turned { -1.0 } else { 1.0 };
        let x: Vec<f64> = displacement.iter().map(|x| sign(turned.0) * x).collect();
        let f: Vec<f64> = force.iter().map(|f| sign(turned.1) * f).collect();
        let relative = |values: &[f64]| noise_deviation(values) / span(values);
        let noise = relative(&x).max(relative(&f));
        // Reversals of the raw displacement that are not noise.
        let reversals = turning_points(&x, REVERSAL.max(NOISE_MARGIN * relative(&x)) * span(&x));
        let step = reversals.len().saturating_sub(1).max(1) as f64 / x.len() as f64;
        let longest = LONGEST_MEAN / step;
        let mean = (4.0 * noise / step).powf(2.0 / 3.0).min(longest);
        let half = (0.5 * mean) as usize;
        Self {
            displacement: moving_mean(&x, half),
            force: moving_mean(&f, half),
            turned,
        }
    }

    /// The cycles in order, including those that the recording cuts off.
    pub fn cycles(&self) -> Vec<Cycle> {
        let x = &self.displacement;
        let noise = noise_deviation(x);
        let turns = turning_points(x, (REVERSAL * span(x)).max(NOISE_MARGIN * noise));
        let last = x.len() - 1;
        let mut cycles = Vec::new();
        for (place, &peak) in turns.iter().enumerate() {
            let before = place.checked_sub(1).map(|place| turns[place]);
            let after = turns.get(place + 1).copied();
            let is_peak = |other: Option<usize>| other.is_none_or(|other| x[other] < x[peak]);
            if !(is_peak(before) && is_peak(after)) {
                continue;
            }
            let (start, end) = (before.unwrap_or(0), after.unwrap_or(last));
            if start == peak || end == peak {
                continue;
            }
            let begins = place > 1 || self.is_low(start, start..end + 1, peak);
            let ends = place + 2 < turns.len() || self.is_low(end, start..end + 1, peak);
            cycles.push(Cycle {
                samples: start..end + 1,
                peak,
                is_whole: begins && ends,
            });
        }
        cycles
    }

    /// Whether a sample is close to the lowest displacement or force of its cycle.
    fn is_low(&self, sample: usize, cycle: Range<usize>, peak: usize) -> bool {
        [&self.displacement, &self.force].into_iter().any(|values| {
            let least = values[cycle.clone()]
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min);
            values[sample] - least <= OPEN * (values[peak] - least)
        })
    }
}

/// Whether displacement and force have to be reversed for both to grow as the specimen is loaded. The force is largest where it is
/// farthest from 0, and the displacement there is larger than where the force is smallest.
fn signs(displacement: &[f64], force: &[f64]) -> (bool, bool) {
    let by_force = |a: &usize, b: &usize| force[*a].abs().total_cmp(&force[*b].abs());
    let largest = (0..force.len()).max_by(by_force).unwrap_or(0);
    let least = (0..force.len()).min_by(by_force).unwrap_or(0);
    (
        displacement[largest] < displacement[least],
        force[largest] < 0.0,
    )
}

/// The samples at which `values` turn by more than `least`, including the first and the last extreme.
fn turning_points(values: &[f64], least: f64) -> Vec<usize> {
    let (mut low, mut high) = (0, 0);
    let mut turns = Vec::new();
    let mut rising = None;
    for (index, &value) in values.iter().enumerate() {
        if value < values[low] {
            low = index;
        }
        if value > values[high] {
            high = index;
        }
        if rising != Some(true) && value - values[low] > least {
            turns.push(low);
            (rising, high) = (Some(true), index);
        } else if rising != Some(false) && values[high] - value > least {
            turns.push(high);
            (rising, low) = (Some(false), index);
        }
    }
    turns.extend(rising.map(|rising| if rising { high } else { low }));
    turns
}

/// The mean of every sample with `half` samples on each side; fewer near the ends, the same number on both sides.
fn moving_mean(values: &[f64], half: usize) -> Vec<f64> {
    let last = values.len() - 1;
    (0..values.len())
        .map(|index| {
            let half = half.min(index).min(last - index);
            let window = &values[index - half..=index + half];
            window.iter().sum::<f64>() / window.len() as f64
        })
        .collect()
}

/// The largest minus the smallest of `values`.
fn span(values: &[f64]) -> f64 {
    let (low, high) = least_and_largest(values);
    high - low
}

//! Tones in what a law leaves of the force.

use realfft::RealFftPlanner;

use crate::recording::trajectory::Trajectory;

/// So many of the strongest tones are given.
const MOST: usize = 3;

/// The frequencies in Hz of the strongest lines in what `predicted` (kN, per trajectory and sample) leaves of the force of
/// the longest trajectory, the strongest first.
pub fn tones(trajectories: &[Trajectory], predicted: &[Vec<f64>]) -> Vec<f64> {
    let longest = trajectories
        .iter()
        .zip(predicted)
        .max_by_key(|(trajectory, _)| trajectory.len());
    let Some((trajectory, predicted)) = longest else {
        return Vec::new();
    };
    let left: Vec<f64> = (0..trajectory.len())
        .map(|index| {
            if trajectory.measured[index] {
                trajectory.force[index] - predicted[index]
            } else {
                0.0
            }
        })
        .collect();
    lines(&left)
        .into_iter()
        .map(|line| line / trajectory.tick)
        .collect()
}

/// The strongest lines in cycles per sample.
///
/// A Hann window keeps a line within four bins, and between the bins its place follows from the ratio of the two largest
/// (Grandke 1983): with a = |X(k+1)|/|X(k)| it is k + (2a − 1)/(a + 1).
fn lines(samples: &[f64]) -> Vec<f64> {
    let count = samples.len();
    let mut windowed: Vec<f64> = samples
        .iter()
        .enumerate()
        .map(|(index, value)| {
            let turn = (index as f64 + 0.5) / count as f64 * std::f64::consts::TAU;
            value * (1.0 - turn.cos())
        })
        .collect();
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(count);
    let mut spectrum = plan.make_output_vec();
    if plan.process(&mut windowed, &mut spectrum).is_err() {
        return Vec::new();
    }
    let size: Vec<f64> = spectrum.iter().map(|bin| bin.norm()).collect();
    let mut peaks: Vec<usize> = (2..size.len().saturating_sub(2))
        .filter(|&k| size[k] > size[k - 1] && size[k] >= size[k + 1])
        .collect();
    peaks.sort_by(|&a, &b| size[b].total_cmp(&size[a]));
    peaks
        .into_iter()
        .take(MOST)
        .map(|k| {
            let (side, sign) = if size[k + 1] > size[k - 1] {
                (size[k + 1], 1.0)
            } else {
                (size[k - 1], -1.0)
            };
            let ratio = side / size[k];
            (k as f64 + sign * (2.0 * ratio - 1.0) / (ratio + 1.0)) / count as f64
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::lines;

    /// Of two tones between bins the stronger comes first, each within a fiftieth of a bin.
    #[test]
    fn tones_between_bins_are_placed() {
        let count = 4000;
        let tone = |frequency: f64, index: usize| {
            (std::f64::consts::TAU * frequency * index as f64 + 0.4).sin()
        };
        for part in [0.0, 0.2, 0.5, 0.9] {
            let (strong, weak) = ((200.0 + part) / 4000.0, (731.0 - part) / 4000.0);
            let samples: Vec<f64> = (0..count)
                .map(|index| tone(strong, index) + 0.1 * tone(weak, index))
                .collect();
            let found = lines(&samples);
            assert!(
                (found[0] - strong).abs() * 4000.0 < 0.02,
                "{found:?} {strong}"
            );
            assert!((found[1] - weak).abs() * 4000.0 < 0.1, "{found:?} {weak}");
        }
    }
}

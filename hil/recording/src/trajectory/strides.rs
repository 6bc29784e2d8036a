//! The samples at which a search computes forces: fewer where the motion is slow.

use std::ops::Range;

use super::Trajectory;
use crate::noise::rms;

/// Between two samples of a stride, the displacement differs from a straight line by at most this fraction of its amplitude, or by its own
/// error, or they are neighbours. Derived: 70 samples in the period of a sine, more than most recordings have at their fastest.
const BENT: f64 = 1e-3;

/// The error of the displacement is at most this many of its deviations. Convention: nearly all are.
const DEVIATIONS: f64 = 3.0;

/// A change of the distance between samples happens at multiples of this, which is also the largest distance. Convention: a power of two,
/// so that every smaller one divides it.
const LARGEST: usize = 64;

/// Samples at equal distances, each the end of a step from the one before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stride {
    /// Where its first step begins, and where its last one ends.
    pub samples: Range<usize>,
    /// Samples in a step; divides the length of `samples`.
    pub step: usize,
}

impl Stride {
    /// Every sample of a recording.
    pub fn each(samples: usize) -> Vec<Self> {
        vec![Self {
            samples: 0..samples.saturating_sub(1),
            step: 1,
        }]
    }

    /// The samples at which its steps end, after the first sample of the recording if it begins there.
    pub fn visits(&self) -> impl Iterator<Item = usize> + use<> {
        let Range { start, end } = self.samples;
        let first = (start == 0).then_some(0);
        let ends = (start + self.step..=end).step_by(self.step);
        first.into_iter().chain(ends)
    }

    /// The same, each with the number of samples that it stands for: those of its step; the first one ends no step.
    pub fn counted(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (start, step) = (self.samples.start, self.step);
        self.visits()
            .map(move |sample| (sample, if sample == start { 1 } else { step }))
    }
}

/// Strides over each of `trajectories`, with steps as long as the motion permits, but no longer than for about `fewest` samples at equal
/// distances: along a straight line too the force may bend, and its noise has to be averaged.
pub fn strides(trajectories: &[Trajectory], fewest: usize) -> Vec<Vec<Stride>> {
    let samples: usize = trajectories.iter().map(Trajectory::len).sum();
    let longest = (samples / fewest).clamp(1, LARGEST);
    trajectories.iter().map(|one| over(one, longest)).collect()
}

/// Strides over a trajectory with steps of at most `longest` samples.
fn over(trajectory: &Trajectory, longest: usize) -> Vec<Stride> {
    let last = trajectory.len().saturating_sub(1);
    let moving = trajectory.blocks.iter();
    let moving = moving.filter(|block| !block.cycles.is_empty());
    let least = moving.map(|block| block.amplitude).reduce(f64::min);
    let displacement = &trajectory.motion.displacement;
    let error = DEVIATIONS * rms(trajectory.motion_error.displacement.iter().copied());
    let mut strides: Vec<Stride> = Vec::new();
    for start in (0..last).step_by(LARGEST) {
        let end = (start + LARGEST).min(last);
        // At rest the amplitude is that of noise.
        let amplitude = trajectory.amplitude[start].max(least.unwrap_or_default());
        let bent = error.max(BENT * amplitude);
        let is_straight = |step: usize| {
            (start..end).step_by(step).all(|from| {
                let [first, last] = [displacement[from], displacement[from + step]];
                let off = |sample: usize| {
                    let part = (sample - from) as f64 / step as f64;
                    (displacement[sample] - first - part * (last - first)).abs()
                };
                (from + 1..from + step).all(|sample| off(sample) <= bent)
            })
        };
        let powers = (0..=longest.ilog2()).rev().map(|power| 1 << power);
        let mut fitting =
            powers.filter(|&step| (end - start).is_multiple_of(step) && is_straight(step));
        let step = fitting.next().unwrap_or(1);
        match strides.last_mut().filter(|stride| stride.step == step) {
            Some(stride) => stride.samples.end = end,
            None => strides.push(Stride {
                samples: start..end,
                step,
            }),
        }
    }
    strides
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// A slow and a fast sine with a rest between them.
    fn slow_and_fast() -> Trajectory {
        const TICK: f64 = 5e-4;
        let sine = |frequency: f64, seconds: f64| {
            let samples = (seconds / TICK) as i32;
            (0..samples).map(move |n| 0.5 * (TAU * frequency * TICK * f64::from(n)).sin())
        };
        let rest = std::iter::repeat_n(0.0, 1000);
        let displacement: Vec<f64> = sine(0.5, 8.0).chain(rest).chain(sine(60.0, 0.5)).collect();
        let force = displacement.clone();
        Trajectory::new("sines", TICK, &displacement, force, None, None)
    }

    #[test]
    fn no_step_passes_over_a_corner() {
        // A triangle of 40 samples a side.
        let triangle = |n: i32| f64::from((n % 80 - 40).abs() - 20) / 20.0;
        let displacement: Vec<f64> = (0..4000).map(triangle).collect();
        let force = displacement.clone();
        let trajectory = Trajectory::new("triangle", 1e-3, &displacement, force, None, None);
        let turns = (40..4000).step_by(40);
        let visited: Vec<usize> = over(&trajectory, LARGEST)
            .iter()
            .flat_map(Stride::visits)
            .collect();
        for turn in turns {
            let beside = |sample: &usize| sample.abs_diff(turn) <= 1;
            assert!(visited.iter().any(beside), "{turn}");
        }
    }

    #[test]
    fn steps_are_long_where_the_motion_is_slow_and_cover_it() {
        let trajectory = slow_and_fast();
        let strides = over(&trajectory, LARGEST);
        let mut at = 0;
        for stride in &strides {
            assert_eq!(stride.samples.start, at);
            at = stride.samples.end;
            assert_eq!(stride.visits().last(), Some(at));
        }
        assert_eq!(at + 1, trajectory.len());
        let step_at = |sample: usize| {
            let stride = strides.iter().find(|one| one.samples.contains(&sample));
            stride.unwrap().step
        };
        // At a turn of a period of 4000 samples, and in one of 33.
        assert_eq!(step_at(9000), 32);
        assert_eq!(step_at(17_500), 1);
        let visited: usize = strides.iter().map(|stride| stride.visits().count()).sum();
        assert!(visited < trajectory.len() / 8, "{visited}");
    }
}

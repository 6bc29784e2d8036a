//! The samples at which a search computes forces: fewer where the motion is slow.

use std::ops::Range;

use super::Trajectory;
use crate::extremes::least_and_largest;
use crate::noise::{noise_deviation, rms};

/// Between two samples of a stride, the displacement differs from a straight line by at most this fraction of its amplitude, or by its own
/// error, or they are neighbours. Derived: 70 samples in the period of a sine, more than most recordings have at their fastest.
const BENT: f64 = 1e-3;

/// A step is at most this fraction of the amplitude long. Derived: as far as [`BENT`] lets a sine go at its fastest, √(8·BENT); along a
/// ramp, which is straight, an effect that is integrated over its own deflection needs the same.
const FAR: f64 = 0.09;

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
/// distances of those that `included(trajectory, sample)` picks: along a straight line too the force may bend, and its noise has to be
/// averaged.
pub fn strides(
    trajectories: &[Trajectory],
    fewest: usize,
    included: impl Fn(usize, usize) -> bool,
) -> Vec<Vec<Stride>> {
    let all = trajectories.iter().enumerate();
    let samples: usize = all
        .map(|(which, one)| {
            (0..one.len())
                .filter(|&sample| included(which, sample))
                .count()
        })
        .sum();
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
    // An effect may follow a control input with a lag.
    let controls = trajectory.controls.iter().map(|control| {
        let (low, high) = least_and_largest(&control.values);
        // An input that changes from sample to sample looks like noise.
        let error = (DEVIATIONS * noise_deviation(&control.values)).min(FAR * (high - low));
        let limits = [BENT, FAR].map(|part| error.max(part * (high - low)));
        (&control.values[..], limits)
    });
    let controls: Vec<(&[f64], [f64; 2])> = controls.collect();
    let mut strides: Vec<Stride> = Vec::new();
    for start in (0..last).step_by(LARGEST) {
        let end = (start + LARGEST).min(last);
        // At rest the amplitude is that of noise.
        let amplitude = trajectory.amplitude[start].max(least.unwrap_or_default());
        let limits = [BENT, FAR].map(|part| error.max(part * amplitude));
        let permits = |step: usize| {
            (start..end).step_by(step).all(|from| {
                let step = from..from + step;
                let mut controls = controls.iter();
                is_straight(displacement, &step, limits)
                    && controls.all(|&(values, limits)| is_straight(values, &step, limits))
            })
        };
        let mut longer = (1..=longest.ilog2()).rev().map(|power| 1 << power);
        let fits = |step: &usize| (end - start).is_multiple_of(*step) && permits(*step);
        let step = longer.find(fits).unwrap_or(1);
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

/// Whether the values at the ends of a step differ by at most `far`, and those between by at most `bent` from the line between the ends.
fn is_straight(values: &[f64], step: &Range<usize>, [bent, far]: [f64; 2]) -> bool {
    let [first, last] = [values[step.start], values[step.end]];
    let length = step.len() as f64;
    let is_near = |sample: usize| {
        let part = (sample - step.start) as f64 / length;
        (values[sample] - first - part * (last - first)).abs() <= bent
    };
    (last - first).abs() <= far && (step.start + 1..step.end).all(is_near)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::sync::Arc;

    use mesh_damper_tables::control::ControlChannel;

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
    fn along_a_ramp_a_step_is_a_small_part_of_the_amplitude() {
        let ramps = |n: i32| f64::from((n % 400 - 200).abs() - 100) / 100.0;
        let displacement: Vec<f64> = (0..4000).map(ramps).collect();
        let force = displacement.clone();
        let trajectory = Trajectory::new("ramps", 1e-3, &displacement, force, None, None);
        let strides = over(&trajectory, LARGEST);
        let steps = strides.iter().map(|stride| stride.step);
        // A sample is a hundredth of the amplitude.
        assert_eq!(steps.max(), Some(8));
    }

    #[test]
    fn no_step_passes_over_a_jump_of_a_control_input() {
        let displacement: Vec<f64> = (0..8000)
            .map(|n| (TAU * f64::from(n) / 4000.0).sin())
            .collect();
        let force = displacement.clone();
        let mut trajectory = Trajectory::new("sine", 1e-3, &displacement, force, None, None);
        let jumps = [1000, 5003];
        let values =
            (0..8000).map(|n| f64::from(jumps.iter().filter(|&&jump| n >= jump).count() as u32));
        trajectory.controls = Arc::new(vec![ControlChannel {
            name: "current_A".into(),
            values: values.collect(),
        }]);
        let strides = over(&trajectory, LARGEST);
        for jump in jumps {
            let stride = strides
                .iter()
                .find(|one| one.samples.contains(&(jump as usize)));
            assert_eq!(stride.unwrap().step, 1, "{jump}");
        }
        assert!(strides.iter().any(|stride| stride.step == 32));
    }

    #[test]
    fn steps_leave_as_many_samples_as_were_asked_for() {
        let trajectories = [slow_and_fast()];
        let samples = trajectories[0].len();
        let longest = |fewest: usize, included: usize| {
            let strides = strides(&trajectories, fewest, |_, sample| sample < included);
            strides[0].iter().map(|stride| stride.step).max().unwrap()
        };
        assert_eq!(longest(100, samples), 64);
        assert_eq!(longest(samples / 8, samples), 8);
        assert_eq!(longest(samples / 8, samples / 4), 2);
        assert_eq!(longest(samples, samples), 1);
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

//! The error of a law in each cycle, relative to the noise.

use std::ops::Range;

use mesh_damper_recording::trajectory::Trajectory;

use crate::tolerance::held_to;
use crate::trace::left_out::LeftOutPolicy;

/// Squared errors over the noise's variance, and the number of samples.
#[derive(Clone, Copy, Debug, Default)]
struct Left {
    squares: f64,
    count: f64,
}

impl Left {
    fn mean(&self) -> f64 {
        self.squares / self.count
    }

    /// The sum; `None` without samples.
    fn sum(parts: &[Self]) -> Option<Self> {
        let sum = |of: fn(&Self) -> f64| parts.iter().map(of).sum();
        let count = sum(|left| left.count);
        (count > 0.0).then(|| Self {
            squares: sum(|left| left.squares),
            count,
        })
    }
}

/// The errors of a law in the cycles of every block, as far as they count.
#[derive(Default)]
pub(super) struct LeftInCycles(Vec<Vec<Left>>);

impl LeftInCycles {
    /// Adds the errors of `predicted`, kN, at those samples of a trajectory that count.
    pub fn add(
        &mut self,
        trajectory: &Trajectory,
        predicted: &[f64],
        counts: impl Fn(usize) -> bool,
    ) {
        let of_cycle = |cycle: &Range<usize>| {
            let telling = cycle
                .clone()
                .filter(|&i| counts(i) && trajectory.is_telling(i));
            let errors = telling
                .map(|i| (predicted[i] - trajectory.force[i]).powi(2) / held_to(trajectory, i));
            errors.fold(Left::default(), |left, error| Left {
                squares: left.squares + error,
                count: left.count + 1.0,
            })
        };
        for block in &trajectory.blocks {
            self.0.push(block.cycles.iter().map(of_cycle).collect());
        }
    }

    /// RMS over the noise, without the worst cycles, which may belong to a start or to a change between blocks; `None` without one
    /// whole cycle.
    pub fn in_most(&self) -> Option<f64> {
        let mut left: Vec<Left> = self.0.concat();
        left.retain(|cycle| cycle.count > 0.0);
        left.sort_by(|a, b| a.mean().total_cmp(&b.mean()));
        left.truncate((LeftOutPolicy::in_use().most_cycles * left.len() as f64).ceil() as usize);
        Left::sum(&left).map(|all| all.mean().sqrt())
    }

    /// The RMS beyond the noise, √(rms² − 1), over the cycles of every block except its first. Each block counts equally. `None`
    /// without two such blocks: others are ramps, and one condition cannot distinguish similar effects.
    pub fn beyond_noise(&self) -> Option<f64> {
        let blocks = self.0.iter();
        let blocks: Vec<f64> = blocks
            .filter(|cycles| cycles.len() >= LeftOutPolicy::in_use().some_cycles)
            .filter_map(|cycles| Left::sum(&cycles[1..]))
            .map(|block| block.mean() - 1.0)
            .collect();
        let mean = blocks.iter().sum::<f64>() / blocks.len() as f64;
        (blocks.len() > 1).then(|| mean.max(0.0).sqrt())
    }
}

//! Cycles of a recorded motion, and the blocks of equal cycles in a test.

use std::ops::Range;

use crate::extremes::{least_and_largest, quantile};

crate::numbers! {
    /// Which cycles and which blocks are alike.
    CyclesPolicy {
        /// Two neighbouring cycles belong to one block if their periods differ by less than this fraction of the larger, and their
        /// amplitudes too.
        alike: f64 = 0.08, Tuned("the blind trial and the recordings of others");
        /// Two blocks have the same amplitude if their amplitudes differ by less than this fraction of the larger.
        same_amplitude: f64 = 0.06, Tuned("the blind trial");
        /// A motion with more amplitudes than this has no levels of amplitude: one set of coefficients of the law holds for all of them.
        most_amplitudes: usize = 8, Convention("a test with more is a sweep of the amplitude");
        /// The boundary of a block moves to a kink of the motion (a jump of the velocity) that is at most this many samples away.
        snap: usize = 2, Derived("noise may move a crossing by one sample, and a kink too");
    }
}

/// One cycle of displacement, from one crossing of the mid level to the next in the same direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Samples of the cycle.
    pub samples: Range<usize>,
    /// Length, s.
    pub period: f64,
    /// Half of the difference between the largest and the smallest displacement, mm.
    pub amplitude: f64,
    /// Largest distance from the mid level, mm: more than the amplitude if that grows within the cycle.
    pub reach: f64,
}

impl Cycle {
    fn is_like(&self, other: &Self) -> bool {
        alike(self.period, other.period) && alike(self.amplitude, other.amplitude)
    }
}

/// Consecutive cycles of nearly equal amplitude and frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundBlock {
    /// Samples of the block. Blocks follow each other without a gap and cover the recording.
    pub samples: Range<usize>,
    /// Its whole cycles.
    pub cycles: Vec<Range<usize>>,
    /// Median amplitude of its cycles, mm; of a single cycle its reach, which is the amplitude to which it grows.
    pub amplitude: f64,
    /// Median frequency of its cycles, Hz.
    pub frequency: f64,
}

/// The cycles and blocks of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycles {
    /// Whole cycles in order. Empty if the displacement does not swing through its mid level twice.
    pub cycles: Vec<Cycle>,
    /// Blocks in order; at least one.
    pub blocks: Vec<FoundBlock>,
}

impl Cycles {
    /// Finds the cycles of `displacement` in mm, sampled every `tick` s.
    ///
    /// A crossing of the mid level counts if the displacement then leaves a band of ±`hysteresis` mm around it on the other side.
    /// Cycles run from upward crossing to upward crossing, or from downward to downward in a test that starts downwards from there,
    /// because the test changes its blocks at such crossings.
    pub fn find(displacement: &[f64], tick: f64, hysteresis: f64) -> Self {
        let level = level_of(displacement, hysteresis);
        let leaves = displacement
            .iter()
            .position(|y| (y - level).abs() > hysteresis);
        let sets_out_downwards =
            leaves.is_some_and(|index| index > 0 && displacement[index] < level);
        if sets_out_downwards {
            let mirrored: Vec<f64> = displacement.iter().map(|y| -y).collect();
            return Self::between_upward(&mirrored, tick, -level, hysteresis);
        }
        Self::between_upward(displacement, tick, level, hysteresis)
    }

    fn between_upward(displacement: &[f64], tick: f64, level: f64, hysteresis: f64) -> Self {
        let count = displacement.len();
        let (low, high) = least_and_largest(displacement);
        let crossings = upward_crossings(displacement, level, hysteresis);
        let cycle = |start: f64, end: f64| {
            let samples = (start.ceil() as usize)..(end.ceil() as usize);
            let (low, high) = least_and_largest(&displacement[samples.clone()]);
            Cycle {
                samples,
                period: (end - start) * tick,
                amplitude: 0.5 * (high - low),
                reach: (high - level).max(level - low),
            }
        };
        let between = crossings.windows(2).map(|pair| cycle(pair[0], pair[1]));
        let mut cycles: Vec<Cycle> = between.collect();
        if are_mostly_single(&runs_of_like(&cycles))
            && let Some(end) = ends_a_cycle(displacement, level, hysteresis, &crossings)
        {
            cycles.extend(crossings.last().map(|&last| cycle(last, end)));
        }
        let blocks = group(&cycles, count, tick, 0.5 * (high - low));
        Self { cycles, blocks }
    }

    /// The dominant period around every one of `count` samples, s: that of the cycle that contains the sample, or of the nearest.
    pub fn period_per_sample(&self, count: usize, tick: f64) -> Vec<f64> {
        let mut period = vec![count as f64 * tick; count];
        let (Some(first), Some(last)) = (self.cycles.first(), self.cycles.last()) else {
            return period;
        };
        period[..first.samples.start].fill(first.period);
        period[last.samples.end..].fill(last.period);
        for cycle in &self.cycles {
            period[cycle.samples.clone()].fill(cycle.period);
        }
        period
    }

    /// Cycles since the first sample, fraction included, at every one of `count` samples.
    pub fn elapsed(&self, count: usize, tick: f64) -> Vec<f64> {
        let mut total = 0.0;
        self.period_per_sample(count, tick)
            .iter()
            .map(|period| {
                let now = total;
                total += tick / period;
                now
            })
            .collect()
    }

    /// The amplitude of the block that contains each of `count` samples, mm; for a block of one cycle the [level](levels) of such
    /// amplitudes.
    pub fn amplitude_per_sample(&self, count: usize) -> Vec<f64> {
        let is_single = |block: &&FoundBlock| block.cycles.len() == 1;
        let single = self.blocks.iter().filter(is_single);
        let levels = levels(single.map(|block| block.amplitude));
        let mut amplitude = vec![0.0; count];
        for block in &self.blocks {
            let off = |level: &&f64| (**level - block.amplitude).abs();
            let level = levels.iter().filter(|_| is_single(&block));
            let level = level.min_by(|a, b| off(a).total_cmp(&off(b)));
            amplitude[block.samples.clone()].fill(*level.unwrap_or(&block.amplitude));
        }
        amplitude
    }

    /// Moves the boundaries of blocks and of their cycles onto kinks within two samples of them: a programme changes blocks where
    /// the velocity jumps, and a crossing found in noise may be off by a sample.
    pub fn snap_to(&mut self, kinks: &[usize]) {
        let snapped = |boundary: usize| {
            let near = kinks
                .iter()
                .copied()
                .find(|kink| kink.abs_diff(boundary) <= CyclesPolicy::in_use().snap);
            near.unwrap_or(boundary)
        };
        for block in &mut self.blocks {
            for range in block.cycles.iter_mut().chain([&mut block.samples]) {
                *range = snapped(range.start)..snapped(range.end);
            }
        }
    }
}

/// The level about which a motion swings, mm. It is the middle of its range, or zero if the first sample is nearer to that: a test
/// starts from there, and its largest swing may be on one side.
fn level_of(displacement: &[f64], hysteresis: f64) -> f64 {
    let (low, high) = least_and_largest(displacement);
    let middle = 0.5 * (low + high);
    let first = displacement.first().copied().unwrap_or_default();
    let sets_out_from_zero = first.abs() + hysteresis < (first - middle).abs();
    if sets_out_from_zero { 0.0 } else { middle }
}

/// Positions, in samples, where the displacement passes `level` upwards.
fn upward_crossings(displacement: &[f64], level: f64, hysteresis: f64) -> Vec<f64> {
    let mut crossings = Vec::new();
    let mut below = displacement
        .first()
        .is_some_and(|&y| y <= level + hysteresis);
    let mut candidate = Some(0.0).filter(|_| below && displacement[0] > level - hysteresis);
    for index in 1..displacement.len() {
        let (before, now) = (displacement[index - 1] - level, displacement[index] - level);
        if now < -hysteresis {
            below = true;
            candidate = None;
        }
        if below && before <= 0.0 && now > 0.0 {
            candidate = Some(index as f64 - 1.0 + before / (before - now));
        }
        if below && now > hysteresis {
            crossings.extend(candidate.take());
            below = false;
        }
    }
    crossings
}

/// The end of a recording if it ends a cycle: at the level, one period after the last of `crossings`. Its upward continuation is
/// not in the recording.
fn ends_a_cycle(
    displacement: &[f64],
    level: f64,
    hysteresis: f64,
    crossings: &[f64],
) -> Option<f64> {
    let &[.., before, last] = crossings else {
        return None;
    };
    let end = displacement.len() as f64;
    let is_there = (displacement.last()? - level).abs() <= hysteresis;
    (is_there && alike(last - before, end - last)).then_some(end)
}

/// Whether two periods, frequencies or amplitudes belong to one block.
pub fn alike(a: f64, b: f64) -> bool {
    (a - b).abs() < CyclesPolicy::in_use().alike * a.abs().max(b.abs())
}

/// Whether two amplitudes in mm are the same: amplitudes with separate coefficients of the law lie further apart.
pub fn same_amplitude(a: f64, b: f64) -> bool {
    (a - b).abs() < CyclesPolicy::in_use().same_amplitude * a.max(b)
}

/// The levels in mm of these amplitudes, in order: the means of those that are the same.
pub fn levels(amplitudes: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut amplitudes: Vec<f64> = amplitudes.collect();
    amplitudes.sort_by(f64::total_cmp);
    let mut levels: Vec<Vec<f64>> = Vec::new();
    for amplitude in amplitudes {
        match levels.last_mut() {
            Some(level) if same_amplitude(level[0], amplitude) => level.push(amplitude),
            _ => levels.push(vec![amplitude]),
        }
    }
    let mean = |level: &Vec<f64>| level.iter().sum::<f64>() / level.len() as f64;
    levels.iter().map(mean).collect()
}

/// Groups cycles into blocks. A cycle that differs from both neighbours is the transition into the next block. If most cycles do,
/// each is a block.
fn group(cycles: &[Cycle], count: usize, tick: f64, half_range: f64) -> Vec<FoundBlock> {
    let mut runs = runs_of_like(cycles);
    if !are_mostly_single(&runs) {
        runs = without_transitions(runs);
    }

    let bounds: Vec<usize> = runs
        .iter()
        .enumerate()
        .map(|(i, run)| {
            if i == 0 || run.is_empty() {
                0
            } else {
                cycles[run.start].samples.start
            }
        })
        .chain([count])
        .collect();
    runs.iter()
        .zip(bounds.windows(2))
        .map(|(run, bound)| FoundBlock {
            samples: bound[0]..bound[1],
            cycles: cycles[run.clone()]
                .iter()
                .map(|c| c.samples.clone())
                .collect(),
            amplitude: match &cycles[run.clone()] {
                [] => half_range,
                [single] => single.reach,
                several => median(several.iter().map(|c| c.amplitude)).unwrap_or(half_range),
            },
            frequency: median(cycles[run.clone()].iter().map(|c| 1.0 / c.period))
                .unwrap_or(1.0 / (count as f64 * tick)),
        })
        .collect()
}

/// Runs of cycles, each equal to the one before; one empty run for no cycles.
fn runs_of_like(cycles: &[Cycle]) -> Vec<Range<usize>> {
    let mut starts = vec![0];
    starts.extend((1..cycles.len()).filter(|&index| !cycles[index - 1].is_like(&cycles[index])));
    starts.push(cycles.len());
    starts.windows(2).map(|pair| pair[0]..pair[1]).collect()
}

/// Whether at least half of the cycles differ from both neighbours.
fn are_mostly_single(runs: &[Range<usize>]) -> bool {
    let single = runs.iter().filter(|run| run.len() == 1).count();
    2 * single >= runs.last().map_or(0, |last| last.end)
}

/// A single cycle joins the block after it, and the last one that before it.
fn without_transitions(all: Vec<Range<usize>>) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for run in all {
        match runs.last_mut() {
            Some(transition) if transition.len() == 1 && run.len() > 1 => transition.end = run.end,
            _ => runs.push(run),
        }
    }
    if let [.., before, last] = runs.as_mut_slice()
        && last.len() == 1
        && before.len() > 1
    {
        before.end = last.end;
        runs.pop();
    }
    runs
}

/// The upper one of two in the middle; `None` for no values.
pub fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    (!values.is_empty()).then(|| quantile(&mut values, 0.5))
}

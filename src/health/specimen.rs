//! The specimen from cycle to cycle: its normal state, its changes, and their causes.
//!
//! ```text
//!                               ┌─────────── drift ───────────┐
//!                               │                             ▼
//! settling ──▶ learning ──▶ watching ──▶ suspecting ──▶ (an event, until cleared)
//!    ▲ another block            ▲             │
//!    └───────────────           └─────────────┘ the change has gone
//! ```
//!
//! While watching, the deviation of each cycle from its [`Baseline`] goes into the [`Cusum`]s. The baselines follow one cycle late,
//! and stand still as long as any sum is above 0. They thus do not take a fault for normal, nor the cycle in which it began. Two
//! cycles after the alarm, when no cycle is left that the fault covers only in part, the changes are classified by their pattern; a
//! mean that was already moving before is reported as a drift at once. In addition, the changes that the baselines have followed
//! must not lead away from their level at the end of the run-in.
//!
//! The work at a cycle's end is done one statistic per look, where the response leaves room for it.

mod alarm;
mod evidence;
mod learning;
mod slow;

use super::HealthConfig;
use super::baseline::Baseline;
use super::cusum::{Cusum, threshold};
use super::event::{Event, Statistic};
use super::pattern::Shift;
use super::sums::CycleSums;
use alarm::EXPLAINED;
use learning::{EARLY, EARLY_CYCLES};

/// Cycles at the beginning of a block that are left out, while the rig's correction learns.
const SETTLING: u32 = 2;
/// Cycles from an alarm to its classification.
const JUDGED_AFTER: u32 = 2;
/// Lower limit of σ, as a part of the size to be found: below it noise is irrelevant.
const LEAST_SIGMA: f32 = 1.0 / 20.0;
/// Uncertainty of the line itself in σ, at a gain of its level of α = 1/4: √(α/(2 − α)).
const UNSURE: f32 = 0.38;
/// The first statistics, on which a mean has no effect.
const UNMOVED: usize = 2;
/// Gain of the temperature's level.
const TEMPERATURE_GAIN: f32 = 0.25;

/// Results of one cycle that do not come from [`CycleSums`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CycleNumbers {
    /// Energy of the measured force and of the running law, J.
    pub(super) energy: f32,
    pub(super) law_energy: f32,
    /// Mean of the measured force minus that of the running law, kN.
    pub(super) mean: f32,
    /// Mean of the command, mm.
    pub(super) command: f32,
    /// Temperature, °C.
    pub(super) temperature: f32,
    /// Cycles completed since the start.
    pub(super) cycle: u32,
}

/// An alarm that waits for its classification.
#[derive(Clone, Copy, Debug)]
struct Suspicion {
    cycles: u32,
    limit: f32,
    /// The mean force, a cycle ago.
    mean: f32,
}

/// State of one statistic.
#[derive(Clone, Copy, Debug, Default)]
struct Watch {
    baseline: Baseline,
    cusum: Cusum,
    /// H.
    threshold: f32,
    /// Level of the baseline at the end of the run-in.
    reference: f32,
    /// Level at the end of learning.
    learned: f32,
}

/// All statistics of whole cycles.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpecimenWatch {
    sums: CycleSums,
    numbers: CycleNumbers,
    /// Next piece of work; [`IDLE`] if there is none.
    piece: usize,
    /// Values of this cycle, and of the one before.
    values: Shift,
    before: Shift,
    /// Third harmonic divided by the first of the law's force in phase with displacement, of the cycle before and of this one.
    law_thirds: [f32; 2],
    watches: [Watch; Statistic::OF_CYCLES],
    /// Cycles of this motion.
    cycles: u32,
    /// Of those, the cycles to leave out since the motion resumed after another one.
    left_out: u32,
    /// Cycles since the start that were not left out.
    since_start: u32,
    suspicion: Option<Suspicion>,
    /// A statistic has changed a lot while it is learned, in this cycle and in the one before; its line has followed neither.
    early: bool,
    /// The normal state before a passing fault became normal, or before it ended.
    known: Option<Shift>,
    /// Cycles for which a drift still explains changes of the mean.
    explained: u8,
    /// Whether a sum is above 0.
    frozen: bool,
    temperature: f32,
    reference_temperature: f32,
    /// Temperature at the end of learning, °C.
    learned_temperature: f32,
}

/// Ratio of the specimen to the law, at least 1, for a specimen whose stiffness or energy differs from the law's by `level`. A part
/// of the specimen is this many times as large a part of the law.
fn of_law(level: f32) -> f32 {
    if level > 0.0 { 1.0 + level } else { 1.0 }
}

/// Pieces of work: the statistics, one sum each, the conclusion, one baseline each.
const FIRST_SUM: usize = 1;
const CONCLUSION: usize = FIRST_SUM + Statistic::WATCHED;
const FIRST_BASELINE: usize = CONCLUSION + 1;
const IDLE: usize = FIRST_BASELINE + Statistic::OF_CYCLES;

impl SpecimenWatch {
    /// A watch before its first cycle.
    pub(super) fn new() -> Self {
        Self {
            sums: CycleSums::default(),
            numbers: CycleNumbers::default(),
            piece: IDLE,
            values: Shift::default(),
            before: Shift::default(),
            law_thirds: [0.0; 2],
            watches: [Watch::default(); Statistic::OF_CYCLES],
            cycles: 0,
            left_out: 0,
            since_start: 0,
            suspicion: None,
            early: false,
            known: None,
            explained: 0,
            frozen: false,
            temperature: 0.0,
            reference_temperature: 0.0,
            learned_temperature: 0.0,
        }
    }

    /// Another block, or the present condition becomes the normal one: learns again. Whether the run-in is over stays.
    pub(super) fn relearn(&mut self) {
        *self = Self {
            since_start: self.since_start,
            ..Self::new()
        };
    }

    /// Learns again after a passing fault has become normal, or has ended. A break in between is reported at the end of that
    /// learning.
    pub(super) fn relearn_beside(&mut self, config: &HealthConfig) {
        if self.is_watching(config) {
            self.known = Some(self.watches.map(|watch| watch.baseline.expected()));
        }
        let known = self.known;
        self.relearn();
        self.known = known;
    }

    /// The same motion resumes after another one or after a ramp.
    pub(super) fn resume(&mut self) {
        self.left_out = SETTLING;
        self.suspicion = None;
        self.clear_sums();
    }

    /// Whether this cycle is the first one of the learning.
    pub(super) fn begins_to_learn(&self) -> bool {
        self.cycles == SETTLING
    }

    /// Whether the cycle that has ended, all of whose work is done, is normal.
    pub(super) fn is_sound(&self, config: &HealthConfig) -> bool {
        self.is_watching(config) && !self.frozen && self.suspicion.is_none()
    }

    /// Whether it has learned the normal state.
    pub(super) fn is_watching(&self, config: &HealthConfig) -> bool {
        self.cycles >= SETTLING + config.learning_cycles
    }

    /// Takes a steady cycle that has ended. The cycle is left out if the work of the one before is not done, because a cycle may
    /// have fewer ticks than that takes.
    pub(super) fn cycle(&mut self, sums: CycleSums, numbers: CycleNumbers) {
        if self.has_work() {
            return;
        }
        if self.left_out > 0 && self.cycles > SETTLING {
            self.left_out -= 1;
            return;
        }
        self.cycles = self.cycles.saturating_add(1);
        if self.cycles <= SETTLING {
            return;
        }
        self.since_start = self.since_start.saturating_add(1);
        self.explained = self.explained.saturating_sub(1);
        self.sums = sums;
        self.numbers = numbers;
        self.piece = 0;
    }

    /// Whether there is work left.
    #[inline(always)]
    pub(super) fn has_work(&self) -> bool {
        self.piece < IDLE
    }

    /// Does a piece of work, and returns its event.
    pub(super) fn work(&mut self, config: &HealthConfig) -> Option<Event> {
        let piece = self.piece;
        self.piece += 1;
        if piece == 0 {
            self.take_values();
            None
        } else if piece < CONCLUSION {
            self.sum(config, piece - FIRST_SUM);
            None
        } else if piece == CONCLUSION {
            let event = self.conclude(config)?;
            self.explain(event)
        } else {
            self.follow(piece - FIRST_BASELINE);
            None
        }
    }

    fn take_values(&mut self) {
        let numbers = &self.numbers;
        // The learning ended with the cycle before.
        self.frozen = false;
        self.early = false;
        match self.sums.in_phase() {
            Some(in_phase) if numbers.law_energy > f32::MIN_POSITIVE => {
                self.before = self.values;
                let [_, before] = self.law_thirds;
                self.law_thirds = [before, in_phase.law_third];
                self.values = [
                    in_phase.stiffness,
                    numbers.energy / (self.sums.given_energy() * numbers.law_energy) - 1.0,
                    (numbers.mean + self.sums.mean_share()) / in_phase.force,
                    self.sums.residual(),
                    in_phase.third,
                    numbers.command / in_phase.amplitude,
                ];
            }
            // Without motion or without a law, there is no cycle to learn from or to follow.
            _ => {
                self.piece = IDLE;
                self.frozen = true;
            }
        }
        if self.cycles == SETTLING + 1 {
            self.temperature = numbers.temperature;
        }
    }

    /// Possible effect of the temperature's change since `then` °C on a statistic of a specimen like the law.
    fn warmth(&self, config: &HealthConfig, then: f32) -> f32 {
        config.temperature_slope * (self.numbers.temperature - then).abs()
    }

    fn sum(&mut self, config: &HealthConfig, index: usize) {
        let learned = self.cycles > SETTLING + config.learning_cycles;
        let last = self.cycles == SETTLING + config.learning_cycles;
        let slack = 0.5 * config.size;
        let warmth = self.warmth(config, self.temperature);
        let value = self.values.get(index).copied().unwrap_or_default();
        let Some(watch) = self.watches.get_mut(index) else {
            return;
        };
        let warmth = warmth * of_law(watch.baseline.level());
        let allowed = slack + warmth + UNSURE * watch.baseline.deviation();
        if learned {
            let error = value - watch.baseline.expected();
            watch.cusum.update(error, allowed);
            self.frozen |= watch.cusum.largest() > 0.0;
        } else if last {
            let deviation = watch.baseline.deviation();
            let least = LEAST_SIGMA * config.size;
            let sigma = if deviation > least { deviation } else { least };
            watch.threshold = threshold(sigma, slack, config.run_length);
            watch.learned = watch.baseline.level();
        } else if self.cycles >= SETTLING + EARLY_CYCLES + 2 {
            let limit = warmth + EARLY * config.size;
            // The level, not its extrapolation: after so few cycles the slope is that of the noise.
            let expected = watch.baseline.level();
            let before = self.before.get(index).copied().unwrap_or_default();
            let (now, before) = (value - expected, before - expected);
            self.early |= now * before > limit * limit;
        }
    }

    fn conclude(&mut self, config: &HealthConfig) -> Option<Event> {
        if self.cycles <= SETTLING + config.learning_cycles {
            if self.early {
                return Some(self.report_early(config));
            }
            return self
                .compare_with_law()
                .or_else(|| self.compare_with_known(config));
        }
        if let Some(suspicion) = self.suspicion {
            self.frozen = true;
            return self.judge(config, suspicion);
        }
        let shift = self.beyond(self.values);
        let [_, _, mean, ..] = shift;
        let alarm = self
            .watches
            .iter()
            .take(Statistic::WATCHED)
            .find(|watch| watch.cusum.largest() > watch.threshold)
            .map(|watch| 0.5 * config.size + watch.threshold);
        if let Some(limit) = alarm {
            if let Some(event) = self.drift(config, &shift, limit) {
                return Some(event);
            }
            self.suspicion = Some(Suspicion {
                cycles: JUDGED_AFTER,
                limit,
                mean,
            });
            return None;
        }
        if self.frozen {
            None
        } else {
            self.look_back(config)
        }
    }

    fn clear_sums(&mut self) {
        for watch in &mut self.watches {
            watch.cusum = Cusum::default();
        }
    }

    fn follow(&mut self, index: usize) {
        // One cycle late: the first cycle of a fault may have been partly normal.
        let value = self.before.get(index).copied().unwrap_or_default();
        if self.cycles == SETTLING + 1 {
            return;
        }
        if let Some(watch) = self.watches.get_mut(index) {
            // A drift was found in this cycle. It changes neither stiffness nor energy, in which another fault may show.
            if self.explained == EXPLAINED && index >= UNMOVED {
                let value = self.values.get(index).copied().unwrap_or_default();
                watch.baseline.place(value);
                watch.learned = value;
                watch.reference = value;
            } else if self.frozen {
                watch.baseline.coast();
            } else {
                watch.baseline.follow(value);
            }
        }
        if index == 0 {
            let gain = if self.frozen { 0.0 } else { TEMPERATURE_GAIN };
            self.temperature += gain * (self.numbers.temperature - self.temperature);
        }
    }
}

#[cfg(test)]
mod tests;

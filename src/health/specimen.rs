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

use super::HealthConfig;
use super::baseline::Baseline;
use super::cause::{Course, Event, HealthCause, Shift, Statistic, Verdict, cause, reversed};
use super::cusum::{Cusum, threshold};
use super::sums::CycleSums;

/// Cycles at the beginning of a block that are left out, while the rig's correction learns.
const SETTLING: u32 = 2;
/// Cycles from an alarm to its classification.
const JUDGED_AFTER: u32 = 2;
/// Lower limit of σ, as a part of the size to be found: below it noise is irrelevant.
const LEAST_SIGMA: f32 = 1.0 / 20.0;
/// Uncertainty of the line itself in σ, at a gain of its level of α = 1/4: √(α/(2 − α)).
const UNSURE: f32 = 0.38;
/// Part of the size to be found that a slow change may have.
const SLOW: f32 = 0.8;
/// Part of a shift by which a gradual one grows in one cycle.
const GROWING: f32 = 0.12;
/// Part of a gradual shift that was present a cycle before.
const DRIFTING: f32 = 0.6;
/// Cycles after a drift, or after a change of the mean that it explains, in which the drift explains further changes of the mean.
const EXPLAINED: u8 = 16;
/// The first statistics, on which a mean has no effect.
const UNMOVED: usize = 2;
/// Change in sizes at which a statistic is reported while it is still learned, when the line through its first cycles is young.
const EARLY: f32 = 3.0;
/// Fewest cycles of a line for such a report: the first ones still belong to the amplitude correction.
const EARLY_CYCLES: u32 = 5;
/// Least stiffness or energy of the specimen at the start, relative to the law's; its inverse is the largest.
const LEAST_OF_LAW: f32 = 0.6;
/// Gain of the temperature's level.
const TEMPERATURE_GAIN: f32 = 0.25;

/// Results of one cycle that do not come from [`CycleSums`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CycleNumbers {
    /// Energy of the measured force and of the law in force, J.
    pub(super) energy: f32,
    pub(super) law_energy: f32,
    /// Mean of the measured force minus that of the law in force, kN.
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

    /// In the first cycle since the start: compares the specimen roughly with the law.
    fn compare_with_law(&self) -> Option<Event> {
        if self.since_start != 1 {
            return None;
        }
        let [stiffness, energy, ..] = self.values;
        let limit = 1.0 - LEAST_OF_LAW;
        let is_far =
            |moved: f32| !(1.0 + moved >= LEAST_OF_LAW && LEAST_OF_LAW * (1.0 + moved) <= 1.0);
        let (cause, or) = if stiffness < -1.0 && energy < -1.0 {
            reversed()
        } else if is_far(stiffness) || is_far(energy) {
            let gain = HealthCause::SensorGain(super::Channel::Force);
            (HealthCause::LawMismatch, gain)
        } else {
            return None;
        };
        let statistic = if is_far(stiffness) {
            Statistic::Stiffness
        } else {
            Statistic::Energy
        };
        Some(self.evidence((cause, Some(or), statistic), &self.values, limit))
    }

    /// At the end of learning: compares the specimen with its state before.
    fn compare_with_known(&mut self, config: &HealthConfig) -> Option<Event> {
        if self.cycles < SETTLING + config.learning_cycles {
            return None;
        }
        let known = self.known.take()?;
        let limit = EARLY * config.size + self.warmth(config, self.temperature);
        let mut shift = known;
        for (moved, watch) in shift.iter_mut().zip(&self.watches) {
            *moved = watch.baseline.level() - *moved;
        }
        let [stiffness, energy, ..] = shift;
        let is_far = stiffness.abs() > limit || energy.abs() > limit;
        is_far.then(|| self.event(&shift, Course::Step, limit))
    }

    /// While learning: reports a shift that is too large for a run-in.
    #[cold]
    #[inline(never)]
    fn report_early(&mut self, config: &HealthConfig) -> Event {
        let limit = EARLY * config.size + self.warmth(config, self.temperature);
        let shift = self.beyond(self.mean_values());
        let event = self.event(&shift, Course::Step, limit);
        self.relearn();
        event
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

    /// A drifting zero moves the mean and keeps moving it. The present mean becomes normal, and a shift soon after belongs to the
    /// drift.
    fn explain(&mut self, event: Event) -> Option<Event> {
        let explained = event.cause == HealthCause::PreloadShift && self.explained > 0;
        if explained || matches!(event.cause, HealthCause::SensorDrifting(_)) {
            self.explained = EXPLAINED;
        }
        (!explained).then_some(event)
    }

    /// A mean force that had most of its change a cycle before its alarm, at which the statistics have changed by `shift`. A sudden
    /// change of the size to be found had at most half of its value by then; with more there would have been an alarm, where noise
    /// and warmth leave the limit near half of that size.
    fn drift(&mut self, config: &HealthConfig, shift: &Shift, limit: f32) -> Option<Event> {
        let [_, _, watch, ..] = &self.watches;
        let ([_, _, mean, ..], [_, _, before, ..]) = (*shift, self.before);
        let beyond = before - watch.baseline.expected();
        let blurred = watch.threshold + self.warmth(config, self.temperature);
        if watch.cusum.largest() <= watch.threshold
            || blurred > (DRIFTING - 0.5) * config.size
            || beyond * mean <= DRIFTING * mean * mean
        {
            return None;
        }
        let event = self.event(shift, Course::Slow, limit);
        if event.statistic != Statistic::MeanForce {
            return None;
        }
        self.clear_sums();
        Some(event)
    }

    /// Deviation of `values` from the baselines.
    // Not inlined, like others below: several functions call it, none on every tick, and flash is scarce.
    #[inline(never)]
    fn beyond(&self, values: Shift) -> Shift {
        let mut shift = values;
        for (value, watch) in shift.iter_mut().zip(&self.watches) {
            *value -= watch.baseline.expected();
        }
        shift
    }

    fn clear_sums(&mut self) {
        for watch in &mut self.watches {
            watch.cusum = Cusum::default();
        }
    }

    /// Mean of this cycle's values and of those of the one before.
    #[inline(never)]
    fn mean_values(&self) -> Shift {
        let mut mean = self.values;
        for (value, before) in mean.iter_mut().zip(&self.before) {
            *value = 0.5 * (*value + before);
        }
        mean
    }

    /// The mean as in [`SpecimenWatch::mean_values`].
    fn law_third(&self) -> f32 {
        let [before, now] = self.law_thirds;
        0.5 * (before + now)
    }

    /// A cycle after an alarm.
    fn judge(&mut self, config: &HealthConfig, suspicion: Suspicion) -> Option<Event> {
        let [_, _, mean, ..] = self.beyond(self.values);
        let growth = mean - suspicion.mean;
        self.suspicion = Some(Suspicion {
            cycles: suspicion.cycles.saturating_sub(1),
            mean,
            ..suspicion
        });
        if suspicion.cycles > 1 {
            return None;
        }
        self.suspicion = None;
        // Averaging two cycles halves the variance of the noise.
        let shift = self.beyond(self.mean_values());
        self.clear_sums();
        let least = 0.5 * config.size + self.warmth(config, self.temperature);
        let watched = || shift.iter().take(Statistic::WATCHED);
        if watched().all(|moved| moved.abs() <= least) {
            return None;
        }
        let course = if growth * mean > 0.0 && growth.abs() > GROWING * mean.abs() {
            Course::Slow
        } else {
            Course::Step
        };
        Some(self.event(&shift, course, suspicion.limit))
    }

    #[inline(never)]
    fn event(&self, shift: &Shift, course: Course, limit: f32) -> Event {
        let verdict = cause(shift, self.law_third(), course);
        self.evidence(verdict, shift, limit)
    }

    fn evidence(&self, (cause, or, statistic): Verdict, shift: &Shift, limit: f32) -> Event {
        let index = usize::from(statistic.place());
        Event {
            cause,
            or,
            statistic,
            value: shift.get(index).copied().unwrap_or_default(),
            limit,
            cycle: self.numbers.cycle,
        }
    }

    /// The baselines' change since the run-in, or since they were learned if that came later.
    fn look_back(&mut self, config: &HealthConfig) -> Option<Event> {
        let limit = SLOW * config.size;
        let settled = self.since_start > config.run_in_cycles;
        let ends = self.since_start == config.run_in_cycles;
        let first = self.cycles == SETTLING + config.learning_cycles + 1;
        let mut shift = self.mean_values();
        let mut all = Statistic::ALL.into_iter();
        for (moved, watch) in shift.iter_mut().zip(&mut self.watches) {
            // Neither a run-in nor the temperature moves a mean.
            let lasting = matches!(
                all.next(),
                Some(Statistic::MeanForce | Statistic::MeanCommand)
            );
            if !lasting {
                // The level of the line, because the noise of one or two cycles exceeds a slow change.
                *moved = watch.baseline.level();
            }
            *moved -= if settled && !lasting {
                watch.reference
            } else {
                watch.learned
            };
            if !settled || first {
                watch.reference = watch.baseline.level();
            }
        }
        if !settled || first {
            self.reference_temperature = self.numbers.temperature;
        }
        if first {
            self.learned_temperature = self.numbers.temperature;
            return None;
        }
        let [_, _, mean, ..] = shift;
        if mean.abs() > limit {
            return Some(self.event(&shift, Course::Slow, limit));
        }
        let watched = Statistic::ALL
            .into_iter()
            .zip(&shift)
            .take(Statistic::WATCHED);
        let (most, moved) = watched.fold((Statistic::Stiffness, 0.0f32), |most, (other, moved)| {
            if moved.abs() > most.1 {
                (other, moved.abs())
            } else {
                most
            }
        });
        if moved <= limit {
            None
        } else if ends {
            Some(self.evidence((HealthCause::RunIn, None, most), &shift, limit))
        } else if !settled {
            let warmth = self.warmth(config, self.learned_temperature);
            let allowed = config.run_in_size + self.of_specimen(most, warmth);
            (moved > allowed).then(|| self.slow(&shift, most, allowed))
        } else {
            let warmth = self.warmth(config, self.reference_temperature);
            let warmth = self.of_specimen(most, warmth);
            // A change that the adaptation may take up is no fault.
            let followed = if config.follow > limit {
                config.follow
            } else {
                limit
            };
            let allowed = followed + warmth;
            if moved > allowed {
                Some(self.slow(&shift, most, allowed))
            } else if moved > limit + warmth {
                None
            } else {
                Some(self.evidence((HealthCause::Temperature, None, most), &shift, limit))
            }
        }
    }

    /// Converts `warmth` of a specimen like the law to this specimen, for `statistic`.
    fn of_specimen(&self, statistic: Statistic, warmth: f32) -> f32 {
        let watch = self.watches.get(usize::from(statistic.place()));
        warmth * watch.map_or(1.0, |watch| of_law(watch.baseline.level()))
    }

    /// Event for a slow change beyond `allowed` of the statistic `most`, which is the evidence. The cause may follow from another
    /// statistic.
    fn slow(&self, shift: &Shift, most: Statistic, allowed: f32) -> Event {
        let (cause, or, _) = cause(shift, self.law_third(), Course::Slow);
        self.evidence((cause, or, most), shift, allowed)
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

//! The specimen from cycle to cycle: what is normal, what has moved, and why.
//!
//! ```text
//!                               ┌──────── what drifts ────────┐
//!                               │                             ▼
//! settling ──▶ learning ──▶ watching ──▶ suspecting ──▶ (an event, until cleared)
//!    ▲ another block            ▲             │
//!    └───────────────           └─────────────┘ what moved has moved back
//! ```
//!
//! While watching, what a cycle gives beyond its [`Baseline`] goes into the [`Cusum`]s. The baselines follow a cycle late, and
//! stand still as long as any sum is above 0, so that they do not take a fault for normal, nor the cycle in which it began. Two
//! cycles after the alarm, when no cycle is left that was only in part another, what has moved is judged by its pattern; a mean
//! that was on its way before is a drift at once. Beside that, whatever the baselines have followed must not lead away from
//! where they were when the run-in was over.
//!
//! The work of one cycle's end is done a statistic a look, where the response leaves room for it.

use super::HealthConfig;
use super::baseline::Baseline;
use super::cause::{Course, Event, HealthCause, Shift, Statistic, Verdict, cause, reversed};
use super::cusum::{Cusum, threshold};
use super::sums::CycleSums;

/// Cycles at the beginning of a block that are left out, while the rig's correction learns.
const SETTLING: u32 = 2;
/// Cycles from an alarm to its judgement.
const JUDGED_AFTER: u32 = 2;
/// σ is at least this part of the size to be found: less than that is no matter of noise.
const LEAST_SIGMA: f32 = 1.0 / 20.0;
/// σ by which the line itself is off, at a gain of its level of α = 1/4: √(α/(2 − α)).
const UNSURE: f32 = 0.38;
/// Part of the size to be found that may have come about slowly.
const SLOW: f32 = 0.8;
/// Part of a shift by which it grows in one cycle where it comes bit by bit.
const GROWING: f32 = 0.12;
/// Part of a shift from which it was there a cycle before where it comes bit by bit.
const DRIFTING: f32 = 0.6;
/// Cycles after a drift, or a mean that it explains, in which it explains what the mean does.
const EXPLAINED: u8 = 16;
/// The first statistics, which a mean does not move.
const UNMOVED: usize = 2;
/// Sizes by which a statistic must have moved for it to be told while it is still learned, when the line through its first cycles is young.
const EARLY: f32 = 3.0;
/// Cycles that a line needs at least for that: the first ones are still those of amplitude's correction.
const EARLY_CYCLES: u32 = 5;
/// Part of the law's stiffness or energy that the specimen must have at the start, and one over what it may have.
const LEAST_OF_LAW: f32 = 0.6;
/// Of the temperature's level.
const TEMPERATURE_GAIN: f32 = 0.25;

/// One cycle, as far as it does not come from [`CycleSums`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CycleNumbers {
    /// Energy of the measured force and of the law's as it is in force, J.
    pub(super) energy: f32,
    pub(super) law_energy: f32,
    /// Mean of the measured force less that of the law's as it is in force, kN.
    pub(super) mean: f32,
    /// Mean of the command, mm.
    pub(super) command: f32,
    /// °C.
    pub(super) temperature: f32,
    /// Cycles completed since the start.
    pub(super) cycle: u32,
}

/// An alarm that waits for its judgement.
#[derive(Clone, Copy, Debug)]
struct Suspicion {
    cycles: u32,
    limit: f32,
    /// Of the mean force, a cycle ago.
    mean: f32,
}

/// What one statistic did.
#[derive(Clone, Copy, Debug, Default)]
struct Watch {
    baseline: Baseline,
    cusum: Cusum,
    /// H.
    threshold: f32,
    /// Where the baseline was when the run-in was over.
    reference: f32,
    /// Where it was when it had been learned.
    learned: f32,
}

/// All statistics of whole cycles.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpecimenWatch {
    sums: CycleSums,
    numbers: CycleNumbers,
    /// Next piece of work; [`IDLE`] where there is none.
    piece: usize,
    /// Of this cycle, and of the one before.
    values: Shift,
    before: Shift,
    /// Third harmonic over the first of the law's force in phase with displacement, of the one before and of this cycle.
    law_thirds: [f32; 2],
    watches: [Watch; Statistic::OF_CYCLES],
    /// Cycles of this motion.
    cycles: u32,
    /// Of those, to be left out since the motion went on after another one.
    left_out: u32,
    /// Cycles since the start that were not left out.
    since_start: u32,
    suspicion: Option<Suspicion>,
    /// A statistic has moved far while it is learned, in this cycle and in the one before, neither of which its line has followed.
    early: bool,
    /// What was normal before a passing fault came to be normal, or went.
    known: Option<Shift>,
    /// Cycles for which a drift still explains what the mean does.
    explained: u8,
    /// A sum is above 0.
    frozen: bool,
    temperature: f32,
    reference_temperature: f32,
    /// When it had been learned, °C.
    learned_temperature: f32,
}

/// How many times the law a specimen is, at least 1, whose stiffness or energy is by `level` beyond the law's: a part of it is as much more of
/// the law.
fn of_law(level: f32) -> f32 {
    if level > 0.0 { 1.0 + level } else { 1.0 }
}

/// Pieces: the statistics, a sum each, the conclusion, a baseline each.
const FIRST_SUM: usize = 1;
const CONCLUSION: usize = FIRST_SUM + Statistic::WATCHED;
const FIRST_BASELINE: usize = CONCLUSION + 1;
const IDLE: usize = FIRST_BASELINE + Statistic::OF_CYCLES;

impl SpecimenWatch {
    /// Before the first cycle.
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

    /// Another block, or what is now shall be normal: learns anew. Whether the run-in is over stays.
    pub(super) fn relearn(&mut self) {
        *self = Self {
            since_start: self.since_start,
            ..Self::new()
        };
    }

    /// Learns again after a passing fault has become normal, or has gone. A break in between is reported once that is learned.
    pub(super) fn relearn_beside(&mut self, config: &HealthConfig) {
        if self.is_watching(config) {
            self.known = Some(self.watches.map(|watch| watch.baseline.expected()));
        }
        let known = self.known;
        self.relearn();
        self.known = known;
    }

    /// The same motion goes on after another one or a ramp.
    pub(super) fn resume(&mut self) {
        self.left_out = SETTLING;
        self.suspicion = None;
        self.clear_sums();
    }

    /// Whether this cycle is the first that is learned.
    pub(super) fn begins_to_learn(&self) -> bool {
        self.cycles == SETTLING
    }

    /// Whether the cycle that has ended, all of whose work is done, is as it should be.
    pub(super) fn is_sound(&self, config: &HealthConfig) -> bool {
        self.is_watching(config) && !self.frozen && self.suspicion.is_none()
    }

    /// Whether it has learned what is normal.
    pub(super) fn is_watching(&self, config: &HealthConfig) -> bool {
        self.cycles >= SETTLING + config.learning_cycles
    }

    /// A steady cycle has ended. It is left out where the work of the one before is not done, as there may be fewer ticks to a
    /// cycle than that takes.
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

    /// Whether there is work.
    #[inline(always)]
    pub(super) fn has_work(&self) -> bool {
        self.piece < IDLE
    }

    /// A piece of work, and what came of it.
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
        // The learning is over with the cycle before.
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
            // Nothing moved, or there is no law: no cycle to learn from, nor to follow.
            _ => {
                self.piece = IDLE;
                self.frozen = true;
            }
        }
        if self.cycles == SETTLING + 1 {
            self.temperature = numbers.temperature;
        }
    }

    /// In the first cycle since the start: whether the specimen is anything like the law.
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

    /// As it has learned: whether the specimen is what it was before.
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

    /// While it learns: a shift so large that no run-in makes it.
    #[cold]
    #[inline(never)]
    fn tell_early(&mut self, config: &HealthConfig) -> Event {
        let limit = EARLY * config.size + self.warmth(config, self.temperature);
        let shift = self.beyond(self.mean_values());
        let event = self.event(&shift, Course::Step, limit);
        self.relearn();
        event
    }

    /// What temperature may have moved in a statistic of a specimen like the law since it was `then` °C.
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
            // Not where its slope leads: of so few cycles that is the noise's.
            let expected = watch.baseline.level();
            let before = self.before.get(index).copied().unwrap_or_default();
            let (now, before) = (value - expected, before - expected);
            self.early |= now * before > limit * limit;
        }
    }

    fn conclude(&mut self, config: &HealthConfig) -> Option<Event> {
        if self.cycles <= SETTLING + config.learning_cycles {
            if self.early {
                return Some(self.tell_early(config));
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

    /// A zero that drifts moves the mean, and goes on moving it: where it is now is normal, and a shift soon after is the
    /// drift's.
    fn explain(&mut self, event: Event) -> Option<Event> {
        let explained = event.cause == HealthCause::PreloadShift && self.explained > 0;
        if explained || matches!(event.cause, HealthCause::SensorDrifting(_)) {
            self.explained = EXPLAINED;
        }
        (!explained).then_some(event)
    }

    /// A mean force that was most of its way a cycle before its alarm, at which all has moved by `shift`. What comes at once, and
    /// is as large as what is to be found, was no more than half way: were it further there would have been an alarm, where
    /// noise and warmth leave its limit near half of that.
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

    /// What `values` have beyond the baselines.
    // Not inlined, as others below: several call it, none on every tick, and flash is short.
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

    /// The mean of this cycle's values and of those of the one before.
    #[inline(never)]
    fn mean_values(&self) -> Shift {
        let mut mean = self.values;
        for (value, before) in mean.iter_mut().zip(&self.before) {
            *value = 0.5 * (*value + before);
        }
        mean
    }

    /// As [`SpecimenWatch::mean_values`].
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
        // Half of the noise.
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

    /// Where the baselines have gone since the run-in, or since they were learned where that came later.
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
                // Where the line is: a cycle or two have more noise than what comes about slowly is large.
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
            // What the law may follow is no fault.
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

    /// What `warmth` of a specimen like the law is of this one, in `statistic`.
    fn of_specimen(&self, statistic: Statistic, warmth: f32) -> f32 {
        let watch = self.watches.get(usize::from(statistic.place()));
        warmth * watch.map_or(1.0, |watch| of_law(watch.baseline.level()))
    }

    /// What went further than is `allowed`, slowly. The evidence is that, which another statistic may name.
    fn slow(&self, shift: &Shift, most: Statistic, allowed: f32) -> Event {
        let (cause, or, _) = cause(shift, self.law_third(), Course::Slow);
        self.evidence((cause, or, most), shift, allowed)
    }

    fn follow(&mut self, index: usize) {
        // A cycle late: the first cycle that a fault was in may have been in part as ever.
        let value = self.before.get(index).copied().unwrap_or_default();
        if self.cycles == SETTLING + 1 {
            return;
        }
        if let Some(watch) = self.watches.get_mut(index) {
            // A drift was found in this cycle. It moves neither stiffness nor energy, in which something else may be wrong.
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

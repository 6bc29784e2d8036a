//! While the watch learns, it compares the specimen with the law, and with what was known before.

use super::super::HealthConfig;
use super::super::cause::{Channel, HealthCause};
use super::super::event::{Event, Statistic};
use super::super::pattern::{Course, reversed};
use super::{SETTLING, SpecimenWatch};

/// Change in sizes at which a statistic is reported while it is still learned, when the line through its first cycles is young.
pub(super) const EARLY: f32 = 3.0;
/// Fewest cycles of a line for such a report: the first ones still belong to the amplitude correction.
pub(super) const EARLY_CYCLES: u32 = 5;
/// Least stiffness or energy of the specimen at the start, relative to the law's; its inverse is the largest.
const LEAST_OF_LAW: f32 = 0.6;

impl SpecimenWatch {
    /// In the first cycle since the start: compares the specimen roughly with the law.
    pub(super) fn compare_with_law(&self) -> Option<Event> {
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
            let gain = HealthCause::SensorGain(Channel::Force);
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
    pub(super) fn compare_with_known(&mut self, config: &HealthConfig) -> Option<Event> {
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
    pub(super) fn report_early(&mut self, config: &HealthConfig) -> Event {
        let limit = EARLY * config.size + self.warmth(config, self.temperature);
        let shift = self.beyond(self.mean_values());
        let event = self.event(&shift, Course::Step, limit);
        self.relearn();
        event
    }
}

//! After an alarm the watch tells a step from a drift.

use super::super::HealthConfig;
use super::super::cause::HealthCause;
use super::super::event::{Event, Statistic};
use super::super::pattern::{Course, Shift};
use super::{SpecimenWatch, Suspicion};

/// Part of a shift by which a gradual one grows in one cycle.
const GROWING: f32 = 0.12;
/// Part of a gradual shift that was present a cycle before.
const DRIFTING: f32 = 0.6;
/// Cycles after a drift, or after a change of the mean that it explains, in which the drift explains further changes of the mean.
pub(super) const EXPLAINED: u8 = 16;

impl SpecimenWatch {
    /// A drifting zero moves the mean and keeps moving it. The present mean becomes normal, and a shift soon after belongs to the
    /// drift.
    pub(super) fn explain(&mut self, event: Event) -> Option<Event> {
        let explained = event.cause == HealthCause::PreloadShift && self.explained > 0;
        if explained || matches!(event.cause, HealthCause::SensorDrifting(_)) {
            self.explained = EXPLAINED;
        }
        (!explained).then_some(event)
    }

    /// A mean force that had most of its change a cycle before its alarm, at which the statistics have changed by `shift`. A sudden
    /// change of the size to be found had at most half of its value by then; with more there would have been an alarm, where noise
    /// and warmth leave the limit near half of that size.
    pub(super) fn drift(
        &mut self,
        config: &HealthConfig,
        shift: &Shift,
        limit: f32,
    ) -> Option<Event> {
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

    /// A cycle after an alarm.
    pub(super) fn judge(&mut self, config: &HealthConfig, suspicion: Suspicion) -> Option<Event> {
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
}

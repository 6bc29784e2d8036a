//! An event carries as its evidence how far the statistics are from their baselines.

use super::super::event::Event;
use super::super::pattern::{Course, Shift, Verdict, cause};
use super::SpecimenWatch;

impl SpecimenWatch {
    /// Deviation of `values` from the baselines.
    // Not inlined, like others below: several functions call it, none on every tick, and flash is scarce.
    #[inline(never)]
    pub(super) fn beyond(&self, values: Shift) -> Shift {
        let mut shift = values;
        for (value, watch) in shift.iter_mut().zip(&self.watches) {
            *value -= watch.baseline.expected();
        }
        shift
    }

    /// Mean of this cycle's values and of those of the one before.
    #[inline(never)]
    pub(super) fn mean_values(&self) -> Shift {
        let mut mean = self.values;
        for (value, before) in mean.iter_mut().zip(&self.before) {
            *value = 0.5 * (*value + before);
        }
        mean
    }

    /// The mean as in [`SpecimenWatch::mean_values`].
    pub(super) fn law_third(&self) -> f32 {
        let [before, now] = self.law_thirds;
        0.5 * (before + now)
    }

    #[inline(never)]
    pub(super) fn event(&self, shift: &Shift, course: Course, limit: f32) -> Event {
        let verdict = cause(shift, self.law_third(), course);
        self.evidence(verdict, shift, limit)
    }

    pub(super) fn evidence(
        &self,
        (cause, or, statistic): Verdict,
        shift: &Shift,
        limit: f32,
    ) -> Event {
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
}

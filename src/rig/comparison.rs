//! Comparison of the measured force with the law's force.

use super::CycleReport;
use crate::cycle::{Cycle, CycleAccumulator};
use crate::fast_law::Adaptation;
use crate::real::square_root;
use crate::sum::{FOLD, Sum};

/// Cycles of the measured force and of the law's, and the error between them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Comparison {
    /// Cycles of the measured force and of the law's.
    cycles: CycleAccumulator<2>,
    error_square: Sum,
    force_square: Sum,
    ticks: u32,
}

impl Comparison {
    /// Takes one tick's forces in kN. `accumulate` passes both to the accumulator, with their displacement and phase; `ended` means
    /// that a cycle ended before this tick.
    #[inline]
    pub(super) fn update(
        &mut self,
        measured: f32,
        model: f32,
        ended: bool,
        accumulate: impl FnOnce(&mut CycleAccumulator<2>, [f32; 2]) -> Option<[Cycle; 2]>,
    ) -> Option<([Cycle; 2], f32)> {
        let cycles = accumulate(&mut self.cycles, [measured, model]);
        let report = if ended {
            let nrmse = self.nrmse();
            self.error_square = Sum::default();
            self.force_square = Sum::default();
            self.ticks = 0;
            cycles.map(|cycles| (cycles, nrmse))
        } else {
            None
        };
        let error = model - measured;
        self.error_square.add(error * error);
        self.force_square.add(measured * measured);
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks.is_multiple_of(FOLD) {
            self.error_square.fold();
            self.force_square.fold();
        }
        report
    }

    /// The law's force at the last tick, kN; 0 before the first.
    pub(super) fn model_force(&self) -> f32 {
        let [_, model] = self.cycles.last_forces();
        model
    }

    /// RMS of the error divided by the RMS of the measured force; 0 where there was no force, [`f32::MAX`] where the squares of the
    /// law's forces exceed a float.
    fn nrmse(&self) -> f32 {
        let force = self.force_square.total();
        if force > f32::MIN_POSITIVE {
            let ratio = square_root(self.error_square.total() / force);
            if ratio.is_finite() { ratio } else { f32::MAX }
        } else {
            0.0
        }
    }
}

impl CycleReport {
    /// The report from `results` of [`Comparison::update`], for the cycle before the `cycles` completed.
    pub(super) fn new(
        ([measured, model], nrmse): ([Cycle; 2], f32),
        block: usize,
        cycles: u32,
        ramp: bool,
        followed: Adaptation,
    ) -> Self {
        Self {
            block,
            cycle: cycles.wrapping_sub(1),
            ramp,
            measured,
            model,
            nrmse,
            followed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nrmse_of(measured: f32, model: f32) -> f32 {
        let mut comparison = Comparison::default();
        let mut update = |ended| {
            let accumulate = |_: &mut CycleAccumulator<2>, _| Some([Cycle::default(); 2]);
            comparison.update(measured, model, ended, accumulate)
        };
        for _ in 0..40 {
            assert!(update(false).is_none());
        }
        update(true).unwrap().1
    }

    #[test]
    fn the_error_is_finite_however_far_off_the_law_is() {
        assert!((nrmse_of(0.5, 0.6) - 0.2).abs() < 1e-6);
        assert!((nrmse_of(-2.0, 2.0) - 2.0).abs() < 1e-6);
        assert_eq!(nrmse_of(0.0, 1.0), 0.0);
        for law in [1e20, -1e20, 1e29, f32::MAX] {
            assert_eq!(nrmse_of(1.0, law), f32::MAX);
            assert_eq!(nrmse_of(1e-15, law), f32::MAX);
        }
    }
}

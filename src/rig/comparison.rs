//! The measured force and the force of the law beside it, held against one another.

use super::CycleReport;
use crate::cycle::{Cycle, CycleAccumulator};
use crate::real::square_root;
use crate::sum::{FOLD, Sum};

/// The cycles of the measured force and of the model's, and the error between them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Comparison {
    /// Of the measured force and of the model's.
    cycles: CycleAccumulator<2>,
    error_square: Sum,
    force_square: Sum,
    ticks: u32,
}

impl Comparison {
    /// One tick's forces in kN. `accumulate` gives both to the accumulator, with their displacement and phase; `ended` says
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

    /// RMS of the error over the RMS of the measured force; 0 where there was no force.
    fn nrmse(&self) -> f32 {
        let force = self.force_square.total();
        if force > f32::MIN_POSITIVE {
            square_root(self.error_square.total() / force)
        } else {
            0.0
        }
    }
}

impl CycleReport {
    /// `results` as [`Comparison::update`] gives them, of the cycle before the `cycles` completed.
    pub(super) fn new(
        ([measured, model], nrmse): ([Cycle; 2], f32),
        block: usize,
        cycles: u32,
        ramp: bool,
    ) -> Self {
        Self {
            block,
            cycle: cycles.wrapping_sub(1),
            ramp,
            measured,
            model,
            nrmse,
        }
    }
}

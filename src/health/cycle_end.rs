//! At a cycle's end the monitor hands the cycle to the specimen's watch and the adaptation, and spreads their work over the looks.

use super::adaptation::Adapter;
use super::specimen::CycleNumbers;
use super::{HealthConfig, HealthMonitor};

/// Relative difference in amplitude below which close looks take two motions for the same.
const SAME_AMPLITUDE: f32 = 0.01;

/// Cycles in a row that are left out for a fault before the fault counts as normal.
const LEFT_OUT: u32 = 16;

/// A cycle that has ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ended {
    /// Block of the programme.
    pub(crate) block: usize,
    /// Temperature, °C.
    pub(crate) temperature: f32,
    /// Mean of the command, mm.
    pub(crate) command: f32,
    /// Another law took over at its end.
    pub(crate) another_law: bool,
    /// Its length in ticks.
    pub(crate) ticks: u32,
    /// A whole cycle of a block, not of a ramp.
    pub(crate) steady: Option<Steady>,
}

/// Results of a whole cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steady {
    /// Energy of the measured force and of the law's, J.
    pub(crate) energy: f32,
    pub(crate) law_energy: f32,
    /// Mean of the measured force minus that of the law's, kN.
    pub(crate) mean: f32,
}

impl HealthMonitor {
    /// A cycle has ended before this tick, whose look is still to come. That look does the work, because this tick has enough to
    /// do.
    #[inline(always)]
    pub(crate) fn cycle(&mut self, ended: Ended) {
        self.cycle = self.cycle.saturating_add(1);
        for seen in [&mut self.disturbed, &mut self.blurred, &mut self.off] {
            let [now, _] = *seen;
            *seen = [false, now];
        }
        self.adaptation.report();
        self.ended = Some(ended);
    }

    /// Whether a passing fault has lasted so long that it counts as normal.
    pub(super) fn is_lasting(&self) -> bool {
        self.left_out > LEFT_OUT
    }

    /// Work of a cycle's end that is left to the next look, done before that look is evaluated.
    #[inline(never)]
    pub(super) fn close_cycle(&mut self, config: &HealthConfig, ended: &Ended) {
        let sums = core::mem::take(&mut self.sums);
        self.amplitudes = core::mem::take(&mut self.largest);
        for (amplitude, least) in self.amplitudes.iter_mut().zip(&self.least_amplitudes) {
            if *amplitude < *least {
                *amplitude = *least;
            }
        }
        if ended.another_law {
            self.relearn();
            self.adaptation = Adapter::new();
            return;
        }
        // A cycle with a passing fault says nothing about the specimen, unless the fault has become lasting.
        let [_, disturbed] = self.disturbed;
        let lasted = self.is_lasting();
        self.left_out = if disturbed { self.left_out + 1 } else { 0 };
        let lasting = self.is_lasting();
        let steady = ended.steady.filter(|_| !disturbed || lasting);
        if config.follows() {
            self.adaptation.cycle(steady.is_some());
        }
        let Some(steady) = steady else {
            return;
        };
        if lasting != lasted {
            self.specimen.relearn_beside(config);
            self.relearn_beside();
        }
        if ended.block != self.block {
            self.block = ended.block;
            if self.is_same_motion(ended.ticks) {
                self.specimen.resume();
            } else {
                self.relearn();
            }
        }
        let [amplitude, _] = self.amplitudes;
        self.motion = (amplitude, ended.ticks);
        self.specimen.cycle(
            sums,
            CycleNumbers {
                energy: steady.energy,
                law_energy: steady.law_energy,
                mean: steady.mean,
                command: ended.command,
                temperature: ended.temperature,
                cycle: self.cycle,
            },
        );
        if !self.spikes {
            let begins = self.specimen.begins_to_learn();
            self.spikes = self.specimen.is_watching(config);
            if begins || self.spikes {
                self.displacement.learn(begins);
                self.force.learn(begins);
            }
        }
    }

    /// Whether the cycle that has ended had the motion of the last steady one. If so, the normal state of one block holds in the
    /// next.
    fn is_same_motion(&self, ticks: u32) -> bool {
        let ([amplitude, _], (before, ticks_before)) = (self.amplitudes, self.motion);
        (amplitude - before).abs() <= SAME_AMPLITUDE * before && ticks.abs_diff(ticks_before) <= 1
    }

    /// Does a piece of the work left from the end of the last cycle.
    pub(super) fn work(&mut self, config: &HealthConfig) {
        if self.specimen.has_work() {
            self.work_on_specimen(config);
        } else if self.adaptation.has_work() {
            self.work_on_adaptation(config);
        }
    }

    #[inline(never)]
    fn work_on_specimen(&mut self, config: &HealthConfig) {
        let Some(event) = self.specimen.work(config) else {
            return;
        };
        // The actuator's fault may have begun in the cycle that this event is about. A fault of the specimen is found again after
        // it.
        let [off, _] = self.off;
        if !(event.cause.is_fault() && off && !self.is_lasting()) {
            self.latch(event);
        }
    }

    #[inline(never)]
    fn work_on_adaptation(&mut self, config: &HealthConfig) {
        let [disturbed, _] = self.disturbed;
        if !self.is_damaged && !disturbed && self.specimen.is_sound(config) {
            self.adaptation.work(config.follow, config.run_in_cycles);
        } else {
            self.adaptation.skip();
        }
    }
}

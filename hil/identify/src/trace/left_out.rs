//! Tests how well a law predicts conditions that are left out of its fit, one after the other. A term may describe only the conditions
//! that it was fitted to.

use mesh_damper_model::predict::predict;
use mesh_damper_model::{Model, ModelError};
use mesh_damper_recording::cycles::{FoundBlock, alike, same_amplitude};
use mesh_damper_recording::trajectory::Trajectory;
use rayon::prelude::*;

use super::conditions::{Condition, Part, conditions};
use super::left_in_cycles::LeftInCycles;
use super::relative_error::RelativeError;
use super::split::Roles;
use super::within_blocks::is_seen_within_blocks;
use crate::tolerance::certainty;

mesh_damper_recording::numbers! {
    /// Conditions that are left out of a fit.
    LeftOutPolicy {
        /// If there are fewer blocks than this to be conditions, the recordings or stretches of them are the conditions.
        fewest_conditions: usize = 3, Convention("with two, each would be judged by the other alone");
        /// A recording whose blocks are no conditions is cut into this many stretches.
        stretches: usize = 5, Convention("each leaves four fifths to fit");
        /// An error over the cycles counts this fraction of them. The worst cycles, which do not count, may belong to a start or to a
        /// change between blocks.
        most_cycles: f64 = 0.8, Tuned("the blind trial");
        /// A block with fewer cycles than this may be a ramp, and is no condition.
        some_cycles: usize = 3, Derived("a cycle into the block, one within it and one out of it");
    }
}

/// The samples of a fit: whether it uses a sample of a trajectory.
pub(super) type Picked<'p> = &'p (dyn Fn(usize, usize) -> bool + Sync);
/// A law fitted to the picked samples.
pub(super) type Fit<'f> = &'f (dyn Fn(Picked) -> Result<Model, ModelError> + Sync);
/// A law with further results of its fit.
pub(super) type FitWith<'f, T> = &'f (dyn Fn(Picked) -> (Result<Model, ModelError>, T) + Sync);

/// The samples of a condition that its error is taken over.
#[derive(Clone, Copy)]
pub(super) enum Samples {
    /// Those that tell laws apart, each weighted by the certainty of its motion: for questions about effects.
    Telling,
    /// All that can be compared, each counting the same: for the choice of the law that is written.
    All,
}

impl Samples {
    fn include(self, trajectory: &Trajectory, sample: usize) -> bool {
        match self {
            Self::Telling => trajectory.is_telling(sample),
            Self::All => trajectory.is_comparable(sample),
        }
    }

    fn weight(self, trajectory: &Trajectory, sample: usize) -> f64 {
        match self {
            Self::Telling => certainty(trajectory, sample),
            Self::All => 1.0,
        }
    }
}

/// Recordings and their conditions that are left out.
pub(super) struct LeftOut<'a> {
    trajectories: &'a [Trajectory],
    roles: &'a Roles,
    conditions: Vec<Condition>,
}

impl<'a> LeftOut<'a> {
    /// No fit uses the samples that `roles` hold out.
    pub fn of(trajectories: &'a [Trajectory], roles: &'a Roles) -> Self {
        Self {
            trajectories,
            roles,
            conditions: conditions(trajectories, roles),
        }
    }

    /// The conditions that are held out in turn.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// The conditions that count: if enough others remain, the ends do not. Coefficients over the amplitude have unlimited errors beyond
    /// the fitted amplitudes, and these would outweigh everything else.
    pub fn inner_conditions(&self) -> Vec<&Condition> {
        self.enough(|one| !one.is_end)
            .unwrap_or_else(|| self.conditions.iter().collect())
    }

    /// The conditions that satisfy `counts`, if they are enough.
    fn enough(&self, counts: impl Fn(&Condition) -> bool) -> Option<Vec<&Condition>> {
        let some: Vec<&Condition> = self.conditions.iter().filter(|one| counts(one)).collect();
        (some.len() >= LeftOutPolicy::in_use().fewest_conditions).then_some(some)
    }

    /// The trajectory of a part.
    pub fn trajectory(&self, part: &Part) -> &Trajectory {
        &self.trajectories[part.which]
    }

    /// Whether the conditions held out in turn differ: parts of one steady motion say nothing about another motion.
    pub fn differ(&self) -> bool {
        let blocks = self.trajectories.iter().flat_map(|one| &one.blocks);
        let mut cycles = blocks.filter(|block| !block.cycles.is_empty());
        let Some(first) = cycles.next() else {
            return true;
        };
        cycles.any(|block| {
            !same_amplitude(block.amplitude, first.amplitude)
                || !alike(block.frequency, first.frequency)
        })
    }

    /// Whether the conditions held out in turn are different motions.
    pub fn are_motions(&self) -> bool {
        self.conditions.iter().all(|one| one.is_motion)
    }

    /// Whether a sample may be fitted.
    pub fn is_open(&self, which: usize, sample: usize) -> bool {
        self.roles.is_open(which, sample)
    }

    /// The error of `model` in the open cycles.
    pub fn left_by(&self, model: &Model) -> Result<LeftInCycles, ModelError> {
        let mut left = LeftInCycles::default();
        for (which, trajectory) in self.trajectories.iter().enumerate() {
            let predicted = predict(model, trajectory)?;
            left.add(trajectory, &predicted, |sample| self.is_open(which, sample));
        }
        Ok(left)
    }

    /// Whether `changing` predicts the changes from cycle to cycle within blocks better than `still`.
    pub fn is_seen_within_blocks(
        &self,
        changing: &Model,
        still: &Model,
    ) -> Result<bool, ModelError> {
        let counts = |which: usize, sample: usize| {
            self.is_open(which, sample) && self.trajectories[which].is_telling(sample)
        };
        let predicted = |model: &Model| -> Result<Vec<Vec<f64>>, ModelError> {
            let each = self.trajectories.iter();
            each.map(|trajectory| predict(model, trajectory)).collect()
        };
        let (changing, still) = (predicted(changing)?, predicted(still)?);
        let all = self.trajectories;
        Ok(is_seen_within_blocks(all, counts, &changing, &still))
    }

    /// The error of `model` beyond the noise over the open samples of all blocks, each with equal weight.
    pub fn inside(&self, model: &Model) -> Result<f64, ModelError> {
        let mut errors = Vec::new();
        for (which, trajectory) in self.trajectories.iter().enumerate() {
            let predicted = predict(model, trajectory)?;
            let is_fair = |i: usize| self.is_open(which, i) && trajectory.is_telling(i);
            let of_block = |block: &FoundBlock| {
                let weight = |i: usize| certainty(trajectory, i);
                RelativeError::of(trajectory, &predicted, &block.samples, is_fair, weight)
            };
            errors.extend(trajectory.blocks.iter().filter_map(of_block));
        }
        Ok(RelativeError::mean(&errors).beyond_noise())
    }

    /// The error of a law on a condition when it is fitted to all other open samples, with the further results of the fit. Each part
    /// counts equally.
    fn held_out<T>(
        &self,
        condition: &Condition,
        samples: Samples,
        fit: FitWith<T>,
    ) -> Option<(RelativeError, T)> {
        let (model, more) =
            fit(&|which, sample| self.is_open(which, sample) && !condition.contains(which, sample));
        // Without this condition the fit may have a law that the crate refuses.
        let errors = model.and_then(|model| self.errors_on(condition, samples, &model));
        let errors = errors.unwrap_or_else(|_| vec![RelativeError::NONE]);
        (!errors.is_empty()).then(|| (RelativeError::mean(&errors), more))
    }

    /// The error of `model` on each part of a condition that has samples.
    fn errors_on(
        &self,
        condition: &Condition,
        samples: Samples,
        model: &Model,
    ) -> Result<Vec<RelativeError>, ModelError> {
        let mut errors = Vec::with_capacity(condition.parts.len());
        let mut parts: Vec<&Part> = condition.parts.iter().collect();
        parts.sort_by_key(|part| part.which);
        for of_one in parts.chunk_by(|a, b| a.which == b.which) {
            let which = of_one[0].which;
            let trajectory = &self.trajectories[which];
            let is_fair = |i: usize| self.is_open(which, i) && samples.include(trajectory, i);
            let weight = |i: usize| samples.weight(trajectory, i);
            let predicted = predict(model, trajectory)?;
            errors.extend(of_one.iter().filter_map(|part| {
                let error =
                    RelativeError::of(trajectory, &predicted, &part.samples, is_fair, weight)?;
                Some(error.times(part.loud))
            }));
        }
        Ok(errors)
    }

    /// The error of a law on each open condition when that condition is held out, with the further results of its fit, in the order
    /// of [`conditions`](Self::conditions). The error of a law that the crate refuses is infinite.
    pub fn each_in_turn<T: Send>(&self, fit: FitWith<T>) -> Vec<Option<(RelativeError, T)>> {
        let each = self.conditions.par_iter();
        each.map(|one| self.held_out(one, Samples::Telling, fit))
            .collect()
    }

    /// The error of the law on each condition when it is held out. For a question about effects, only
    /// [those that count](Self::inner_conditions) are, and not an amplitude of its own either, if enough others remain: the law errs
    /// there with any effect.
    pub fn in_turn(&self, samples: Samples, fit: Fit) -> Vec<RelativeError> {
        let counted = match samples {
            Samples::Telling => {
                (self.enough(|one| !one.is_alone)).unwrap_or_else(|| self.inner_conditions())
            }
            Samples::All => self.conditions.iter().collect(),
        };
        let fit: FitWith<()> = &|picked| (fit(picked), ());
        let each = counted.par_iter();
        each.filter_map(|one| Some(self.held_out(one, samples, fit)?.0))
            .collect()
    }
}

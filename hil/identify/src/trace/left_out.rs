//! Tests how well a law predicts blocks that are left out of its fit, one after the other. A term may describe only the conditions
//! that it was fitted to.

use std::ops::Range;

use mesh_damper_model::predict::predict;
use mesh_damper_model::{Model, ModelError};
use mesh_damper_recording::cycles::{FoundBlock, alike, same_amplitude};
use mesh_damper_recording::trajectory::Trajectory;
use rayon::prelude::*;

use super::conditions::{Condition, blocks, conditions};
use super::left_in_cycles::LeftInCycles;
use super::relative_error::{BlockErrors, RelativeError};
use super::score::ValidationSamples;
use super::split::{Role, Roles};
use super::within_blocks::is_seen_within_blocks;
use crate::tolerance::goal;

mesh_damper_recording::numbers! {
    /// Blocks and conditions that are left out of a fit.
    LeftOutPolicy {
        /// Blocks are left out of a fit only if there are at least this many blocks.
        fewest_blocks: usize = 4, Derived("two amplitudes with two blocks each");
        /// The first and the last block of a recording are left out of a fit only if fewer than this many others can be.
        fewest_inner: usize = 2, Convention("one alone decides nothing");
        /// If there are fewer blocks than this to be conditions, the recordings or stretches of them are the conditions.
        fewest_conditions: usize = 3, Convention("with two, each would be judged by the other alone");
        /// At most this many conditions are held out in turn.
        most_conditions: usize = 8, Convention("bounds the time: each needs a fit");
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
pub(super) type FitWith<'f, T> = &'f (dyn Fn(Picked) -> Result<(Model, T), ModelError> + Sync);

/// Recordings and their blocks that are left out.
pub(super) struct LeftOut<'a> {
    trajectories: &'a [Trajectory],
    validation: &'a Roles,
    roles: &'a Roles,
    blocks: Vec<(usize, &'a FoundBlock)>,
    conditions: Vec<Condition>,
}

impl<'a> LeftOut<'a> {
    /// No fit uses the samples that `roles` hold out. If there are too few blocks, the cycles kept apart by `validation` take their
    /// place.
    pub fn of(trajectories: &'a [Trajectory], [validation, roles]: [&'a Roles; 2]) -> Self {
        Self {
            trajectories,
            validation,
            roles,
            blocks: blocks(trajectories, roles),
            conditions: conditions(trajectories, roles),
        }
    }

    /// The conditions that are held out in turn.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// The trajectory of a condition.
    pub fn trajectory(&self, condition: &Condition) -> &Trajectory {
        &self.trajectories[condition.which]
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

    /// The error there, and the error of `model`, the law as fitted to all open samples.
    pub fn block_errors(&self, fit: Fit, model: &Model) -> Result<BlockErrors, ModelError> {
        Ok(BlockErrors {
            outside: self.error(fit)?.beyond_noise(),
            inside: self.inside(model)?,
        })
    }

    /// The error of `model` beyond the noise over the open samples of all blocks, each with equal weight.
    pub fn inside(&self, model: &Model) -> Result<f64, ModelError> {
        let mut errors = Vec::new();
        for (which, trajectory) in self.trajectories.iter().enumerate() {
            let predicted = predict(model, trajectory)?;
            let is_fair = |i: usize| self.is_open(which, i) && trajectory.is_telling(i);
            let of_block = |block: &FoundBlock| {
                RelativeError::of(trajectory, &predicted, &block.samples, is_fair)
            };
            errors.extend(trajectory.blocks.iter().filter_map(of_block));
        }
        Ok(RelativeError::mean(&errors).beyond_noise())
    }

    /// The error of a law at samples of one trajectory when it is fitted to all other open samples, with the further results of the
    /// fit.
    fn held_out<T>(
        &self,
        fit: FitWith<T>,
        which: usize,
        samples: &Range<usize>,
    ) -> Result<Option<(RelativeError, T)>, ModelError> {
        let (model, more) = fit(&|other, sample| {
            self.is_open(other, sample) && !(other == which && samples.contains(&sample))
        })?;
        let trajectory = &self.trajectories[which];
        let is_fair = |i: usize| self.is_open(which, i) && trajectory.is_telling(i);
        let predicted = predict(&model, trajectory)?;
        let error = RelativeError::of(trajectory, &predicted, samples, is_fair);
        Ok(error.map(|error| (error, more)))
    }

    /// The error of a law on each open condition when that condition is held out, with the further results of its fit, in the order
    /// of [`conditions`](Self::conditions).
    pub fn each_in_turn<T: Send>(
        &self,
        fit: FitWith<T>,
    ) -> Result<Vec<Option<(RelativeError, T)>>, ModelError> {
        let all: Vec<&Condition> = self.conditions.iter().collect();
        self.held_out_each(&all, fit)
    }

    /// The error of the law on each open condition when that condition is held out. If enough others remain, the ends do not count:
    /// coefficients over the amplitude have unlimited errors beyond the fitted amplitudes, and these would outweigh everything
    /// else.
    pub fn in_turn(&self, fit: Fit) -> Result<Vec<RelativeError>, ModelError> {
        let inner: Vec<&Condition> = self.conditions.iter().filter(|one| !one.is_end).collect();
        let counted = match inner.len() < LeftOutPolicy::in_use().fewest_conditions {
            true => self.conditions.iter().collect(),
            false => inner,
        };
        let errors = self.held_out_each(&counted, &|picked| Ok((fit(picked)?, ())))?;
        Ok(errors
            .into_iter()
            .flatten()
            .map(|(error, ())| error)
            .collect())
    }

    fn held_out_each<T: Send>(
        &self,
        conditions: &[&Condition],
        fit: FitWith<T>,
    ) -> Result<Vec<Option<(RelativeError, T)>>, ModelError> {
        let errors = conditions.par_iter().map(|condition| {
            let error = self.held_out(fit, condition.which, &condition.samples)?;
            Ok(error.map(|(error, more)| (error.times(condition.loud), more)))
        });
        errors.collect()
    }

    /// The error relative to the force, each block with equal weight.
    pub fn error(&self, fit: Fit) -> Result<RelativeError, ModelError> {
        if self.blocks.is_empty() {
            let model = fit(&|which, sample| self.validation.of(which, sample) == Role::Fit)?;
            let samples =
                ValidationSamples::of(self.trajectories, self.validation, Role::Validation);
            let score = samples.score(|trajectory| predict(&model, trajectory))?;
            return Ok(RelativeError {
                error: score.nrmse().powi(2),
                noise: goal(samples.noise()).powi(2),
            });
        }
        let errors = self.blocks.par_iter();
        let errors = errors.map(|(which, block)| {
            let fit: FitWith<()> = &|picked| Ok((fit(picked)?, ()));
            self.held_out(fit, *which, &block.samples)
        });
        let errors: Vec<_> = errors.collect::<Result<_, ModelError>>()?;
        let errors: Vec<RelativeError> = errors.into_iter().flatten().map(|(e, ())| e).collect();
        Ok(RelativeError::mean(&errors))
    }
}

//! How well a law predicts blocks that are left out of its fit, one after the other: a term may know the conditions that it
//! was fitted to and no others.

use std::ops::Range;

use mesh_damper_model::predict::predict;
use mesh_damper_model::{Model, ModelError};
use mesh_damper_recording::cycles::{FoundBlock, alike, same_amplitude};
use mesh_damper_recording::trajectory::Trajectory;
use rayon::prelude::*;

use super::score::Jury;
use super::split::{Role, Roles};
use super::within_blocks::is_seen_within_blocks;
use crate::beyond_noise::beyond_noise;
use crate::policy::policy;
use crate::tolerance::{certainty, goal, held_to, least};

mesh_damper_recording::numbers! {
    /// Blocks that are left out of a fit.
    LeftOutPolicy {
        /// With fewer blocks none is left out.
        fewest_blocks: usize = 4, Derived("two amplitudes with two blocks each");
        /// With fewer blocks between the first and the last of their recordings those are left out too.
        fewest_inner: usize = 2, Convention("one alone decides nothing");
        /// With fewer conditions, stretches of the recordings take their place.
        fewest_conditions: usize = 3, Convention("of two each would be judged by the other alone");
        /// At most this many conditions are held out in turn.
        most_conditions: usize = 8, Convention("bounds the time: each takes a fit");
        /// Stretches that recordings without conditions are cut into.
        stretches: usize = 5, Convention("each leaves four fifths to fit");
        /// At most this many blocks are left out.
        most: usize = 4, Convention("bounds the time: each takes a fit");
        /// This part of the cycles are not the worst, which may be those of a start or of a change between blocks.
        most_cycles: f64 = 0.8, Tuned("the blind trial");
        /// Blocks of fewer cycles may be ramps.
        some_cycles: usize = 3, Derived("a cycle into the block, one in it and one out of it");
        /// A force wanders where the squared differences of its cycles' means are more than this many times those of noise.
        wanders: f64 = 20.0, Tuned("the recordings of others");
    }
}

/// Squared errors over the noise's variance, and of how many samples.
#[derive(Clone, Copy, Debug, Default)]
struct Left {
    squares: f64,
    count: f64,
}

impl Left {
    fn mean(&self) -> f64 {
        self.squares / self.count
    }

    /// None of nothing.
    fn sum(parts: &[Self]) -> Option<Self> {
        let sum = |of: fn(&Self) -> f64| parts.iter().map(of).sum();
        let count = sum(|left| left.count);
        (count > 0.0).then(|| Self {
            squares: sum(|left| left.squares),
            count,
        })
    }
}

/// What a law leaves of every block's cycles, as far as they count.
#[derive(Default)]
pub(super) struct LeftInCycles(Vec<Vec<Left>>);

impl LeftInCycles {
    /// Adds what `predicted`, kN, leaves of those samples of a trajectory that count.
    pub fn add(
        &mut self,
        trajectory: &Trajectory,
        predicted: &[f64],
        counts: impl Fn(usize) -> bool,
    ) {
        let of_cycle = |cycle: &Range<usize>| {
            let telling = cycle
                .clone()
                .filter(|&i| counts(i) && trajectory.is_telling(i));
            let errors = telling
                .map(|i| (predicted[i] - trajectory.force[i]).powi(2) / held_to(trajectory, i));
            errors.fold(Left::default(), |left, error| Left {
                squares: left.squares + error,
                count: left.count + 1.0,
            })
        };
        for block in &trajectory.blocks {
            self.0.push(block.cycles.iter().map(of_cycle).collect());
        }
    }

    /// Over the noise: RMS of all but the worst cycles, which may be those of a start or of a change between blocks; none where
    /// there is not one whole cycle.
    pub fn in_most(&self) -> Option<f64> {
        let mut left: Vec<Left> = self.0.concat();
        left.retain(|cycle| cycle.count > 0.0);
        left.sort_by(|a, b| a.mean().total_cmp(&b.mean()));
        left.truncate((policy().left_out.most_cycles * left.len() as f64).ceil() as usize);
        Left::sum(&left).map(|all| all.mean().sqrt())
    }

    /// The same beyond the noise, √(left² − 1), of the cycles but the first of every block that has some, each block counting
    /// the same; none where there are not two such blocks: others are ramps, and one condition tells no effect from its like.
    pub fn beyond_noise(&self) -> Option<f64> {
        let blocks = self.0.iter();
        let blocks: Vec<f64> = blocks
            .filter(|cycles| cycles.len() >= policy().left_out.some_cycles)
            .filter_map(|cycles| Left::sum(&cycles[1..]))
            .map(|block| block.mean() - 1.0)
            .collect();
        let mean = blocks.iter().sum::<f64>() / blocks.len() as f64;
        (blocks.len() > 1).then(|| mean.max(0.0).sqrt())
    }
}

/// The samples of a fit: whether it takes that of a trajectory.
pub(super) type Picked<'p> = &'p (dyn Fn(usize, usize) -> bool + Sync);
/// A law fitted to the samples that are picked.
pub(super) type Fit<'f> = &'f (dyn Fn(Picked) -> Result<Model, ModelError> + Sync);
/// The same with what else the fit gives.
pub(super) type FitWith<'f, T> = &'f (dyn Fn(Picked) -> Result<(Model, T), ModelError> + Sync);

/// Recordings and the blocks of them that are left out.
pub(super) struct LeftOut<'a> {
    trajectories: &'a [Trajectory],
    judging: &'a Roles,
    roles: &'a Roles,
    blocks: Vec<(usize, &'a FoundBlock)>,
    conditions: Vec<Condition>,
}

impl<'a> LeftOut<'a> {
    /// What `roles` hold out is never fitted. Where there are too few blocks, the cycles that `judging` keeps apart take
    /// their place.
    pub fn of(trajectories: &'a [Trajectory], [judging, roles]: [&'a Roles; 2]) -> Self {
        Self {
            trajectories,
            judging,
            roles,
            blocks: blocks(trajectories, roles),
            conditions: conditions(trajectories, roles),
        }
    }

    /// What is held out in turn.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// The trajectory that a condition is of.
    pub fn trajectory(&self, condition: &Condition) -> &Trajectory {
        &self.trajectories[condition.which]
    }

    /// Whether what is held out in turn differs: parts of one steady motion say nothing of another.
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

    /// What `model` leaves of the cycles that may be fitted.
    pub fn left_by(&self, model: &Model) -> Result<LeftInCycles, ModelError> {
        let mut left = LeftInCycles::default();
        for (which, trajectory) in self.trajectories.iter().enumerate() {
            let predicted = predict(model, trajectory)?;
            left.add(trajectory, &predicted, |sample| self.is_open(which, sample));
        }
        Ok(left)
    }

    /// Whether the mean of what `model` leaves differs from cycle to cycle of one block by more than noise would have it: a
    /// force that changes by itself, whatever the motion.
    pub fn wanders(&self, model: &Model) -> Result<bool, ModelError> {
        let (mut squares, mut expected) = (0.0, 0.0);
        for (which, trajectory) in self.trajectories.iter().enumerate() {
            let predicted = predict(model, trajectory)?;
            for block in &trajectory.blocks {
                let cycles = block.cycles.iter().filter(|cycle| {
                    let mut samples = (*cycle).clone();
                    samples.all(|i| trajectory.measured[i] && self.is_open(which, i))
                });
                let means: Vec<f64> = cycles
                    .map(|cycle| {
                        let left = cycle.clone().map(|i| trajectory.force[i] - predicted[i]);
                        let count = cycle.len() as f64;
                        let noise = cycle.clone().map(|i| held_to(trajectory, i));
                        expected += noise.sum::<f64>() / (count * count);
                        left.sum::<f64>() / count
                    })
                    .collect();
                let mean = means.iter().sum::<f64>() / means.len().max(1) as f64;
                squares += means.iter().map(|m| (m - mean).powi(2)).sum::<f64>();
            }
        }
        Ok(squares > policy().left_out.wanders * expected)
    }

    /// Whether `changing` knows what changes from cycle to cycle within blocks better than `still`.
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

    /// What is left there, and what `model` leaves, the law as fitted to all that may be.
    pub fn judged(&self, fit: Fit, model: &Model) -> Result<Judged, ModelError> {
        Ok(Judged {
            outside: self.error(fit)?.beyond_noise(),
            inside: self.inside(model)?,
        })
    }

    /// What `model` leaves beyond the noise of all blocks as far as they may be fitted, each counting the same.
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

    /// What a law leaves of samples of one trajectory when it is fitted to all others that may be; with it what else the fit gives.
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

    /// What a law leaves of each condition that may be fitted when that is held out, and what else its fit gives, in the order of
    /// [`conditions`](Self::conditions).
    pub fn each_in_turn<T: Send>(
        &self,
        fit: FitWith<T>,
    ) -> Result<Vec<Option<(RelativeError, T)>>, ModelError> {
        let all: Vec<&Condition> = self.conditions.iter().collect();
        self.held_out_each(&all, fit)
    }

    /// What the law leaves of each condition that may be fitted when that is held out. Where enough others are left, the ends do not count: coefficients
    /// over the amplitude err without bound beyond the amplitudes that they were fitted to, and that would outweigh all that is known.
    pub fn in_turn(&self, fit: Fit) -> Result<Vec<RelativeError>, ModelError> {
        let inner: Vec<&Condition> = self.conditions.iter().filter(|one| !one.is_end).collect();
        let counted = match inner.len() < policy().left_out.fewest_conditions {
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

    /// What is left there of the force, each block counting the same.
    pub fn error(&self, fit: Fit) -> Result<RelativeError, ModelError> {
        if self.blocks.is_empty() {
            let model = fit(&|which, sample| self.judging.of(which, sample) == Role::Fit)?;
            let jury = Jury::of(self.trajectories, self.judging, Role::Judge);
            let score = jury.score(|trajectory| predict(&model, trajectory))?;
            return Ok(RelativeError {
                error: score.nrmse().powi(2),
                noise: goal(jury.noise()).powi(2),
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

/// Errors [beyond the noise](RelativeError::beyond_noise).
#[derive(Clone, Copy, Debug)]
pub(super) struct Judged {
    /// In blocks left out of the fit,
    pub outside: f64,
    /// and in the fit.
    pub inside: f64,
}

impl Judged {
    /// The geometric mean of both: few blocks are left out, and what they know nothing of shows in the fit.
    pub fn both(&self) -> f64 {
        (self.outside * self.inside).sqrt()
    }
}

/// Squares over that of the force.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativeError {
    /// Of what a law leaves,
    pub error: f64,
    /// and of what a perfect one would.
    pub noise: f64,
}

impl RelativeError {
    /// In the samples that are `is_fair`; `None` where there is none.
    fn of(
        trajectory: &Trajectory,
        predicted: &[f64],
        samples: &Range<usize>,
        is_fair: impl Fn(usize) -> bool,
    ) -> Option<Self> {
        let (mut error, mut noise, mut force) = (0.0, 0.0, 0.0);
        for i in samples.clone().filter(|&i| is_fair(i)) {
            error += certainty(trajectory, i) * (predicted[i] - trajectory.force[i]).powi(2);
            noise += least(trajectory);
            force += trajectory.force[i].powi(2);
        }
        (force > 0.0).then(|| Self {
            error: error / force,
            noise: noise / force,
        })
    }

    fn times(self, factor: f64) -> Self {
        Self {
            error: factor * self.error,
            noise: factor * self.noise,
        }
    }

    pub fn mean(errors: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| errors.iter().map(of).sum::<f64>() / errors.len() as f64;
        Self {
            error: mean(|one| one.error),
            noise: mean(|one| one.noise),
        }
    }

    /// RMS of what is left [beyond the noise](beyond_noise()).
    pub fn beyond_noise(&self) -> f64 {
        beyond_noise(self.error, self.noise)
    }
}

/// Blocks of at least that many cycles of which something may be fitted, by their amplitude, then by their frequency.
fn blocks_of_cycles<'t>(
    trajectories: &'t [Trajectory],
    roles: &Roles,
    fewest: usize,
) -> Vec<(usize, &'t FoundBlock)> {
    let each = trajectories.iter().enumerate();
    let each = each
        .flat_map(|(which, trajectory)| trajectory.blocks.iter().map(move |block| (which, block)));
    let mut blocks: Vec<(usize, &FoundBlock)> = each
        .filter(|(which, block)| {
            let mut samples = block.samples.clone();
            let trajectory = &trajectories[*which];
            block.cycles.len() >= fewest
                && samples.any(|i| roles.is_open(*which, i) && trajectory.is_telling(i))
        })
        .collect();
    blocks.sort_by(|(_, a), (_, b)| {
        let by_amplitude = a.amplitude.total_cmp(&b.amplitude);
        by_amplitude.then(a.frequency.total_cmp(&b.frequency))
    });
    blocks
}

/// Of the blocks whose amplitude another one has, so that eq 13 is known there, some that are evenly spread over amplitude
/// and frequency; where those are few, of amplitudes between others too, and of all where there is none such. The first and the
/// last of several in a recording are not left out where there are others.
fn blocks<'t>(trajectories: &'t [Trajectory], roles: &Roles) -> Vec<(usize, &'t FoundBlock)> {
    let blocks = blocks_of_cycles(trajectories, roles, 2);
    if blocks.len() < policy().left_out.fewest_blocks {
        return Vec::new();
    }
    let has_another = |block: &FoundBlock| {
        let mut others = blocks.iter().filter(|(_, b)| !std::ptr::eq(*b, block));
        others.any(|(_, other)| same_amplitude(other.amplitude, block.amplitude))
    };
    let (least, largest) = (blocks[0].1.amplitude, blocks[blocks.len() - 1].1.amplitude);
    let is_between = |block: &FoundBlock| {
        let is_end = |end: f64| same_amplitude(block.amplitude, end);
        !is_end(least) && !is_end(largest)
    };
    let few = blocks.iter().filter(|(_, b)| has_another(b)).count() < policy().left_out.most;
    let known: Vec<(usize, &FoundBlock)> = blocks
        .iter()
        .filter(|(_, block)| has_another(block) || few && is_between(block))
        .copied()
        .collect();
    let known = if known.is_empty() { blocks } else { known };
    // What changes with time is not known before the first block that may be fitted nor after the last.
    let is_inner = |(which, block): &(usize, &FoundBlock)| {
        let all = trajectories[*which].blocks.iter();
        let mut open = all.filter(|block| block.samples.clone().any(|i| roles.is_open(*which, i)));
        let (first, last) = (open.next(), open.next_back());
        let is = |end: Option<&FoundBlock>| end.is_some_and(|end| std::ptr::eq(end, *block));
        let is_only = last.is_none();
        is_only || !(is(first) || is(last))
    };
    let inner: Vec<(usize, &FoundBlock)> = known.iter().copied().filter(is_inner).collect();
    let known = if inner.len() < policy().left_out.fewest_inner {
        known
    } else {
        inner
    };
    let count = known.len().min(policy().left_out.most);
    (0..count)
        .map(|place| known[(2 * place + 1) * known.len() / (2 * count)])
        .collect()
}

/// Samples of one trajectory that are held out together.
pub(super) struct Condition {
    /// Of which trajectory.
    pub which: usize,
    /// Which.
    pub samples: Range<usize>,
    /// By how much their force is more than that which an error is over, in squares: of a stretch that is of the recording, as it may rest.
    loud: f64,
    /// Whether no other condition has an amplitude as small, or none one as large: what is said of it then is an extrapolation.
    is_end: bool,
}

/// Conditions that may be fitted, evenly spread over amplitude and frequency, those at the ends among them: blocks of several cycles, or where there
/// are few, recordings, or stretches where these are few too.
fn conditions(trajectories: &[Trajectory], roles: &Roles) -> Vec<Condition> {
    let LeftOutPolicy {
        fewest_conditions,
        most_conditions,
        stretches,
        ..
    } = policy().left_out;
    let blocks = blocks_of_cycles(trajectories, roles, policy().left_out.some_cycles);
    // The cycles of a random motion are like others only by chance: what blocks have of it is no condition.
    let open = |which: usize, samples: &Range<usize>| {
        samples.clone().filter(|&i| roles.is_open(which, i)).count()
    };
    let in_blocks: usize = blocks
        .iter()
        .map(|(which, block)| open(*which, &block.samples))
        .sum();
    let all = trajectories.iter().enumerate();
    let all: usize = all
        .map(|(which, trajectory)| open(which, &(0..trajectory.len())))
        .sum();
    if blocks.len() < fewest_conditions || 2 * in_blocks < all {
        let pieces = if trajectories.len() < fewest_conditions {
            stretches
        } else {
            1
        };
        let cut = |(which, trajectory): (usize, &Trajectory)| {
            let open: Vec<usize> = (0..trajectory.len())
                .filter(|&i| roles.is_open(which, i))
                .collect();
            let length = open.len().div_ceil(pieces).max(1);
            let power = |samples: &[usize]| {
                let squares = samples.iter().map(|&i| trajectory.force[i].powi(2));
                squares.sum::<f64>() / samples.len() as f64
            };
            let of_all = power(&open);
            let each = open.chunks(length).map(|some| Condition {
                which,
                samples: some[0]..some[some.len() - 1] + 1,
                loud: power(some) / of_all,
                is_end: false,
            });
            each.collect::<Vec<_>>()
        };
        let all = trajectories.iter().enumerate().flat_map(cut).collect();
        return evenly(all, most_conditions);
    }
    // They are in the order of their amplitudes.
    let amplitudes: Vec<f64> = blocks.iter().map(|(_, block)| block.amplitude).collect();
    let is_end = |amplitude: f64| {
        let alone_at = |end: f64, next: f64| amplitude == end && !same_amplitude(end, next);
        let last = amplitudes.len() - 1;
        alone_at(amplitudes[0], amplitudes[1]) || alone_at(amplitudes[last], amplitudes[last - 1])
    };
    let each = evenly(blocks, most_conditions).into_iter();
    each.map(|(which, block)| Condition {
        which,
        samples: block.samples.clone(),
        loud: 1.0,
        is_end: is_end(block.amplitude),
    })
    .collect()
}

/// At most `most` of `all`, the first and the last among them.
fn evenly<T>(all: Vec<T>, most: usize) -> Vec<T> {
    let (length, count) = (all.len(), all.len().min(most));
    let mut places = (0..count)
        .map(|place| place * (length - 1) / (count - 1).max(1))
        .peekable();
    let picked = all.into_iter().enumerate();
    picked
        .filter(|(place, _)| places.next_if_eq(place).is_some())
        .map(|(_, one)| one)
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use mesh_damper_model::LawNode;
    use mesh_damper_recording::Recording;

    /// Sines of 1 Hz with these amplitudes in mm follow each other.
    fn test(amplitudes: &[f64]) -> Trajectory {
        let samples = 0..amplitudes.len() * 2000;
        let sine = |i: usize| amplitudes[i / 2000] * (TAU * i as f64 / 500.0).sin();
        let displacement: Vec<f64> = samples.clone().map(sine).collect();
        let force = displacement.iter().map(|y| 2.0 * y).collect();
        let time = samples.map(|i| i as f64 / 500.0).collect();
        let recording = Recording::new("test", time, displacement, force).unwrap();
        let trajectory = Trajectory::of(&recording).unwrap();
        assert_eq!(trajectory.blocks.len(), amplitudes.len());
        trajectory
    }

    /// Which blocks of which recording are left out.
    fn left_out(trajectories: &[Trajectory]) -> Vec<(usize, usize)> {
        let roles = Roles::all_fit(trajectories);
        let number = |(which, block): (usize, &FoundBlock)| {
            let blocks = &trajectories[which].blocks;
            let same = |other: &FoundBlock| std::ptr::eq(other, block);
            (which, blocks.iter().position(same).unwrap())
        };
        let mut places: Vec<_> = blocks(trajectories, &roles)
            .into_iter()
            .map(number)
            .collect();
        places.sort_unstable();
        places
    }

    #[test]
    fn what_lies_beyond_all_other_amplitudes_counts_only_where_little_else_is() {
        let counted = |amplitudes: &[f64]| {
            let trajectories = [test(amplitudes)];
            let roles = Roles::all_fit(&trajectories);
            let left_out = LeftOut::of(&trajectories, [&roles, &roles]);
            let no_force = || Model {
                law: vec![LawNode {
                    amplitude: 0.1,
                    k1: 0.0,
                    k3: 0.0,
                    c: 0.0,
                    alpha: 1.0,
                }],
                effects: Vec::new(),
                correction: None,
            };
            left_out.in_turn(&|_| Ok(no_force())).unwrap().len()
        };
        assert_eq!(counted(&[0.2, 0.1, 0.2, 0.3, 0.2]), 3);
        assert_eq!(counted(&[0.1, 0.3, 0.2, 0.1, 0.3]), 5, "no end is alone");
        assert_eq!(
            counted(&[0.2, 0.1, 0.2, 0.3]),
            4,
            "two alone decide nothing"
        );
    }

    #[test]
    fn the_ends_of_a_recording_are_left_out_only_where_little_is_between() {
        // Of each amplitude there is another block.
        let long = test(&[0.1, 0.2, 0.3, 0.1, 0.2, 0.3]);
        assert_eq!(left_out(&[long]), [(0, 1), (0, 2), (0, 3), (0, 4)]);
        let mixed = [test(&[0.1, 0.2, 0.1, 0.2]), test(&[0.1])];
        assert_eq!(left_out(&mixed), [(0, 1), (0, 2), (1, 0)]);
        let short = [test(&[0.1, 0.2, 0.1]), test(&[0.2])];
        assert_eq!(left_out(&short), [(0, 1), (1, 0)]);
        let single = [0.1, 0.2, 0.1, 0.2].map(|amplitude| test(&[amplitude]));
        assert_eq!(left_out(&single), [(0, 0), (1, 0), (2, 0), (3, 0)]);
    }
}

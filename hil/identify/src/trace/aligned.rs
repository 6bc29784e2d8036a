//! Corrects channel faults that recordings of one rig share: a force that is early or late, and the zero of the displacement. Each
//! recording shows them only roughly.

use mesh_damper_model::predict::predict;
use mesh_damper_model::{Model, ModelError};
use mesh_damper_output::error::InputError;
use mesh_damper_recording::Recording;
use mesh_damper_recording::cycles::FoundBlock;
use mesh_damper_recording::faults::ShiftPolicy;
use mesh_damper_recording::pink::pink_deviation;
use mesh_damper_recording::rig::RigFacts;
use mesh_damper_recording::trajectory::{Known, Trajectory, Zero};
use mesh_damper_recording::zero::{ZeroPolicy, zero_step};
use mesh_damper_recording::zeros::{self, LeftOfOne, odd_zeros};

use crate::trace::closing::{Closed, Forces};
use crate::trace::early::EarlyPolicy;
use crate::trace::result::Verdict;
use crate::trace::split::Role;

mesh_damper_recording::numbers! {
    /// The properties that recordings of one rig share.
    AlignedPolicy {
        /// Two recordings have the same wrong zero of the displacement if the middles of their motions differ by less than this fraction of
        /// the smaller amplitude.
        same_zero: f64 = 0.05, Tuned("the recordings of others");
        /// Two recordings may have the same time shift of the force if their shifts differ by less than this many ticks.
        same_shift: f64 = 1.5, Tuned("the injected channel faults");
    }
}

/// Prepared recordings: the fitted ones and the held-out ones.
pub(super) struct Aligned<'r> {
    recordings: [&'r [&'r Recording]; 2],
    /// In the same order.
    pub trajectories: [Vec<Trajectory>; 2],
    rig: RigFacts,
}

impl<'r> Aligned<'r> {
    /// Applies the result from the longest of the `fitted` recordings, or else of the held-out ones, to all recordings that may
    /// share it, unless `rig` states it.
    ///
    /// # Errors
    /// As [`Trajectory::knowing`].
    pub fn of(
        fitted: &'r [&'r Recording],
        held: &'r [&'r Recording],
        rig: RigFacts,
    ) -> Result<Self, InputError> {
        let known = Known {
            rig,
            ..Known::default()
        };
        let each = |recordings: &[&Recording]| -> Result<Vec<Trajectory>, InputError> {
            let each = recordings.iter();
            each.map(|recording| Trajectory::knowing(recording, known))
                .collect()
        };
        let mut aligned = Self {
            recordings: [fitted, held],
            trajectories: [each(fitted)?, each(held)?],
            rig,
        };
        if rig.zero.is_none() {
            aligned.share_zero()?;
        }
        if let Some(late) = aligned.shifted().map(|shifted| shifted.late) {
            aligned.move_from(late, late)?;
        }
        Ok(aligned)
    }

    /// Moves all forces that were moved, once more, if they are still `early` by some s. A law measures the rest of what the channels show,
    /// which is at most a tick. Returns whether anything moved.
    ///
    /// # Errors
    /// As [`Trajectory::of`].
    pub fn follow(&mut self, early: f64) -> Result<bool, InputError> {
        let Some((late, tick)) = self.shifted().map(|one| (one.late, one.tick)) else {
            return Ok(false);
        };
        let to = late - early.clamp(-tick, tick);
        // What a law measures cannot make an early force late, nor a late one early.
        let to = if late < 0.0 { to.min(0.0) } else { to.max(0.0) };
        let differs = (to - late).abs() > EarlyPolicy::in_use().within * tick;
        if differs {
            self.move_from(late, to)?;
        }
        Ok(differs)
    }

    /// Whether a force was moved, or its delay is stated.
    pub fn is_moved(&self) -> bool {
        self.rig.force_delay.is_some() || self.shifted().is_some()
    }

    /// Moves the force of every recording, which is late by `late` s, or early if that is below 0: one rig has one delay.
    ///
    /// # Errors
    /// As [`Trajectory::of`].
    pub fn move_all(&mut self, late: f64) -> Result<(), InputError> {
        self.again(|trajectory| {
            Some(Known {
                late: Some(late),
                zero: Some(zero_of(trajectory)),
                ..Known::default()
            })
        })
    }

    /// Allows for noise that quick changes do not show. Returns whether the residuals of laws with these `forces`, in the order of
    /// the recordings, contain such noise.
    pub fn take_pink_noise(&mut self, forces: &[Forces]) -> bool {
        let [fitted, held] = &mut self.trajectories;
        let mut most = 1.0_f64;
        for (trajectory, forces) in fitted.iter_mut().zip(forces) {
            let left = |index: usize| {
                if trajectory.is_comparable(index) {
                    trajectory.force[index] - forces.after[index]
                } else {
                    0.0
                }
            };
            // Nothing may be learned from held-out recordings.
            let mut start = 0;
            let runs = forces.roles.split(|role| *role == Role::HeldOut);
            let runs = runs.map(|run| {
                let samples = start..start + run.len();
                start = samples.end + 1;
                samples
            });
            let longest = runs.max_by_key(ExactSizeIterator::len).unwrap_or_default();
            let left: Vec<f64> = longest.map(left).collect();
            if let Some(noise) = pink_deviation(&left)
                && noise > trajectory.force_noise
            {
                trajectory.take_pink_noise(noise);
                most = most.max(trajectory.noise_beside);
            }
        }
        let any = most > 1.0;
        if any {
            // They are from the same load cell.
            for trajectory in held {
                trajectory.take_pink_noise(most * trajectory.force_noise);
            }
        }
        any
    }

    /// Moves forces back at the largest step of their zero. Looks at the residual of the named effects in `closed` and, if these
    /// are not all of it, at the residual of the mixed damping law alone. Returns whether any force moved.
    ///
    /// # Errors
    /// A law that the crate refuses.
    pub fn take_zero_steps(&mut self, closed: &Closed) -> Result<bool, ModelError> {
        let named = named(closed);
        let [fitted, held] = &mut self.trajectories;
        let mut any = false;
        for (trajectory, forces) in fitted.iter_mut().zip(&closed.forces) {
            let open = open(trajectory, &forces.roles);
            let left = |predicted: &[f64]| -> Vec<f64> {
                let each = open.iter();
                each.map(|&index| trajectory.force[index] - predicted[index])
                    .collect()
            };
            let mut each = vec![left(&predict(&named, trajectory)?)];
            if closed.result.verdict == Verdict::Unlisted {
                each.push(left(&forces.before));
            }
            let each: Vec<&[f64]> = each.iter().map(Vec::as_slice).collect();
            let step =
                zero_step(&each).filter(|step| !changes_near(trajectory, &open, step.sample));
            let Some(step) = step else { continue };
            let sample = open[step.sample];
            take_from(trajectory, held, |one| {
                one.take_zero_step(sample, step.change);
            });
            any = true;
        }
        Ok(any)
    }

    /// Moves back forces whose zero differs from that of the other recordings. Looks at the residual of the named effects in
    /// `closed` and, if these are not all of it, at the residual of the mixed damping law alone. Returns whether any force moved.
    ///
    /// # Errors
    /// A law that the crate refuses.
    pub fn take_zeros(&mut self, closed: &Closed) -> Result<bool, ModelError> {
        let named = named(closed);
        let [fitted, held] = &mut self.trajectories;
        let each = fitted.iter();
        let with_names = each.map(|trajectory| predict(&named, trajectory));
        let with_names: Vec<Vec<f64>> = with_names.collect::<Result<_, _>>()?;
        let mut laws: Vec<Vec<&[f64]>> = vec![with_names.iter().map(Vec::as_slice).collect()];
        if closed.result.verdict == Verdict::Unlisted {
            let alone = closed.forces.iter();
            laws.push(alone.map(|forces| &forces.before[..]).collect());
        }
        for predicted in laws {
            let each = fitted.iter().zip(&closed.forces).zip(predicted);
            let left: Vec<LeftOfOne> = each
                .map(|((trajectory, forces), predicted)| {
                    left_of(trajectory, &open(trajectory, &forces.roles), predicted)
                })
                .collect();
            let odd = odd_zeros(&left, noise_of_means(fitted));
            for &(place, change) in &odd {
                take_from(&mut fitted[place], held, |one| one.take_zero(change));
            }
            if !odd.is_empty() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Reports held-out recordings whose zero differs from that of the fitted ones. Nothing may be learned from them, so they stay
    /// as they are.
    ///
    /// # Errors
    /// A law that the crate refuses.
    pub fn say_odd_zeros(&self, closed: &mut Closed) -> Result<(), ModelError> {
        let [fitted, held] = &self.trajectories;
        if held.is_empty() {
            return Ok(());
        }
        let law = named(closed);
        let left = |trajectory: &Trajectory| -> Result<LeftOfOne, ModelError> {
            let measured = (0..trajectory.len()).filter(|&index| trajectory.is_comparable(index));
            let measured: Vec<usize> = measured.collect();
            Ok(left_of(trajectory, &measured, &predict(&law, trajectory)?))
        };
        let mut all: Vec<LeftOfOne> = fitted.iter().map(left).collect::<Result<_, _>>()?;
        for trajectory in held {
            all.push(left(trajectory)?);
            let odd = odd_zeros(&all, noise_of_means(fitted));
            all.pop();
            if let [(place, change)] = odd[..]
                && place == fitted.len()
            {
                let fault = zeros::fault(change, false);
                let warning = format!("{}: {fault}", trajectory.name);
                closed.result.warnings.push(warning);
            }
        }
        Ok(())
    }

    /// The longest fitted recording whose force was moved, or else the longest held-out one.
    fn shifted(&self) -> Option<&Trajectory> {
        self.longest(|trajectory| trajectory.late != 0.0)
    }

    fn longest(&self, of: fn(&Trajectory) -> bool) -> Option<&Trajectory> {
        let duration = |trajectory: &Trajectory| trajectory.len() as f64 * trajectory.tick;
        let mut each = self.trajectories.iter();
        each.find_map(|trajectories| {
            let some = trajectories.iter().filter(|trajectory| of(trajectory));
            some.max_by(|a, b| duration(a).total_cmp(&duration(b)))
        })
    }

    /// Moves every force that was moved by about `from` s, or that may be late by `to` s, by the latter.
    fn move_from(&mut self, from: f64, to: f64) -> Result<(), InputError> {
        self.again(|trajectory| {
            let differs = (trajectory.late - from).abs() / trajectory.tick;
            let shares = trajectory.late != 0.0 && differs < AlignedPolicy::in_use().same_shift;
            (shares || trajectory.may_be_late_by(to)).then_some(Known {
                late: Some(to),
                zero: Some(zero_of(trajectory)),
                ..Known::default()
            })
        })
    }

    /// If a zero was left in, it was left in wherever the motion has the same middle, even if it is small compared to that motion.
    fn share_zero(&mut self) -> Result<(), InputError> {
        let Some(off) = self.longest(|trajectory| trajectory.centre != 0.0) else {
            return Ok(());
        };
        let (middle, largest) = (off.middle, largest_amplitude(off));
        self.again(|trajectory| {
            let same =
                AlignedPolicy::in_use().same_zero * largest.min(largest_amplitude(trajectory));
            let shares = trajectory.centre == 0.0 && (trajectory.middle - middle).abs() < same;
            shares.then_some(Known {
                zero: Some(Zero::Middle),
                ..Known::default()
            })
        })
    }

    /// Prepares recordings again if more is known about them.
    fn again(&mut self, known: impl Fn(&Trajectory) -> Option<Known>) -> Result<(), InputError> {
        for (recordings, trajectories) in self.recordings.iter().zip(&mut self.trajectories) {
            for (recording, trajectory) in recordings.iter().zip(trajectories) {
                if let Some(known) = known(trajectory) {
                    let known = Known {
                        rig: self.rig,
                        ..known
                    };
                    *trajectory = Trajectory::knowing(recording, known)?;
                }
            }
        }
        Ok(())
    }
}

/// Where its displacement is counted from, if nothing is stated.
fn zero_of(trajectory: &Trajectory) -> Zero {
    match trajectory.centre {
        0.0 => Zero::Recorded,
        _ => Zero::Middle,
    }
}

/// The model with named effects only: a residual table may have absorbed a zero.
fn named(closed: &Closed) -> Model {
    Model {
        correction: None,
        ..closed.model.clone()
    }
}

/// The measured samples from which something may be learned: none of the held-out ones.
fn open(trajectory: &Trajectory, roles: &[Role]) -> Vec<usize> {
    let all = 0..trajectory.len();
    all.filter(|&index| trajectory.is_comparable(index) && roles[index] != Role::HeldOut)
        .collect()
}

/// Applies a correction to a fitted recording, and to a longer recording of the same test that contains it.
fn take_from(fitted: &mut Trajectory, held: &mut [Trajectory], take: impl Fn(&mut Trajectory)) {
    let again = held
        .iter_mut()
        .filter(|held| held.force.starts_with(&fitted.force));
    again.for_each(&take);
    take(fitted);
}

/// The residual of a law with this force in kN at some samples of a recording.
fn left_of(trajectory: &Trajectory, samples: &[usize], predicted: &[f64]) -> LeftOfOne {
    let count = samples.len() as f64;
    let (mut sum, mut squares) = (0.0, 0.0);
    for &index in samples {
        let left = trajectory.force[index] - predicted[index];
        sum += left;
        squares += left * left;
    }
    let mean = sum / count;
    LeftOfOne {
        mean,
        variance: squares / count - mean * mean,
        scale: trajectory.force_rms,
    }
}

/// The possible error of a mean under slow noise: at most that of a sample, kN.
fn noise_of_means(trajectories: &[Trajectory]) -> f64 {
    let noise = trajectories.iter().map(|one| one.force_noise);
    noise.fold(f64::MIN_POSITIVE, f64::max)
}

/// Whether the motion changes there, or samples of `open` are missing. The deviations that a law lacks change with the amplitude
/// and over time.
fn changes_near(trajectory: &Trajectory, open: &[usize], place: usize) -> bool {
    // Two of the narrowest means on each side show whether the step comes at once.
    let reach = 2 * ZeroPolicy::in_use().narrowest;
    let about = place.saturating_sub(reach)..(place + reach).min(open.len());
    let is_spliced = open[about].windows(2).any(|pair| pair[1] > pair[0] + 1);
    let blocks = trajectory.blocks.windows(2).filter(|pair| {
        let steady = |block: &FoundBlock| block.cycles.len() >= ShiftPolicy::in_use().steady;
        pair.iter().all(steady)
    });
    let cycle = |block: &FoundBlock| (1.0 / (block.frequency * trajectory.tick)) as usize;
    let mut ends = blocks.map(|pair| (pair[1].samples.start, cycle(&pair[0]).max(cycle(&pair[1]))));
    is_spliced || ends.any(|(end, cycle)| end.abs_diff(open[place]) <= cycle)
}

fn largest_amplitude(trajectory: &Trajectory) -> f64 {
    trajectory.amplitude.iter().copied().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const TICK: f64 = 2e-3;

    /// A spring with friction at one frequency for 6 s and then at another for 4 s, with a force that is `late` by that number of
    /// ticks.
    fn recording(name: &str, frequencies: [f64; 2], late: isize) -> Recording {
        let at = |index: isize| {
            let time = index as f64 * TICK;
            let frequency = frequencies[usize::from(time >= 6.0)];
            let (sin, cos) = (TAU * frequency * time).sin_cos();
            let speed = 0.1 * TAU * frequency * cos.abs();
            (
                0.1 * sin,
                0.15 * sin + 0.05 * speed.powf(0.2) * cos.signum(),
            )
        };
        let samples = 0..5000;
        Recording::new(
            name,
            samples.clone().map(|index| index as f64 * TICK).collect(),
            samples.clone().map(|index| at(index).0).collect(),
            samples.map(|index| at(index - late).1).collect(),
        )
        .unwrap()
    }

    /// Whatever the size: the force that was found early first is the one that is moved.
    #[test]
    fn what_was_moved_is_moved_by_what_a_law_shows() {
        let early = recording("early", [1.0, 5.0], -3);
        let recordings = [&early];
        for ticks in [0.5, 2.0, 9.0] {
            let mut aligned = Aligned::of(&recordings, &[], RigFacts::default()).unwrap();
            let before = aligned.trajectories[0][0].late;
            assert!((before / TICK + 3.0).abs() < 0.5, "{before} s");
            assert!(!aligned.follow(0.01 * TICK).unwrap());
            assert!(aligned.follow(-ticks * TICK).unwrap());
            let expected = before + ticks.min(1.0) * TICK;
            assert_eq!(aligned.trajectories[0][0].late, expected);
        }
    }

    /// Whichever recording shows it: one with a single frequency shows no delay, and a slow one appears to take energy although it
    /// is late.
    #[test]
    fn what_is_held_out_is_moved_as_what_is_fitted() {
        for (shows, hides, late) in [
            ([1.0, 5.0], [2.0, 2.0], -8),
            ([1.0, 5.0], [0.5, 0.5], -8),
            ([1.0, 5.0], [0.25, 0.5], 25),
        ] {
            let shows = recording("shows", shows, late);
            let hides = recording("hides", hides, late);
            assert_eq!(Trajectory::of(&hides).unwrap().late, 0.0);
            for (fitted, held) in [([&shows], [&hides]), ([&hides], [&shows])] {
                let aligned = Aligned::of(&fitted, &held, RigFacts::default()).unwrap();
                let [fitted, held] = aligned.trajectories.map(|each| each[0].late / TICK);
                assert!((fitted - late as f64).abs() < 0.5, "{fitted} of {late}");
                assert_eq!(fitted, held, "{late}");
            }
        }
    }

    #[test]
    fn a_force_that_moved_would_give_energy_is_not_moved() {
        let early = recording("early", [1.0, 5.0], -20);
        let in_time = recording("in time", [5.0, 5.0], 0);
        let (fitted, held) = ([&early], [&in_time]);
        let aligned = Aligned::of(&fitted, &held, RigFacts::default()).unwrap();
        assert!(aligned.trajectories[0][0].late < -19.0 * TICK);
        assert_eq!(aligned.trajectories[1][0].late, 0.0);
    }
}

//! Decides which samples are fitted, which are validation data, and which are held out.
//!
//! Neighbouring samples of a recording are similar, so random samples make no test. Instead, whole cycles are kept apart: the last
//! cycles of every block, and all of one block, which is a new condition.

use std::ops::Range;

use mesh_damper_recording::cycles::same_amplitude;
use mesh_damper_recording::trajectory::Trajectory;

mesh_damper_recording::numbers! {
    /// Which samples are validation and test data.
    SplitPolicy {
        /// One in this many of the cycles of a block becomes test data, and of the remaining cycles the same part becomes validation data.
        cycles_per_kept: usize = 4, Tuned("the blind trial");
        /// A whole block becomes test or validation data only if at least this many blocks are still training data.
        fewest_blocks: usize = 3, Derived("with two blocks one condition would be left to fit");
        /// A block counts as training data for `fewest_blocks` only if at least this many of its cycles are.
        fewest_cycles: usize = 2, Derived("one of them may be a ramp");
        /// If its cycles would make less than this fraction of a recording test or validation data, stretches of the recording are taken
        /// instead.
        least_kept: f64 = 0.08, Derived("of a block at least one in seven cycles is taken, and half of a test may be ramps");
        /// A recording without similar cycles is cut into this many stretches, of which one in four becomes validation data.
        stretches: usize = 16, Tuned("the blind trial over any motion");
    }
}

/// The purpose of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Coefficients are fitted to it.
    Fit,
    /// Effects are chosen by it.
    Validation,
    /// The error is reported on it; it takes no part in a fit or a choice.
    HeldOut,
}

/// A role for every sample of every trajectory.
#[derive(Clone, Debug)]
pub struct Roles(Vec<Vec<Role>>);

impl Roles {
    /// Everything is fitted.
    pub fn all_fit(trajectories: &[Trajectory]) -> Self {
        Self(
            trajectories
                .iter()
                .map(|t| vec![Role::Fit; t.len()])
                .collect(),
        )
    }

    /// The role of a sample.
    pub fn of(&self, trajectory: usize, sample: usize) -> Role {
        self.0[trajectory][sample]
    }

    /// Whether a sample is open, which means that the final fit may use it.
    pub fn is_open(&self, trajectory: usize, sample: usize) -> bool {
        self.of(trajectory, sample) != Role::HeldOut
    }

    /// The runs of open samples, in order.
    pub fn open_runs(&self, trajectory: usize) -> Vec<Range<usize>> {
        let held = |role: &Role| *role == Role::HeldOut;
        let mut at = 0;
        let runs = self.0[trajectory].chunk_by(|a, b| held(a) == held(b));
        let placed = runs.map(|run| {
            at += run.len();
            (at - run.len()..at, held(&run[0]))
        });
        placed
            .filter_map(|(run, held)| (!held).then_some(run))
            .collect()
    }

    /// Takes the last quarter of the still fitted cycles in every block, and one whole block, for `role`.
    ///
    /// The whole block is one whose amplitude other fitted blocks have too. Coefficients of eq 13 depend on amplitude, so a block
    /// with an amplitude of its own would test the interpolation between amplitudes and not the effects. If there is no such block,
    /// none is taken. A recording with hardly two similar cycles gives a quarter of the still fitted samples: the last ones to be
    /// held out, or stretches from all over it for validation, because a stretch may resemble no other.
    pub fn keep_apart(&mut self, trajectories: &[Trajectory], role: Role) {
        let whole = self.whole_block(trajectories);
        for (which, trajectory) in trajectories.iter().enumerate() {
            for (number, block) in trajectory.blocks.iter().enumerate() {
                if whole == Some((which, number)) {
                    self.assign(which, block.samples.clone(), role);
                    continue;
                }
                let cycles: Vec<&Range<usize>> = block
                    .cycles
                    .iter()
                    .filter(|cycle| self.is_fit(which, cycle))
                    .collect();
                if let [_, .., last] = cycles.as_slice() {
                    let kept = (cycles.len() / SplitPolicy::in_use().cycles_per_kept).max(1);
                    let first = cycles[cycles.len() - kept];
                    self.assign(which, first.start..last.end, role);
                }
            }
            self.keep_stretches(which, role, &trajectory.measured);
        }
    }

    /// Gives `role` to a quarter of the `measured` samples of a recording if its cycles gave it to hardly any. The samples of a pause would
    /// outnumber those of the cycles.
    fn keep_stretches(&mut self, which: usize, role: Role, measured: &[bool]) {
        let roles = &mut self.0[which];
        let is_free = |one: Role| one == role || one == Role::Fit;
        let free: Vec<usize> = (0..roles.len())
            .filter(|&i| is_free(roles[i]) && measured[i])
            .collect();
        let kept = free.iter().filter(|&&sample| roles[sample] == role).count();
        let SplitPolicy {
            cycles_per_kept,
            least_kept,
            stretches,
            ..
        } = *SplitPolicy::in_use();
        if kept as f64 >= least_kept * free.len() as f64 {
            return;
        }
        let is_kept = |place: usize| match role {
            Role::HeldOut => place >= free.len() - free.len() / cycles_per_kept,
            _ => place * stretches / free.len() % cycles_per_kept == cycles_per_kept / 2,
        };
        for (place, &sample) in free.iter().enumerate() {
            roles[sample] = if is_kept(place) { role } else { Role::Fit };
        }
    }

    /// The block of middle frequency among those whose amplitude another fitted block has, if at least three blocks are fitted.
    fn whole_block(&self, trajectories: &[Trajectory]) -> Option<(usize, usize)> {
        let fitted: Vec<(usize, usize)> = trajectories
            .iter()
            .enumerate()
            .flat_map(|(which, trajectory)| {
                (0..trajectory.blocks.len()).map(move |number| (which, number))
            })
            .filter(|&(which, number)| {
                let cycles = &trajectories[which].blocks[number].cycles;
                cycles
                    .iter()
                    .filter(|cycle| self.is_fit(which, cycle))
                    .count()
                    >= SplitPolicy::in_use().fewest_cycles
            })
            .collect();
        if fitted.len() < SplitPolicy::in_use().fewest_blocks {
            return None;
        }
        let block = |(which, number): (usize, usize)| &trajectories[which].blocks[number];
        let mut eligible: Vec<(usize, usize)> = fitted
            .iter()
            .copied()
            .filter(|&one| {
                fitted.iter().any(|&other| {
                    other != one && same_amplitude(block(one).amplitude, block(other).amplitude)
                })
            })
            .collect();
        eligible.sort_by(|&a, &b| block(a).frequency.total_cmp(&block(b).frequency));
        eligible.get(eligible.len() / 2).copied()
    }

    fn is_fit(&self, which: usize, samples: &Range<usize>) -> bool {
        samples
            .clone()
            .all(|sample| self.0[which][sample] == Role::Fit)
    }

    /// Gives `role` to the still fitted ones of the samples: held-out samples stay held out.
    fn assign(&mut self, which: usize, samples: Range<usize>, role: Role) {
        let free = self.0[which][samples].iter_mut();
        free.filter(|one| **one == Role::Fit)
            .for_each(|one| *one = role);
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use mesh_damper_recording::Recording;

    use super::*;

    /// The samples that were measured, by their roles: to fit, to validate, held out.
    fn shares(pause: f64) -> [f64; 3] {
        let time = (0..1600).map(|n| n as f64 / 200.0 + if n < 800 { 0.0 } else { pause });
        let time: Vec<f64> = time.collect();
        let displacement: Vec<f64> = (0..1600)
            .map(|n| 0.1 * (TAU * 5.0 * n as f64 / 200.0).sin())
            .collect();
        let force = displacement.iter().map(|y| 8.0 * y).collect();
        let recording = Recording::new("joined", time, displacement, force).unwrap();
        let trajectories = [Trajectory::of(&recording).unwrap()];
        let mut roles = Roles::all_fit(&trajectories);
        roles.keep_apart(&trajectories, Role::HeldOut);
        roles.keep_apart(&trajectories, Role::Validation);
        [Role::Fit, Role::Validation, Role::HeldOut].map(|role| {
            let measured = (0..trajectories[0].len()).filter(|&i| trajectories[0].measured[i]);
            measured.filter(|&i| roles.of(0, i) == role).count() as f64 / 1600.0
        })
    }

    /// However long the pause of a joined file is, cycles of both parts are fitted.
    #[test]
    fn a_pause_is_nothing_to_hold_out() {
        for pause in [0.0, 1.0, 6.0, 20.0] {
            let shares = shares(pause);
            assert!(shares[0] > 0.45, "{pause} s: {shares:?}");
            assert!(shares[1] > 0.1 && shares[2] > 0.1, "{pause} s: {shares:?}");
        }
    }
}

//! The errors of a law on the held-out samples of the recordings, and on the rest.

use mesh_damper_model::predict::predict;
use mesh_damper_model::{Family, Model, ModelError};
use mesh_damper_recording::trajectory::Trajectory;

use super::closing::Closing;
use super::left_in_cycles::LeftInCycles;
use super::relative_error::RelativeError;
use super::remainder::depends_on;
use super::result::{Errors, Remainder};
use super::split::Role;
use super::verdict::OverNoise;
use crate::rows::Rows;
use crate::solution::Solution;
use crate::tolerance::certainty;

impl Closing<'_> {
    /// The errors of a law with these forces for each recording, kN, on the held-out samples and on the rest.
    pub(super) fn over_noise(&self, predicted: &[Vec<f64>]) -> OverNoise {
        let left = |held_out: bool| {
            let mut left = LeftInCycles::default();
            for ((trajectory, roles), predicted) in self.recordings.iter().zip(predicted) {
                left.add(trajectory, predicted, |sample| {
                    counts_as(roles[sample], held_out)
                });
            }
            left.in_most()
        };
        OverNoise {
            fitted: left(false),
            held_out: left(true),
        }
    }

    /// The error of a model on the held-out samples, recording by recording.
    pub(super) fn left_of_held_out(&self, model: &Model) -> Result<Vec<RelativeError>, ModelError> {
        let mut errors = Vec::new();
        for (trajectory, roles) in &self.recordings {
            let is_fair = |i: usize| roles[i] == Role::HeldOut && trajectory.is_telling(i);
            if !(0..roles.len()).any(is_fair) {
                continue;
            }
            let predicted = predict(model, trajectory)?;
            let all = 0..trajectory.len();
            let weight = |i: usize| certainty(trajectory, i);
            errors.extend(RelativeError::of(
                trajectory, &predicted, &all, is_fair, weight,
            ));
        }
        Ok(errors)
    }

    /// The remainder of a model on the samples that are `held_out`, or on the rest, and the variables that it depends on. Its size
    /// is `nrmse`, RMS over RMS of the force, and `times_noise`.
    pub(super) fn remainder(
        &self,
        model: &Model,
        held_out: bool,
        [nrmse, times_noise]: [f64; 2],
    ) -> Result<Remainder, ModelError> {
        let some = self.recordings.iter();
        let some = some.filter(|(_, roles)| roles.iter().any(|&role| counts_as(role, held_out)));
        let (trajectories, roles): (Vec<&Trajectory>, Vec<&Vec<Role>>) =
            some.map(|(trajectory, roles)| (*trajectory, roles)).unzip();
        let counts = |which: usize, sample: usize| counts_as(roles[which][sample], held_out);
        let depends_on = depends_on(&trajectories, counts, model)?.into_iter();
        Ok(Remainder {
            nrmse,
            times_noise,
            held_out,
            depends_on: depends_on.map(str::to_owned).collect(),
        })
    }

    /// The model's force on every recording, kN, and its errors.
    pub(super) fn evaluate(
        &self,
        model: &Model,
        predict: impl Fn(&Model, &Trajectory) -> Result<Vec<f64>, ModelError>,
    ) -> Result<(Vec<Vec<f64>>, Errors), ModelError> {
        let predicted = self
            .recordings
            .iter()
            .map(|(trajectory, _)| predict(model, trajectory))
            .collect::<Result<Vec<_>, _>>()?;
        let errors = Errors {
            nrmse_fitted: self.nrmse(&predicted, false),
            nrmse_held_out: self.nrmse(&predicted, true),
        };
        Ok((predicted, errors))
    }

    /// The error of `predicted`, kN for every sample of every recording, on the held-out samples or on the rest.
    fn nrmse(&self, predicted: &[Vec<f64>], held_out: bool) -> f64 {
        let each = self.recordings.iter().zip(predicted);
        let (error, force) = each.fold(
            (0.0, 0.0),
            |(error, force), ((trajectory, roles), predicted)| {
                let (more_error, more_force) = squares(trajectory, roles, predicted, held_out);
                (error + more_error, force + more_force)
            },
        );
        (error / force).sqrt()
    }

    /// The error of `model` on the held-out samples.
    pub(super) fn held_out(&self, model: &Model) -> Result<f64, ModelError> {
        let (mut error, mut force) = (0.0, 0.0);
        for (trajectory, roles) in &self.recordings {
            if roles.contains(&Role::HeldOut) {
                let predicted = predict(model, trajectory)?;
                let (more_error, more_force) = squares(trajectory, roles, &predicted, true);
                error += more_error;
                force += more_force;
            }
        }
        Ok((error / force).sqrt())
    }

    /// The held-out error of a law without the terms of one family.
    pub(super) fn without(
        &self,
        rows: &Rows,
        solution: &Solution,
        family: Family,
    ) -> Result<f64, ModelError> {
        let rest = solution.without_family(family);
        self.held_out(&self.fit_near(rows, &rest).model())
    }
}

/// Whether a sample is `held_out`, or one of the rest.
fn counts_as(role: Role, held_out: bool) -> bool {
    (role == Role::HeldOut) == held_out
}

/// Squares of the error of `predicted` and of the force, kN², on the held-out samples of a trajectory or on the rest. Held-out samples
/// count as whoever compares the prediction with the recording sees them, with a beginning that no model can know.
fn squares(
    trajectory: &Trajectory,
    roles: &[Role],
    predicted: &[f64],
    held_out: bool,
) -> (f64, f64) {
    let is_seen = |i: usize| match held_out {
        true => trajectory.measured[i],
        false => trajectory.is_comparable(i),
    };
    let counts = |&i: &usize| counts_as(roles[i], held_out) && is_seen(i);
    let of_part = (0..roles.len()).filter(counts);
    of_part.fold((0.0, 0.0), |(error, force), i| {
        let measured = trajectory.force[i];
        (
            error + (predicted[i] - measured).powi(2),
            force + measured * measured,
        )
    })
}

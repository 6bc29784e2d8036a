//! A rough law with a mass estimates the specimen's force before the search begins.

use mesh_damper::effects::Inertia;
use mesh_damper::law::Law;
use mesh_damper_model::ModelError;
use mesh_damper_recording::trajectory::Trajectory;

use super::Search;
use crate::families::inertia;
use crate::problem::Problem;
use crate::term::Term;

/// A rough estimate of the specimen's force at a moment.
pub struct Rough {
    law: Law<f64>,
    inertia: Inertia<f64>,
}

impl Rough {
    /// Force at a displacement in mm, a velocity in mm/s and an acceleration in mm/s², kN.
    pub fn force(&self, displacement: f64, velocity: f64, acceleration: f64) -> f64 {
        self.law.force(displacement, velocity) + self.inertia.force_at(acceleration)
    }

    /// Force at every sample of a recording, kN.
    pub fn predicted(&self, trajectory: &Trajectory) -> Vec<f64> {
        let motion = &trajectory.motion;
        let both = motion.displacement.iter().zip(&motion.velocity);
        both.zip(&motion.acceleration)
            .map(|((&y, &v), &a)| self.force(y, v, a))
            .collect()
    }
}

impl Search<'_> {
    /// Eq 13, with the specimen's mass if it clearly has one.
    ///
    /// # Errors
    /// The crate refuses a fitted law.
    pub fn rough(&self) -> Result<Rough, ModelError> {
        let fit = |terms: &[Term]| {
            let problem = Problem::new(&self.rows, &self.extent, terms);
            self.scored(problem.solve())
        };
        let mut best = fit(&[])?;
        // On a slow test the mass is undetermined, and the fit may give one that the crate refuses.
        let massive = fit(&[Term::sought(inertia::FORMS[0], 0.0)]);
        if let Ok(massive) = massive
            && massive.is_admissible()
            && massive.score.beats(&best.score)
        {
            best = massive;
        }
        let masses = best.solution.terms.iter().map(|value| value.size(0));
        let inertia = Inertia::new(masses.sum()).map_err(|error| ModelError::Refused {
            place: "a mass".to_owned(),
            error,
        })?;
        Ok(Rough {
            law: best.solution.model().law_at(0.0)?,
            inertia,
        })
    }
}

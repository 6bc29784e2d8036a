//! The search for the effects that the law lacks: one at a time, each judged on cycles it was not fitted to.

use rayon::prelude::*;

use super::score::Score;
use super::split::{Role, Roles, same_amplitude};
use crate::identify::problem::Problem;
use crate::identify::rows::Rows;
use crate::identify::solution::Solution;
use crate::identify::term::{Term, TermValue, most_terms};
use crate::model::{Family, ModelError};
use crate::predict::predict;
use crate::recording::trajectory::Trajectory;

/// Most terms beside eq 13.
const MOST_TERMS: usize = 6;
/// A law whose error is within so many times the noise lacks nothing that is larger than the noise; what a term could
/// still gain there is the error of the estimated motion.
const SETTLED: f64 = 1.5;
/// However quiet a recording, errors below this part of the force are those of the estimated motion. What was filtered
/// before it was written also looks quieter than it is.
const QUIET: f64 = 1e-3;
/// A search fits to at most about this many samples, evenly picked; the closing fit takes all.
const MOST_ROWS: usize = 20_000;

/// A fitted law and how it does on the cycles that judge.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// What was fitted.
    pub solution: Solution,
    /// Errors on the cycles that judge.
    pub score: Score,
}

/// One family tried beside the law found so far.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// What was tried.
    pub family: Family,
    /// At which step, from 1.
    pub step: usize,
    /// The law with it.
    pub fitted: Fitted,
    /// Whether the judging cycles tell it from the step's best.
    pub distinguishable: bool,
    /// Whether it was added to the law at this step.
    pub added: bool,
    /// Whether no term of it would be a source of energy, or a mass that pushes.
    pub admissible: bool,
}

/// What a search ended in.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Eq 13 alone.
    pub baseline: Fitted,
    /// Eq 13 with the effects found.
    pub found: Fitted,
    /// All that was tried, step by step, the best first.
    pub candidates: Vec<Candidate>,
}

/// The search over one set of data.
pub struct Search<'a> {
    trajectories: &'a [Trajectory],
    roles: &'a Roles,
    rows: Rows<'a>,
    families: Vec<Term>,
    noise_floor: f64,
}

impl<'a> Search<'a> {
    /// A search with eq 13's coefficients at the amplitudes `nodes`.
    pub fn new(trajectories: &'a [Trajectory], roles: &'a Roles, nodes: Vec<f64>) -> Self {
        let temperature = trajectories
            .iter()
            .find_map(|t| t.temperature.as_ref()?.first().copied());
        let families = Family::ALL
            .into_iter()
            .filter(|&family| family != Family::Temperature || temperature.is_some())
            .map(|family| Term {
                family,
                reference: temperature.unwrap_or_default(),
            })
            .collect();
        Self {
            trajectories,
            roles,
            rows: Rows::gather(trajectories, nodes, |which, sample| {
                roles.of(which, sample) == Role::Fit
            })
            .thinned(MOST_ROWS),
            families,
            noise_floor: noise_floor(trajectories),
        }
    }

    /// Adds effects while one of them makes the judging cycles' error clearly smaller, then drops those that became
    /// needless. `progress` is called after each step with what is being done.
    ///
    /// # Errors
    /// A fitted law that the crate refuses.
    pub fn run(&self, progress: &(dyn Fn(&str) + Sync)) -> Result<Selection, ModelError> {
        progress("fitting eq 13");
        let baseline = self.fit(&[], None)?;
        let mut found = baseline.clone();
        let mut candidates = Vec::new();
        for step in 1..=MOST_TERMS {
            progress(&format!(
                "trying {} effects beside {}",
                self.families.len(),
                named(&found)
            ));
            let mut tried = self.step(&found, step);
            let Some(best) = tried.first_mut() else { break };
            let settled = found.score.nrmse() <= SETTLED * goal(self.noise_floor);
            let accepted = best.admissible && !settled && best.fitted.score.beats(&found.score);
            let next = best.fitted.clone();
            best.added = accepted;
            candidates.extend(tried);
            if !accepted {
                break;
            }
            found = next;
        }
        found = self.prune(found)?;
        Ok(Selection {
            baseline,
            found,
            candidates,
        })
    }

    /// All families beside `law`, the best first, those that are not admissible last.
    fn step(&self, law: &Fitted, step: usize) -> Vec<Candidate> {
        let known: Vec<Term> = law.solution.terms.iter().map(|value| value.term).collect();
        let mut tried: Vec<Candidate> = self
            .families
            .par_iter()
            .filter(|term| {
                known.iter().filter(|k| k.family == term.family).count() < most_terms(term.family)
            })
            .map(|&term| {
                let terms: Vec<Term> = known.iter().copied().chain([term]).collect();
                self.fit(&terms, Some(&law.solution))
                    .map(|fitted| Candidate {
                        family: term.family,
                        step,
                        admissible: fitted
                            .solution
                            .terms
                            .iter()
                            .all(|value| !value.term.size_is_positive() || value.size > 0.0),
                        fitted,
                        distinguishable: true,
                        added: false,
                    })
            })
            // A fit that ends in coefficients which the crate refuses is no candidate.
            .filter_map(Result::ok)
            .collect();
        tried.sort_by(|a, b| {
            let score = |candidate: &Candidate| candidate.fitted.score.nrmse();
            b.admissible
                .cmp(&a.admissible)
                .then(score(a).total_cmp(&score(b)))
        });
        if let Some((best, rest)) = tried.split_first_mut() {
            for rival in rest {
                rival.distinguishable =
                    !rival.admissible || best.fitted.score.beats(&rival.fitted.score);
            }
        }
        tried
    }

    /// Drops terms without which the judging cycles are predicted as well.
    fn prune(&self, found: Fitted) -> Result<Fitted, ModelError> {
        let mut found = found;
        let mut index = 0;
        while found.solution.terms.len() > 1 && index < found.solution.terms.len() {
            let mut terms: Vec<Term> = found
                .solution
                .terms
                .iter()
                .map(|value| value.term)
                .collect();
            terms.remove(index);
            let without = self.fit(&terms, None)?;
            if found.score.beats(&without.score) {
                index += 1;
            } else {
                found = without;
                index = 0;
            }
        }
        Ok(found)
    }

    fn fit(&self, terms: &[Term], start: Option<&Solution>) -> Result<Fitted, ModelError> {
        let solution = Problem::solve(&self.rows, terms, start);
        let model = solution.model();
        let predicted = self
            .trajectories
            .iter()
            .map(|trajectory| predict(&model, trajectory))
            .collect::<Result<Vec<_>, _>>()?;
        let score = Score::of(self.trajectories, self.roles, Role::Judge, &predicted);
        Ok(Fitted { solution, score })
    }
}

/// How well a law with coefficients at the amplitudes `nodes` predicts an amplitude that it was not fitted to: each inner
/// node in turn is left out, and the root of the summed squared error there is returned, kN.
pub fn error_between(
    trajectories: &[Trajectory],
    nodes: &[f64],
    left_out: &[f64],
    terms: &[TermValue],
) -> Result<f64, ModelError> {
    let terms: Vec<Term> = terms.iter().map(|value| value.term).collect();
    let mut error = 0.0;
    for &amplitude in left_out {
        let is_left_out = |which: usize, sample: usize| {
            let trajectory: &Trajectory = &trajectories[which];
            same_amplitude(trajectory.amplitude[sample], amplitude)
        };
        let others = nodes
            .iter()
            .copied()
            .filter(|&node| node != amplitude)
            .collect();
        let rows = Rows::gather(trajectories, others, |which, sample| {
            !is_left_out(which, sample)
        });
        let model = Problem::solve(&rows, &terms, None).model();
        for (which, trajectory) in trajectories.iter().enumerate() {
            let predicted = predict(&model, trajectory)?;
            error += (0..trajectory.len())
                .filter(|&sample| is_left_out(which, sample))
                .map(|sample| (predicted[sample] - trajectory.force[sample]).powi(2))
                .sum::<f64>();
        }
    }
    Ok(error.sqrt())
}

fn named(law: &Fitted) -> String {
    law.solution
        .terms
        .iter()
        .fold("eq 13".to_owned(), |text, value| {
            format!("{text} + {}", value.term.family)
        })
}

/// The noise of the force over its RMS; of several recordings the root of the mean square.
pub fn noise_floor(trajectories: &[Trajectory]) -> f64 {
    let squares = trajectories.iter().map(|trajectory| {
        let power = trajectory
            .force
            .iter()
            .map(|force| force * force)
            .sum::<f64>()
            / trajectory.len() as f64;
        trajectory.force_noise.powi(2) / power
    });
    (squares.sum::<f64>() / trajectories.len() as f64).sqrt()
}

/// The error that a law is held to: the noise, or [`QUIET`] where the recording is quieter.
pub fn goal(noise_floor: f64) -> f64 {
    noise_floor.max(QUIET)
}

/// The amplitudes in mm of the blocks that are fitted, those that are nearly the same taken as one.
pub fn amplitude_nodes(trajectories: &[Trajectory], roles: &Roles) -> Vec<f64> {
    let mut amplitudes: Vec<f64> = trajectories
        .iter()
        .enumerate()
        .flat_map(|(which, trajectory)| {
            let fitted = trajectory.blocks.iter().filter(move |block| {
                block
                    .samples
                    .clone()
                    .any(|sample| roles.of(which, sample) == Role::Fit)
            });
            fitted.map(|block| block.amplitude)
        })
        .collect();
    amplitudes.sort_by(f64::total_cmp);
    let mut nodes: Vec<Vec<f64>> = Vec::new();
    for amplitude in amplitudes {
        match nodes.last_mut() {
            Some(node) if same_amplitude(node[0], amplitude) => node.push(amplitude),
            _ => nodes.push(vec![amplitude]),
        }
    }
    nodes
        .iter()
        .map(|node| node.iter().sum::<f64>() / node.len() as f64)
        .collect()
}

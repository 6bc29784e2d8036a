//! The search for missing effects: one at a time, each judged on cycles that it was not fitted to.

use std::cmp::Ordering;
use std::sync::{Arc, OnceLock};

use mesh_damper::effects::Inertia;
use mesh_damper::law::Law;
use mesh_damper_model::predict::predict;
use mesh_damper_model::{Family, ModelError};
use mesh_damper_recording::cycles::{FoundBlock, levels, same_amplitude};
use mesh_damper_recording::trajectory::Trajectory;
use rayon::prelude::*;

use super::fitted::Fitted;
use super::rule::Rule;
use super::ruled_out;
use super::score::{Jury, Score};
use super::sought::Sought;
use super::split::{Role, Roles};
use super::tones::{OfMotion, tones};
use super::within_blocks::is_seen_within_blocks;
use crate::base_law::BaseLaw;
use crate::families::{Form, drift, inertia};
use crate::known_terms::KnownTerm;
use crate::policy::policy;
use crate::problem::Problem;
use crate::rows::Rows;
use crate::screen::{Screen, Start};
use crate::shape::Extent;
use crate::solution::Solution;
use crate::term::Term;
use crate::tolerance::goal;

mesh_damper_recording::numbers! {
    /// The search for effects.
    SelectPolicy {
        /// A search adds at most this many terms to the law.
        most_terms: usize = 6, Convention("a search ends long before, when nothing is gained");
        /// This many of the best laws enter the next step of a search: the best law with one effect need not be part of the best with two.
        beam: usize = 3, Tuned("the blind trial");
        /// At most this many candidates of a step are fitted, those with the largest predicted gain. The others keep the parameters of
        /// their best starting value.
        fitted: usize = 4, Tuned("the blind trial");
        /// A candidate is fitted only if its predicted gain exceeds this fraction of the largest.
        promising: f64 = 0.5, Tuned("the blind trial");
        /// A candidate is fitted from at most this many starting values.
        starts: usize = 2, Tuned("the blind trial");
    }
}

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
}

/// One effect that was tried in addition to an earlier law.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The family that was tried.
    pub family: Family,
    /// The step, from 1.
    pub step: usize,
    /// The law with it.
    pub fitted: Fitted,
    /// Whether the judging cycles distinguish it from the step's best.
    pub distinguishable: bool,
    /// Whether it became the law at this step.
    pub added: bool,
    /// Whether all its terms are admissible: none is a source of energy, a mass that pushes, a drift that stands still in every
    /// block, or a drift that the temperature explains.
    pub admissible: bool,
    /// Whether it was fitted. Otherwise it was rated with the parameters of the start of a fit.
    pub was_fitted: bool,
    /// Whether a shape has a value at which the data cannot distinguish the effect from a simpler one.
    pub degenerate: bool,
    /// The rule by which it is not in the law; none if it is, or if the data do not distinguish it from an effect in the law.
    pub rejected_by: Option<Rule>,
}

/// The result of a search.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Eq 13 alone.
    pub baseline: Fitted,
    /// Eq 13 with the effects found.
    pub found: Fitted,
    /// All candidates, step by step, the best first.
    pub candidates: Vec<Candidate>,
    /// The tolerated error on the judging cycles.
    pub goal: f64,
}

/// The search over one set of data.
pub struct Search<'a> {
    trajectories: &'a [Trajectory],
    jury: Jury<'a>,
    roles: &'a Roles,
    rows: Rows<'a>,
    extent: Extent,
    terms: Vec<Term>,
    known: Vec<KnownTerm>,
    /// Computed when a tone is searched for.
    of_motion: Arc<OnceLock<OfMotion>>,
}

impl<'a> Search<'a> {
    /// A search with separate coefficients of eq 13 at the amplitudes `nodes`, for effects that `sought` permits.
    pub fn new(
        trajectories: &'a [Trajectory],
        roles: &'a Roles,
        nodes: Vec<f64>,
        sought: &Sought,
    ) -> Self {
        let temperature = trajectories
            .iter()
            .find_map(|t| t.temperature.as_ref()?.first().copied());
        let terms = Form::all()
            .filter(|&form| sought.has(form.family()))
            .filter(|form| form.is_seen_in(trajectories))
            .map(|form| Term {
                form,
                reference: temperature.unwrap_or_default(),
                is_known: false,
            })
            .collect();
        Self {
            trajectories,
            jury: Jury::of(trajectories, roles, Role::Judge),
            roles,
            rows: Rows::gather(
                trajectories,
                sought.law,
                nodes,
                policy().rows.search,
                |which, sample| roles.of(which, sample) == Role::Fit,
            ),
            extent: Extent::of(trajectories),
            terms,
            known: sought.known.clone(),
            of_motion: Arc::default(),
        }
    }

    /// The same search with coefficients of eq 13 at other amplitudes.
    #[must_use]
    pub fn with_nodes(&self, nodes: Vec<f64>) -> Self {
        Self {
            rows: self.rows.with_nodes(nodes),
            jury: self.jury.clone(),
            roles: self.roles,
            extent: self.extent.clone(),
            terms: self.terms.clone(),
            known: self.known.clone(),
            of_motion: self.of_motion.clone(),
            trajectories: self.trajectories,
        }
    }

    /// Adds effects while one of them clearly reduces the error on the judging cycles, then drops those that became unnecessary.
    /// `progress` is called before each step with a description of it.
    ///
    /// # Errors
    /// The crate refuses a fitted law.
    pub fn run(&self, progress: &(dyn Fn(&str) + Sync)) -> Result<Selection, ModelError> {
        progress("fitting the law");
        let baseline = self.judged(self.without_more())?;
        let mut found = baseline.clone();
        let mut beam = vec![baseline.clone()];
        let mut candidates = Vec::new();
        for step in 1..=policy().select.most_terms {
            progress(&format!(
                "trying {} forms of effects in addition to {}",
                self.terms.len(),
                found.named()
            ));
            let may_add = !self.is_settled(&found);
            let mut tried = self.step(
                &beam,
                step,
                if may_add { policy().select.fitted } else { 0 },
            );
            let Some(best) = tried.first_mut() else { break };
            let accepted = may_add && best.admissible && best.fitted.score.beats(&found.score);
            let next = best.fitted.clone();
            best.added = accepted;
            if !accepted {
                ruled_out::by_the_law_before(&mut tried, may_add);
            }
            beam = tried
                .iter()
                .filter(|candidate| candidate.admissible)
                .map(|candidate| candidate.fitted.clone())
                .take(policy().select.beam)
                .collect();
            candidates.extend(tried);
            if !accepted {
                break;
            }
            // A law near the noise is refined too: a missing term distorts its parameters.
            found = self.refined(&next);
            if let Some(first) = beam.first_mut() {
                *first = found.clone();
            }
        }
        found = self.prune(self.unrefined(found)?)?;
        ruled_out::in_the_end(&mut candidates, &found);
        Ok(Selection {
            baseline,
            found,
            candidates,
            goal: self.goal(),
        })
    }

    /// The law with the known effects.
    fn without_more(&self) -> Solution {
        let mut terms = Vec::new();
        let mut law = Problem::new(&self.rows, &self.extent, &terms).solve();
        for known in &self.known {
            terms.push(known.term);
            let problem = Problem::new(&self.rows, &self.extent, &terms);
            law = problem.solve_from(&law, &known.shapes);
        }
        law
    }

    /// Laws made of `rest` and one effect of a family that `law` does not have in addition to it, which predict the judging cycles
    /// as well as `law`: the best for each family.
    ///
    /// # Errors
    /// The crate refuses a fitted law.
    pub fn rivals(&self, law: &Solution, rest: &Solution) -> Result<Vec<Solution>, ModelError> {
        let refit = |known: &Solution| {
            let problem = Problem::new(&self.rows, &self.extent, &known.terms());
            self.judged(problem.solve_near(known))
        };
        let (law, rest) = (refit(law)?, refit(rest)?);
        let families = law.families();
        let is_other = |term: &&Term| !families.contains(&term.form.family());
        let others: Vec<Term> = self.terms.iter().filter(is_other).copied().collect();
        let mut beside = self.beside(&rest, &others, policy().select.fitted);
        beside.retain(|(_, rival, _)| rival.is_admissible() && !law.score.beats(&rival.score));
        beside.sort_by(|(_, a, _), (_, b, _)| a.score.nrmse().total_cmp(&b.score.nrmse()));
        let mut known: Vec<Family> = Vec::new();
        beside.retain(|(term, ..)| {
            let is_new = !known.contains(&term.form.family());
            known.push(term.form.family());
            is_new
        });
        Ok(beside
            .into_iter()
            .map(|(_, rival, _)| rival.solution)
            .collect())
    }

    /// Eq 13, with the specimen's mass if it clearly has one.
    ///
    /// # Errors
    /// The crate refuses a fitted law.
    pub fn rough(&self) -> Result<Rough, ModelError> {
        let fit = |terms: &[Term]| {
            let problem = Problem::new(&self.rows, &self.extent, terms);
            self.judged(problem.solve())
        };
        let mut best = fit(&[])?;
        // On a slow test the mass is undetermined, and the fit may give one that the crate refuses.
        let massive = fit(&[Term {
            form: inertia::FORMS[0],
            reference: 0.0,
            is_known: false,
        }]);
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

    fn of_motion(&self) -> &OfMotion {
        self.of_motion
            .get_or_init(|| OfMotion::of(self.trajectories))
    }

    /// Whether the error is within the noise.
    pub fn is_settled(&self, law: &Fitted) -> bool {
        law.score.nrmse() <= policy().verdict.noise_limited * self.goal()
    }

    /// The tolerated error on the judging cycles: the noise, or [`quiet`](crate::tolerance::TolerancePolicy::quiet) if the
    /// recording is quieter.
    pub fn goal(&self) -> f64 {
        goal(self.jury.noise())
    }

    /// The same terms with coefficients of other nodes.
    ///
    /// # Errors
    /// The crate refuses a fitted law.
    pub fn refit(&self, law: &Fitted) -> Result<Fitted, ModelError> {
        let problem = Problem::new(&self.rows, &self.extent, &law.solution.terms());
        self.judged(problem.solve_near(&law.solution))
    }

    /// All forms in addition to each law of `beam`, the best first and inadmissible ones last; at most `most` for each law are
    /// fitted.
    fn step(&self, beam: &[Fitted], step: usize, most: usize) -> Vec<Candidate> {
        // A refined form of another family's effect is no separate step: see `refined`.
        let is_step = |term: &&Term| {
            !term.form.refines || term.form.special_cases.contains(&term.form.family)
        };
        let steps: Vec<Term> = self.terms.iter().filter(is_step).copied().collect();
        let mut tried: Vec<Candidate> = beam
            .par_iter()
            .flat_map(|law| self.beside(law, &steps, most))
            .map(|(term, fitted, was_fitted)| {
                let rejected_by = if !fitted.is_admissible() {
                    Some(Rule::NotPassive)
                } else if fitted.has_tone(self.of_motion()) {
                    Some(Rule::InStepWithMotion)
                } else {
                    // A law that the crate refuses without its drift is inadmissible with it.
                    let stands_still = self.stands_still(&fitted).unwrap_or(true);
                    stands_still.then_some(Rule::StandsStill)
                };
                Candidate {
                    family: term.form.family(),
                    step,
                    admissible: rejected_by.is_none(),
                    was_fitted,
                    degenerate: fitted.is_degenerate(&self.extent),
                    fitted,
                    distinguishable: true,
                    added: false,
                    rejected_by,
                }
            })
            .collect();
        tried.sort_by(|a, b| {
            let score = |candidate: &Candidate| candidate.fitted.score.nrmse();
            b.admissible
                .cmp(&a.admissible)
                .then(score(a).total_cmp(&score(b)))
        });
        // The same terms found in another order are one candidate.
        let mut known: Vec<Vec<usize>> = Vec::new();
        tried.retain(|candidate| {
            let forms = candidate.fitted.forms();
            let is_new = !known.contains(&forms);
            known.push(forms);
            is_new
        });
        let warmed: Vec<(Vec<Family>, Score)> = tried
            .iter()
            .filter(|candidate| candidate.admissible)
            .map(|candidate| (candidate.fitted.families(), candidate.fitted.score.clone()))
            .filter(|(families, _)| {
                families
                    .iter()
                    .any(|family| family.depends_on_temperature())
            })
            .collect();
        for candidate in &mut tried {
            if candidate.admissible && candidate.fitted.is_but_warmth(&warmed) {
                candidate.admissible = false;
                candidate.rejected_by = Some(Rule::Warmth);
            }
        }
        tried.sort_by_key(|candidate| !candidate.admissible);
        self.prefer(&mut tried);
        while let Some(best) = tried.first_mut()
            && best.admissible
            && self.is_but_simpler_ones(&best.fitted, most)
        {
            best.admissible = false;
            best.rejected_by = Some(Rule::SimplerOnes);
            tried.sort_by_key(|candidate| !candidate.admissible);
            self.prefer(&mut tried);
        }
        if let Some((best, rest)) = tried.split_first_mut() {
            for rival in rest {
                // A candidate that contains the best and does no better is at the limit of its shapes.
                rival.degenerate |= rival.fitted.includes(&best.fitted);
                rival.distinguishable =
                    !rival.admissible || best.fitted.score.beats(&rival.fitted.score);
            }
        }
        ruled_out::by_the_best(&mut tried);
        tried
    }

    /// Whether two simpler effects that the last one contains do equally well in its place. Without this test it would replace any
    /// two of them.
    fn is_but_simpler_ones(&self, law: &Fitted, most: usize) -> bool {
        let terms = &law.solution.terms;
        let Some(last) = terms.last().map(|value| value.term.form) else {
            return false;
        };
        if last.special_cases.is_empty() || last.refines || most == 0 {
            return false;
        }
        let is_special = |term: &Term| last.special_cases.contains(&term.form.family);
        let simpler: Vec<Term> = self.terms.iter().copied().filter(is_special).collect();
        let rest = law.solution.without(terms.len() - 1);
        let Ok(mut rest) = self.judged(rest) else {
            return false;
        };
        for _ in 0..2 {
            let beside = self.beside(&rest, &simpler, simpler.len());
            let admissible = beside.into_iter().filter(|(_, law, _)| law.is_admissible());
            let better = admissible
                .min_by(|(_, a, _), (_, b, _)| a.score.nrmse().total_cmp(&b.score.nrmse()));
            let Some((_, better, _)) = better else {
                return false;
            };
            rest = better;
        }
        !self.refined(law).score.beats(&rest.score)
    }

    /// The law with its last effect in a refined form, if that is clearly better and the data distinguish it from a simpler one;
    /// otherwise unchanged.
    fn refined(&self, law: &Fitted) -> Fitted {
        let Some(last) = law.solution.terms.last().map(|value| value.term.form) else {
            return law.clone();
        };
        let refines =
            |term: &Term| term.form.refines && term.form.special_cases.contains(&last.family);
        let refining: Vec<Term> = self.terms.iter().copied().filter(refines).collect();
        if refining.is_empty() {
            return law.clone();
        }
        let refined = self.beside(law, &refining, refining.len()).into_iter();
        let refined = refined.map(|(_, refined, _)| refined);
        let better = refined.filter(|refined| {
            refined.is_admissible()
                && !refined.is_degenerate(&self.extent)
                && refined.score.beats(&law.score)
        });
        better
            .min_by(|a, b| a.score.nrmse().total_cmp(&b.score.nrmse()))
            .unwrap_or_else(|| law.clone())
    }

    /// Moves the [preferred](Self::preferred) one to the front.
    fn prefer(&self, tried: &mut Vec<Candidate>) {
        let preferred = self.preferred(tried);
        if preferred > 0 {
            let preferred = tried.remove(preferred);
            tried.insert(0, preferred);
        }
    }

    /// The best of `tried`, which are in order, or a simpler one that does equally well. Simpler means: fewer parameters and the
    /// same families; or as many parameters in forms that are tried first; or the effect that the best becomes, or may become, at
    /// the limit of its shape.
    fn preferred(&self, tried: &[Candidate]) -> usize {
        let Some(best) = tried.first() else { return 0 };
        let simpler = |candidate: &Candidate| {
            let (fitted, best_fitted) = (&candidate.fitted, &best.fitted);
            let same = fitted.families() == best_fitted.families();
            match fitted.parameters().cmp(&best_fitted.parameters()) {
                Ordering::Less => best.degenerate || same || best_fitted.includes(fitted),
                Ordering::Equal => {
                    same && fitted.rank() < best_fitted.rank() || best_fitted.includes(fitted)
                }
                Ordering::Greater => false,
            }
        };
        tried
            .iter()
            .position(|candidate| {
                candidate.admissible
                    && !candidate.degenerate
                    && simpler(candidate)
                    && !best.fitted.score.beats(&candidate.fitted.score)
            })
            .unwrap_or(0)
    }

    /// Whether it has a drift that the cycles within blocks do not show.
    fn stands_still(&self, law: &Fitted) -> Result<bool, ModelError> {
        let mut terms = law.solution.terms.iter();
        let Some(drift) = terms.position(|value| value.term.form.family == drift::OF_EACH.family)
        else {
            return Ok(false);
        };
        let counts = |which: usize, sample: usize| {
            self.roles.is_open(which, sample) && self.trajectories[which].is_telling(sample)
        };
        let all = self.trajectories;
        let still = law.solution.without(drift).predicted(all)?;
        let changing = law.solution.predicted(all)?;
        Ok(!is_seen_within_blocks(all, counts, &changing, &still))
    }

    /// Each of `terms` added to `law`, and whether it was fitted. At most the `most` most promising ones are fitted; the others
    /// have their start parameters.
    fn beside(&self, law: &Fitted, terms: &[Term], most: usize) -> Vec<(Term, Fitted, bool)> {
        let known = law.solution.terms();
        // The crate does not refuse a law that was judged.
        let predicted = law
            .solution
            .predicted(self.trajectories)
            .unwrap_or_default();
        let extent = self.extent.with_tones(tones(
            self.trajectories,
            self.roles,
            &predicted,
            self.of_motion(),
        ));
        drop(predicted);
        let screen = Screen::at(&self.rows, &extent, &law.solution);
        // The work differs between candidates by orders of magnitude.
        let mut rated: Vec<(Term, Solution, Vec<Start>)> = terms
            .par_iter()
            .with_max_len(1)
            .flat_map(|&term| {
                let beside = (!term.form.refines && may_stand(term, &known))
                    .then(|| (term, law.solution.clone(), screen.starts(term)));
                // A form that may be several simpler ones may already contain the last of them.
                let is_special = |known: &Term| {
                    !known.is_known && term.form.special_cases.contains(&known.form.family)
                };
                let rest = known.iter().rposition(is_special);
                let rest = rest.map(|index| law.solution.without(index));
                let rest = rest.filter(|rest| may_stand(term, &rest.terms()));
                let in_place = rest.map(|rest| {
                    let starts = Screen::at(&self.rows, &extent, &rest).starts(term);
                    (term, rest, starts)
                });
                [beside, in_place].into_par_iter().flatten()
            })
            .filter(|(_, _, starts)| !starts.is_empty())
            .collect();
        rated.sort_by(|a, b| b.2[0].gain.total_cmp(&a.2[0].gain));
        let promising =
            policy().select.promising * rated.first().map_or(0.0, |(_, _, starts)| starts[0].gain);
        rated
            .into_par_iter()
            .with_max_len(1)
            .enumerate()
            .filter_map(|(place, (term, base, starts))| {
                let terms: Vec<Term> = base.terms().into_iter().chain([term]).collect();
                let problem = Problem::new(&self.rows, &extent, &terms);
                let is_fitted = place < most && starts[0].gain > promising;
                let solution = if is_fitted {
                    starts[..policy().select.starts.min(starts.len())]
                        .par_iter()
                        .map(|start| problem.solve_from(&base, &start.shapes))
                        .min_by(|a, b| a.squares.total_cmp(&b.squares))?
                } else {
                    problem.solve_at(&base, &starts[0].shapes)
                };
                // A fit with coefficients that the crate refuses is no candidate.
                Some((term, self.judged(solution).ok()?, is_fitted))
            })
            .collect()
    }

    /// The law with simpler forms in place of refined ones, if they do equally well: a form that was refined while another effect
    /// was still missing may have covered for that effect.
    fn unrefined(&self, found: Fitted) -> Result<Fitted, ModelError> {
        let mut found = found;
        let mut index = 0;
        while let Some(term) = found.solution.terms.get(index).map(|value| value.term) {
            index += 1;
            if term.is_known || !term.form.refines {
                continue;
            }
            let is_simpler = |other: &&Term| {
                !other.form.refines && term.form.special_cases.contains(&other.form.family)
            };
            let simpler: Vec<Term> = self.terms.iter().filter(is_simpler).copied().collect();
            let rest = self.judged(found.solution.without(index - 1))?;
            let others = self.beside(&rest, &simpler, simpler.len()).into_iter();
            let others = others.map(|(_, other, _)| other);
            let best = others
                .filter(Fitted::is_admissible)
                .min_by(|a, b| a.score.nrmse().total_cmp(&b.score.nrmse()));
            if let Some(best) = best
                && !found.score.beats(&best.score)
            {
                found = best;
                index = 0;
            }
        }
        Ok(found)
    }

    /// Drops terms without which the judging cycles are predicted equally well.
    fn prune(&self, found: Fitted) -> Result<Fitted, ModelError> {
        let mut found = found;
        let mut index = 0;
        while found.solution.found().count() > 1 && index < found.solution.terms.len() {
            if found.solution.terms[index].term.is_known {
                index += 1;
                continue;
            }
            let rest = found.solution.without(index);
            let problem = Problem::new(&self.rows, &self.extent, &rest.terms());
            let without = self.judged(problem.solve_near(&rest))?;
            if found.score.beats(&without.score) {
                index += 1;
            } else {
                found = without;
                index = 0;
            }
        }
        Ok(found)
    }

    fn judged(&self, solution: Solution) -> Result<Fitted, ModelError> {
        let model = solution.model();
        let score = self.jury.score(|trajectory| predict(&model, trajectory))?;
        Ok(Fitted { solution, score })
    }
}

/// Whether a term may be added to the `known` ones.
fn may_stand(term: Term, known: &[Term]) -> bool {
    let same = known.iter().filter(|known| known.form == term.form).count();
    same < term.form.most && !known.iter().any(|known| known.form.excludes(term.form))
}

/// How well a law with coefficients at the amplitudes `nodes` predicts an amplitude that it was not fitted to. Each inner node in
/// turn is left out; returns the root of the summed squared error there, kN. Samples that `roles` hold out are not used.
pub fn error_between(
    trajectories: &[Trajectory],
    roles: &Roles,
    nodes: &[f64],
    left_out: &[f64],
    (found, law): (&Solution, BaseLaw),
) -> Result<f64, ModelError> {
    let extent = Extent::of(trajectories);
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
        let rows = Rows::gather(
            trajectories,
            law,
            others,
            policy().rows.search,
            |which, sample| roles.is_open(which, sample) && !is_left_out(which, sample),
        );
        let model = Problem::new(&rows, &extent, &found.terms())
            .solve_near(found)
            .model();
        for (which, trajectory) in trajectories.iter().enumerate() {
            let predicted = predict(&model, trajectory)?;
            error += (0..trajectory.len())
                .filter(|&sample| roles.is_open(which, sample) && is_left_out(which, sample))
                .map(|sample| (predicted[sample] - trajectory.force[sample]).powi(2))
                .sum::<f64>();
        }
    }
    Ok(error.sqrt())
}

/// The levels of amplitude in mm of the fitted blocks.
pub fn amplitude_nodes(trajectories: &[Trajectory], roles: &Roles) -> Vec<f64> {
    let is_fitted = |which: usize, block: &FoundBlock| {
        let mut samples = block.samples.clone();
        samples.any(|sample| roles.of(which, sample) == Role::Fit)
    };
    let each = trajectories.iter().enumerate();
    levels(each.flat_map(|(which, trajectory)| {
        let fitted = trajectory
            .blocks
            .iter()
            .filter(move |block| is_fitted(which, block));
        fitted.map(|block| block.amplitude)
    }))
}

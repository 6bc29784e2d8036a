//! One step tries every effect in addition to the best laws, and rates what it finds.

use std::cmp::Ordering;

use mesh_damper_model::{Family, ModelError};
use rayon::prelude::*;

use super::super::fitted::Fitted;
use super::super::rule::Rule;
use super::super::ruled_out;
use super::super::score::Score;
use super::super::within_blocks::is_seen_within_blocks;
use super::Search;
use crate::families::drift;
use crate::term::Term;

/// One effect that was tried in addition to an earlier law.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The family that was tried.
    pub family: Family,
    /// The step, from 1.
    pub step: usize,
    /// The law with it.
    pub fitted: Fitted,
    /// Whether the validation cycles distinguish it from the step's best.
    pub distinguishable: bool,
    /// Whether it became the law at this step.
    pub added: bool,
    /// Whether all its terms are admissible: none is a source of energy, a drift that stands still in every
    /// block, or a drift that the temperature explains.
    pub admissible: bool,
    /// Whether it was fitted. Otherwise it was rated with the parameters of the start of a fit.
    pub was_fitted: bool,
    /// Whether a shape has a value at which the data cannot distinguish the effect from a simpler one.
    pub degenerate: bool,
    /// The rule by which it is not in the law; none if it is, or if the data do not distinguish it from an effect in the law.
    pub rejected_by: Option<Rule>,
}

impl Search<'_> {
    /// All forms in addition to each law of `beam`, the best first and inadmissible ones last; at most `most` for each law are
    /// fitted.
    pub(super) fn step(&self, beam: &[Fitted], step: usize, most: usize) -> Vec<Candidate> {
        let steps = self.steps();
        let mut tried: Vec<Candidate> = beam
            .par_iter()
            .flat_map(|law| self.beside(law, &steps, most))
            .map(|(term, fitted, was_fitted)| {
                let rejected_by = self.rejected_by(&fitted);
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

    /// The terms that a step may add. A refined form of another family's effect is no separate step: see `refined`.
    pub(super) fn steps(&self) -> Vec<Term> {
        let is_step = |term: &&Term| {
            !term.form.refines || term.form.special_cases.contains(&term.form.family)
        };
        self.terms.iter().filter(is_step).copied().collect()
    }

    /// The reason why a law is not admissible.
    pub(super) fn rejected_by(&self, law: &Fitted) -> Option<Rule> {
        if !law.is_admissible() {
            return Some(Rule::NotPassive);
        }
        if law.has_tone(self.of_motion()) {
            return Some(Rule::InStepWithMotion);
        }
        // A law that the crate refuses without its drift is inadmissible with it.
        let stands_still = self.stands_still(law).unwrap_or(true);
        stands_still.then_some(Rule::StandsStill)
    }

    /// Whether two simpler effects that the last one contains are better in its place. Without this test it would replace any two of
    /// them.
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
        let Ok(mut rest) = self.scored(rest) else {
            return false;
        };
        for _ in 0..2 {
            let beside = self.beside(&rest, &simpler, simpler.len());
            let admissible = beside.into_iter().filter(|(_, law, _)| law.is_admissible());
            let better = admissible.min_by(|(_, a, _), (_, b, _)| a.by_error(b));
            let Some((_, better, _)) = better else {
                return false;
            };
            rest = better;
        }
        rest.score.beats(&self.refined(law).score)
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
}

//! A law gets one more term: the screen rates every term, and the promising ones are fitted.

use rayon::prelude::*;

use super::super::fitted::Fitted;
use super::super::tones::tones;
use super::Search;
use crate::problem::Problem;
use crate::screen::{Screen, Start};
use crate::solution::Solution;
use crate::term::Term;
use crate::trace::select::SelectPolicy;

impl Search<'_> {
    /// Each of `terms` added to `law`, and whether it was fitted. At most the `most` most promising ones are fitted; the others
    /// have their start parameters.
    pub(super) fn beside(
        &self,
        law: &Fitted,
        terms: &[Term],
        most: usize,
    ) -> Vec<(Term, Fitted, bool)> {
        let known = law.solution.terms();
        // The crate does not refuse a law that was scored.
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
        let promising = SelectPolicy::in_use().promising
            * rated.first().map_or(0.0, |(_, _, starts)| starts[0].gain);
        rated
            .into_par_iter()
            .with_max_len(1)
            .enumerate()
            .filter_map(|(place, (term, base, starts))| {
                let terms: Vec<Term> = base.terms().into_iter().chain([term]).collect();
                let problem = Problem::new(&self.rows, &extent, &terms);
                let is_fitted = place < most && starts[0].gain > promising;
                let solution = if is_fitted {
                    let starts = starts.iter().take(SelectPolicy::in_use().starts);
                    problem.solve_from_best(&base, starts.map(|start| &start.shapes[..]))?
                } else {
                    problem.solve_at(&base, &starts[0].shapes)
                };
                // A fit with coefficients that the crate refuses is no candidate.
                Some((term, self.scored(solution).ok()?, is_fitted))
            })
            .collect()
    }
}

/// Whether a term may be added to the `known` ones.
fn may_stand(term: Term, known: &[Term]) -> bool {
    let same = known.iter().filter(|known| known.form == term.form).count();
    same < term.form.most && !known.iter().any(|known| known.form.excludes(term.form))
}

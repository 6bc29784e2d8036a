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

/// An effect is not fitted if it would leave this many times the squared error of another, to first order. Convention: twice the error.
const FAR_MORE: f64 = 4.0;

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
        let is_promising =
            |place: usize, starts: &[Start]| place < most && starts[0].gain > promising;
        let rated: Vec<(Term, Solution, Start, bool)> = rated
            .into_par_iter()
            .with_max_len(1)
            .enumerate()
            .map(|(place, (term, base, mut starts))| {
                if !is_promising(place, &starts) {
                    return (term, base, starts.swap_remove(0), false);
                }
                let own = (base.terms.len() < known.len())
                    .then(|| Screen::at(&self.rows, &extent, &base));
                let screen = own.as_ref().unwrap_or(&screen);
                let starts = starts.iter().take(SelectPolicy::in_use().starts);
                let best = starts.map(|start| screen.improved(term, start));
                let best = best.min_by(|a, b| a.left.total_cmp(&b.left));
                (term, base, best.expect("there is a start"), true)
            })
            .collect();
        let least = rated.iter().filter(|(.., is_promising)| *is_promising);
        let least = least.fold(f64::INFINITY, |least, (_, _, start, _)| {
            least.min(start.left)
        });
        // Near the noise a start has little to be better by.
        let least = least.max(self.rows.expected());
        rated
            .into_par_iter()
            .with_max_len(1)
            .filter_map(|(term, base, start, is_promising)| {
                let terms: Vec<Term> = base.terms().into_iter().chain([term]).collect();
                let problem = Problem::new(&self.rows, &extent, &terms);
                let is_fitted = is_promising && start.left <= FAR_MORE * least;
                let solution = match is_fitted {
                    true => problem.solve_from(&base, &start.shapes),
                    false => problem.solve_at(&base, &start.shapes),
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

//! Rivals are effects of other families that explain the same cycles as well.

use mesh_damper_model::Family;

use super::Search;
use crate::solution::Solution;
use crate::term::Term;
use crate::trace::select::SelectPolicy;

impl Search<'_> {
    /// Laws made of `rest` and one effect of a family that `law` does not have in addition to it, which predict the validation cycles
    /// as well as `law`: the best for each family. None if the crate refuses one of the two as it is fitted here.
    pub fn rivals(&self, law: &Solution, rest: &Solution) -> Vec<Solution> {
        let (Ok(law), Ok(rest)) = (self.refit(law), self.refit(rest)) else {
            return Vec::new();
        };
        let families = law.families();
        let is_other = |term: &&Term| !families.contains(&term.form.family());
        let others: Vec<Term> = self.terms.iter().filter(is_other).copied().collect();
        let mut beside = self.beside(&rest, &others, SelectPolicy::in_use().fitted);
        beside.retain(|(_, rival, _)| rival.is_admissible() && !law.score.beats(&rival.score));
        beside.sort_by(|(_, a, _), (_, b, _)| a.by_error(b));
        let mut known: Vec<Family> = Vec::new();
        beside.retain(|(term, ..)| {
            let is_new = !known.contains(&term.form.family());
            known.push(term.form.family());
            is_new
        });
        let rivals = beside.into_iter().map(|(_, rival, _)| rival.solution);
        rivals.collect()
    }
}

//! A search refines the form of an effect, and afterwards simplifies or drops what became unnecessary.

use mesh_damper_model::ModelError;

use super::super::fitted::Fitted;
use super::Search;
use crate::problem::Problem;
use crate::term::Term;

impl Search<'_> {
    /// The law with its last effect in a refined form, if that is clearly better and the data distinguish it from a simpler one;
    /// otherwise unchanged.
    pub(super) fn refined(&self, law: &Fitted) -> Fitted {
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

    /// The law with simpler forms in place of refined ones, if they do equally well: a form that was refined while another effect
    /// was still missing may have covered for that effect.
    pub(super) fn unrefined(&self, found: Fitted) -> Result<Fitted, ModelError> {
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
            let rest = self.scored(found.solution.without(index - 1))?;
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

    /// Drops terms without which the validation cycles are predicted equally well.
    pub(super) fn prune(&self, found: Fitted) -> Result<Fitted, ModelError> {
        let mut found = found;
        let mut index = 0;
        while found.solution.found().count() > 1 && index < found.solution.terms.len() {
            if found.solution.terms[index].term.is_known {
                index += 1;
                continue;
            }
            let rest = found.solution.without(index);
            let problem = Problem::new(&self.rows, &self.extent, &rest.terms());
            let without = self.scored(problem.solve_near(&rest))?;
            if self.is_better(&found, &without) {
                index += 1;
            } else {
                found = without;
                index = 0;
            }
        }
        Ok(found)
    }
}

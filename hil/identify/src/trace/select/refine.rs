//! A search refines the form of an effect, and afterwards exchanges, simplifies or drops what other effects made unnecessary.

use mesh_damper_model::Family;

use super::super::fitted::Fitted;
use super::super::separating::Rivals;
use super::{MOST_TERMS, Search};
use crate::term::Term;
use crate::trace::select::SelectPolicy;

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
            .min_by(Fitted::by_error)
            .unwrap_or_else(|| law.clone())
    }

    /// The law with simpler forms in place of refined ones, if they do equally well: a form that was refined while another effect
    /// was still missing may have covered for that effect.
    pub(super) fn unrefined(&self, found: Fitted) -> Fitted {
        let mut found = found;
        let mut index = 0;
        while let Some(term) = found.solution.terms.get(index).map(|value| value.term) {
            index += 1;
            if term.is_known || !term.form.refines {
                continue;
            }
            if let Some((_, simpler)) = self.simpler(&found, index - 1) {
                found = simpler;
                index = 0;
            }
        }
        found
    }

    /// The first of the `unbounded` families of `found` that has a simpler effect in its place which does equally well, and that one: the
    /// data, which do not bound a parameter of the family, do not tell the two apart.
    pub(in super::super) fn in_place_of_unbounded(
        &self,
        found: &Fitted,
        unbounded: &[Family],
    ) -> Option<Rivals> {
        for (index, value) in found.solution.terms.iter().enumerate() {
            let family = value.term.form.family();
            if value.term.is_known || !unbounded.contains(&family) {
                continue;
            }
            if let Some((simpler, law)) = self.simpler(found, index) {
                let others = [(simpler, law.solution)];
                return Some(Rivals::in_place_of(family, &found.solution, others));
            }
        }
        None
    }

    /// The family of a form that the one at `index` contains, and the law with it in the place of that one, if one does equally well.
    fn simpler(&self, found: &Fitted, index: usize) -> Option<(Family, Fitted)> {
        let form = found.solution.terms[index].term.form;
        let is_simpler =
            |other: &&Term| !other.form.refines && form.special_cases.contains(&other.form.family);
        let simpler: Vec<Term> = self.terms.iter().filter(is_simpler).copied().collect();
        let others = self.in_place(found, index, &simpler, simpler.len())?;
        let others = others
            .into_iter()
            .map(|(term, other, _)| (term.form.family(), other));
        let best = others
            .filter(|(_, other)| other.is_admissible())
            .min_by(|(_, a), (_, b)| a.by_error(b));
        best.filter(|(_, best)| !found.score.beats(&best.score))
    }

    /// The law with another effect in the place of one, as long as that is clearly better, or as good with fewer parameters than one at the
    /// limit of a shape: what a search added first had to stand for effects that it found later.
    pub(super) fn exchanged(&self, found: Fitted) -> Fitted {
        let mut found = found;
        for _ in 0..MOST_TERMS {
            let mut indices = 0..found.solution.terms.len();
            match indices.find_map(|index| self.instead(&found, index)) {
                Some(better) => found = better,
                None => break,
            }
        }
        found
    }

    /// The law with another effect in the place of the one at `index`.
    fn instead(&self, found: &Fitted, index: usize) -> Option<Fitted> {
        let old = found.solution.terms[index].term;
        if old.is_known || found.solution.found().count() < 2 {
            return None;
        }
        let mut others = self.steps();
        others.retain(|term| term.form != old.form);
        let others = self.in_place(found, index, &others, SelectPolicy::in_use().fitted)?;
        let fitted = others.into_iter().filter(|(_, _, was_fitted)| *was_fitted);
        let others = fitted.map(|(_, law, _)| self.refined(&law));
        // At the limit of a shape an effect may be a simpler one.
        let is_simpler = |law: &Fitted| {
            found.is_degenerate(&self.extent)
                && law.parameters() < found.parameters()
                && !found.score.beats(&law.score)
        };
        let better = others.filter(|law| law.score.beats(&found.score) || is_simpler(law));
        let better = better
            .filter(|law| self.rejected_by(law).is_none() && !law.is_degenerate(&self.extent));
        better.min_by(Fitted::by_error)
    }

    /// Each of `terms` in the place of the effect at `index`, as in [`beside`](Self::beside); none if the crate refuses the law without that.
    fn in_place(
        &self,
        found: &Fitted,
        index: usize,
        terms: &[Term],
        most: usize,
    ) -> Option<Vec<(Term, Fitted, bool)>> {
        let rest = self.scored(found.solution.without(index)).ok()?;
        Some(self.beside(&rest, terms, most))
    }

    /// Drops terms without which the validation cycles are predicted equally well.
    pub(super) fn prune(&self, found: Fitted) -> Fitted {
        let mut found = found;
        let mut index = 0;
        while found.solution.found().count() > 1 && index < found.solution.terms.len() {
            if found.solution.terms[index].term.is_known {
                index += 1;
                continue;
            }
            let rest = found.solution.without(index);
            match self.refit(&rest) {
                Ok(without) if !self.is_better(&found, &without) => {
                    found = without;
                    index = 0;
                }
                _ => index += 1,
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use mesh_damper_recording::Recording;
    use mesh_damper_recording::trajectory::Trajectory;

    use super::super::super::sought::Sought;
    use super::super::super::split::{Role, Roles};
    use super::*;
    use crate::families::Form;
    use crate::problem::Problem;
    use crate::uncertainty::Uncertainty;

    const TICK: f64 = 2e-3;

    /// What stands in the place of the yielding branch that is fitted to a spring of 2 kN/mm and `branch`, a stiffness in kN/mm with the
    /// rate of a dashpot in mm/s behind it, which depends on the branch's force.
    fn in_place_of_yielding(branch: f64, dashpot: fn(f64) -> f64) -> Option<Vec<&'static str>> {
        let mut stretch = 0.0;
        let mut before = 0.0;
        let (mut displacement, mut force) = (Vec::new(), Vec::new());
        for frequency in [1.0, 4.0, 10.0] {
            for n in 0..1500 {
                let y = 0.2 * (TAU * frequency * TICK * f64::from(n)).sin();
                for _ in 0..10 {
                    stretch += (y - before) / 10.0 - dashpot(branch * stretch) * TICK / 10.0;
                }
                before = y;
                displacement.push(y);
                // Noise without a random generator: a sum of tones that share nothing with the motion.
                let noise = (1..9).map(|k| (f64::from(n) * f64::from(k) * 1.234_567).sin());
                force.push(2.0 * y + branch * stretch + 2e-4 * noise.sum::<f64>());
            }
        }
        let time = (0..displacement.len()).map(|n| n as f64 * TICK).collect();
        let recording = Recording::new("test", time, displacement, force).unwrap();
        let trajectories = [Trajectory::of(&recording).unwrap()];
        let mut roles = Roles::all_fit(&trajectories);
        roles.keep_apart(&trajectories, Role::Validation);
        let search = Search::new(&trajectories, &roles, vec![0.0], &Sought::default());
        let term = Term::sought(Form::named("yielding").unwrap(), 0.0);
        let law = Problem::new(&search.rows, &search.extent, &[term]).solve();
        let found = search.scored(law).unwrap();
        let uncertainty = Uncertainty::of(&search.rows, &search.extent, &found.solution);
        let unbounded = !uncertainty.terms[0].is_bounded();
        let unbounded = Vec::from_iter(unbounded.then(|| term.form.family()));
        let rival = search.in_place_of_unbounded(&found, &unbounded);
        let [(family, _), (_, simpler)] = <[_; 2]>::try_from(rival?.laws).unwrap();
        let rest = simpler.families().into_iter().map(Family::name);
        Some([family.name()].into_iter().chain(rest).collect())
    }

    #[test]
    fn a_branch_that_never_yields_may_be_a_maxwell_branch() {
        let maxwell = in_place_of_yielding(1.0, |force| force / 0.04);
        assert_eq!(maxwell, Some(vec!["yielding", "relaxation"]));
        let yields = in_place_of_yielding(1.0, |force| 0.1 * (force / 0.02).sinh());
        assert_eq!(yields, None, "its yield force is known");
    }
}

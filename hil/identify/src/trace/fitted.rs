//! A law during a search: fitted, scored, and compared with others by its effects.

use std::cmp::Ordering;

use mesh_damper_model::Family;

use super::score::Score;
use super::tones::OfMotion;
use crate::families::{drift, inertia, periodic};
use crate::shape::Extent;
use crate::solution::Solution;
use crate::term::TermValue;

/// A fitted law and its errors on the validation cycles.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The fit.
    pub solution: Solution,
    /// Errors on the validation cycles.
    pub score: Score,
}

impl Fitted {
    /// The order of laws by their error on the validation cycles, the best first.
    pub(super) fn by_error(&self, other: &Self) -> Ordering {
        self.score.nrmse().total_cmp(&other.score.nrmse())
    }

    /// The families of its effects in the order of their names, each once.
    pub fn families(&self) -> Vec<Family> {
        let mut families = self.solution.families();
        families.sort_by_key(|family| family.name());
        families
    }

    /// Whether `other` has the same families except for one, whose general form is one of this law's effects.
    pub(super) fn includes(&self, other: &Self) -> bool {
        let mut forms = self.solution.found().map(|value| value.term.form);
        forms.any(|form| {
            let mut special_cases = form.special_cases.iter();
            special_cases.any(|&special| {
                let mut families = self.families();
                families.retain(|&family| family != form.family());
                families.extend(Family::named(special));
                families.sort_by_key(|family| family.name());
                families.dedup();
                families == other.families()
            })
        })
    }

    pub(super) fn is_admissible(&self) -> bool {
        self.solution.found().all(TermValue::is_admissible) && !self.has_doubtful_mass()
    }

    /// Whether it has a mass below 0, as of a load cell that is compensated for too much, beside an effect that depends on frequency: both
    /// stiffen as the frequency rises, and together they would fit nearly any such effect.
    fn has_doubtful_mass(&self) -> bool {
        let is_mass = |value: &&TermValue| value.term.form == inertia::FORMS[0];
        let mut masses = self
            .solution
            .found()
            .filter(is_mass)
            .map(|value| value.size(0));
        let mut others = self.solution.terms.iter().filter(|value| !is_mass(value));
        let stiffens = |value: &TermValue| {
            value
                .term
                .form
                .family()
                .depends_on()
                .any(|on| on == "frequency")
        };
        masses.any(|mass| mass < 0.0) && others.any(stiffens)
    }

    /// Whether it has a tone with a frequency that the motion produces.
    pub(super) fn has_tone(&self, of_motion: &OfMotion) -> bool {
        let mut terms = self.solution.found();
        terms.any(|value| value.term.form == periodic::FORMS[0] && of_motion.holds(value.shape(0)))
    }

    /// Whether it is `other` with a mass in addition.
    pub(super) fn is_with_mass(&self, other: &Self) -> bool {
        let mut others = other.forms();
        others.push(inertia::FORMS[0].place());
        others.sort_unstable();
        self.forms() == others
    }

    pub(super) fn is_degenerate(&self, extent: &Extent) -> bool {
        let mut terms = self.solution.found();
        terms.any(|value| value.is_degenerate(extent))
    }

    /// Its forms with their counts, in a fixed order.
    pub(super) fn forms(&self) -> Vec<usize> {
        let terms = self.solution.terms.iter();
        let mut forms: Vec<usize> = terms.map(|value| value.term.form.place()).collect();
        forms.sort_unstable();
        forms
    }

    /// Whether one of `warmed` does equally well with the temperature in place of its drift of both forces. The cycle count rises
    /// while a chamber warms, and the measured temperature explains that with fewer numbers.
    pub(super) fn is_but_warmth(&self, warmed: &[(Vec<Family>, Score)]) -> bool {
        let mut terms = self.solution.terms.iter();
        if !terms.any(|value| value.term.form == drift::OF_EACH) {
            return false;
        }
        let mut families = self.families();
        families.retain(|&family| family != drift::OF_EACH.family());
        warmed.iter().any(|(others, score)| {
            let others = others
                .iter()
                .filter(|family| !family.depends_on_temperature());
            others.eq(&families) && !self.score.beats(score)
        })
    }

    /// Sum over all its forms.
    pub(super) fn rank(&self) -> u32 {
        let terms = self.solution.terms.iter();
        terms.map(|value| u32::from(value.term.form.rank)).sum()
    }

    pub(super) fn parameters(&self) -> usize {
        let terms = self.solution.terms.iter();
        terms
            .map(|value| value.sizes.len() + value.shapes.len())
            .sum()
    }

    pub(super) fn named(&self) -> String {
        self.solution
            .terms
            .iter()
            .fold("the mixed damping law".to_owned(), |text, value| {
                format!("{text} + {}", value.term.form.family())
            })
    }
}

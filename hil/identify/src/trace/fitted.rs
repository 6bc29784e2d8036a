//! A law as a search has it: fitted, judged, and compared with others by what it is made of.

use mesh_damper_model::Family;

use super::score::Score;
use super::tones::OfMotion;
use crate::families::{drift, periodic};
use crate::shape::Extent;
use crate::solution::Solution;
use crate::term::TermValue;

/// A fitted law and how it does on the cycles that judge.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// What was fitted.
    pub solution: Solution,
    /// Errors on the cycles that judge.
    pub score: Score,
}

impl Fitted {
    /// The families of its effects in the order of their names, those of several terms once.
    pub fn families(&self) -> Vec<Family> {
        let mut families = self.solution.families();
        families.sort_by_key(|family| family.name());
        families
    }

    /// Whether `other` has the same families but for one, of which one of this law's effects is the general form.
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
        self.solution.found().all(TermValue::is_admissible)
    }

    /// Whether it has a tone of a frequency that the motion makes.
    pub(super) fn has_tone(&self, of_motion: &OfMotion) -> bool {
        let mut terms = self.solution.found();
        terms.any(|value| value.term.form == periodic::FORMS[0] && of_motion.holds(value.shape(0)))
    }

    pub(super) fn is_degenerate(&self, extent: &Extent) -> bool {
        let mut terms = self.solution.found();
        terms.any(|value| value.is_degenerate(extent))
    }

    /// Forms and how often, whatever their order.
    pub(super) fn forms(&self) -> Vec<usize> {
        let terms = self.solution.terms.iter();
        let mut forms: Vec<usize> = terms.map(|value| value.term.form.place()).collect();
        forms.sort_unstable();
        forms
    }

    /// Whether one of `warmed` does as well with the temperature in the place of its drift of both forces: the cycles count on
    /// as a chamber warms, and what was measured explains it with fewer numbers.
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

    /// Of all its forms.
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
            .fold("eq 13".to_owned(), |text, value| {
                format!("{text} + {}", value.term.form.family())
            })
    }
}

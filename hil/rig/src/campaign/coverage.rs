//! Diagnostic coverage, by the element that fails: dangerous faults detected over dangerous faults injected.

use std::collections::BTreeMap;

use serde::Serialize;

use super::facts::Element;
use super::summary::Summary;

/// Coverage of one element.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Coverage {
    /// The element that fails.
    pub element: Element,
    /// Faults injected into it, one per trial.
    pub injected: usize,
    /// Number of these faults that were found.
    pub found: usize,
    /// Number of dangerous faults injected into it.
    pub dangerous: usize,
    /// Number of dangerous faults that were detected: a cause was reported, or the rig stopped, or it refused its settings.
    pub detected: usize,
    /// Number of dangerous faults that cannot be observed. They count as injected.
    pub hidden: usize,
}

impl Coverage {
    /// Dangerous faults detected divided by those injected, 0…1; `None` if there were none.
    pub fn part(&self) -> Option<f64> {
        (self.dangerous > 0).then(|| self.detected as f64 / self.dangerous as f64)
    }

    fn count(&mut self, is_found: bool, is_dangerous: bool, is_hidden: bool) {
        self.injected += 1;
        self.found += usize::from(is_found);
        self.dangerous += usize::from(is_dangerous);
        self.detected += usize::from(is_dangerous && is_found);
        self.hidden += usize::from(is_dangerous && is_hidden);
    }
}

/// Coverage element by element, of all changes that were injected alone and of invalid settings.
pub fn coverage(summary: &Summary) -> Vec<Coverage> {
    let mut all: BTreeMap<Element, Coverage> = BTreeMap::new();
    let mut count = |element, found, dangerous, hidden| {
        let of_this = all.entry(element).or_insert(Coverage {
            element,
            injected: 0,
            found: 0,
            dangerous: 0,
            detected: 0,
            hidden: 0,
        });
        of_this.count(found, dangerous, hidden);
    };
    let attacks = &summary.attacks;
    for outcome in summary.outcomes.iter().chain(&attacks.outcomes.singles) {
        let facts = outcome.trial.changes[0].kind.facts();
        let is_hidden = facts.hidden.is_some();
        count(facts.element, outcome.found, facts.is_dangerous, is_hidden);
    }
    for forgery in &attacks.forgeries {
        count(Element::Settings, forgery.refused, true, false);
    }
    all.into_values().collect()
}

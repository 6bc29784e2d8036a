//! Diagnostic coverage, by the element that fails: dangerous faults detected over dangerous faults injected.

use serde::Serialize;

use super::kind::Element;
use super::trial::AttackOutcome;
use crate::faults::kind::InjectedFault;
use crate::faults::summary::Summary;

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

/// The element of an injected fault, and whether the fault is dangerous.
fn of_injected(kind: InjectedFault) -> (Element, bool) {
    use InjectedFault as F;
    match kind {
        F::WireBreakage | F::FrictionWear | F::Loosening => (Element::Specimen, false),
        F::PreloadShift => (Element::Specimen, true),
        F::DisplacementStuck
        | F::DisplacementDroppedOut
        | F::DisplacementOpen
        | F::DisplacementClipped
        | F::DisplacementSpiking
        | F::DisplacementDrifting => (Element::DisplacementChannel, true),
        F::ForceStuck
        | F::ForceDroppedOut
        | F::ForceOpen
        | F::ForceClipped
        | F::ForceSpiking
        | F::ForceDrifting => (Element::ForceChannel, true),
        F::ActuatorSaturated | F::ActuatorLagging | F::ActuatorDead => {
            (Element::ActuatorAndDac, true)
        }
    }
}

/// Coverage element by element, of all faults that were injected alone.
pub fn coverage(summary: &Summary) -> Vec<Coverage> {
    let mut all = Element::ALL.map(|element| Coverage {
        element,
        injected: 0,
        found: 0,
        dangerous: 0,
        detected: 0,
        hidden: 0,
    });
    let mut count = |element: Element, found: bool, dangerous: bool, hidden: bool| {
        let of_this = all.iter_mut().find(|one| one.element == element);
        if let Some(of_this) = of_this {
            of_this.count(found, dangerous, hidden);
        }
    };
    for outcome in &summary.outcomes {
        let (element, dangerous) = of_injected(outcome.trial.kind);
        count(element, outcome.cycles.is_some(), dangerous, false);
    }
    for outcome in &summary.attacks.outcomes.singles {
        let AttackOutcome { trial, found, .. } = outcome;
        let kind = trial.attacks[0].kind;
        let is_hidden = kind.hidden().is_some();
        count(kind.element(), *found, kind.is_dangerous(), is_hidden);
    }
    for forgery in &summary.attacks.forgeries {
        count(Element::Settings, forgery.refused, true, false);
    }
    let there = all.into_iter().filter(|one| one.injected > 0);
    there.collect()
}

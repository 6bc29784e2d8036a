//! Rates, error ratios and the confusion matrix of many trials.

use std::collections::BTreeMap;

use serde::Serialize;

use super::draw::Class;
use super::judge::{Mark, Outcome};

/// A count out of a total.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rate {
    /// The count.
    pub count: usize,
    /// The total.
    pub of: usize,
}

impl Rate {
    /// Between 0 and 1; NaN if the total is 0.
    pub fn value(&self) -> f64 {
        self.count as f64 / self.of as f64
    }

    fn over<'a>(
        outcomes: impl IntoIterator<Item = &'a Outcome>,
        holds: impl Fn(&Outcome) -> bool,
    ) -> Self {
        let mut rate = Self::default();
        for outcome in outcomes {
            rate.count += usize::from(holds(outcome));
            rate.of += 1;
        }
        rate
    }
}

/// Held-out error of the embedded law over the noise, in quantiles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Ratios {
    /// The median: half of the ratios are smaller.
    pub median: f64,
    /// The ninth decile: nine in ten ratios are smaller.
    pub ninth_decile: f64,
    /// The largest ratio.
    pub worst: f64,
}

/// The results of many trials. Rates of hidden effects count only effects that are at least three times the noise.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// Trials with one listed effect, in which only that effect was named.
    pub listed: Rate,
    /// Trials with one listed effect that was named, alone or among several indistinguishable effects.
    pub listed_or_among: Rate,
    /// Trials without an effect in which one was found.
    pub false_discoveries: Rate,
    /// Trials with two listed effects, both named.
    pub pairs: Rate,
    /// Trials with two listed effects, both named, alone or among several.
    pub pairs_or_among: Rate,
    /// Trials with an unlisted effect that was reported as unlisted.
    pub unlisted: Rate,
    /// Trials with an unlisted effect that was given the name of another one.
    pub unlisted_named: Rate,
    /// Trials with an unlisted effect that the law predicts within 1.5 times the noise, or within a tenth of the error of eq 13.
    #[serde(rename = "unlisted_mended")]
    pub unlisted_augmented: Rate,
    /// Errors by class of trial.
    pub ratios: BTreeMap<Class, Ratios>,
    /// How often each answer was given for each truth. Unlisted truths are in brackets.
    pub confusion: BTreeMap<String, BTreeMap<String, usize>>,
    /// Seeds of trials whose effect no test shows.
    pub not_shown: Vec<u64>,
    /// The trials.
    pub outcomes: Vec<Outcome>,
}

impl Summary {
    /// Counts `outcomes`; the seeds `not_shown` are separate.
    pub fn of(outcomes: Vec<Outcome>, not_shown: Vec<u64>) -> Self {
        let counted = |class| {
            outcomes
                .iter()
                .filter(move |o| o.secret.class == class && o.counts())
        };
        let right = |outcome: &Outcome| outcome.mark() == Mark::Right;
        let named = |outcome: &Outcome| outcome.mark() != Mark::Wrong;
        let mut confusion: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
        for outcome in &outcomes {
            let row = confusion.entry(outcome.truth()).or_default();
            *row.entry(outcome.answer()).or_default() += 1;
        }
        let classes = [Class::None, Class::Listed, Class::Pair, Class::Unlisted];
        Self {
            listed: Rate::over(counted(Class::Listed), right),
            listed_or_among: Rate::over(counted(Class::Listed), named),
            false_discoveries: Rate::over(counted(Class::None), |outcome| !right(outcome)),
            pairs: Rate::over(counted(Class::Pair), right),
            pairs_or_among: Rate::over(counted(Class::Pair), named),
            unlisted: Rate::over(counted(Class::Unlisted), right),
            unlisted_named: Rate::over(counted(Class::Unlisted), Outcome::is_called_another),
            unlisted_augmented: Rate::over(counted(Class::Unlisted), Outcome::is_augmented),
            ratios: classes
                .into_iter()
                .filter_map(|class| Some((class, ratios(&outcomes, class)?)))
                .collect(),
            confusion,
            not_shown,
            outcomes,
        }
    }
}

fn ratios(outcomes: &[Outcome], class: Class) -> Option<Ratios> {
    let mut sorted: Vec<f64> = outcomes
        .iter()
        .filter(|outcome| outcome.secret.class == class)
        .filter_map(|outcome| Some(outcome.said.as_ref().ok()?.after))
        .collect();
    sorted.sort_by(f64::total_cmp);
    let worst = *sorted.last()?;
    let at = |part: f64| sorted[((sorted.len() - 1) as f64 * part).round() as usize];
    Some(Ratios {
        median: at(0.5),
        ninth_decile: at(0.9),
        worst,
    })
}

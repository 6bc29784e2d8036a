//! The results of many trials: rates, error ratios, the confusion matrix, and a row for each group.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use super::families::Version;
use super::judge::{Mark, Outcome};
use super::trial::{Class, Test};

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

/// The results of a group of trials that count.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Row {
    /// Name of the group.
    pub of: String,
    /// Number of trials that count.
    pub count: usize,
    /// Number of trials for each [`Mark`], in order.
    pub marks: [usize; 6],
    /// Median of the held-out error over that of the true law.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub median: f64,
    /// Ninth decile of the held-out error over that of the true law.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub ninth_decile: f64,
    /// Median duration of a trace, s.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub seconds: f64,
    /// Largest duration of a trace over that of its recordings.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub time: f64,
    /// Fraction of the 90 % intervals of the law's coefficients that contain the true value.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub intervals: f64,
    /// Number of trials whose law predicts the held-out motion worse than eq 13 alone, by more than 2 %.
    pub worse: usize,
    /// Part of the held-out samples within the bands that the models state, 0…1.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub within_band: f64,
    /// Geometric mean of the error of the estimated velocity over that of cubics in windows alone.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub over_cubics: f64,
    /// Fraction of the samples at which the velocity error is within its 90 % interval.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub covered: f64,
}

/// A quotient over nothing is NaN, and null in a file.
pub(crate) fn if_any<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    value.is_finite().then_some(value).serialize(serializer)
}

impl Row {
    fn of(name: String, outcomes: &[&Outcome]) -> Self {
        let count = |mark: Mark| outcomes.iter().filter(|o| o.mark() == mark).count();
        let quantile = |of: fn(&Outcome) -> f64, part: f64| {
            let each = outcomes.iter().map(|o| of(o));
            let mut values: Vec<f64> = each.filter(|value| value.is_finite()).collect();
            values.sort_by(f64::total_cmp);
            let place = (part * values.len() as f64) as usize;
            let place = place.min(values.len().saturating_sub(1));
            values.get(place).copied().unwrap_or(f64::NAN)
        };
        let mean = |of: &dyn Fn(&Outcome) -> f64| {
            let each = outcomes.iter().map(|o| of(o));
            let values = each.filter(|value| value.is_finite());
            let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
            sum / count
        };
        let [held, of] =
            [0, 1].map(|which| outcomes.iter().map(|o| o.intervals()[which]).sum::<usize>());
        Self {
            of: name,
            count: outcomes.len(),
            marks: Mark::ALL.map(count),
            median: quantile(Outcome::error, 0.5),
            ninth_decile: quantile(Outcome::error, 0.9),
            seconds: quantile(|o| o.seconds, 0.5),
            time: outcomes.iter().map(|o| o.time).fold(0.0, f64::max),
            intervals: held as f64 / of as f64,
            worse: outcomes.iter().filter(|o| o.is_worse()).count(),
            within_band: mean(&|o| {
                o.said
                    .as_ref()
                    .map_or(f64::NAN, |said| said.within_band.unwrap_or(f64::NAN))
            }),
            over_cubics: mean(&|o| o.velocity.over_cubics.ln()).exp(),
            covered: mean(&|o| o.velocity.covered),
        }
    }

    /// The fraction with the right answer, or with the truth among effects that cannot be distinguished.
    pub fn right(&self) -> f64 {
        (self.marks[0] + self.marks[1]) as f64 / self.count as f64
    }

    /// The fraction that is false or missed.
    pub fn wrong(&self) -> f64 {
        (self.marks[3] + self.marks[4]) as f64 / self.count as f64
    }
}

/// The results of many trials. Rates of hidden effects count only effects that are at least three times the noise.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Results {
    /// Version of the draw: a seed hides the same effects only with the same version.
    pub draw_version: u32,
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
    /// The results of all trials that count.
    pub all: Row,
    /// Results by each property in turn: by motion or shape of the test, by sensors, and by hidden effect.
    pub rows: Vec<Row>,
    /// Seeds of trials whose effect no test shows.
    pub not_shown: Vec<u64>,
}

/// The results of many trials, and the trials.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary<O = Outcome> {
    /// The results.
    #[serde(flatten)]
    pub results: Results,
    /// The trials.
    pub outcomes: Vec<O>,
}

impl Summary {
    /// Counts `outcomes`; the seeds `not_shown` are separate.
    pub fn of(version: Version, outcomes: Vec<Outcome>, not_shown: Vec<u64>) -> Self {
        let counted: Vec<&Outcome> = outcomes.iter().filter(|o| o.counts()).collect();
        let of_class = |class| {
            let all = counted.iter().copied();
            all.filter(move |o| o.secret.class == class)
        };
        let right = |outcome: &Outcome| outcome.mark() == Mark::Right;
        let named = |outcome: &Outcome| outcome.mark().is_named();
        let mut confusion: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
        for outcome in &outcomes {
            let row = confusion.entry(outcome.truth()).or_default();
            *row.entry(outcome.answer()).or_default() += 1;
        }
        let classes = [Class::None, Class::Listed, Class::Pair, Class::Unlisted];
        let results = Results {
            draw_version: version.number(),
            listed: Rate::over(of_class(Class::Listed), right),
            listed_or_among: Rate::over(of_class(Class::Listed), named),
            false_discoveries: Rate::over(of_class(Class::None), |outcome| !right(outcome)),
            pairs: Rate::over(of_class(Class::Pair), right),
            pairs_or_among: Rate::over(of_class(Class::Pair), named),
            unlisted: Rate::over(of_class(Class::Unlisted), right),
            unlisted_named: Rate::over(of_class(Class::Unlisted), Outcome::is_called_another),
            unlisted_augmented: Rate::over(of_class(Class::Unlisted), Outcome::is_augmented),
            ratios: classes
                .into_iter()
                .filter_map(|class| Some((class, ratios(&outcomes, class)?)))
                .collect(),
            confusion,
            all: Row::of("all".to_owned(), &counted),
            rows: rows(&counted),
            not_shown,
        };
        Self { results, outcomes }
    }
}

/// By motion or shape, by sensors, and by hidden effect; each sorted by its name.
fn rows(counted: &[&Outcome]) -> Vec<Row> {
    let by: [fn(&Outcome) -> Option<String>; 3] = [
        |o| {
            Some(match &o.secret.test {
                Test::Blocks(blocks) => name(&blocks.programme.shape),
                Test::Motion(motion) => name(&motion.kind),
            })
        },
        |o| match &o.secret.test {
            Test::Blocks(_) => None,
            Test::Motion(motion) => Some(format!("sensors: {}", name(&motion.sensors.flaw))),
        },
        |o| {
            Some(match &o.secret.families()[..] {
                [] => "hidden: nothing".to_owned(),
                [one] => format!("hidden: {one}"),
                _ => "hidden: two".to_owned(),
            })
        },
    ];
    let groups = by.into_iter().flat_map(|by| grouped(counted, by));
    groups.map(|(name, these)| Row::of(name, &these)).collect()
}

/// `outcomes` by the name of their group, in its order; without a name they are in none.
pub(crate) fn grouped<'o, O>(
    outcomes: &[&'o O],
    by: impl Fn(&O) -> Option<String>,
) -> BTreeMap<String, Vec<&'o O>> {
    let mut groups: BTreeMap<String, Vec<&O>> = BTreeMap::new();
    for &outcome in outcomes {
        if let Some(name) = by(outcome) {
            groups.entry(name).or_default().push(outcome);
        }
    }
    groups
}

/// The word in its JSON.
pub(crate) fn name(of: &impl Serialize) -> String {
    let json = serde_json::to_string(of).unwrap_or_default();
    json.trim_matches('"').replace('_', " ")
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

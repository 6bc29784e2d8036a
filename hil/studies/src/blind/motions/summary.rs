//! Many trials over any motion: how often right, and how large the error.

use serde::Serialize;

use super::judge::{Mark, Outcome};

/// What some trials came to.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Row {
    /// Which.
    pub of: String,
    /// How many count.
    pub count: usize,
    /// Of these, by mark in the order of [`Mark`].
    pub marks: [usize; 6],
    /// Held-out error over that of the true law: half of them are below,
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub median: f64,
    /// and nine in ten, as a ratio.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub ninth_decile: f64,
    /// How long a trace took, s: half of them took less.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub seconds: f64,
    /// The largest time of a trace over that of its recordings.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub time: f64,
    /// The part of the 90 % intervals of the law's coefficients that hold.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub intervals: f64,
    /// Error of the estimated velocity over that of cubics in windows alone, the geometric mean.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub over_cubics: f64,
    /// The part of the samples at which that error is within its 90 % interval.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub covered: f64,
}

impl Row {
    fn of(name: String, outcomes: &[&Outcome]) -> Self {
        let count = |mark: Mark| outcomes.iter().filter(|o| o.mark == mark).count();
        let quantile = |of: fn(&Outcome) -> f64, part: f64| {
            let each = outcomes.iter().map(|o| of(o));
            let mut values: Vec<f64> = each.filter(|value| value.is_finite()).collect();
            values.sort_by(f64::total_cmp);
            let place = (part * values.len() as f64) as usize;
            let place = place.min(values.len().saturating_sub(1));
            values.get(place).copied().unwrap_or(f64::NAN)
        };
        let mean = |of: &dyn Fn(&Outcome) -> f64| {
            let values = outcomes.iter().map(|o| of(o)).filter(|x| x.is_finite());
            let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
            sum / count
        };
        Self {
            of: name,
            count: outcomes.len(),
            marks: [
                Mark::Right,
                Mark::Among,
                Mark::Honest,
                Mark::False,
                Mark::Missed,
                Mark::Refused,
            ]
            .map(count),
            median: quantile(|o| o.error, 0.5),
            ninth_decile: quantile(|o| o.error, 0.9),
            seconds: quantile(|o| o.seconds, 0.5),
            time: outcomes.iter().map(|o| o.time).fold(0.0, f64::max),
            intervals: {
                let [held, of] =
                    [0, 1].map(|which| outcomes.iter().map(|o| o.intervals[which]).sum::<usize>());
                held as f64 / of as f64
            },
            over_cubics: mean(&|o| o.velocity.over_cubics.ln()).exp(),
            covered: mean(&|o| o.velocity.covered),
        }
    }

    /// The part that is right, or names what is hidden among what cannot be told apart.
    pub fn right(&self) -> f64 {
        (self.marks[0] + self.marks[1]) as f64 / self.count as f64
    }

    /// The part that is false or missed.
    pub fn wrong(&self) -> f64 {
        (self.marks[3] + self.marks[4]) as f64 / self.count as f64
    }
}

/// Rows of all, by kind of motion, by sensors and by what is hidden.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// All that count.
    pub all: Row,
    /// By one thing after another.
    pub rows: Vec<Row>,
    /// The trials.
    pub outcomes: Vec<Outcome>,
}

impl Summary {
    /// Counts `outcomes`.
    pub fn of(outcomes: Vec<Outcome>) -> Self {
        let counted: Vec<&Outcome> = outcomes.iter().filter(|o| o.counts()).collect();
        let mut rows = Vec::new();
        let by: [fn(&Outcome) -> String; 3] = [
            |o| name(&o.kind),
            |o| format!("sensors: {}", name(&o.flaw)),
            |o| match &o.hidden[..] {
                [] => "hidden: nothing".to_owned(),
                [one] => format!("hidden: {one}"),
                _ => "hidden: two".to_owned(),
            },
        ];
        for by in by {
            let mut names: Vec<String> = counted.iter().map(|o| by(o)).collect();
            names.sort();
            names.dedup();
            for name in names {
                let these: Vec<&Outcome> =
                    counted.iter().filter(|o| by(o) == name).copied().collect();
                rows.push(Row::of(name, &these));
            }
        }
        Self {
            all: Row::of("all".to_owned(), &counted),
            rows,
            outcomes,
        }
    }
}

/// As its JSON has it, in words.
fn name(of: &impl Serialize) -> String {
    let json = serde_json::to_string(of).unwrap_or_default();
    json.trim_matches('"').replace('_', " ")
}

//! Many trials over any motion: the rate of right answers, and the error.

use serde::Serialize;

use super::judge::{Mark, Outcome};

/// The results of a group of trials.
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
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub median: f64,
    /// Ninth decile of the held-out error over that of the true law.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub ninth_decile: f64,
    /// Median duration of a trace, s.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub seconds: f64,
    /// Largest duration of a trace over that of its recordings.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub time: f64,
    /// Fraction of the 90 % intervals of the law's coefficients that contain the true value.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub intervals: f64,
    /// Geometric mean of the error of the estimated velocity over that of cubics in windows alone.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub over_cubics: f64,
    /// Fraction of the samples at which the velocity error is within its 90 % interval.
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

    /// The fraction with the right answer, or with the truth among effects that cannot be distinguished.
    pub fn right(&self) -> f64 {
        (self.marks[0] + self.marks[1]) as f64 / self.count as f64
    }

    /// The fraction that is false or missed.
    pub fn wrong(&self) -> f64 {
        (self.marks[3] + self.marks[4]) as f64 / self.count as f64
    }
}

/// Results for all trials, by kind of motion, by sensors and by hidden effect.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// The results of all trials that count.
    pub all: Row,
    /// Results by each property in turn.
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

/// The word in its JSON.
fn name(of: &impl Serialize) -> String {
    let json = serde_json::to_string(of).unwrap_or_default();
    json.trim_matches('"').replace('_', " ")
}

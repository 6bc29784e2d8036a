//! The results of many trials, in groups, and their requirements.

use mesh_damper_rig::check::Check;
use serde::Serialize;

use super::judge::Outcome;
use crate::blind::{grouped, if_any, name};

/// A written model is worse than the law alone in at most this part of the trials: the level reached, 7 of 500. The target is 2.
const MOST_WORSE: f64 = 0.014;
/// The part of the held-out samples in bands of nine in ten, at least and at most: the target.
const WITHIN_BAND: [f64; 2] = [0.85, 0.95];

/// The results of a group of trials.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Row {
    /// Name of the group.
    pub of: String,
    /// Number of trials.
    pub count: usize,
    /// Number of trials whose written model predicts worse than the law alone by more than 2 %, with those refused.
    pub worse: usize,
    /// Number of trials that the trace refused.
    pub refused: usize,
    /// Geometric mean of the held-out error of the written model over that of the law alone.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub mean_ratio: f64,
    /// Largest of these ratios.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub worst_ratio: f64,
    /// Number of trials whose model states a band.
    pub banded: usize,
    /// Part of their held-out samples within that band, mean over these trials.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub within_band: f64,
    /// Median duration of a trace, s.
    #[serde(serialize_with = "if_any")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub seconds: f64,
}

impl Row {
    fn of(name: String, outcomes: &[&Outcome]) -> Self {
        let ratios: Vec<f64> = outcomes.iter().filter_map(|o| o.ratio()).collect();
        let said = outcomes.iter().filter_map(|o| o.said.as_ref().ok());
        let bands: Vec<f64> = said.filter_map(|said| said.within_band).collect();
        let mut seconds: Vec<f64> = outcomes.iter().map(|o| o.seconds).collect();
        seconds.sort_by(f64::total_cmp);
        let logs = ratios.iter().map(|ratio| ratio.ln());
        Self {
            of: name,
            count: outcomes.len(),
            worse: outcomes.iter().filter(|o| o.is_worse()).count(),
            refused: outcomes.iter().filter(|o| o.said.is_err()).count(),
            mean_ratio: mean(logs.collect()).exp(),
            worst_ratio: ratios.iter().copied().fold(f64::NAN, f64::max),
            banded: bands.len(),
            within_band: mean(bands),
            seconds: seconds.get(seconds.len() / 2).copied().unwrap_or(f64::NAN),
        }
    }
}

fn mean(values: Vec<f64>) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The results of many trials, and the trials.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// All trials.
    pub all: Row,
    /// Groups of them: by kind of condition, place of the held-out conditions, and kind of device.
    pub rows: Vec<Row>,
    /// The trials.
    pub outcomes: Vec<Outcome>,
}

impl Summary {
    /// Counts `outcomes`.
    pub fn of(outcomes: Vec<Outcome>) -> Self {
        let by: [fn(&Outcome) -> String; 3] = [
            |o| format!("by {}", name(&o.secret.programme.kind)),
            |o| {
                let outside = o.secret.programme.is_outside;
                if outside { "outside" } else { "inside" }.to_owned()
            },
            |o| name(&o.secret.family),
        ];
        let all: Vec<&Outcome> = outcomes.iter().collect();
        let groups = by.into_iter().flat_map(|by| grouped(&all, |o| Some(by(o))));
        let rows = groups.map(|(name, these)| Row::of(name, &these)).collect();
        Self {
            all: Row::of("all".to_owned(), &all),
            rows,
            outcomes,
        }
    }

    /// The requirements on the results.
    pub fn checks(&self) -> Vec<Check> {
        let all = &self.all;
        let most = (MOST_WORSE * all.count as f64) as usize;
        let [least_within, most_within] = WITHIN_BAND;
        let within = (least_within..=most_within).contains(&all.within_band);
        let worse = "worse than the law alone";
        let band = "held-out samples within the band";
        [
            Check::new(worse, all.worse <= most, || {
                let (count, of) = (all.worse, all.count);
                format!("{worse}: {count} of {of}, at most {most}")
            })
            .of(all.count),
            Check::new(band, within || all.count == 0, || {
                format!(
                    "{band}: {:.3}, from {least_within} to {most_within}",
                    all.within_band
                )
            })
            .of(all.banded),
        ]
        .into()
    }
}

//! The cost of a variation of a number in the blind trial.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The score of a blind trial: two counts out of a total.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Score {
    /// Number of trials with the right answer.
    pub right: usize,
    /// Number of trials that count.
    pub of: usize,
    /// Number of trials with an unlisted effect that the law predicts within 1.5 times the noise, or within a tenth of the law's
    /// error.
    #[serde(rename = "mended")]
    pub augmented: usize,
}

impl Score {
    /// From the JSON of `hil blind`; `None` if it is something else.
    pub fn of(summary: &Value) -> Option<Self> {
        let rate = |name: &str, part: &str| Some(summary.get(name)?.get(part)?.as_u64()? as usize);
        let named = ["listed", "pairs", "unlisted"];
        let sum = |part: &str| {
            named
                .iter()
                .map(|name| rate(name, part))
                .sum::<Option<usize>>()
        };
        let nothing = rate("false_discoveries", "of")?;
        Some(Self {
            right: sum("count")? + nothing - rate("false_discoveries", "count")?,
            of: sum("of")? + nothing,
            augmented: rate("unlisted_mended", "count")?,
        })
    }
}

/// The scores with a number doubled and halved. Null if the number cannot be varied in that way, or if the trial failed with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Cost {
    /// The score with half of the number.
    pub halved: Option<Score>,
    /// The score with twice the number.
    pub doubled: Option<Score>,
}

/// The results of a study of the policy's numbers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Costs {
    /// The seeds of the blind trial.
    pub seeds: Range<u64>,
    /// The score with all numbers at their defaults; null if it was not measured.
    pub default: Option<Score>,
    /// The costs by the path of the number.
    pub costs: BTreeMap<String, Cost>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_score_counts_what_is_right_in_every_class() {
        let summary = serde_json::json!({
            "listed": {"count": 7, "of": 9}, "pairs": {"count": 2, "of": 4},
            "unlisted": {"count": 5, "of": 6}, "unlisted_mended": {"count": 4, "of": 6},
            "false_discoveries": {"count": 1, "of": 10}
        });
        let score = Score {
            right: 23,
            of: 29,
            augmented: 4,
        };
        assert_eq!(Score::of(&summary), Some(score));
        assert_eq!(Score::of(&serde_json::json!({})), None);
    }
}

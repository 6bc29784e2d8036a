//! The cost of a variation of a number in the blind trial.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The result of a blind trial in two counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Score {
    /// Trials with the right answer.
    pub right: usize,
    /// Trials that count.
    pub of: usize,
    /// Trials with an unlisted effect that were predicted to 1.5 times the noise or a tenth of the law's error.
    pub mended: usize,
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
            mended: rate("unlisted_mended", "count")?,
        })
    }
}

/// The scores of a number's variations; `None` if the number cannot be varied in that way, or the trial failed with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Cost {
    /// With half of the number.
    pub halved: Option<Score>,
    /// With twice the number.
    pub doubled: Option<Score>,
}

/// The results of a study of the numbers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Costs {
    /// The seeds of the blind trial.
    pub seeds: Range<u64>,
    /// With all numbers at their defaults; `None` if nothing was measured.
    pub default: Option<Score>,
    /// By the number's path.
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
            mended: 4,
        };
        assert_eq!(Score::of(&summary), Some(score));
        assert_eq!(Score::of(&serde_json::json!({})), None);
    }
}

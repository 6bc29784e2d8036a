//! One statement of the paper and its verification.

use std::collections::BTreeMap;

use mesh_damper_recording::extremes::least_and_largest;
use serde::Serialize;

/// Whether a statement holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The recomputation confirms the statement.
    Holds,
    /// The recomputation gives another result.
    Fails,
    /// The paper does not give the data that the recomputation needs.
    CannotTell,
}

impl Verdict {
    /// [`Verdict::Holds`] or [`Verdict::Fails`].
    pub fn of(holds: bool) -> Self {
        if holds { Self::Holds } else { Self::Fails }
    }

    /// In words for a reader.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Fails => "fails",
            Self::CannotTell => "cannot be decided",
        }
    }
}

/// A statement of the paper, recomputed.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Claim {
    /// Short name, unique among the claims.
    pub name: &'static str,
    /// Section, equation, table or figure of the paper.
    pub place: &'static str,
    /// The statement.
    pub says: &'static str,
    /// Whether it holds.
    pub verdict: Verdict,
    /// The reason for the verdict, in one line.
    pub reason: String,
    /// The numbers that decide. Their units are in their names.
    pub figures: BTreeMap<String, f64>,
}

impl Claim {
    /// A claim without numbers yet.
    pub fn new(
        name: &'static str,
        place: &'static str,
        says: &'static str,
        verdict: Verdict,
        reason: impl Into<String>,
    ) -> Self {
        Self {
            name,
            place,
            says,
            verdict,
            reason: reason.into(),
            figures: BTreeMap::new(),
        }
    }

    /// The claim with one more number.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, value: f64) -> Self {
        self.figures.insert(name.into(), value);
        self
    }

    /// The claim with a number for each of the published densities, or for the first ones.
    #[must_use]
    pub fn with_each<'a>(
        mut self,
        name: &str,
        at: &'a [f64],
        values: impl IntoIterator<Item = &'a f64>,
    ) -> Self {
        for (at, value) in at.iter().zip(values) {
            self.figures.insert(format!("{name} at {at}"), *value);
        }
        self
    }
}

/// Whether every value is above the one before.
pub fn is_rising(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[1] > pair[0])
}

/// Whether every value is below the one before.
pub fn is_falling(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[1] < pair[0])
}

/// Largest over smallest.
pub fn spread(values: impl IntoIterator<Item = f64>) -> f64 {
    let (low, high) = least_and_largest(values);
    high / low
}

/// Numbers as text, with a number of decimals.
pub fn listed(values: &[f64], decimals: usize) -> String {
    let texts: Vec<String> = values
        .iter()
        .map(|value| format!("{value:.decimals$}").replace('-', "−"))
        .collect();
    texts.join(", ")
}

//! What a laboratory knows about its rig, so that it need not be found in the recordings.

use serde::{Deserialize, Serialize};

/// Facts about a rig, as its user states them. Each is absent if it is unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RigFacts {
    /// The mass that moves between specimen and load cell, kg; below 0 if the load cell is compensated for too large a mass.
    #[serde(default)]
    pub fixture_mass: Option<f64>,
    /// The time by which the recorded force is late, s; below 0 if it is early.
    #[serde(default)]
    pub force_delay: Option<f64>,
    /// Where the displacement of the specimen is 0.
    #[serde(default)]
    pub zero: Option<DisplacementZero>,
}

impl RigFacts {
    /// Whether nothing is stated.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The facts as sentences.
    pub fn in_words(&self) -> Vec<String> {
        let mass = self.fixture_mass.map(|mass| {
            format!("a mass of {mass} kg moves between specimen and load cell; it is part of the law and was not fitted")
        });
        let delay = self.force_delay.map(|delay| {
            let how = if delay < 0.0 { "early" } else { "late" };
            format!(
                "the force is {how} by {} ms; it was moved back, and the law contains no delay",
                1e3 * delay.abs()
            )
        });
        let zero = self.zero.map(|zero| {
            let at = match zero {
                DisplacementZero::Mean => "its mean in each recording",
                DisplacementZero::Start => "its value at the start of each recording",
                DisplacementZero::None => "the recorded zero",
            };
            format!("the displacement is counted from {at}")
        });
        [mass, delay, zero].into_iter().flatten().collect()
    }
}

/// Where the displacement of the specimen is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum DisplacementZero {
    /// At the mean of the recorded displacement.
    Mean,
    /// At the displacement with which the recording starts, at rest.
    Start,
    /// At the recorded zero.
    None,
}

impl DisplacementZero {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Mean, Self::Start, Self::None];

    /// As in options and files.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Start => "start",
            Self::None => "none",
        }
    }
}

//! The error of a model on motions that it was not fitted to.

use serde::{Deserialize, Serialize};

/// Errors on conditions that were left out of a fit, one after the other: each is a motion, or a stretch of one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Elsewhere {
    /// Conditions that were left out.
    pub conditions: usize,
    /// Nine of ten errors were at most this fraction of the RMS force of their condition.
    pub most: f64,
}

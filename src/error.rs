//! What a constructor refuses, naming the field.

use core::fmt;

/// A configuration that was refused. Every variant carries the field's name as it stands in the type's documentation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ConfigError {
    /// The field is NaN or infinite.
    NonFinite(&'static str),
    /// The field lies outside the range that its documentation gives.
    OutOfRange {
        /// The field's name.
        field: &'static str,
        /// What was given.
        value: f64,
        /// Smallest value allowed.
        low: f64,
        /// Largest value allowed.
        high: f64,
    },
    /// A grid's nodes do not increase strictly.
    NotIncreasing(&'static str),
    /// More elements than the fixed capacity holds.
    Full {
        /// What was being filled.
        field: &'static str,
        /// How many fit.
        capacity: usize,
    },
    /// Nothing was given where at least one element is needed.
    Empty(&'static str),
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NonFinite(field) => write!(f, "{field} is not a finite number"),
            Self::OutOfRange {
                field,
                value,
                low,
                high,
            } if value.abs() >= 1e15 => write!(f, "{field} = {value:.3e} is outside {low}…{high}"),
            Self::OutOfRange {
                field,
                value,
                low,
                high,
            } => write!(f, "{field} = {value} is outside {low}…{high}"),
            Self::NotIncreasing(field) => write!(f, "{field} must increase from node to node"),
            Self::Full { field, capacity } => write!(f, "{field} holds at most {capacity}"),
            Self::Empty(field) => write!(f, "{field} is empty"),
        }
    }
}

impl core::error::Error for ConfigError {}

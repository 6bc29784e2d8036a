//! Errors of constructors. They name the field.

use core::fmt;

/// A configuration that was rejected. Every variant carries the name of the field as the type's documentation gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum ConfigError {
    /// The field is NaN or infinite.
    NonFinite(&'static str),
    /// The field lies outside the range given in its documentation.
    OutOfRange {
        /// The field's name.
        field: &'static str,
        /// The value given.
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
        /// Name of the list.
        field: &'static str,
        /// Its capacity.
        capacity: usize,
    },
    /// The list is empty, and at least one element is needed.
    Empty(&'static str),
    /// A feature of an earlier version that this version no longer has.
    Removed(&'static str),
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
            Self::Removed(what) => write!(f, "there is no {what} any more"),
        }
    }
}

impl core::error::Error for ConfigError {}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::string::ToString as _;

    #[test]
    fn a_refusal_is_written_in_words() {
        let out_of_range = |value| {
            ConfigError::OutOfRange {
                field: "lead",
                value,
                low: 0.0,
                high: 0.1,
            }
            .to_string()
        };
        assert_eq!(out_of_range(-0.25), "lead = -0.25 is outside 0…0.1");
        // Beyond this size the digits are no longer written out.
        assert_eq!(
            out_of_range(9e14),
            "lead = 900000000000000 is outside 0…0.1"
        );
        assert_eq!(out_of_range(1e15), "lead = 1.000e15 is outside 0…0.1");
        assert_eq!(out_of_range(-2.5e38), "lead = -2.500e38 is outside 0…0.1");
        let text = [
            ConfigError::NonFinite("size"),
            ConfigError::NotIncreasing("densities"),
            ConfigError::Full {
                field: "blocks",
                capacity: 4,
            },
            ConfigError::Empty("points"),
        ]
        .map(|error| error.to_string());
        assert_eq!(
            text,
            [
                "size is not a finite number",
                "densities must increase from node to node",
                "blocks holds at most 4",
                "points is empty",
            ]
        );
    }
}

//! The reason why a call is refused: the given value, the error, and the remedy.

use std::fmt::Display;

use crate::types::Status;

/// A call that changed nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The return value of the call.
    pub status: Status,
    /// For the logger, in one line.
    pub message: String,
}

impl Refusal {
    /// `field` has a `value` with this `problem`; `remedy` says how to correct it.
    pub fn new(field: &str, value: impl Display, problem: impl Display, remedy: &str) -> Self {
        Self {
            status: Status::Error,
            message: format!("{field} = {value}: {problem}; {remedy}"),
        }
    }

    /// The same, with the status by which the standard lets the master continue.
    #[must_use]
    pub fn discarded(self) -> Self {
        Self {
            status: Status::Discard,
            ..self
        }
    }

    /// For a pointer that is null and may not be.
    pub fn null(field: &str) -> Self {
        Self::new(
            field,
            "NULL",
            "something must lie there",
            "give the address of it",
        )
    }
}

/// A finite `value`.
///
/// # Errors
/// It is NaN or infinite.
pub fn finite(field: &str, value: f64) -> Result<f64, Refusal> {
    if value.is_finite() {
        return Ok(value);
    }
    Err(Refusal::new(
        field,
        value,
        "no finite number",
        "give a finite number",
    ))
}

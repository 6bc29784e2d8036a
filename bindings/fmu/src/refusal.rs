//! Why a call is refused: what was given, what is wrong with it, and how to mend it.

use std::fmt::Display;

use crate::types::Status;

/// A call that changed nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// What the call returns.
    pub status: Status,
    /// For the logger, in one line.
    pub message: String,
}

impl Refusal {
    /// `field` has a `value` that is wrong by `problem`; `remedy` mends it.
    pub fn new(field: &str, value: impl Display, problem: impl Display, remedy: &str) -> Self {
        Self {
            status: Status::Error,
            message: format!("{field} = {value}: {problem}; {remedy}"),
        }
    }

    /// The same where the standard has the master go on.
    #[must_use]
    pub fn discarded(self) -> Self {
        Self {
            status: Status::Discard,
            ..self
        }
    }

    /// Of a pointer that is null and may not be.
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

//! One requirement on a result, for callers that count how many are met.

/// One requirement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Check {
    /// The requirement, with the same text from run to run.
    pub name: String,
    /// The value reached instead, in one line; `None` if the requirement is met.
    pub failure: Option<String>,
    /// Whether there were cases to judge. A requirement without cases has shown nothing.
    pub is_judged: bool,
}

impl Check {
    /// A requirement that is met if it `holds`; otherwise `failure` gives the value reached.
    pub fn new(name: impl Into<String>, holds: bool, failure: impl FnOnce() -> String) -> Self {
        Self {
            name: name.into(),
            failure: (!holds).then(failure),
            is_judged: true,
        }
    }

    /// The same, judged on `count` cases.
    #[must_use]
    pub fn of(self, count: usize) -> Self {
        Self {
            is_judged: count > 0,
            ..self
        }
    }
}

/// The failures among `checks`, one line each.
pub fn failures(checks: Vec<Check>) -> Vec<String> {
    checks
        .into_iter()
        .filter_map(|check| check.failure)
        .collect()
}

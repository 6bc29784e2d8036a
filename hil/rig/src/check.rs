//! What is asked of a result, one thing at a time, for whoever counts what holds.

/// One thing that is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Check {
    /// What is asked for, the same from run to run.
    pub name: String,
    /// What was reached in its place, in a line; `None` where it holds.
    pub failure: Option<String>,
    /// Whether there was anything to judge; what holds for nothing has shown nothing.
    pub is_judged: bool,
}

impl Check {
    /// That `holds`, where `failure` says what was reached if it does not.
    pub fn new(name: impl Into<String>, holds: bool, failure: impl FnOnce() -> String) -> Self {
        Self {
            name: name.into(),
            failure: (!holds).then(failure),
            is_judged: true,
        }
    }

    /// The same, judged by `count` of whatever it is about.
    #[must_use]
    pub fn of(self, count: usize) -> Self {
        Self {
            is_judged: count > 0,
            ..self
        }
    }
}

/// The failures among `checks`, a line each.
pub fn failures(checks: Vec<Check>) -> Vec<String> {
    checks
        .into_iter()
        .filter_map(|check| check.failure)
        .collect()
}

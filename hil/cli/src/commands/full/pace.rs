//! How fast a simulated rig runs beside the clock on the wall.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;
use std::time::{Duration, Instant};

/// Slowest and fastest pace that may be given.
const RANGE: (f64, f64) = (1e-3, 1e3);
/// Time that the rig may be ahead: shorter waits are inexact, s.
const AHEAD: f64 = 5e-3;

/// A pace: seconds of the test to a second of the wall's clock, or as fast as it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Speed {
    /// This many times as fast as the clock, at most.
    Factor(f64),
    /// As fast as it goes.
    Max,
}

impl FromStr for Speed {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (low, high) = RANGE;
        match text.parse() {
            Ok(factor) if (low..=high).contains(&factor) => Ok(Self::Factor(factor)),
            _ if text == "max" => Ok(Self::Max),
            _ => Err(format!("give {low} to {high}, or max")),
        }
    }
}

impl Display for Speed {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Factor(factor) => factor.fmt(f),
            Self::Max => f.write_str("max"),
        }
    }
}

/// Holds a rig back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Seconds of the wall's clock to a second of the test; none to hold nothing back.
    per_second: Option<f64>,
    /// When the test was at `at`, had it not been faster.
    due: Instant,
    /// s of the test.
    at: f64,
}

impl Pace {
    pub(super) fn new(speed: Speed) -> Self {
        Self {
            per_second: match speed {
                Speed::Factor(factor) => Some(1.0 / factor),
                Speed::Max => None,
            },
            due: Instant::now(),
            at: 0.0,
        }
    }

    /// Waits until the test may be at `time`, s.
    pub(super) fn wait(&mut self, time: f64) {
        let Some(per_second) = self.per_second else {
            return;
        };
        let passed = (time - self.at) * per_second;
        if passed < AHEAD {
            return;
        }
        self.at = time;
        self.due += Duration::from_secs_f64(passed);
        let now = Instant::now();
        match self.due.checked_duration_since(now) {
            Some(ahead) => std::thread::sleep(ahead),
            // What a busy machine has cost is not made up for.
            None => self.due = now,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pace_is_a_factor_or_none() {
        assert_eq!("2.5".parse(), Ok(Speed::Factor(2.5)));
        assert_eq!("max".parse(), Ok(Speed::Max));
        for bad in ["", "0", "-1", "nan", "inf", "1001", "fast"] {
            assert!(bad.parse::<Speed>().is_err(), "{bad}");
        }
    }
}

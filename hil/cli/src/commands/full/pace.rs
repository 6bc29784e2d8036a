//! The speed of a simulated rig relative to real time.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;
use std::time::{Duration, Instant};

/// Slowest and fastest speed that may be given.
const RANGE: (f64, f64) = (1e-3, 1e3);
/// Time by which the rig may be ahead, s. Shorter waits are inexact.
const AHEAD: f64 = 5e-3;

/// The speed of the test relative to real time, or as fast as possible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Speed {
    /// At most this many times real time.
    Factor(f64),
    /// As fast as possible.
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

/// Limits the speed of a rig.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Seconds of real time for a second of the test; `None` for no limit.
    per_second: Option<f64>,
    /// Real time at which the test time `at` is due.
    due: Instant,
    /// Test time, s.
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

    /// Waits until the test may continue at the test time `time`, s.
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
            // Delays by a busy machine are not made up for.
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

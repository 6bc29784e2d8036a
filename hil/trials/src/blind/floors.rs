//! The requirements on the blind trial: its results when this was last written, minus the change that one more seed may cause.

use std::ops::Range;

use mesh_damper_rig::check::{Check, failures};

use super::summary::{Rate, Summary};

/// Lowest rates, and the highest of false discoveries.
#[derive(Clone, Copy, Debug)]
pub struct Floors {
    /// For [`Summary::listed`].
    pub listed: f64,
    /// For [`Summary::listed_or_among`].
    pub listed_or_among: f64,
    /// Highest [`Summary::false_discoveries`].
    pub false_discoveries: f64,
    /// For [`Summary::pairs`].
    pub pairs: f64,
    /// For [`Summary::unlisted`].
    pub unlisted: f64,
    /// Highest [`Summary::unlisted_named`].
    pub unlisted_named: f64,
    /// For [`Summary::unlisted_augmented`].
    pub unlisted_augmented: f64,
}

/// Over seeds 0…499.
pub const FLOORS: Floors = Floors {
    listed: 0.97,
    listed_or_among: 0.97,
    false_discoveries: 0.01,
    pairs: 0.95,
    unlisted: 0.96,
    unlisted_named: 0.035,
    unlisted_augmented: 0.87,
};

/// Over unlisted seeds 0…429. No other effects are hidden there.
pub const FLOORS_OF_THE_UNLISTED: Floors = Floors {
    listed: 0.0,
    listed_or_among: 0.0,
    false_discoveries: 0.0,
    pairs: 0.0,
    unlisted: 0.96,
    unlisted_named: 0.035,
    unlisted_augmented: 0.82,
};

/// Over the crate's own effects, described seeds 0…95. No other effects are hidden there.
pub const FLOORS_OF_THE_DESCRIBED: Floors = Floors {
    listed: 0.92,
    listed_or_among: 0.94,
    false_discoveries: 0.0,
    pairs: 0.0,
    unlisted: 0.0,
    unlisted_named: 0.0,
    unlisted_augmented: 0.0,
};

/// Seeds that are tested with every change.
pub const PART: Range<u64> = 0..25;

/// Over these seeds.
pub const FLOORS_OF_A_PART: Floors = Floors {
    listed: 1.0,
    listed_or_among: 1.0,
    false_discoveries: 0.0,
    pairs: 1.0,
    unlisted: 0.33,
    unlisted_named: 0.34,
    unlisted_augmented: 0.66,
};

/// Checks that a bound `holds`; if not, the message gives the result, `said`.
pub(super) fn bounded(holds: bool, what: &str, said: &str, end: &str, bound: f64) -> Check {
    Check::new(what, holds, || {
        format!("{what}: {said}, {end} {bound:.3} has been reached")
    })
}

impl Floors {
    /// The [`Floors::checks`] that `summary` fails, one per line.
    pub fn missed(&self, summary: &Summary) -> Vec<String> {
        failures(self.checks(summary))
    }

    /// The requirements on `summary`.
    pub fn checks(&self, summary: &Summary) -> Vec<Check> {
        // Without trials there is no rate to check.
        let said = |rate: Rate| format!("{} of {}", rate.count, rate.of);
        let least = |what: &str, rate: Rate, bound: f64| {
            let holds = rate.of == 0 || rate.value() >= bound;
            bounded(holds, what, &said(rate), "at least", bound).of(rate.of)
        };
        let most = |what: &str, rate: Rate, bound: f64| {
            let holds = rate.of == 0 || rate.value() <= bound;
            bounded(holds, what, &said(rate), "at most", bound).of(rate.of)
        };
        [
            least("listed", summary.listed, self.listed),
            least(
                "listed, or among several",
                summary.listed_or_among,
                self.listed_or_among,
            ),
            most(
                "false discoveries",
                summary.false_discoveries,
                self.false_discoveries,
            ),
            least("pairs", summary.pairs, self.pairs),
            least("no family: unmodelled", summary.unlisted, self.unlisted),
            most(
                "no family: given a family's name",
                summary.unlisted_named,
                self.unlisted_named,
            ),
            least(
                "no family: law augmented",
                summary.unlisted_augmented,
                self.unlisted_augmented,
            ),
        ]
        .into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_reached_is_said() {
        let mut summary = Summary::of(Vec::new(), Vec::new());
        assert!(
            FLOORS.missed(&summary).is_empty(),
            "of none there is no rate"
        );
        summary.listed = Rate { count: 96, of: 100 };
        summary.unlisted_named = Rate { count: 1, of: 20 };
        let said = [
            "listed: 96 of 100, at least 0.970 has been reached",
            "no family: given a family's name: 1 of 20, at most 0.035 has been reached",
        ];
        assert_eq!(FLOORS.missed(&summary), said);
    }
}

//! The requirements on the blind trial: its results when this was last written, minus the change that one more seed may cause.

use std::ops::Range;

use mesh_damper_rig::check::{Check, failures};

use super::summary::{Rate, Results};

/// The trials that have requirements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Floors {
    /// Seeds 0…499 of version 1 of the draw.
    Specimens,
    /// [`PART`] of version 1.
    Part,
    /// Unlisted seeds 0…429 of version 1. No other effects are hidden there.
    Unlisted,
    /// The crate's own effects, four times each. No other effects are hidden there.
    Described,
    /// Over any motion, 140 seeds from 112 on of version 2: no rule of the trace was tuned on them.
    Motions,
    /// Over any motion, two of each kind, one of which hides an effect.
    PartOfMotions,
}

/// Seeds that are tested with every change.
pub const PART: Range<u64> = 0..25;

/// A result.
enum Reached {
    /// Without trials there is no rate to check.
    Rate(Rate),
    /// Without trials it is not a number, and not enough.
    Number(f64),
}

/// The side on which a result may be of its bound.
#[derive(Clone, Copy, PartialEq)]
enum End {
    Least,
    Most,
}

/// A requirement: its name, on which side of the bound the result is, the result, and a bound for each of [`Floors`].
type Floor = (&'static str, End, fn(&Results) -> Reached, [f64; 6]);

/// No requirement.
const NONE: f64 = f64::NAN;

#[rustfmt::skip]
const TABLE: [Floor; 12] = {
    use End::{Least, Most};
    use Reached as R;
    [
        ("listed",                           Least, |s| R::Rate(s.listed),            [ 0.97,   1.0,  NONE,  0.92,  NONE,  NONE]),
        ("listed, or among several",         Least, |s| R::Rate(s.listed_or_among),   [ 0.97,   1.0,  NONE,  0.94,  NONE,  NONE]),
        ("false discoveries",                Most,  |s| R::Rate(s.false_discoveries), [ 0.01,   0.0,  NONE,  NONE,  NONE,  NONE]),
        ("pairs",                            Least, |s| R::Rate(s.pairs),             [ 0.95,   1.0,  NONE,  NONE,  NONE,  NONE]),
        ("no family: unmodelled",            Least, |s| R::Rate(s.unlisted),          [ 0.96,  0.33,  0.96,  NONE,  NONE,  NONE]),
        ("no family: given a family's name", Most,  |s| R::Rate(s.unlisted_named),    [0.035,  0.34, 0.035,  NONE,  NONE,  NONE]),
        ("no family: law augmented",         Least, |s| R::Rate(s.unlisted_augmented), [ 0.87,  0.66,  0.82,  NONE,  NONE,  NONE]),
        ("right, or among several",          Least, |s| R::Number(s.all.right()),     [ NONE,  NONE,  NONE,  NONE, 0.915,   0.7]),
        ("false or missed",                  Most,  |s| R::Number(s.all.wrong()),     [ NONE,  NONE,  NONE,  NONE,  0.03,  0.04]),
        ("median error over the true law's", Most,  |s| R::Number(s.all.median),      [ NONE,  NONE,  NONE,  NONE,  1.02,   1.1]),
        ("error in nine of ten",             Most,  |s| R::Number(s.all.ninth_decile), [ NONE,  NONE,  NONE,  NONE,   1.1,   2.0]),
        ("intervals that hold",              Least, |s| R::Number(s.all.intervals),   [ NONE,  NONE,  NONE,  NONE,  0.78,   0.7]),
    ]
};

impl Floors {
    /// The [`Floors::checks`] that `results` fail, one per line.
    pub fn missed(self, results: &Results) -> Vec<String> {
        failures(self.checks(results))
    }

    /// The requirements on `results`.
    pub fn checks(self, results: &Results) -> Vec<Check> {
        let mut checks = Vec::new();
        for (what, end, result, bounds) in TABLE {
            let bound = bounds[self as usize];
            if bound.is_nan() {
                continue;
            }
            let holds = |value: f64| match end {
                End::Least => value >= bound,
                End::Most => value <= bound,
            };
            let (holds, said, is_judged) = match result(results) {
                Reached::Rate(rate) => (
                    rate.of == 0 || holds(rate.value()),
                    format!("{} of {}", rate.count, rate.of),
                    rate.of > 0,
                ),
                Reached::Number(value) => (holds(value), format!("{value:.3}"), true),
            };
            let end = match end {
                End::Least => "at least",
                End::Most => "at most",
            };
            let check = Check::new(what, holds, || {
                format!("{what}: {said}, {end} {bound:.3} has been reached")
            });
            checks.push(check.of(is_judged.into()));
        }
        checks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blind::{Summary, Version};

    fn nothing() -> Results {
        Summary::of(Version::NEWEST, Vec::new(), Vec::new()).results
    }

    #[test]
    fn what_is_not_reached_is_said() {
        let mut results = nothing();
        let none = Floors::Specimens.missed(&results);
        assert!(none.is_empty(), "of none there is no rate");
        results.listed = Rate { count: 96, of: 100 };
        results.unlisted_named = Rate { count: 1, of: 20 };
        let said = [
            "listed: 96 of 100, at least 0.970 has been reached",
            "no family: given a family's name: 1 of 20, at most 0.035 has been reached",
        ];
        assert_eq!(Floors::Specimens.missed(&results), said);
    }

    #[test]
    fn what_is_not_reached_over_any_motion_is_said() {
        let mut results = nothing();
        let all = &mut results.all;
        all.count = 100;
        all.marks = [92, 5, 1, 1, 1, 0];
        (all.median, all.ninth_decile, all.intervals) = (1.02, 1.2, 0.8);
        let said = ["error in nine of ten: 1.200, at most 1.100 has been reached"];
        assert_eq!(Floors::Motions.missed(&results), said);
        // If no trial counts, no requirement is met.
        assert_eq!(Floors::Motions.missed(&nothing()).len(), 5);
    }
}

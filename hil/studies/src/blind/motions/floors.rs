//! What the trial over any motion has to reach: what it reached when this was last written, less what one more seed may change.

use super::summary::Summary;

/// Least and largest of what the counted trials come to.
#[derive(Clone, Copy, Debug)]
pub struct Floors {
    /// The least part named alone, or among several that cannot be told apart.
    pub right: f64,
    /// The largest part called by another name, or `none` where something shows.
    pub wrong: f64,
    /// The largest held-out error over that of the true law, in the median,
    pub median: f64,
    /// and in nine of ten.
    pub ninth_decile: f64,
    /// The least part of the 90 % intervals of the law's coefficients that holds.
    pub intervals: f64,
}

/// Over 140 seeds from 112 on: no rule of the trace was tuned on them.
pub const FLOORS: Floors = Floors {
    right: 0.915,
    wrong: 0.03,
    median: 1.02,
    ninth_decile: 1.1,
    intervals: 0.78,
};

/// Two of each kind of motion, of which one hides something.
pub const FLOORS_OF_A_PART: Floors = Floors {
    right: 0.7,
    wrong: 0.04,
    median: 1.1,
    ninth_decile: 2.0,
    intervals: 0.7,
};

impl Floors {
    /// What `summary` does not reach, each in a line.
    pub fn missed(&self, summary: &Summary) -> Vec<String> {
        let all = &summary.all;
        let mut missed = Vec::new();
        let mut hold = |what: &str, value: f64, bound: f64, is_least: bool| {
            let holds = if is_least {
                value >= bound
            } else {
                value <= bound
            };
            if !holds {
                let end = if is_least { "at least" } else { "at most" };
                missed.push(format!(
                    "{what}: {value:.3}, {end} {bound:.3} has been reached"
                ));
            }
        };
        hold("right, or among several", all.right(), self.right, true);
        hold("false or missed", all.wrong(), self.wrong, false);
        hold(
            "median error over the true law's",
            all.median,
            self.median,
            false,
        );
        hold(
            "error in nine of ten",
            all.ninth_decile,
            self.ninth_decile,
            false,
        );
        hold("intervals that hold", all.intervals, self.intervals, true);
        missed
    }
}

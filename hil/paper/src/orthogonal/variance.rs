//! Analysis of variance for an L9: which factors stand out from the error, and whether there is an error for comparison.
//!
//! A factor's sum of squares is 3r·Σ(mean of a level − mean of everything)² over its three levels, with 2 degrees of freedom; r is
//! the number of repetitions of every run. It is compared with the first of these that exists:
//!
//! 1. if runs were repeated: the scatter between repeats, with 9·(r − 1) degrees of freedom;
//! 2. if columns are free: the remainder of the runs without the factors, with 2 for every column without a factor. It is error
//!    only if it contains nothing else, such as an interaction;
//! 3. in a saturated array, with four factors in nine single runs: nothing remains. The usual method is pooling, which takes the
//!    smallest column for the error; but a column that was chosen for being small makes every other one look large.
//!
//! In the third case the distribution is known. If all four columns were error, normal and independent, each sum of squares would
//! be σ²·χ² with 2 degrees of freedom, an exponential variable. The excess of a column over the smallest, S₁ the least of four, is
//! again exponential and independent of it (it has no memory). So, with F = S/S₁,
//!
//! ```text
//! P(S/S₁ ≥ F) = 4/(3 + F)        where the F distribution says 1/(1 + F)
//! P(S_max/ΣS ≥ g) = Σ_j (−1)^(j+1)·(4 over j)·(1 − j·g)³ over j·g < 1     (Fisher 1929, Proc. R. Soc. A 125, 54)
//! ```
//!
//! The first is p of each column, the second that of the largest, which needs no pooling at all.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF as _, FisherSnedecor};

use super::array::{COLUMNS, LEVELS, RUNS};
use super::experiment::{Experiment, Response};
use super::ranges::mean;

/// Name for the columns without a factor.
pub const FREE_COLUMNS: &str = "free columns";

/// An effect counts as distinct from error if error alone gives one as large in fewer cases than this.
pub const SIGNIFICANCE: f64 = 0.05;

/// Degrees of freedom of three levels.
const FREEDOM: usize = LEVELS - 1;

/// Sums of squares below this fraction of the squares themselves are rounding.
const ROUNDING: f64 = 1e-24;

/// The error with which the factors are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ErrorSource {
    /// The scatter between repeats of the same run.
    Repeats,
    /// The columns without a factor.
    FreeColumns,
    /// The factor with the smallest sum of squares: the array is saturated.
    SmallestColumn,
    /// None: the results do not scatter.
    None,
}

/// The line of one factor in the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Effect {
    /// The factor, or `free columns` for the columns without a factor in repeated runs. Those columns show interactions.
    pub name: String,
    /// Sum of squares, in the square of the result's unit.
    pub sum_of_squares: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Fraction of the total sum of squares, 0…1.
    pub share: f64,
    /// Ratio F of the mean square to that of the error; null for the error itself, and if there is no error.
    pub f: Option<f64>,
    /// The probability that error alone gives such an F, from the F distribution; null if there is no F.
    pub p_nominal: Option<f64>,
    /// The same probability corrected for the choice of the error. It differs from `p_nominal` only in a saturated array.
    pub p: Option<f64>,
}

/// The analysis of variance of one result.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Variance {
    /// One effect for each factor, in their order, and one for the free columns if runs were repeated.
    pub effects: Vec<Effect>,
    /// The error for the comparison.
    pub error: ErrorSource,
    /// Degrees of freedom of the error.
    pub error_freedom: usize,
    /// Mean square of the error, in the square of the result's unit.
    pub error_mean_square: f64,
    /// Sum of squares about the overall mean, in the square of the result's unit.
    pub total: f64,
    /// In a saturated array, the probability that error alone gives a largest column with this fraction of the total; null in other
    /// arrays.
    pub p_largest: Option<f64>,
    /// The factors distinguished from error at [`SIGNIFICANCE`], the largest first.
    pub told: Vec<String>,
}

impl Variance {
    pub(super) fn of(experiment: &Experiment, response: &Response) -> Self {
        let repeats = response.runs[0].len();
        let of_runs = response.runs.each_ref().map(|values| mean(values));
        let grand = mean(&of_runs);
        let squares = |values: &[f64], about: f64| -> f64 {
            values.iter().map(|value| (value - about).powi(2)).sum()
        };
        let all = |about| -> f64 {
            let runs = response.runs.iter();
            runs.map(|values| squares(values, about)).sum()
        };
        let total = all(grand);
        let least = ROUNDING * all(0.0);
        let between = repeats as f64 * squares(&of_runs, grand);
        let mut effects: Vec<Effect> = experiment
            .factors()
            .iter()
            .map(|factor| {
                let mut means = [0.0; LEVELS];
                for (&level, value) in factor.column.iter().zip(of_runs) {
                    means[level] += value / LEVELS as f64;
                }
                let sum_of_squares = (LEVELS * repeats) as f64 * squares(&means, grand);
                Effect::new(&factor.name, sum_of_squares, FREEDOM, total)
            })
            .collect();
        let factors: f64 = effects.iter().map(|effect| effect.sum_of_squares).sum();
        let free = FREEDOM * (COLUMNS - effects.len());
        let rest = (between - factors).max(0.0);
        let smallest = effects
            .iter()
            .map(|effect| effect.sum_of_squares)
            .fold(f64::INFINITY, f64::min);
        let (mut error, error_freedom, of_error) = if repeats > 1 {
            let within = RUNS * (repeats - 1);
            if free > 0 {
                effects.push(Effect::new(FREE_COLUMNS, rest, free, total));
            }
            (ErrorSource::Repeats, within, (total - between).max(0.0))
        } else if free > 0 {
            (ErrorSource::FreeColumns, free, rest)
        } else {
            (ErrorSource::SmallestColumn, FREEDOM, smallest)
        };
        if of_error <= least {
            error = ErrorSource::None;
        }
        let error_mean_square = of_error / error_freedom as f64;
        let mut p_largest = None;
        if error != ErrorSource::None {
            // Both degrees of freedom are at least 2, so this distribution exists.
            for effect in &mut effects {
                effect.hold_against(error, error_freedom, error_mean_square);
            }
            if error == ErrorSource::SmallestColumn {
                let largest = effects
                    .iter()
                    .map(|effect| effect.share)
                    .fold(0.0, f64::max);
                p_largest = Some(probability_of_largest(largest));
            }
        }
        let mut variance = Self {
            effects,
            error,
            error_freedom,
            error_mean_square,
            total,
            p_largest,
            told: Vec::new(),
        };
        variance.told = variance.tell();
        variance
    }

    fn tell(&self) -> Vec<String> {
        let mut ordered: Vec<&Effect> = self.effects.iter().collect();
        ordered.sort_by(|a, b| b.mean_square().total_cmp(&a.mean_square()));
        let below = |p: Option<f64>| p.is_some_and(|p| p < SIGNIFICANCE);
        (0..)
            .zip(ordered)
            .filter(|&(rank, effect)| below(effect.p) || rank == 0 && below(self.p_largest))
            .map(|(_, effect)| effect.name.clone())
            .collect()
    }
}

impl Effect {
    fn new(name: &str, sum_of_squares: f64, freedom: usize, total: f64) -> Self {
        Self {
            name: name.into(),
            sum_of_squares,
            freedom,
            share: if total > 0.0 {
                sum_of_squares / total
            } else {
                0.0
            },
            f: None,
            p_nominal: None,
            p: None,
        }
    }

    fn mean_square(&self) -> f64 {
        self.sum_of_squares / self.freedom as f64
    }

    fn hold_against(&mut self, error: ErrorSource, error_freedom: usize, error_mean_square: f64) {
        let f = self.mean_square() / error_mean_square;
        let saturated = error == ErrorSource::SmallestColumn;
        // That column is the error.
        if saturated && f <= 1.0 {
            return;
        }
        let distribution = FisherSnedecor::new(self.freedom as f64, error_freedom as f64).ok();
        self.f = Some(f);
        self.p_nominal = distribution.map(|distribution| distribution.sf(f));
        self.p = if saturated {
            Some(probability_beside_smallest(f))
        } else {
            self.p_nominal
        };
    }
}

/// The probability that a column of error is `f` times the smallest of four, if it is another one.
fn probability_beside_smallest(f: f64) -> f64 {
    COLUMNS as f64 / (COLUMNS as f64 - 1.0 + f)
}

/// The probability that the largest of four columns of error is at least `share` of their sum: Fisher's g.
fn probability_of_largest(share: f64) -> f64 {
    let mut binomial = 1.0;
    let mut probability = 0.0;
    for j in 1..=COLUMNS {
        binomial *= (COLUMNS + 1 - j) as f64 / j as f64;
        let left = 1.0 - j as f64 * share;
        if left <= 0.0 {
            break;
        }
        let sign = if j % 2 == 1 { 1.0 } else { -1.0 };
        probability += sign * binomial * left.powi(COLUMNS as i32 - 1);
    }
    probability.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt as _;
    use rand::SeedableRng as _;

    /// Both compared to 200 000 draws of four columns of error, whose sums of squares are exponential.
    #[test]
    fn the_probabilities_of_a_saturated_array_are_those_of_draws() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let draws = 200_000;
        let thresholds = [(2.0, 0.4), (10.0, 0.6), (77.0, 0.8)];
        let mut beside = [0.0; 3];
        let mut largest = [0.0; 3];
        for _ in 0..draws {
            let columns: [f64; 4] = std::array::from_fn(|_| -(1.0 - random.random::<f64>()).ln());
            let least = columns.iter().copied().fold(f64::INFINITY, f64::min);
            let most = columns.iter().copied().fold(0.0, f64::max);
            let total: f64 = columns.iter().sum();
            for (index, (f, share)) in thresholds.into_iter().enumerate() {
                let others = columns.iter().filter(|&&column| column > least);
                beside[index] += others.filter(|&&column| column >= f * least).count() as f64 / 3.0;
                largest[index] += f64::from(u8::from(most >= share * total));
            }
        }
        for (index, (f, share)) in thresholds.into_iter().enumerate() {
            for (drawn, told) in [
                (beside[index], probability_beside_smallest(f)),
                (largest[index], probability_of_largest(share)),
            ] {
                let drawn = drawn / f64::from(draws);
                // Four standard deviations of the draws.
                let tolerance = 4.0 * (told * (1.0 - told) / f64::from(draws)).sqrt();
                assert!((drawn - told).abs() < tolerance, "{drawn} {told}");
            }
        }
        assert_eq!(probability_of_largest(0.25), 1.0);
        assert_eq!(probability_of_largest(1.0), 0.0);
    }
}

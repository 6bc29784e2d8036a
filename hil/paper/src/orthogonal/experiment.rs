//! An experiment: the columns of an orthogonal array and the results of its runs.

use mesh_damper_reference::orthogonal_test::{FACTORS, LEVELS as TABLE_2, Printed, UNITS};

use super::array::{COLUMNS, LEVELS, RUNS, l9, unequal_pair};

/// A factor and its level in every run.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// Its name.
    pub name: String,
    /// Its levels.
    pub levels: [String; LEVELS],
    /// The level of every run, 0…2.
    pub column: [usize; RUNS],
}

/// A result of every run.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Its name.
    pub name: String,
    /// The values of every run, one for each repetition; all runs have the same number.
    pub runs: [Vec<f64>; RUNS],
}

/// Factors on orthogonal columns with their results.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    factors: Vec<Factor>,
    responses: Vec<Response>,
}

/// The reason why factors and results are no experiment on an L9.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Defect {
    /// Fewer than two factors or more than four.
    #[error("{0} factors, where an L9 holds 2 to {COLUMNS}")]
    Factors(usize),
    /// No result.
    #[error("no result")]
    Responses,
    /// A level that does not occur in three runs.
    #[error("level {level} stands in {count} runs, where each of three levels needs {LEVELS}")]
    Unbalanced {
        /// The factor.
        factor: String,
        /// The level.
        level: String,
        /// Number of occurrences.
        count: usize,
    },
    /// Two levels of two factors that do not meet exactly once.
    #[error("not orthogonal to {other}: {level} meets {other_level} {count} times instead of once")]
    NotOrthogonal {
        /// The factor.
        factor: String,
        /// Its level.
        level: String,
        /// The other factor.
        other: String,
        /// Its level.
        other_level: String,
        /// Number of meetings.
        count: usize,
    },
    /// A run was repeated a different number of times than the first, or is missing.
    #[error("run {run} has {count} values, where the first has {first}")]
    Repeats {
        /// The result.
        response: String,
        /// The run, from 1.
        run: usize,
        /// Its values.
        count: usize,
        /// The first run's values.
        first: usize,
    },
    /// A value that is not finite.
    #[error("a value of run {run} is not finite")]
    NotFinite {
        /// The result.
        response: String,
        /// The run, from 1.
        run: usize,
    },
}

impl Experiment {
    /// Two to four factors, and one or more results.
    ///
    /// # Errors
    /// The columns are not balanced or not orthogonal, or values are missing or not finite.
    pub fn new(factors: Vec<Factor>, responses: Vec<Response>) -> Result<Self, Defect> {
        if !(2..=COLUMNS).contains(&factors.len()) {
            return Err(Defect::Factors(factors.len()));
        }
        if responses.is_empty() {
            return Err(Defect::Responses);
        }
        for factor in &factors {
            for (level, name) in factor.levels.iter().enumerate() {
                let count = factor.column.iter().filter(|&&l| l == level).count();
                if count != LEVELS {
                    return Err(Defect::Unbalanced {
                        factor: factor.name.clone(),
                        level: name.clone(),
                        count,
                    });
                }
            }
        }
        for (index, factor) in factors.iter().enumerate() {
            for other in &factors[..index] {
                if let Some((a, b, count)) = unequal_pair(&factor.column, &other.column) {
                    return Err(Defect::NotOrthogonal {
                        factor: factor.name.clone(),
                        level: factor.levels[a].clone(),
                        other: other.name.clone(),
                        other_level: other.levels[b].clone(),
                        count,
                    });
                }
            }
        }
        for response in &responses {
            let first = response.runs[0].len();
            for (run, values) in (1..).zip(&response.runs) {
                if values.is_empty() || values.len() != first {
                    return Err(Defect::Repeats {
                        response: response.name.clone(),
                        run,
                        count: values.len(),
                        first,
                    });
                }
                if values.iter().any(|value| !value.is_finite()) {
                    return Err(Defect::NotFinite {
                        response: response.name.clone(),
                        run,
                    });
                }
            }
        }
        Ok(Self { factors, responses })
    }

    /// The paper's experiment: Tables 2 and 3.
    ///
    /// # Panics
    /// Never: the columns are those of [`l9`].
    pub fn published(results: &[Printed]) -> Self {
        let factors = (0..COLUMNS)
            .map(|index| Factor {
                name: FACTORS[index].into(),
                levels: TABLE_2[index].map(|level| format!("{level} {}", UNITS[index])),
                column: l9().map(|run| run[index]),
            })
            .collect();
        let responses = results
            .iter()
            .map(|printed| Response {
                name: printed.name.into(),
                runs: printed.runs.map(|value| vec![value]),
            })
            .collect();
        Self::new(factors, responses).expect("the columns of an L9 are orthogonal")
    }

    /// The factors.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// The results.
    pub fn responses(&self) -> &[Response] {
        &self.responses
    }
}

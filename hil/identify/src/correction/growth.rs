//! The choice of trends: those that reduce the error in data that were left out, one at a time.

use rayon::prelude::*;

use super::gram::{GramRows, TableForm};
use super::trend::Trend;

mesh_damper_recording::numbers! {
    /// Which trends a residual table follows. A trend is a function of displacement and speed, or of a memory in place of speed.
    GrowthPolicy {
        /// A residual table follows at most this many trends (functions of its variables).
        most: usize = 5, Tuned("the blind trial");
        /// A trend is added if it reduces the error beyond the noise to at most this fraction of the error without it.
        worthwhile: f64 = 0.93, Tuned("the blind trial");
        /// The widths of the trends are multiplied and divided by these factors, one factor after the other, to find better ones.
        wider: [f64; 4] = [1.5, 1.22, 1.11, 1.05], Derived("each the square root of the one before");
        /// The width of a trend is changed if this reduces the error beyond the noise to at most this fraction.
        better: f64 = 0.98, Tuned("the blind trial");
    }
}

/// At most this many widths are changed with each factor of `wider`. Convention: bounds the time.
const MOST_CHANGES: usize = 6;

/// At each step only this many trends are judged by the blocks left out of the fit: those that save most in the fit. Convention:
/// bounds the time.
const MOST_JUDGED: usize = 24;

/// Those of `candidates` that clearly reduce the cross-validated error, one at a time; and that error, kN.
pub(super) fn grown(rows: &GramRows, candidates: &[Trend]) -> Option<(f64, Vec<Trend>)> {
    let sums = rows.sums(TableForm {
        trends: candidates,
        ..TableForm::NONE
    })?;
    let mut taken: Vec<usize> = Vec::new();
    let mut error = sums.error_with(&taken)?;
    while taken.len() < GrowthPolicy::in_use().most {
        let savings = sums.savings_beside(&taken)?;
        let mut promising: Vec<usize> = (0..candidates.len())
            .filter(|candidate| !taken.contains(candidate))
            .collect();
        promising.sort_by(|a, b| savings[*b].total_cmp(&savings[*a]));
        promising.truncate(MOST_JUDGED);
        let next = promising
            .into_par_iter()
            .filter_map(|candidate| {
                let more: Vec<usize> = taken.iter().copied().chain([candidate]).collect();
                Some((sums.error_with(&more)?, more))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match next {
            Some((less, more)) if less <= GrowthPolicy::in_use().worthwhile * error => {
                (error, taken) = (less, more)
            }
            _ => break,
        }
    }
    let taken = taken.into_iter().map(|index| candidates[index].clone());
    Some(polished(rows, error, taken.collect()))
}

/// These trends, with the widths that have the smallest cross-validated error.
fn polished(rows: &GramRows, mut error: f64, mut trends: Vec<Trend>) -> (f64, Vec<Trend>) {
    for factor in GrowthPolicy::in_use().wider {
        for _ in 0..MOST_CHANGES {
            let near = trends.iter().enumerate();
            let near = near.flat_map(|(place, trend)| {
                let near = trend.near(factor).into_iter();
                near.map(move |other| (place, other))
            });
            match best_change(rows, &trends, &near.collect::<Vec<_>>()) {
                Some((less, others)) if less <= GrowthPolicy::in_use().better * error => {
                    (error, trends) = (less, others)
                }
                _ => break,
            }
        }
    }
    (error, trends)
}

/// The best of these trends with one of them replaced, and its cross-validated error; `None` without others.
fn best_change(
    rows: &GramRows,
    trends: &[Trend],
    others: &[(usize, Trend)],
) -> Option<(f64, Vec<Trend>)> {
    if others.is_empty() {
        return None;
    }
    let others_alone = others.iter().map(|(_, other)| other);
    let all: Vec<Trend> = trends.iter().chain(others_alone).cloned().collect();
    let sums = rows.sums(TableForm {
        trends: &all,
        ..TableForm::NONE
    })?;
    let changed = others
        .par_iter()
        .enumerate()
        .filter_map(|(index, (place, _))| {
            let mut set: Vec<usize> = (0..trends.len()).collect();
            set[*place] = trends.len() + index;
            Some((sums.error_with(&set)?, set))
        });
    let (error, set) = changed.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((error, set.into_iter().map(|i| all[i].clone()).collect()))
}

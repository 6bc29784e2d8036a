//! Repeats the least squares until the exponents of eq 13 have settled together with the other terms.

use rayon::prelude::*;

use super::design::{Coefficients, Design, Recalled};
use super::gram::{GramRows, Solved, TableForm};
use super::trend::Trend;
use crate::correction::growth::GrowthPolicy;

mesh_damper_recording::numbers! {
    /// When the law's exponents have settled in the fit of a residual table.
    SettlePolicy {
        /// The law's exponents have settled if none of them changes by this or more in a step.
        settled: f64 = 2e-3, Convention("below their intervals");
    }
}

/// The law's exponents are fitted together with a residual table in at most this many steps. Convention: they settle in three or
/// four.
const MOST_STEPS: usize = 8;

/// Settles with these trends. Then settles with fewer, if unneeded ones covered for the exponents of eq 13.
pub(super) fn settle_needed(
    design: &Design,
    start: &Coefficients,
    mut trends: Vec<Trend>,
    recalled: Option<&Recalled>,
) -> Option<(Solved, Vec<Trend>)> {
    let settled_with = |start: &Coefficients, trends: &[Trend]| {
        let form = TableForm {
            trends,
            ..TableForm::NONE
        };
        settle(design, start, form, recalled)
    };
    let mut solved = settled_with(start, &trends)?;
    while !trends.is_empty() {
        let fewer = (0..trends.len()).into_par_iter().filter_map(|place| {
            let mut fewer = trends.clone();
            fewer.remove(place);
            Some((settled_with(&solved.coefficients, &fewer)?, fewer))
        });
        let fewer = fewer.min_by(|(a, _), (b, _)| a.error.total_cmp(&b.error));
        match fewer {
            Some((without, fewer))
                if GrowthPolicy::in_use().worthwhile * without.error < solved.error =>
            {
                (solved, trends) = (without, fewer);
            }
            _ => break,
        }
    }
    Some((solved, trends))
}

/// Solves until the exponents of eq 13 have settled, and cross-validates the result.
pub(super) fn settle(
    design: &Design,
    start: &Coefficients,
    form: TableForm,
    recalled: Option<&Recalled>,
) -> Option<Solved> {
    let at = settled(design, start, form, recalled)?.coefficients;
    GramRows::over(design, &at, recalled)
        .sums(form)?
        .cross_validated(form)
}

/// Solves until the exponents of eq 13 have settled.
pub(super) fn settled(
    design: &Design,
    start: &Coefficients,
    form: TableForm,
    recalled: Option<&Recalled>,
) -> Option<Solved> {
    let mut at = start.clone();
    for step in 1.. {
        let solved = GramRows::over(design, &at, recalled).solved(form)?;
        let changes = at.0.iter().zip(&solved.coefficients.0);
        let change = changes.fold(0.0_f64, |most, (a, b)| most.max((a[3] - b[3]).abs()));
        if change < SettlePolicy::in_use().settled || step == MOST_STEPS {
            return Some(solved);
        }
        at = solved.coefficients;
    }
    None
}

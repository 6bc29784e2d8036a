//! The search for the structure of a correction: its trends, its table around them, and its memory.

use mesh_damper_model::correction::Remembered;
use rayon::prelude::*;

use super::design::{Coefficients, Design, Recalled};
use super::gram::{GramRows, Solved, TableForm};
use super::settle::{settle, settle_needed};
use super::trend::{self, Trend};
use super::{Choice, Fitted, growth, memory};
use crate::correction::CorrectionPolicy;

mesh_damper_recording::numbers! {
    /// How a residual table is searched for.
    SearchPolicy {
        /// Penalties on the curvature of the table that are tried, relative to the weight of the data in a cell.
        smoothness: [f64; 7] = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0], Convention("decades, from hardly any smoothing to a plane");
        /// The penalty on the curvature of the table (see `smoothness`) with which kinds of memory are compared.
        typical: f64 = 1e-2, Tuned("the blind trial");
        /// A table is added to the trends if it reduces the error beyond the noise below this fraction.
        tabulated: f64 = 0.9, Tuned("the blind trial");
        /// A kind of memory is judged by left-out blocks only if the error of its fit is at most this many times the smallest one. The time
        /// since the start does not count for the smallest.
        comparable: f64 = 2.0, Tuned("the blind trial");
        /// Edges on both sides are considered only if their fit has less than this fraction of the error with an edge on one side.
        another_side: f64 = 0.9, Tuned("the blind trial");
        /// The limit, time or edge of a memory is refined this many times.
        sought: u32 = 5, Tuned("the blind trial");
        /// Trends are searched for this many times, each time with the law's exponents from the fit before.
        rounds: usize = 2, Tuned("the blind trial");
    }
}

/// The best correction without memory.
pub(super) fn momentary(design: &Design, alone: &Solved) -> Option<Fitted> {
    let mut at = alone.coefficients.clone();
    let mut trends = Vec::new();
    // The exponents of eq 13 may be far off until another term covers the missing effect.
    for _ in 0..SearchPolicy::in_use().rounds {
        let rows = GramRows::over(design, &at, None);
        (_, trends) = growth::grown(&rows, &trend::trends(None, None))?;
        let solved;
        (solved, trends) = settle_needed(design, &at, trends, None)?;
        at = solved.coefficients;
    }
    around(design, &at, trends, None)
}

/// These trends, with a table around them if that clearly reduces the error.
fn around(
    design: &Design,
    start: &Coefficients,
    trends: Vec<Trend>,
    recalled: Option<&Recalled>,
) -> Option<Fitted> {
    let rows = GramRows::over(design, start, recalled);
    let form = |table| TableForm {
        trends: &trends,
        table,
    };
    let mut solved = rows.sums(form(None))?.cross_validated(form(None))?;
    let sums = rows.sums(form(Some(SearchPolicy::in_use().typical)))?;
    let solved_with = SearchPolicy::in_use()
        .smoothness
        .par_iter()
        .filter_map(|&smoothness| {
            let table = Some(smoothness);
            Some((sums.cross_validated(form(table))?, table))
        });
    let best = solved_with.min_by(|(a, _), (b, _)| a.error.total_cmp(&b.error));
    let best =
        best.filter(|(with, _)| with.error < SearchPolicy::in_use().tabulated * solved.error);
    let mut table = None;
    if let Some((with, smoothness)) = best {
        table = smoothness;
        let again = settle(design, &with.coefficients, form(table), recalled);
        let again = again.filter(|again| again.error < with.error);
        solved = again.unwrap_or(with);
    }
    let choice = Choice {
        reach: design.reach,
        table,
        memory: recalled.map(Recalled::axis),
        trends,
        is_passive: false,
    };
    Some(Fitted { choice, solved })
}

/// The best memory of a kind.
pub(super) struct Memorable {
    pub recalled: Recalled,
    trends: Vec<Trend>,
    /// Cross-validated error, kN.
    error: f64,
}

/// The best memory of each kind, if a table over it fits clearly better than `plain`, and not much worse than a table over another
/// kind.
pub(super) fn promising(design: &Design, plain: &Fitted) -> Vec<Memorable> {
    let at = &plain.solved.coefficients;
    let tabulated = TableForm {
        trends: &[],
        table: Some(SearchPolicy::in_use().typical),
    };
    let fitted = |of: Remembered| {
        let recalled = design.recall(of)?;
        let rows = GramRows::over(design, at, Some(&recalled));
        Some((rows.solved(tabulated)?.inside, of))
    };
    let best_of = |candidates: Vec<Remembered>| {
        let fitted = candidates.into_par_iter().filter_map(fitted);
        fitted.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let kinds = memory::kinds(design, at);
    let best_of_each = kinds.into_par_iter().filter_map(|kind| {
        let coarse = best_of(kind)?;
        if coarse.0 > CorrectionPolicy::in_use().worthwhile * plain.solved.inside {
            return None;
        }
        let finer = |best: (f64, Remembered), sought| {
            let near = best_of(memory::around(best.1, sought, design));
            near.filter(|near| near.0 < best.0).unwrap_or(best)
        };
        Some((0..SearchPolicy::in_use().sought).fold(coarse, finer))
    });
    let mut best_of_each: Vec<(f64, Remembered)> = best_of_each.collect();
    let mut each = best_of_each.iter();
    if let Some(&(with_one, _)) = each.find(|(_, of)| memory::sides(*of, design) == 1) {
        let pays = |error: f64| error < SearchPolicy::in_use().another_side * with_one;
        best_of_each.retain(|(error, of)| memory::sides(*of, design) != 2 || pays(*error));
    }
    // Whether the table may remember how long a test has run is decided later.
    let of_motion = best_of_each
        .iter()
        .filter(|(_, of)| !memory::goes_on_with_time(*of));
    let least = of_motion.fold(f64::INFINITY, |least, (error, _)| least.min(*error));
    let comparable = best_of_each.into_par_iter();
    let comparable =
        comparable.filter(|(error, _)| *error <= SearchPolicy::in_use().comparable * least);
    let memories = comparable.filter_map(|(_, of)| {
        let recalled = design.recall(of)?;
        let rows = GramRows::over(design, at, Some(&recalled));
        let (along_trends, trends) = growth::grown(&rows, &trend::trends(Some(of), None))?;
        let in_table = rows.sums(tabulated)?.cross_validated(tabulated)?.error;
        Some(Memorable {
            recalled,
            trends,
            error: along_trends.min(in_table),
        })
    });
    memories.collect()
}

/// The best of these memories in place of `plain`, if that clearly reduces the error.
pub(super) fn remembering(design: &Design, plain: &Fitted, kinds: &[Memorable]) -> Option<Fitted> {
    let best = kinds.iter().min_by(|a, b| a.error.total_cmp(&b.error))?;
    let recalled = Some(&best.recalled);
    // The exponents of eq 13 may have covered for the memory.
    let start = &plain.solved.coefficients;
    let (solved, trends) = settle_needed(design, start, best.trends.clone(), recalled)?;
    let fitted = around(design, &solved.coefficients, trends, recalled)?;
    let choice = &fitted.choice;
    let remembers = choice.table.is_some() || choice.trends.iter().any(Trend::is_over_memory);
    let pays = fitted.solved.error <= CorrectionPolicy::in_use().remembered * plain.solved.error;
    (remembers && pays).then_some(fitted)
}

//! What a correction is made of: its trends, its tables around them, and what it remembers.

use mesh_damper::effects::correction::CELLS;
use rayon::prelude::*;

use super::design::{Design, Recalled};
use super::gram::{Form, Rows, Solved};
use super::settle::{settle, settle_needed};
use super::trend::{self, Trend};
use super::{Choice, Fitted, MemoryChoice, REMEMBERED, WORTHWHILE, edges, growth, memory};
use crate::correction::Remembered;

/// Penalties of the bends of T that are tried, over what the data say of a cell.
const SMOOTHNESS: [f64; 7] = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0];
/// The same of U, or none.
const MEMORY_SMOOTHNESS: [Option<f64>; 6] = [
    None,
    Some(1e-4),
    Some(1e-3),
    Some(1e-2),
    Some(0.1),
    Some(1.0),
];
/// With which kinds of memory are compared.
const TYPICAL: f64 = 1e-2;
/// A table around the trends is taken for an error beyond the noise that is at most this part of that without.
const TABULATED: f64 = 0.9;
/// A kind of memory is judged if the error of its fit is at most so many times the least of those that do not go on with time,
/// and at most [`WORTHWHILE`] of that without.
const COMPARABLE: f64 = 2.0;
/// Something touches on both sides if that fits with at most this part of the error of one.
const ANOTHER_SIDE: f64 = 0.9;
/// Times that what a memory is of is sought ever more finely.
const SOUGHT: u32 = 5;
/// Times that trends are sought, each beside the exponents of eq 13 that those before led to.
const ROUNDS: usize = 2;

/// The best correction without memory.
pub(super) fn momentary(design: &Design, alone: &Solved) -> Option<Fitted> {
    let mut solved = alone.clone();
    let mut choice = Choice {
        extent: design.extent,
        trends: Vec::new(),
        table: None,
        memory: None,
    };
    // Eq 13's exponents may be far off until something stands in for what it lacks.
    for _ in 0..ROUNDS {
        let at = solved.coefficients.clone();
        let rows = Rows::over(design, &at, None);
        let (_, trends) = growth::grown(&rows, &[], &trend::of_table(None))?;
        (solved, choice.trends) = settle_needed(design, &at, trends, None)?;
    }
    let rows = Rows::over(design, &solved.coefficients, None);
    let with_table = |smoothness: f64| Form {
        table: Some(smoothness),
        ..choice.form()
    };
    let sums = rows.sums(with_table(TYPICAL))?;
    let around = SMOOTHNESS
        .par_iter()
        .filter_map(|&smoothness| Some((sums.judged(with_table(smoothness))?, smoothness)));
    let around = around.min_by(|(a, _), (b, _)| a.error.total_cmp(&b.error));
    if let Some((with, smoothness)) = around
        && with.error < TABULATED * solved.error
    {
        choice.table = Some(smoothness);
        solved = with.clone();
    }
    Some(Fitted { choice, solved })
}

/// The best of a kind of memory beside a correction without one.
pub(super) struct Memorable {
    pub recalled: Recalled,
    trends: Vec<Trend>,
    /// Judged, kN.
    error: f64,
}

/// What may be remembered beside `plain`, of each kind the best, if tables with it fit clearly better than `plain`, and not much
/// worse than those with another kind.
pub(super) fn promising(design: &Design, plain: &Fitted) -> Vec<Memorable> {
    let at = &plain.solved.coefficients;
    let known = &plain.choice.trends;
    let tabulated = Form {
        memory: Some(TYPICAL),
        ..plain.choice.form()
    };
    let fitted = |of: Remembered| {
        let recalled = design.recall(of)?;
        let rows = Rows::over(design, at, Some(&recalled));
        Some((rows.solved(tabulated)?.inside, of))
    };
    let best_of = |candidates: Vec<Remembered>| {
        let fitted = candidates.into_par_iter().filter_map(fitted);
        fitted.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mut kinds = memory::kinds(design);
    kinds.extend(edges::likely_sides(design, at, known).into_iter().flatten());
    let best_of_each = kinds.into_par_iter().filter_map(|kind| {
        let coarse = best_of(kind)?;
        if coarse.0 > WORTHWHILE * plain.solved.inside {
            return None;
        }
        let finer = |best: (f64, Remembered), sought| {
            let near = best_of(memory::around(best.1, sought, design));
            near.filter(|near| near.0 < best.0).unwrap_or(best)
        };
        Some((0..SOUGHT).fold(coarse, finer))
    });
    let mut best_of_each: Vec<(f64, Remembered)> = best_of_each.collect();
    let mut each = best_of_each.iter();
    if let Some(&(with_one, _)) = each.find(|(_, of)| memory::sides(*of, design) == 1) {
        let pays = |error: f64| error < ANOTHER_SIDE * with_one;
        best_of_each.retain(|(error, of)| memory::sides(*of, design) != 2 || pays(*error));
    }
    // Whether how long a test has run may be remembered is decided later.
    let of_motion = best_of_each
        .iter()
        .filter(|(_, of)| !memory::goes_on_with_time(*of));
    let least = of_motion.fold(f64::INFINITY, |least, (error, _)| least.min(*error));
    let comparable = best_of_each.into_par_iter();
    let comparable = comparable.filter(|(error, _)| *error <= COMPARABLE * least);
    let judged = comparable.filter_map(|(_, of)| {
        let recalled = design.recall(of)?;
        let rows = Rows::over(design, at, Some(&recalled));
        let candidates = trend::of_memory(of, None);
        let (error, trends) = growth::grown(&rows, known, &candidates)?;
        let with_table = rows.sums(tabulated)?.judged(tabulated)?.error;
        let (error, trends) = if error < with_table {
            (error, trends)
        } else {
            (with_table, known.clone())
        };
        Some(Memorable {
            recalled,
            trends,
            error,
        })
    });
    judged.collect()
}

/// What is best remembered of these beside `plain`, where that clearly pays.
pub(super) fn remembering(design: &Design, plain: &Fitted, kinds: &[Memorable]) -> Option<Fitted> {
    let at = &plain.solved.coefficients;
    let best = kinds.iter().min_by(|a, b| a.error.total_cmp(&b.error))?;
    let (recalled, of) = (&best.recalled, best.recalled.of);
    let rows = Rows::over(design, at, Some(recalled));
    // What was taken without the memory may have stood in for it.
    let all: Vec<Trend> = trend::of_table(None)
        .into_iter()
        .chain(trend::of_memory(of, None))
        .collect();
    let trends = match growth::grown(&rows, &[], &all) {
        Some((anew, others)) if anew < best.error => others,
        _ => best.trends.clone(),
    };
    // Eq 13's exponents may have stood in for the memory.
    let (mut solved, trends) = settle_needed(design, at, trends, Some(recalled))?;
    let at = solved.coefficients.clone();
    let rows = Rows::over(design, &at, Some(recalled));
    let forms = [plain.choice.table, Some(TYPICAL)].into_iter();
    let forms = forms.flat_map(|table| {
        MEMORY_SMOOTHNESS.map(|memory| Form {
            trends: &trends,
            table,
            memory,
        })
    });
    let has_tables = |form: &Form| (form.table.is_some(), form.memory.is_some());
    let forms: Vec<Form> = forms
        .filter(|form| has_tables(form) != (false, false))
        .collect();
    // However smooth they are, the same tables are of the same sums.
    let alike = forms.chunk_by(|a, b| has_tables(a) == has_tables(b));
    let judged = alike.flat_map(|alike| {
        let sums = rows.sums(alike[0]);
        let judged = alike
            .par_iter()
            .map(|&form| Some((sums.as_ref()?.judged(form)?, form)));
        judged.collect::<Vec<_>>()
    });
    let around = judged.flatten();
    let around = around.min_by(|(a, _), (b, _)| a.error.total_cmp(&b.error));
    let mut form = Form {
        trends: &trends,
        ..Form::NONE
    };
    if let Some((with, tables)) = around
        && with.error < TABULATED * solved.error
    {
        form = tables;
        let again = settle(design, &with.coefficients, form, Some(recalled));
        let again = again.filter(|again| again.error < with.error);
        solved = again.unwrap_or(with);
    }
    let uses_memory = form.memory.is_some()
        || trends
            .iter()
            .any(|trend| trend.cells.iter().any(|(cell, _)| *cell >= CELLS));
    if !uses_memory {
        return None;
    }
    if solved.error > REMEMBERED * plain.solved.error {
        return None;
    }
    let memory = MemoryChoice {
        of,
        range: recalled.range,
        table: form.memory,
    };
    let choice = Choice {
        table: form.table,
        trends: form.trends.to_vec(),
        memory: Some(memory),
        ..plain.choice.clone()
    };
    Some(Fitted { choice, solved })
}

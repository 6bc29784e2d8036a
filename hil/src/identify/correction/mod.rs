//! The correction without a name: fitted to what a law leaves when nothing listed explains it.
//!
//! The tables of [`mesh_damper::effects::correction`] are linear in their cells, so they are fitted by least squares
//! together with eq 13's coefficients, as smooth as keeps the error small where the data were left out. A table without
//! memory comes first; one that remembers takes its place only where that clearly pays.

pub(crate) mod design;
mod gram;
pub(crate) mod memory;

use mesh_damper::effects::correction::{CELLS, MEMORY_CELLS};
use rayon::prelude::*;

use crate::correction::{CorrectionTable, MemoryTable, Remembered};
use crate::model::{Model, ModelError};
use crate::recording::trajectory::Trajectory;
use design::{Coefficients, Design, Recalled};
use gram::{Form, Solved};

/// Penalties of a table's bends that are tried, over what the data say of a cell.
const SMOOTHNESS: [f64; 7] = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0];
/// For the memory's table, over that for the other.
const MEMORY_SMOOTHNESS: [f64; 3] = [0.1, 1.0, 10.0];
/// A table is taken for an error that is at most this part of that without.
const WORTHWHILE: f64 = 0.85;
/// A memory is taken for an error that is at most this part of that without: with so many to choose from, one will look
/// better by chance.
const REMEMBERED: f64 = 0.75;
/// Steps in which eq 13's exponents follow.
const STEPS: usize = 3;
/// Counts of the largest cell.
const FULL: f64 = 32_000.0;

/// `model` with a correction, and with eq 13 fitted anew beside it, where that predicts clearly better than `model` with eq
/// 13 fitted anew alone; `None` where it does not.
///
/// It is fitted to the samples that `included(trajectory, sample)` picks. How smooth it is and what it remembers is chosen
/// by the error in blocks left out of the fit one at a time, each of an amplitude that another block has, and by the error
/// in the fit.
///
/// # Errors
/// A model that the crate refuses.
pub fn fit(
    trajectories: &[Trajectory],
    model: &Model,
    included: impl Fn(usize, usize) -> bool,
) -> Result<Option<Model>, ModelError> {
    let Some(design) = Design::new(trajectories, model, included)? else {
        return Ok(None);
    };
    let law_alone = Form {
        table: false,
        smoothness: 0.0,
        memory_smoothness: 0.0,
    };
    let start = Coefficients::of(model);
    let Some(alone) = settle(&design, &start, law_alone, None) else {
        return Ok(None);
    };
    let plain = SMOOTHNESS.par_iter().filter_map(|&smoothness| {
        let form = Form {
            table: true,
            smoothness,
            memory_smoothness: smoothness,
        };
        Some((form, settle(&design, &start, form, None)?))
    });
    let Some((form, plain)) = plain.min_by(|(_, a), (_, b)| a.error.total_cmp(&b.error)) else {
        return Ok(None);
    };
    let remembering = best_memory(&design, &plain, form);
    let (solved, memory) = match remembering {
        Some((of, recalled, solved)) => (solved, Some((of, recalled))),
        None => (plain, None),
    };
    if solved.error > WORTHWHILE * alone.error {
        return Ok(None);
    }
    Ok(Some(corrected(model, &design, &solved, memory)))
}

/// What is best remembered beside the table `plain`, where that clearly pays.
fn best_memory(
    design: &Design,
    plain: &Solved,
    form: Form,
) -> Option<(Remembered, Recalled, Solved)> {
    let fitted = |of: Remembered| {
        let recalled = design.recall(of)?;
        let error = gram::solve(design, &plain.coefficients, form, Some(&recalled))?.error;
        Some((error, of))
    };
    let best_of = |candidates: Vec<Remembered>| {
        let fitted = candidates.into_par_iter().filter_map(fitted);
        fitted.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let kinds = memory::kinds(design);
    let best_of_each = kinds.into_iter().filter_map(|kind| {
        let (_, coarse) = best_of(kind)?;
        let (_, of) = best_of(memory::around(coarse))?;
        let recalled = design.recall(of)?;
        let judged = gram::judge(design, &plain.coefficients, form, Some(&recalled))?;
        Some((judged.error, of, recalled))
    });
    let (error, of, recalled) = best_of_each.min_by(|a, b| a.0.total_cmp(&b.0))?;
    if error > REMEMBERED * plain.error {
        return None;
    }
    let settled = MEMORY_SMOOTHNESS.par_iter().filter_map(|factor| {
        let form = Form {
            memory_smoothness: factor * form.smoothness,
            ..form
        };
        settle(design, &plain.coefficients, form, Some(&recalled))
    });
    let solved = settled.min_by(|a, b| a.error.total_cmp(&b.error))?;
    (solved.error < plain.error).then_some((of, recalled, solved))
}

/// Solves until eq 13's exponents have settled, and judges that.
fn settle(
    design: &Design,
    start: &Coefficients,
    form: Form,
    recalled: Option<&Recalled>,
) -> Option<Solved> {
    let mut at = start.clone();
    for _ in 1..STEPS {
        at = gram::solve(design, &at, form, recalled)?.coefficients;
    }
    gram::judge(design, &at, form, recalled)
}

/// The model with the tables rounded to what the crate stores.
fn corrected(
    model: &Model,
    design: &Design,
    solved: &Solved,
    memory: Option<(Remembered, Recalled)>,
) -> Model {
    let largest = solved
        .cells
        .iter()
        .fold(0.0_f64, |most, cell| most.max(cell.abs()));
    let unit = (largest / FULL).max(f64::MIN_POSITIVE.sqrt());
    let counts = |cells: &[f64]| -> Vec<i16> {
        cells
            .iter()
            .map(|cell| (cell / unit).round() as i16)
            .collect()
    };
    let (cells, memory_cells) = solved.cells.split_at(CELLS);
    debug_assert!(memory_cells.is_empty() || memory_cells.len() == MEMORY_CELLS);
    Model {
        law: solved.coefficients.nodes(model),
        effects: model.effects.clone(),
        correction: Some(CorrectionTable {
            reach: design.extent.displacement,
            speed: design.extent.speed,
            unit,
            cells: counts(cells),
            memory: memory.map(|(of, recalled)| MemoryTable {
                of,
                range: recalled.range,
                cells: counts(memory_cells),
            }),
        }),
    }
}

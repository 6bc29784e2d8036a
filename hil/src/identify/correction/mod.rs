//! The correction without a name: fitted to what a law leaves when nothing listed explains it.
//!
//! The tables of [`mesh_damper::effects::correction`] are linear in their cells, so they are fitted by least squares
//! together with eq 13's coefficients: along a few trends, and as smooth around them as keeps the error small where the data
//! were left out. A table without memory comes first; one that remembers takes its place only where that clearly pays.

pub(crate) mod design;
mod edges;
mod gram;
mod growth;
mod hat;
pub(crate) mod memory;
mod system;
mod trend;

use mesh_damper::effects::correction::CELLS;
use rayon::prelude::*;

use super::beyond_noise::beyond_noise;
use crate::correction::{CorrectionTable, MemoryTable, Remembered};
use crate::model::{Model, ModelError};
use crate::recording::trajectory::Trajectory;
use design::{Coefficients, Design, Extent, Recalled};
use gram::{Form, Rows, Solved};
use trend::{Trend, Variable};

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
/// A correction is taken for an error beyond the noise that is at most this part of that without.
const WORTHWHILE: f64 = 0.85;
/// A table around the trends, likewise.
const TABULATED: f64 = 0.9;
/// A memory, likewise: with so many to choose from, one will look better by chance.
const REMEMBERED: f64 = 0.75;
/// A kind of memory is judged if the error of its fit is at most so many times the least of those that do not go on with time,
/// and at most [`WORTHWHILE`] of that without.
const COMPARABLE: f64 = 2.0;
/// Something touches on both sides if that fits with at most this part of the error of one.
const ANOTHER_SIDE: f64 = 0.9;
/// Times that what a memory is of is sought ever more finely.
const SOUGHT: u32 = 5;
/// A variable is needed whose absence makes the error more than so many times as large.
const NEEDED: f64 = 1.7;
/// Times that trends are sought, each beside the exponents of eq 13 that those before led to.
const ROUNDS: usize = 2;
/// Most steps in which eq 13's exponents follow,
const STEPS: usize = 8;
/// until none changes by more than this.
const SETTLED: f64 = 2e-3;
/// Counts of the largest cell.
const FULL: f64 = 32_000.0;

/// What a correction is made of, before its cells are solved for.
#[derive(Clone, Debug)]
pub struct Choice {
    extent: Extent,
    trends: Vec<Trend>,
    /// How smooth T is around them, where it is.
    table: Option<f64>,
    memory: Option<MemoryChoice>,
}

#[derive(Clone, Copy, Debug)]
struct MemoryChoice {
    of: Remembered,
    range: [f64; 2],
    /// How smooth U is around its trends, where it is.
    table: Option<f64>,
}

impl Choice {
    /// Whether it remembers how long a test has run, whatever the motion was.
    pub fn goes_on_with_time(&self) -> bool {
        self.memory
            .is_some_and(|memory| memory::goes_on_with_time(memory.of))
    }

    fn form(&self) -> Form<'_> {
        Form {
            trends: &self.trends,
            table: self.table,
            memory: self.memory.and_then(|memory| memory.table),
        }
    }

    /// What is remembered at each row of `design`.
    fn recalled(&self, design: &Design) -> Option<Recalled> {
        let memory = self.memory?;
        design.recall_within(memory.of, memory.range)
    }
}

/// A choice and what it led to.
#[derive(Clone)]
struct Fitted {
    choice: Choice,
    solved: Solved,
}

/// `model` with a correction, and with eq 13 fitted anew beside it, where that predicts clearly better than `model` with eq
/// 13 fitted anew alone; `None` where it does not.
///
/// It is fitted to the samples that `included(trajectory, sample)` picks. Which trends it follows, how smooth it is around
/// them and what it remembers is chosen by the error in blocks left out of the fit one at a time, each of an amplitude that
/// another block has, and by the error in the fit. How long a test has run it remembers only if `is_seen(with, without)` of the
/// model that does and of the best that does not. The choice is returned too.
///
/// # Errors
/// A model that the crate refuses.
pub fn fit(
    trajectories: &[Trajectory],
    model: &Model,
    included: impl Fn(usize, usize) -> bool,
    is_seen: impl Fn(&Model, &Model) -> Result<bool, ModelError>,
) -> Result<Option<(Model, Choice)>, ModelError> {
    let Some(design) = Design::new(trajectories, model, None, included)? else {
        return Ok(None);
    };
    let start = Coefficients::of(model);
    let Some(alone) = settle(&design, &start, Form::NONE, None) else {
        return Ok(None);
    };
    let Some(plain) = momentary(&design, &alone) else {
        return Ok(None);
    };
    // What comes to the noise without a memory can't come to much less with one.
    let may_remember = REMEMBERED * plain.solved.error > beyond_noise(0.0, design.noise());
    let mut kinds = if may_remember {
        promising(&design, &plain)
    } else {
        Vec::new()
    };
    let best_of = |kinds: &[Memorable]| {
        let remembered = remembering(&design, &plain, kinds);
        let Fitted { choice, solved } = remembered.unwrap_or_else(|| plain.clone());
        let is_worthwhile = solved.error <= WORTHWHILE * alone.error;
        is_worthwhile.then(|| (corrected(model, &solved, &choice), choice))
    };
    let found = best_of(&kinds);
    let Some((with, choice)) = &found else {
        return Ok(None);
    };
    if !choice.goes_on_with_time() {
        return Ok(found);
    }
    kinds.retain(|kind| !memory::goes_on_with_time(kind.recalled.of));
    let of_motion = best_of(&kinds);
    let without = of_motion.as_ref().map_or(model, |(without, _)| without);
    Ok(if is_seen(with, without)? {
        found
    } else {
        of_motion
    })
}

/// `model` with the correction of a choice made before, fitted to other samples; without one where they say nothing.
///
/// # Errors
/// A model that the crate refuses.
pub fn refit(
    choice: &Choice,
    trajectories: &[Trajectory],
    model: &Model,
    included: impl Fn(usize, usize) -> bool,
) -> Result<Model, ModelError> {
    let design = Design::new(trajectories, model, Some(choice.extent), included)?;
    let solved = design.and_then(|design| {
        let recalled = choice.recalled(&design);
        let start = Coefficients::of(model);
        settled(&design, &start, choice.form(), recalled.as_ref())
    });
    Ok(solved.map_or_else(|| model.clone(), |solved| corrected(model, &solved, choice)))
}

/// What the correction of a choice depends on, by the names of `trace.json`: each variable without which the samples that
/// `included` picks are explained clearly worse, and what is remembered.
///
/// # Errors
/// A model that the crate refuses.
pub fn depends_on(
    choice: &Choice,
    trajectories: &[Trajectory],
    model: &Model,
    included: impl Fn(usize, usize) -> bool,
) -> Result<Vec<&'static str>, ModelError> {
    let mut names = Vec::new();
    let design = Design::new(trajectories, model, Some(choice.extent), included)?;
    if let Some(design) = &design {
        let recalled = choice.recalled(design);
        let at = Coefficients::of(model);
        let rows = Rows::over(design, &at, recalled.as_ref());
        let of = recalled.as_ref().map(|recalled| recalled.of);
        let judged = |form: Form| Some(rows.sums(form)?.judged(form)?.error);
        let along_trends = |without: Option<Variable>| {
            let mut trends = trend::of_table(without);
            trends.extend(of.map_or(Vec::new(), |of| trend::of_memory(of, without)));
            Some(growth::grown(&rows, &[], &trends)?.0)
        };
        let least = |errors: [Option<f64>; 2]| {
            let errors = errors.into_iter().flatten();
            errors.fold(f64::INFINITY, f64::min)
        };
        let all = least([along_trends(None), judged(choice.form())]);
        for (name, variable) in [
            ("displacement", Variable::Displacement),
            ("velocity", Variable::Velocity),
        ] {
            let hats = hat::hats_without(variable, of);
            let tables = Form {
                trends: &hats,
                ..Form::NONE
            };
            if least([along_trends(Some(variable)), judged(tables)]) > NEEDED * all {
                names.push(name);
            }
        }
    }
    let of = choice.memory.map(|memory| memory.of.is_of());
    names.extend(of.filter(|name| !names.contains(name)));
    Ok(names)
}

/// The best correction without memory.
fn momentary(design: &Design, alone: &Solved) -> Option<Fitted> {
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
struct Memorable {
    recalled: Recalled,
    trends: Vec<Trend>,
    /// Judged, kN.
    error: f64,
}

/// What may be remembered beside `plain`, of each kind the best, if tables with it fit clearly better than `plain`, and not much
/// worse than those with another kind.
fn promising(design: &Design, plain: &Fitted) -> Vec<Memorable> {
    let at = &plain.solved.coefficients;
    let known = &plain.choice.trends;
    let tabulated = Form {
        memory: Some(TYPICAL),
        ..plain.choice.form()
    };
    let fitted = |of: Remembered| {
        let recalled = design.recall(of)?;
        let rows = Rows::over(design, at, Some(&recalled));
        Some((rows.sums(tabulated)?.solved(tabulated)?.inside, of))
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
fn remembering(design: &Design, plain: &Fitted, kinds: &[Memorable]) -> Option<Fitted> {
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

/// Settles beside these trends, and beside fewer where those not needed stood in for eq 13's exponents.
fn settle_needed(
    design: &Design,
    start: &Coefficients,
    mut trends: Vec<Trend>,
    recalled: Option<&Recalled>,
) -> Option<(Solved, Vec<Trend>)> {
    let settled_with = |start: &Coefficients, trends: &[Trend]| {
        let form = Form {
            trends,
            ..Form::NONE
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
            Some((without, fewer)) if growth::WORTHWHILE * without.error < solved.error => {
                (solved, trends) = (without, fewer);
            }
            _ => break,
        }
    }
    Some((solved, trends))
}

/// Solves until eq 13's exponents have settled, and judges that.
fn settle(
    design: &Design,
    start: &Coefficients,
    form: Form,
    recalled: Option<&Recalled>,
) -> Option<Solved> {
    let at = settled(design, start, form, recalled)?.coefficients;
    Rows::over(design, &at, recalled).sums(form)?.judged(form)
}

/// Solves until eq 13's exponents have settled.
fn settled(
    design: &Design,
    start: &Coefficients,
    form: Form,
    recalled: Option<&Recalled>,
) -> Option<Solved> {
    let mut at = start.clone();
    for step in 1.. {
        let solved = Rows::over(design, &at, recalled).sums(form)?.solved(form)?;
        let changes = at.0.iter().zip(&solved.coefficients.0);
        let change = changes.fold(0.0_f64, |most, (a, b)| most.max((a[3] - b[3]).abs()));
        if change < SETTLED || step == STEPS {
            return Some(solved);
        }
        at = solved.coefficients;
    }
    None
}

/// The model with the tables rounded to what the crate stores.
fn corrected(model: &Model, solved: &Solved, choice: &Choice) -> Model {
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
    Model {
        law: solved.coefficients.nodes(model),
        effects: model.effects.clone(),
        correction: Some(CorrectionTable {
            reach: choice.extent.displacement,
            speed: choice.extent.speed,
            unit,
            cells: counts(cells),
            memory: choice.memory.map(|memory| MemoryTable {
                of: memory.of,
                range: memory.range,
                cells: counts(memory_cells),
            }),
        }),
    }
}

//! On what depends what a law leaves: tests on the residual itself, whatever may have caused it.
//!
//! Eq 13 is fitted anew together with tables over displacement, velocity and what the motion was before, each time without
//! one of them. The residual depends on what the tables cannot do without on cycles that they were not fitted to.

use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;

use crate::correction::Remembered;
use crate::identify::correction::design::{Coefficients, Design, Row};
use crate::identify::correction::memory::kinds;
use crate::model::{Model, ModelError};
use crate::recording::trajectory::Trajectory;
use mesh_damper::effects::correction::{CELLS, DISPLACEMENTS, MEMORIES, MEMORY_CELLS, SPEEDS};

/// The least part of what eq 13 leaves above the noise that a dependence has to explain.
const LEAST_SHARE: f64 = 0.1;
/// How many deviations the gain per cycle has to stand from zero: of noise one in 740 passes.
const DEVIATIONS: f64 = 3.0;
/// Two memories that leave errors within this part of each other do as well.
const AS_GOOD: f64 = 0.03;
/// Amplitudes or frequencies that differ by less than this part are one.
const SAME: f64 = 0.06;
/// Added to the diagonal of the scaled normal equations: cells without data stay small.
const RIDGE: f64 = 1e-6;

/// Something that the residual depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dependence {
    /// `displacement`, `velocity`, `history`, `time`, `cycle`, `temperature`, `frequency` or `amplitude`.
    pub on: &'static str,
    /// The part of the residual's variance above the noise that is explained with it and not without.
    pub share: f64,
    /// How many deviations the mean gain per cycle stands from zero.
    pub deviations: f64,
}

/// On what the force depends beyond `model`, over the samples that `included(trajectory, sample)` picks.
///
/// # Errors
/// A model that the crate refuses.
pub fn dependence(
    trajectories: &[Trajectory],
    model: &Model,
    included: impl Fn(usize, usize) -> bool,
) -> Result<Vec<Dependence>, ModelError> {
    let Some(design) = Design::new(trajectories, model, included)? else {
        return Ok(Vec::new());
    };
    let tests = Tests::new(&design, Coefficients::of(model));
    Ok(tests.run())
}

/// Columns that a fit has beside eq 13's: entries at every row, and how many columns there are.
struct Columns {
    width: usize,
    rows: Vec<Vec<(usize, f64)>>,
}

struct Tests<'d, 'a> {
    design: &'d Design<'a>,
    at: Coefficients,
    /// The cycle of each row, counted over all trajectories.
    cycle: Vec<usize>,
    cycles: usize,
}

/// A memory with the cells of its table at every row.
struct Memory {
    of: Remembered,
    cells: Vec<[(usize, f64); 4]>,
    /// Mean squared errors by cycle.
    errors: Vec<f64>,
}

impl<'d, 'a> Tests<'d, 'a> {
    fn new(design: &'d Design<'a>, at: Coefficients) -> Self {
        let mut last = None;
        let mut cycles = 0;
        let cycle = design
            .rows
            .iter()
            .map(|row| {
                let (which, sample) = row.origin;
                let now = (which, design.trajectories[which].cycles[sample] as usize);
                if last != Some(now) {
                    last = Some(now);
                    cycles += 1;
                }
                cycles - 1
            })
            .collect();
        Self {
            design,
            at,
            cycle,
            cycles,
        }
    }

    fn run(&self) -> Vec<Dependence> {
        let law = self.errors(&[]);
        let left = mean(&law) - self.design.noise;
        if left <= 0.0 {
            return Vec::new();
        }
        let depends = |on: &'static str, with: &[f64], without: &[f64]| {
            let share = (mean(without) - mean(with)) / left;
            let deviations = deviations(with, without);
            (share > LEAST_SHARE && deviations > DEVIATIONS).then_some(Dependence {
                on,
                share,
                deviations,
            })
        };
        let table = self.table(|cell| cell, CELLS);
        let without_memory = self.errors(&[&table]);
        let settles = depends(
            "time",
            &self.errors(&[&table, &self.trend()]),
            &without_memory,
        )
        .is_some();
        let memories = self.memories(&table, settles);
        let memory = memories
            .iter()
            .min_by(|a, b| mean(&a.errors).total_cmp(&mean(&b.errors)))
            .filter(|memory| depends("history", &memory.errors, &without_memory).is_some());

        let mut found: Vec<Dependence> = Vec::new();
        let full = memory.map_or(&without_memory, |memory| &memory.errors);
        let with = |table: Columns, memory: Option<Columns>| match memory {
            Some(memory) => self.errors(&[&table, &memory]),
            None => self.errors(&[&table]),
        };
        let along = |cell: usize| cell / DISPLACEMENTS;
        let without_displacement = with(
            self.table(along, 2 * SPEEDS),
            memory.map(|memory| self.remembered(memory, along, 2 * MEMORIES)),
        );
        found.extend(depends("displacement", full, &without_displacement));
        let without_velocity = with(
            self.table(|cell| cell % DISPLACEMENTS, DISPLACEMENTS),
            memory.map(|memory| {
                let undirected = |cell| cell % (MEMORIES * DISPLACEMENTS);
                self.remembered(memory, undirected, MEMORIES * DISPLACEMENTS)
            }),
        );
        found.extend(depends("velocity", full, &without_velocity));
        if let Some(memory) = memory {
            let near =
                |other: &&Memory| mean(&other.errors) < (1.0 + AS_GOOD) * mean(&memory.errors);
            for on in memories
                .iter()
                .filter(near)
                .flat_map(|other| names(other.of))
            {
                let known = found.iter().any(|known| known.on == *on);
                if !known {
                    found.extend(depends(on, &memory.errors, &without_memory));
                }
            }
        }
        let grouped = |on: &'static str, columns: Option<Columns>| {
            let errors = self.errors(&[&table, &columns?]);
            depends(on, &errors, &without_memory)
        };
        found.extend(grouped("frequency", self.by_frequency()));
        found.extend(grouped("amplitude", self.by_amplitude()));
        found.extend(grouped("temperature", self.by_temperature()));
        found
    }

    /// The table over displacement and velocity, its cells joined by `join` into `width`.
    fn table(&self, join: impl Fn(usize) -> usize, width: usize) -> Columns {
        let rows = self.design.rows.iter().map(|row| joined(&row.cells, &join));
        Columns {
            width,
            rows: rows.collect(),
        }
    }

    fn remembered(&self, memory: &Memory, join: impl Fn(usize) -> usize, width: usize) -> Columns {
        let rows = memory.cells.iter().map(|cells| joined(cells, &join));
        Columns {
            width,
            rows: rows.collect(),
        }
    }

    /// Every kind of memory at its best beside `table`. What only ages is none where nothing settles within a block: it
    /// would tell blocks from each other by their order.
    fn memories(&self, table: &Columns, settles: bool) -> Vec<Memory> {
        let kinds = kinds(self.design);
        let of_kind = |kind: Vec<Remembered>| {
            let tried = kind.into_iter().filter_map(|of| {
                let cells = self.design.recall(of)?.cells;
                let mut memory = Memory {
                    of,
                    cells,
                    errors: Vec::new(),
                };
                let columns = self.remembered(&memory, |cell| cell, MEMORY_CELLS);
                memory.errors = self.errors(&[table, &columns]);
                Some(memory)
            });
            tried.min_by(|a, b| mean(&a.errors).total_cmp(&mean(&b.errors)))
        };
        kinds
            .into_par_iter()
            .filter(|kind| settles || !kind.iter().any(|of| ages(*of)))
            .filter_map(of_kind)
            .collect()
    }

    /// A force, a stiffness and a friction that change in proportion to time, block by block.
    fn trend(&self) -> Columns {
        let (count, design) = (self.design.rows.len(), self.design);
        let mut ends = vec![(count, 0); design.blocks];
        for (index, row) in design.rows.iter().enumerate() {
            let (first, last) = &mut ends[row.block];
            *first = index.min(*first);
            *last = index;
        }
        let rows = design.rows.iter().enumerate().map(|(index, row)| {
            let (first, last) = ends[row.block];
            let time = (index - first) as f64 / (last - first).max(1) as f64 - 0.5;
            let moment = [
                1.0,
                row.displacement / design.extent.displacement,
                row.direction,
            ];
            let entries = moment.iter().enumerate();
            entries
                .map(|(i, value)| (3 * row.block + i, time * value))
                .collect()
        });
        Columns {
            width: 3 * design.blocks,
            rows: rows.collect(),
        }
    }

    /// A stiffness and a friction for each frequency; `None` where there is only one.
    fn by_frequency(&self) -> Option<Columns> {
        self.by_group(
            |block| block.1,
            |row, reach| vec![row.displacement / reach, row.direction],
        )
    }

    /// What eq 13 does not make of amplitude: an offset, even stiffness, and both with friction.
    fn by_amplitude(&self) -> Option<Columns> {
        self.by_group(
            |block| block.0,
            |row, reach| {
                let y = row.displacement / reach;
                vec![
                    1.0,
                    y * y,
                    y * y.abs(),
                    y.abs() * row.direction,
                    y * row.direction,
                ]
            },
        )
    }

    /// `features` for each group of blocks whose `key` of (amplitude, frequency) is the same.
    fn by_group(
        &self,
        key: impl Fn((f64, f64)) -> f64,
        features: impl Fn(&Row, f64) -> Vec<f64>,
    ) -> Option<Columns> {
        let blocks = self.design.trajectories.iter().flat_map(|t| &t.blocks);
        let mut groups: Vec<f64> = Vec::new();
        let of_block: Vec<usize> = blocks
            .map(|block| {
                let key = key((block.amplitude, block.frequency));
                let known = groups
                    .iter()
                    .position(|group| (group - key).abs() < SAME * key);
                known.unwrap_or_else(|| {
                    groups.push(key);
                    groups.len() - 1
                })
            })
            .collect();
        if groups.len() < 2 {
            return None;
        }
        let reach = self.design.extent.displacement;
        let mut width = 0;
        let rows = self.design.rows.iter().map(|row| {
            let values = features(row, reach);
            width = groups.len() * values.len();
            let first = of_block[row.block] * values.len();
            values
                .into_iter()
                .enumerate()
                .map(|(i, value)| (first + i, value))
                .collect()
        });
        let rows = rows.collect();
        Some(Columns { width, rows })
    }

    /// A force, a stiffness and a friction in proportion to temperature; `None` where it was not measured or stays.
    fn by_temperature(&self) -> Option<Columns> {
        let trajectories = self.design.trajectories;
        let rows = &self.design.rows;
        let temperature = |row: &Row| trajectories[row.origin.0].temperature_at(row.origin.1);
        let (low, high) = rows
            .iter()
            .map(temperature)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
                (low.min(t), high.max(t))
            });
        if trajectories.iter().any(|t| t.temperature.is_none()) || high - low < 1.0 {
            return None;
        }
        let reach = self.design.extent.displacement;
        let entries = |row: &Row| {
            let warm = (temperature(row) - low) / (high - low);
            let moment = [1.0, row.displacement / reach, row.direction];
            moment
                .iter()
                .enumerate()
                .map(|(i, value)| (i, warm * value))
                .collect()
        };
        Some(Columns {
            width: 3,
            rows: rows.iter().map(entries).collect(),
        })
    }

    /// Mean squared error in every cycle, kN², of eq 13 and `columns` fitted to every other cycle.
    fn errors(&self, columns: &[&Columns]) -> Vec<f64> {
        let design = self.design;
        let law = if design.fits_law {
            4 * self.at.0.len()
        } else {
            0
        };
        let width = law + columns.iter().map(|columns| columns.width).sum::<usize>();
        let mut entries: Vec<Vec<(usize, f64)>> = Vec::with_capacity(design.rows.len());
        let mut left = Vec::with_capacity(design.rows.len());
        for (index, row) in design.rows.iter().enumerate() {
            let mut own = Vec::new();
            let mut force = row.force;
            if design.fits_law {
                force -= row.law_force(&self.at);
                row.law_derivatives(&self.at, &mut own);
            }
            let mut first = law;
            for columns in columns {
                own.extend(
                    columns.rows[index]
                        .iter()
                        .map(|&(i, value)| (first + i, value)),
                );
                first += columns.width;
            }
            entries.push(own);
            left.push(force);
        }
        let mut squares = vec![0.0; self.cycles];
        let mut counts = vec![0.0; self.cycles];
        for parity in [0, 1] {
            let is_fitted = |index: usize| self.cycle[index] % 2 != parity;
            let x = least_squares(width, &entries, &left, is_fitted);
            for (index, own) in entries.iter().enumerate() {
                if !is_fitted(index) {
                    let force: f64 = own.iter().map(|&(i, value)| value * x[i]).sum();
                    squares[self.cycle[index]] += (left[index] - force).powi(2);
                    counts[self.cycle[index]] += 1.0;
                }
            }
        }
        squares
            .iter()
            .zip(&counts)
            .map(|(square, count)| square / count)
            .collect()
    }
}

/// The cells of a row when those that `join` gives one number are one.
fn joined(cells: &[(usize, f64); 4], join: impl Fn(usize) -> usize) -> Vec<(usize, f64)> {
    let mut entries: Vec<(usize, f64)> = Vec::with_capacity(4);
    for &(cell, weight) in cells {
        match entries.iter_mut().find(|(known, _)| *known == join(cell)) {
            Some((_, sum)) => *sum += weight,
            None => entries.push((join(cell), weight)),
        }
    }
    entries
}

/// What a memory's name stands for.
fn names(of: Remembered) -> &'static [&'static str] {
    match of {
        Remembered::Slip { .. } | Remembered::Lag { .. } | Remembered::Largest => {
            &["displacement", "history"]
        }
        Remembered::Travel { .. } => &["velocity", "history"],
        Remembered::Age { .. } => &["time"],
        Remembered::Cycles { .. } => &["cycle"],
    }
}

fn ages(of: Remembered) -> bool {
    matches!(of, Remembered::Age { .. } | Remembered::Cycles { .. })
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// How many deviations of its mean the relative gain (a − b)/(a + b) of a cycle stands from zero. It lies in −1…1, so that no
/// cycle decides alone; cycles err independently, samples within one do not.
fn deviations(with: &[f64], without: &[f64]) -> f64 {
    let gains: Vec<f64> = with
        .iter()
        .zip(without)
        .map(|(with, without)| (without - with) / (without + with).max(f64::MIN_POSITIVE))
        .collect();
    let mean = mean(&gains);
    let count = gains.len() as f64;
    let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0);
    mean / (variance / count).sqrt().max(f64::MIN_POSITIVE)
}

/// The unknowns that leave the least squares over the rows that `is_fitted` picks; 0 where nothing is known of them.
fn least_squares(
    width: usize,
    entries: &[Vec<(usize, f64)>],
    left: &[f64],
    is_fitted: impl Fn(usize) -> bool,
) -> DVector<f64> {
    let mut gram = DMatrix::<f64>::zeros(width, width);
    let mut right = DVector::<f64>::zeros(width);
    for (index, own) in entries.iter().enumerate() {
        if !is_fitted(index) {
            continue;
        }
        for (place, &(i, a)) in own.iter().enumerate() {
            right[i] += a * left[index];
            for &(j, b) in &own[..=place] {
                gram[(i.max(j), i.min(j))] += a * b;
            }
        }
    }
    let scale = gram
        .diagonal()
        .map(|d| if d > 0.0 { d.sqrt().recip() } else { 0.0 });
    for column in 0..width {
        for row in column..width {
            gram[(row, column)] *= scale[row] * scale[column];
        }
        gram[(column, column)] += RIDGE;
    }
    let right = right.component_mul(&scale);
    match Cholesky::new(gram) {
        Some(factor) => factor.solve(&right).component_mul(&scale),
        None => DVector::zeros(width),
    }
}

//! The least squares of eq 13 and the tables, with each block left out in turn.

use mesh_damper::effects::correction::{CELLS, MEMORY_CELLS};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::design::{Coefficients, Design, Recalled};
use super::system::System;
use super::trend::{Trend, hats_of_memory, hats_of_table};
use crate::correction::Remembered;
use crate::identify::beyond_noise::beyond_noise;

/// What a trend has beyond others is nothing where it is less than this part of it, in squares.
const ALIKE: f64 = 1e-9;
/// The largest change of α in one step.
const LARGEST_STEP: f64 = 0.1;

/// What is fitted beside eq 13: trends, and tables around them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form<'t> {
    pub trends: &'t [Trend],
    /// What a bend of T costs, over what the data say of a cell; `None` without the table.
    pub table: Option<f64>,
    /// The same of U.
    pub memory: Option<f64>,
}

impl Form<'_> {
    /// Eq 13 and nothing else.
    pub const NONE: Self = Form {
        trends: &[],
        table: None,
        memory: None,
    };
}

/// What was solved for.
#[derive(Clone)]
pub(super) struct Solved {
    pub coefficients: Coefficients,
    /// The cells of T, then those of U, kN.
    pub cells: Vec<f64>,
    /// In the fit, beyond the noise, kN.
    pub inside: f64,
    /// The same, or [judged](Sums::judged).
    pub error: f64,
}

/// Where each unknown stands: eq 13's, the trends' factors, the cells of T, those of U.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    pub law: usize,
    pub trends: usize,
    pub table: usize,
    pub memory: usize,
    /// What U is over, where there is one.
    pub of: Option<Remembered>,
}

impl Layout {
    pub fn width(&self) -> usize {
        self.law + self.trends + self.table + self.memory
    }
}

/// Sums over the rows of one block.
pub(super) struct Block {
    pub gram: DMatrix<f64>,
    right: DVector<f64>,
    energy: f64,
    /// Variance of the force's noise, summed.
    noise: f64,
    pub count: f64,
}

/// The sums of every block over eq 13 and over all cells, at given coefficients.
pub(super) struct Raw<'d> {
    design: &'d Design<'d>,
    at: &'d Coefficients,
    law: usize,
    of: Option<Remembered>,
    blocks: Vec<Block>,
}

impl<'d> Raw<'d> {
    /// Over what eq 13 with `at` leaves. The unknowns of eq 13 are changes from `at`.
    pub fn over(design: &'d Design<'d>, at: &'d Coefficients, recalled: Option<&Recalled>) -> Self {
        Self::gather(design, at, recalled, design.blocks)
    }

    /// The same with all blocks as one, of which none can be left out.
    pub fn of_whole(
        design: &'d Design<'d>,
        at: &'d Coefficients,
        recalled: Option<&Recalled>,
    ) -> Self {
        Self::gather(design, at, recalled, 1)
    }

    fn gather(
        design: &'d Design<'d>,
        at: &'d Coefficients,
        recalled: Option<&Recalled>,
        blocks: usize,
    ) -> Self {
        let law = if design.fits_law { 4 * at.0.len() } else { 0 };
        let memory = recalled.map_or(0, |_| MEMORY_CELLS);
        let mut blocks: Vec<Block> = (0..blocks)
            .map(|_| Block::new(law + CELLS + memory))
            .collect();
        let mut entries: Vec<(usize, f64)> = Vec::new();
        for (index, row) in design.rows.iter().enumerate() {
            entries.clear();
            let mut left = row.force;
            if law > 0 {
                left -= row.law_force(at);
                row.law_derivatives(at, &mut entries);
            }
            entries.extend(row.cells().map(|(cell, weight)| (law + cell, weight)));
            if let Some(recalled) = recalled {
                let cells = recalled.cells_of(index);
                entries.extend(cells.map(|(cell, weight)| (law + CELLS + cell, weight)));
            }
            add_up(&mut entries);
            let last = blocks.len() - 1;
            let block = &mut blocks[row.block.min(last)];
            for (place, &(i, a)) in entries.iter().enumerate() {
                block.right[i] += a * left;
                for &(j, b) in &entries[..=place] {
                    block.gram[(i.max(j), i.min(j))] += a * b;
                }
            }
            block.energy += left * left;
            block.noise += design.noise_of(row);
            block.count += 1.0;
        }
        for block in &mut blocks {
            block.gram.fill_upper_triangle_with_lower_triangle();
        }
        Self {
            design,
            at,
            law,
            of: recalled.map(|recalled| recalled.of),
            blocks,
        }
    }

    /// The sums over eq 13 and what `form` has beside it, however smooth; `None` without samples.
    pub fn sums<'t>(&self, form: Form<'t>) -> Option<Sums<'_, 't>> {
        let table = form.table.map_or(Vec::new(), |_| hats_of_table());
        let memory = form.memory.and(self.of).map_or(Vec::new(), hats_of_memory);
        let layout = Layout {
            law: self.law,
            trends: form.trends.len(),
            table: table.len(),
            memory: memory.len(),
            of: self.of,
        };
        let hats: Vec<Trend> = table.into_iter().chain(memory).collect();
        let blocks = self
            .blocks
            .par_iter()
            .map(|block| block.mapped(self.law, form.trends, &hats));
        let blocks = blocks.collect();
        Sums::of(self.design, self.at, layout, form.trends, hats, blocks)
    }
}

/// Leaves one entry for each place.
fn add_up(entries: &mut Vec<(usize, f64)>) {
    entries.sort_unstable_by_key(|(place, _)| *place);
    entries.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
}

/// The normal equations but for the penalties, which a [`Form`] adds.
pub(super) struct Sums<'d, 't> {
    design: &'d Design<'d>,
    at: &'d Coefficients,
    layout: Layout,
    trends: &'t [Trend],
    /// What the tables are made of.
    hats: Vec<Trend>,
    blocks: Vec<Block>,
    total: Block,
}

impl<'d, 't> Sums<'d, 't> {
    fn of(
        design: &'d Design<'d>,
        at: &'d Coefficients,
        layout: Layout,
        trends: &'t [Trend],
        hats: Vec<Trend>,
        blocks: Vec<Block>,
    ) -> Option<Self> {
        let mut total = Block::new(layout.width());
        for block in &blocks {
            total.add(block);
        }
        (total.count > 0.0).then_some(Self {
            design,
            at,
            layout,
            trends,
            hats,
            blocks,
            total,
        })
    }

    /// The judged error with some of the trends, without tables.
    pub fn error_with(&self, trends: &[usize]) -> Option<f64> {
        let unknowns = self.unknowns_of(trends);
        let blocks = self.blocks.iter().map(|block| block.only(&unknowns));
        let layout = self.layout_of(trends);
        let sums = Sums::of(
            self.design,
            self.at,
            layout,
            &[],
            Vec::new(),
            blocks.collect(),
        )?;
        let system = sums.system(Form::NONE);
        sums.judged_error(&system, &sums.unknowns(&system)?)
    }

    /// What each trend would save of the squared error in the fit beside some of them, without tables.
    pub fn savings_beside(&self, trends: &[usize]) -> Option<Vec<f64>> {
        let known = self.unknowns_of(trends);
        let own = self.total.only(&known);
        let layout = self.layout_of(trends);
        let system = System::new(self.design, self.at, &layout, Form::NONE, &own);
        let solver = system.solver(own.gram)?;
        let solution = solver.solve(own.right);
        let saving = |trend: usize| {
            let place = self.layout.law + trend;
            let shared = self.total.gram.column(place).select_rows(&known);
            let right = self.total.right[place] - shared.dot(&solution);
            let left = self.total.gram[(place, place)];
            let power = left - shared.dot(&solver.solve_bare(shared.clone()));
            if power > ALIKE * left {
                right * right / power
            } else {
                0.0
            }
        };
        Some((0..self.layout.trends).map(saving).collect())
    }

    fn unknowns_of(&self, trends: &[usize]) -> Vec<usize> {
        let law = self.layout.law;
        (0..law).chain(trends.iter().map(|t| law + t)).collect()
    }

    fn layout_of(&self, trends: &[usize]) -> Layout {
        Layout {
            trends: trends.len(),
            table: 0,
            memory: 0,
            ..self.layout
        }
    }

    /// One step from the coefficients, with the error in the fit alone; `None` where the equations cannot be solved.
    pub fn solved(&self, form: Form) -> Option<Solved> {
        Some(self.solution(&self.unknowns(&self.system(form))?))
    }

    /// The same with the geometric mean of the error in the fit and of the errors in the blocks left out, one at a time, each
    /// beyond the noise.
    pub fn judged(&self, form: Form) -> Option<Solved> {
        let system = self.system(form);
        let unknowns = self.unknowns(&system)?;
        Some(Solved {
            error: self.judged_error(&system, &unknowns)?,
            ..self.solution(&unknowns)
        })
    }

    fn system(&self, form: Form) -> System {
        System::new(self.design, self.at, &self.layout, form, &self.total)
    }

    fn judged_error(&self, system: &System, unknowns: &DVector<f64>) -> Option<f64> {
        let mut outside = 0.0;
        for &left_out in &self.design.left_out {
            let block = &self.blocks[left_out];
            let (gram, right) = (
                &self.total.gram - &block.gram,
                &self.total.right - &block.right,
            );
            outside += block.beyond_noise(&system.solve(gram, right)?).ln();
        }
        let outside = outside / self.design.left_out.len() as f64;
        let inside = self.total.beyond_noise(unknowns).ln();
        Some((0.5 * (inside + outside)).exp())
    }

    fn unknowns(&self, system: &System) -> Option<DVector<f64>> {
        let solve =
            |system: &System| system.solve(self.total.gram.clone(), self.total.right.clone());
        let (law, at) = (self.layout.law, &self.at.0);
        let mut x = solve(system)?;
        // Damping that feeds energy in is none.
        let negative = |x: &DVector<f64>| {
            let mut nodes = 0..law / 4;
            nodes.find(|&node| at[node][2] + x[4 * node + 2] < -1e-12 * at[node][2])
        };
        let mut system = system.clone();
        for _ in 0..law / 4 {
            let Some(node) = negative(&x) else { break };
            system.pin(4 * node + 2, -at[node][2]);
            x = solve(&system)?;
        }
        Some(x)
    }

    fn solution(&self, x: &DVector<f64>) -> Solved {
        let law = self.layout.law;
        let moved = |(node, &[k1, k3, c, alpha]): (usize, &[f64; 4])| {
            if law == 0 {
                return [k1, k3, c, alpha];
            }
            let change = |i: usize| x[4 * node + i];
            let step = change(3).clamp(-LARGEST_STEP, LARGEST_STEP);
            [
                k1 + change(0),
                k3 + change(1),
                (c + change(2)).max(0.0),
                (alpha + step).clamp(0.0, 1.0),
            ]
        };
        let mut cells = vec![0.0; CELLS + MEMORY_CELLS];
        let columns = self.trends.iter().chain(&self.hats);
        for (column, factor) in columns.zip(x.iter().skip(law)) {
            for &(cell, value) in &column.0 {
                cells[cell] += factor * value;
            }
        }
        let inside = self.total.beyond_noise(x);
        Solved {
            coefficients: Coefficients(self.at.0.iter().enumerate().map(moved).collect()),
            cells,
            inside,
            error: inside,
        }
    }
}

impl Block {
    fn new(width: usize) -> Self {
        Self {
            gram: DMatrix::zeros(width, width),
            right: DVector::zeros(width),
            energy: 0.0,
            noise: 0.0,
            count: 0.0,
        }
    }

    fn add(&mut self, other: &Self) {
        self.gram += &other.gram;
        self.right += &other.right;
        self.energy += other.energy;
        self.noise += other.noise;
        self.count += other.count;
    }

    /// The sums over the unknowns of eq 13 and over the factors of `trends`, which fill most cells, and of `hats`, which fill
    /// few.
    fn mapped(&self, law: usize, trends: &[Trend], hats: &[Trend]) -> Self {
        let (first_hat, width) = (law + trends.len(), law + trends.len() + hats.len());
        let mut mapped = Self {
            energy: self.energy,
            noise: self.noise,
            count: self.count,
            ..Self::new(width)
        };
        let own = self.gram.view((0, 0), (law, law));
        mapped.gram.view_mut((0, 0), (law, law)).copy_from(&own);
        mapped
            .right
            .rows_mut(0, law)
            .copy_from(&self.right.rows(0, law));
        let mut dense = DMatrix::zeros(self.gram.nrows() - law, trends.len());
        for (column, trend) in trends.iter().enumerate() {
            for &(cell, value) in &trend.0 {
                dense[(cell, column)] = value;
            }
        }
        let products = self.gram.columns_range(law..) * &dense;
        let size = (trends.len(), trends.len());
        // Several times as fast as `tr_mul`.
        let squares = dense.transpose() * products.rows_range(law..);
        mapped.gram.view_mut((law, law), size).copy_from(&squares);
        let right = dense.tr_mul(&self.right.rows_range(law..));
        mapped.right.rows_mut(law, trends.len()).copy_from(&right);
        for column in 0..trends.len() {
            for i in 0..law {
                mapped.gram[(i, law + column)] = products[(i, column)];
                mapped.gram[(law + column, i)] = products[(i, column)];
            }
        }
        let mut with_hat = DVector::zeros(self.gram.nrows());
        for (hat, cells) in hats.iter().enumerate() {
            let place = first_hat + hat;
            with_hat.fill(0.0);
            for &(cell, value) in &cells.0 {
                with_hat.axpy(value, &self.gram.column(law + cell), 1.0);
                mapped.right[place] += value * self.right[law + cell];
                for column in 0..trends.len() {
                    mapped.gram[(place, law + column)] += value * products[(law + cell, column)];
                }
            }
            for i in 0..law {
                mapped.gram[(place, i)] = with_hat[i];
            }
            for (other, beside) in hats[..=hat].iter().enumerate() {
                let product = |&(cell, value): &(usize, f64)| value * with_hat[law + cell];
                mapped.gram[(place, first_hat + other)] = beside.0.iter().map(product).sum();
            }
            for i in 0..place {
                mapped.gram[(i, place)] = mapped.gram[(place, i)];
            }
        }
        mapped
    }

    /// The sums over some of the unknowns.
    fn only(&self, unknowns: &[usize]) -> Self {
        Self {
            gram: DMatrix::from_fn(unknowns.len(), unknowns.len(), |i, j| {
                self.gram[(unknowns[i], unknowns[j])]
            }),
            right: self.right.select_rows(unknowns),
            energy: self.energy,
            noise: self.noise,
            count: self.count,
        }
    }

    /// The error with the unknowns `x` beyond the noise, kN.
    fn beyond_noise(&self, x: &DVector<f64>) -> f64 {
        let squares = self.energy - 2.0 * x.dot(&self.right) + x.dot(&(&self.gram * x));
        let count = self.count.max(1.0);
        beyond_noise(squares.max(0.0) / count, self.noise / count)
    }
}

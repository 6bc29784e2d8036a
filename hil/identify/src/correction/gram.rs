//! The least squares of eq 13 and a table, with each block left out in turn.

use mesh_damper::effects::residual_table::CELLS;
use mesh_damper_model::correction::Remembered;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::design::{Coefficients, Design, Recalled, Row};
use super::hat::hats;
use super::system::System;
use super::trend::Trend;
use crate::beyond_noise::beyond_noise;

/// A trend counts as a combination of others if the rest is less than this fraction of it, in squares. Derived: above rounding.
const ALIKE: f64 = 1e-9;
mesh_damper_recording::numbers! {
    /// The least squares of a residual table.
    GramPolicy {
        /// In the fit of a residual table, the law's exponent α changes by at most this in one step.
        largest_step: f64 = 0.1, Tuned("the blind trial");
    }
}

/// The terms fitted together with eq 13: trends, and a table around them.
#[derive(Clone, Copy, Debug)]
pub(super) struct TableForm<'t> {
    pub trends: &'t [Trend],
    /// The penalty for a bend of the table, relative to the data's weight on a cell; `None` without a table.
    pub table: Option<f64>,
}

impl TableForm<'_> {
    /// Only eq 13.
    pub const NONE: Self = TableForm {
        trends: &[],
        table: None,
    };
}

/// The solution.
#[derive(Clone)]
pub(super) struct Solved {
    pub coefficients: Coefficients,
    /// kN
    pub cells: Vec<f64>,
    /// Error in the fit beyond the noise, kN.
    pub inside: f64,
    /// The same error, or the [cross-validated](Sums::cross_validated) error.
    pub error: f64,
}

/// The place of each unknown: those of eq 13, the factors of the trends, the hats.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    pub law: usize,
    pub trends: usize,
    pub hats: usize,
    /// The axis of the table in place of speed.
    pub of: Option<Remembered>,
}

impl Layout {
    pub fn width(&self) -> usize {
        self.law + self.trends + self.hats
    }
}

/// Sums over the rows of one block.
pub(super) struct BlockSums {
    pub gram: DMatrix<f64>,
    right: DVector<f64>,
    energy: f64,
    /// Sum of the variance of the force's noise.
    noise: f64,
    pub count: f64,
}

/// The rows of a fit, at given coefficients.
pub(super) struct GramRows<'d> {
    design: &'d Design<'d>,
    at: &'d Coefficients,
    recalled: Option<&'d Recalled>,
}

impl<'d> GramRows<'d> {
    /// Residuals of eq 13 with `at`. The unknowns of eq 13 are changes from `at`.
    pub fn over(
        design: &'d Design<'d>,
        at: &'d Coefficients,
        recalled: Option<&'d Recalled>,
    ) -> Self {
        Self {
            design,
            at,
            recalled,
        }
    }

    /// The sums over eq 13 and the terms of `form`, for any smoothness; `None` without samples.
    pub fn sums<'t>(&self, form: TableForm<'t>) -> Option<Sums<'_, 't>> {
        let (layout, hats) = self.layout(form);
        let parts = Parts::new(&layout, form.trends, &hats);
        let is_left_out = |block: usize| self.design.left_out.binary_search(&block).is_ok();
        // Blocks that are never left out share one sum: there may be thousands, and each sum takes a megabyte.
        let together = |a: &Row, b: &Row| {
            a.block == b.block || !(is_left_out(a.block) || is_left_out(b.block))
        };
        let mut first = 0;
        let runs = self.design.rows.chunk_by(together);
        let runs: Vec<(usize, &[Row])> = runs
            .map(|run| {
                first += run.len();
                (first - run.len(), run)
            })
            .collect();
        let summed = runs
            .into_par_iter()
            .map(|(first, run)| (run[0].block, self.block(first, run, &layout, &parts)));
        let summed: Vec<(usize, BlockSums)> = summed.collect();
        let total = BlockSums::sum(layout.width(), summed.iter().map(|(_, sums)| sums));
        let left_out = summed.into_iter().filter(|(block, _)| is_left_out(*block));
        let blocks = left_out.map(|(_, sums)| sums).collect();
        Sums::of(
            self.design,
            self.at,
            layout,
            form.trends,
            hats,
            blocks,
            total,
        )
    }

    /// One step from the coefficients, with only the error in the fit; `None` without samples, or if the equations cannot be
    /// solved.
    pub fn solved(&self, form: TableForm) -> Option<Solved> {
        let (layout, hats) = self.layout(form);
        let parts = Parts::new(&layout, form.trends, &hats);
        let total = self.block(0, &self.design.rows, &layout, &parts);
        let none = Vec::new();
        let sums = Sums::of(self.design, self.at, layout, form.trends, hats, none, total)?;
        Some(sums.solution(&sums.unknowns(&sums.system(form))?))
    }

    /// The place of each unknown, and the hats.
    fn layout(&self, form: TableForm) -> (Layout, Vec<Trend>) {
        let of = self.recalled.map(|recalled| recalled.of);
        let hats = form.table.map_or(Vec::new(), |_| hats(of));
        let layout = Layout {
            law: self.width_of_law(),
            trends: form.trends.len(),
            hats: hats.len(),
            of,
        };
        (layout, hats)
    }

    fn width_of_law(&self) -> usize {
        if self.design.fits_law {
            4 * self.at.0.len()
        } else {
            0
        }
    }

    /// The sums over `rows`; `first` is the index of the first row.
    fn block(&self, first: usize, rows: &[Row], layout: &Layout, parts: &Parts) -> BlockSums {
        let (law, width) = (layout.law, layout.law + layout.trends);
        let mut block = BlockSums::new(layout.width());
        let mut of_law: Vec<(usize, f64)> = Vec::new();
        // Nearly all unknowns of eq 13 and of the trends are active at once, but few of the hats.
        let mut dense = DMatrix::zeros(width, rows.len());
        let mut hats: Vec<(usize, f64)> = Vec::new();
        let mut left = DVector::zeros(rows.len());
        for (place, row) in rows.iter().enumerate() {
            let known = &mut dense.as_mut_slice()[place * width..][..width];
            hats.clear();
            left[place] = row.force;
            if law > 0 {
                left[place] -= row.law_force(self.at);
                of_law.clear();
                row.law_derivatives(self.at, &mut of_law);
                of_law.iter().for_each(|&(i, a)| known[i] += a);
            }
            let add = |(cell, weight)| parts.add(cell, weight, &mut known[law..], &mut hats);
            match self.recalled {
                None => row.cells().for_each(add),
                Some(recalled) => recalled.cells_of(first + place).for_each(add),
            }
            add_up(&mut hats);
            block.add_hats(known, &hats, left[place]);
            block.noise += self.design.noise_of(row);
        }
        // Several times faster than `tr_mul`.
        let squares = &dense * dense.transpose();
        let own = (width, width);
        block.gram.view_mut((0, 0), own).copy_from(&squares);
        block.right.rows_mut(0, width).copy_from(&(&dense * &left));
        block.gram.fill_lower_triangle_with_upper_triangle();
        block.energy = left.norm_squared();
        block.count = rows.len() as f64;
        block
    }
}

/// The components of the cells.
struct Parts {
    trends: usize,
    /// The value of each trend in each cell, trends running fastest.
    of_trends: Vec<f64>,
    /// The unknowns of the hats at each cell, with their values there.
    of_hats: Vec<Vec<(usize, f64)>>,
}

impl Parts {
    fn new(layout: &Layout, trends: &[Trend], hats: &[Trend]) -> Self {
        let mut of_trends = vec![0.0; CELLS * trends.len()];
        for (index, trend) in trends.iter().enumerate() {
            for &(cell, value) in &trend.cells {
                of_trends[cell * trends.len() + index] = value;
            }
        }
        let mut of_hats = vec![Vec::new(); CELLS];
        for (unknown, hat) in (layout.law + layout.trends..).zip(hats) {
            for &(cell, value) in &hat.cells {
                of_hats[cell].push((unknown, value));
            }
        }
        Self {
            trends: trends.len(),
            of_trends,
            of_hats,
        }
    }

    /// Adds the components of a cell with this weight.
    fn add(&self, cell: usize, weight: f64, trends: &mut [f64], hats: &mut Vec<(usize, f64)>) {
        if weight == 0.0 {
            return;
        }
        let values = &self.of_trends[cell * self.trends..][..self.trends];
        let sums = trends.iter_mut().zip(values);
        sums.for_each(|(sum, value)| *sum += weight * value);
        hats.extend(self.of_hats[cell].iter().map(|&(hat, a)| (hat, weight * a)));
    }
}

/// Merges entries, so that one remains for each place.
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

/// The normal equations without the penalties, which a [`TableForm`] adds.
pub(super) struct Sums<'d, 't> {
    design: &'d Design<'d>,
    at: &'d Coefficients,
    layout: Layout,
    trends: &'t [Trend],
    /// The hats of the table.
    hats: Vec<Trend>,
    /// Sums of the blocks that are left out one at a time.
    blocks: Vec<BlockSums>,
    total: BlockSums,
}

impl<'d, 't> Sums<'d, 't> {
    fn of(
        design: &'d Design<'d>,
        at: &'d Coefficients,
        layout: Layout,
        trends: &'t [Trend],
        hats: Vec<Trend>,
        blocks: Vec<BlockSums>,
        total: BlockSums,
    ) -> Option<Self> {
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

    /// The cross-validated error with some of the trends, without the table.
    pub fn error_with(&self, trends: &[usize]) -> Option<f64> {
        let unknowns = self.unknowns_of(trends);
        let blocks = self.blocks.iter().map(|block| block.only(&unknowns));
        let blocks: Vec<BlockSums> = blocks.collect();
        let layout = self.layout_of(trends);
        let total = self.total.only(&unknowns);
        let none = Vec::new();
        let sums = Sums::of(self.design, self.at, layout, &[], none, blocks, total)?;
        let system = sums.system(TableForm::NONE);
        sums.cross_validated_error(&system, &sums.unknowns(&system)?)
    }

    /// The reduction of the squared error in the fit by each trend, when added to some of the others, without the table.
    pub fn savings_beside(&self, trends: &[usize]) -> Option<Vec<f64>> {
        let known = self.unknowns_of(trends);
        let own = self.total.only(&known);
        let layout = self.layout_of(trends);
        let system = System::new(self.design, self.at, &layout, TableForm::NONE, &own);
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
            hats: 0,
            ..self.layout
        }
    }

    /// One step from the coefficients, with the geometric mean of the error in the fit and the errors in the blocks left out one at
    /// a time, each beyond the noise; `None` if the equations cannot be solved.
    pub fn cross_validated(&self, form: TableForm) -> Option<Solved> {
        let system = self.system(form);
        let unknowns = self.unknowns(&system)?;
        Some(Solved {
            error: self.cross_validated_error(&system, &unknowns)?,
            ..self.solution(&unknowns)
        })
    }

    fn system(&self, form: TableForm) -> System {
        System::new(self.design, self.at, &self.layout, form, &self.total)
    }

    fn cross_validated_error(&self, system: &System, unknowns: &DVector<f64>) -> Option<f64> {
        let mut outside = 0.0;
        for block in &self.blocks {
            let (gram, right) = (
                &self.total.gram - &block.gram,
                &self.total.right - &block.right,
            );
            outside += block.beyond_noise(&system.solve(gram, right)?).ln();
        }
        let outside = outside / self.blocks.len() as f64;
        let inside = self.total.beyond_noise(unknowns).ln();
        Some((0.5 * (inside + outside)).exp())
    }

    fn unknowns(&self, system: &System) -> Option<DVector<f64>> {
        let solve =
            |system: &System| system.solve(self.total.gram.clone(), self.total.right.clone());
        let (law, at) = (self.layout.law, &self.at.0);
        let mut x = solve(system)?;
        // Negative damping, which feeds energy in, is not allowed.
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
            let step = change(3).clamp(
                -GramPolicy::in_use().largest_step,
                GramPolicy::in_use().largest_step,
            );
            [
                k1 + change(0),
                k3 + change(1),
                (c + change(2)).max(0.0),
                (alpha + step).clamp(0.0, 1.0),
            ]
        };
        let mut cells = vec![0.0; CELLS];
        let columns = self.trends.iter().chain(&self.hats);
        for (column, factor) in columns.zip(x.iter().skip(law)) {
            for &(cell, value) in &column.cells {
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

impl BlockSums {
    fn new(width: usize) -> Self {
        Self {
            gram: DMatrix::zeros(width, width),
            right: DVector::zeros(width),
            energy: 0.0,
            noise: 0.0,
            count: 0.0,
        }
    }

    fn sum<'a>(width: usize, blocks: impl Iterator<Item = &'a Self>) -> Self {
        blocks.fold(Self::new(width), |mut sum, block| {
            sum.gram += &block.gram;
            sum.right += &block.right;
            sum.energy += block.energy;
            sum.noise += block.noise;
            sum.count += block.count;
            sum
        })
    }

    /// Adds the products of the hats at a row with the preceding unknowns, `known`, and with each other, in the upper triangle.
    fn add_hats(&mut self, known: &[f64], hats: &[(usize, f64)], left: f64) {
        let height = self.gram.nrows();
        for (place, &(i, a)) in hats.iter().enumerate() {
            let column = &mut self.gram.as_mut_slice()[i * height..][..height];
            let shared = column.iter_mut().zip(known);
            shared.for_each(|(sum, b)| *sum += a * b);
            for &(j, b) in &hats[..=place] {
                column[j] += a * b;
            }
            self.right[i] += a * left;
        }
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

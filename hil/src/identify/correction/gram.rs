//! The least squares of eq 13 and the tables, with each block left out in turn.

use mesh_damper::effects::correction::{CELLS, DISPLACEMENTS, MEMORIES, MEMORY_CELLS, SPEEDS};
use nalgebra::{Cholesky, DMatrix, DVector};

use super::design::{Coefficients, Design, Recalled};

/// What a bend between neighbouring amplitudes costs eq 13's coefficients, over what the data say of them.
const BEND: f64 = 1e-3;
/// What a change of α costs, likewise: a step of the search, that later ones carry on.
const STEP: f64 = 1e-3;
/// The largest change of α in one step.
const LARGEST_STEP: f64 = 0.1;
/// What a slope costs a table, over what a bend costs: so that it ends flat where nothing is known.
const SLOPE: f64 = 1e-3;
/// Added to the diagonal of the scaled normal equations.
const RIDGE: f64 = 1e-10;
/// What holds a coefficient at the end of its range.
const PIN: f64 = 1e9;

/// What is fitted beside eq 13.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form {
    /// T is; U is where something is remembered.
    pub table: bool,
    /// What a bend of T costs, over what the data say of a cell.
    pub smoothness: f64,
    /// The same of U.
    pub memory_smoothness: f64,
}

/// What was solved for.
pub(super) struct Solved {
    pub coefficients: Coefficients,
    /// The cells of T, then those of U, kN.
    pub cells: Vec<f64>,
    /// RMS, kN.
    pub error: f64,
}

/// Where each unknown stands.
struct Layout {
    law: usize,
    table: usize,
    memory: usize,
}

impl Layout {
    fn width(&self) -> usize {
        self.law + self.table + self.memory
    }
}

/// Sums over the rows of one block.
struct Block {
    gram: DMatrix<f64>,
    right: DVector<f64>,
    energy: f64,
    count: f64,
}

/// One step from the coefficients `at`, for the error in the fit alone; `None` where the equations cannot be solved.
pub(super) fn solve(
    design: &Design,
    at: &Coefficients,
    form: Form,
    recalled: Option<&Recalled>,
) -> Option<Solved> {
    Sums::over(design, at, form, recalled)?.solve(at)
}

/// The same for the geometric mean of the error in the fit and of the errors in the blocks left out, one at a time.
pub(super) fn judge(
    design: &Design,
    at: &Coefficients,
    form: Form,
    recalled: Option<&Recalled>,
) -> Option<Solved> {
    let sums = Sums::over(design, at, form, recalled)?;
    let mut solved = sums.solve(at)?;
    // A block that is predicted better than its noise counts no more than one that is predicted to it.
    let floor = 0.3 * design.noise;
    let mut outside = 0.0;
    for &left_out in &design.left_out {
        let block = &sums.blocks[left_out];
        let (gram, right) = (
            &sums.total.gram - &block.gram,
            &sums.total.right - &block.right,
        );
        outside += (block.error(&sums.system.solve(gram, right)?) + floor).ln();
    }
    let outside = outside / design.left_out.len() as f64;
    let inside = (solved.error.powi(2) + floor).ln();
    solved.error = (0.25 * (inside + outside)).exp();
    Some(solved)
}

/// The normal equations.
struct Sums {
    layout: Layout,
    blocks: Vec<Block>,
    total: Block,
    system: System,
}

impl Sums {
    fn over(
        design: &Design,
        at: &Coefficients,
        form: Form,
        recalled: Option<&Recalled>,
    ) -> Option<Self> {
        let layout = Layout {
            law: if design.fits_law { 4 * at.0.len() } else { 0 },
            table: if form.table { CELLS } else { 0 },
            memory: recalled.map_or(0, |_| MEMORY_CELLS),
        };
        let blocks = accumulate(design, at, &layout, recalled);
        let mut total = Block::new(layout.width());
        for block in &blocks {
            total.add(block);
        }
        if total.count == 0.0 {
            return None;
        }
        Some(Self {
            system: System::new(design, at, &layout, form, &total),
            layout,
            blocks,
            total,
        })
    }

    fn solve(&self, at: &Coefficients) -> Option<Solved> {
        let solve =
            |system: &System| system.solve(self.total.gram.clone(), self.total.right.clone());
        let law = self.layout.law;
        let mut x = solve(&self.system)?;
        // Damping that feeds energy in is none.
        let negative = |x: &DVector<f64>| {
            let mut nodes = 0..law / 4;
            nodes.find(|&node| at.0[node][2] + x[4 * node + 2] < -1e-12 * at.0[node][2])
        };
        let mut system = self.system.clone();
        for _ in 0..law / 4 {
            let Some(node) = negative(&x) else { break };
            system.pin(4 * node + 2, -at.0[node][2]);
            x = solve(&system)?;
        }
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
        Some(Solved {
            coefficients: Coefficients(at.0.iter().enumerate().map(moved).collect()),
            cells: x.iter().skip(law).copied().collect(),
            error: self.total.error(&x).sqrt(),
        })
    }
}

impl Block {
    fn new(width: usize) -> Self {
        Self {
            gram: DMatrix::zeros(width, width),
            right: DVector::zeros(width),
            energy: 0.0,
            count: 0.0,
        }
    }

    fn add(&mut self, other: &Self) {
        self.gram += &other.gram;
        self.right += &other.right;
        self.energy += other.energy;
        self.count += other.count;
    }

    /// Mean squared error with the unknowns `x`, kN². Only the lower triangle of the sums is filled.
    fn error(&self, x: &DVector<f64>) -> f64 {
        let mut error = self.energy - 2.0 * x.dot(&self.right);
        for column in 0..x.len() {
            error += x[column] * x[column] * self.gram[(column, column)];
            for row in column + 1..x.len() {
                error += 2.0 * x[row] * x[column] * self.gram[(row, column)];
            }
        }
        error.max(0.0) / self.count.max(1.0)
    }
}

/// The sums of every block, over what eq 13 with `at` leaves. The unknowns of eq 13 are changes from `at`.
fn accumulate(
    design: &Design,
    at: &Coefficients,
    layout: &Layout,
    recalled: Option<&Recalled>,
) -> Vec<Block> {
    let mut blocks: Vec<Block> = (0..design.blocks)
        .map(|_| Block::new(layout.width()))
        .collect();
    let mut entries: Vec<(usize, f64)> = Vec::new();
    for (index, row) in design.rows.iter().enumerate() {
        entries.clear();
        let mut left = row.force;
        if layout.law > 0 {
            left -= row.law_force(at);
            row.law_derivatives(at, &mut entries);
        }
        if layout.table > 0 {
            entries.extend(row.cells.map(|(cell, weight)| (layout.law + cell, weight)));
        }
        if let Some(recalled) = recalled {
            let first = layout.law + layout.table;
            entries.extend(recalled.cells[index].map(|(cell, weight)| (first + cell, weight)));
        }
        let block = &mut blocks[row.block];
        for (place, &(i, a)) in entries.iter().enumerate() {
            block.right[i] += a * left;
            for &(j, b) in &entries[..=place] {
                block.gram[(i.max(j), i.min(j))] += a * b;
            }
        }
        block.energy += left * left;
        block.count += 1.0;
    }
    blocks
}

/// The penalties.
#[derive(Clone)]
struct System {
    penalty: DMatrix<f64>,
    pull: DVector<f64>,
}

impl System {
    fn new(design: &Design, at: &Coefficients, layout: &Layout, form: Form, total: &Block) -> Self {
        let width = layout.width();
        let mut system = Self {
            penalty: DMatrix::zeros(width, width),
            pull: DVector::zeros(width),
        };
        if layout.law > 0 {
            system.law(design, at, total);
        }
        let per_cell = total.count / CELLS as f64;
        if layout.table > 0 {
            // A straight line over speed costs nothing: nodes stand twice as far apart each time.
            system.table(layout.law, SPEEDS, 2.0, form.smoothness * per_cell);
        }
        if layout.memory > 0 {
            system.table(
                layout.law + layout.table,
                MEMORIES,
                1.0,
                form.memory_smoothness * per_cell,
            );
        }
        system
    }

    /// Adds weight·(Σ aᵢ·xᵢ − target)².
    fn add(&mut self, terms: &[(usize, f64)], target: f64, weight: f64) {
        for &(i, a) in terms {
            self.pull[i] += weight * a * target;
            for &(j, b) in terms {
                self.penalty[(i, j)] += weight * a * b;
            }
        }
    }

    /// Eq 13's coefficients shall not bend over amplitude more than the data ask for, nor α run away.
    fn law(&mut self, design: &Design, at: &Coefficients, total: &Block) {
        let count = at.0.len();
        for i in 0..4 {
            let power = (0..count)
                .map(|node| total.gram[(4 * node + i, 4 * node + i)])
                .sum::<f64>()
                / count as f64;
            if i == 3 {
                for node in 0..count {
                    self.add(
                        &[(4 * node + 3, 1.0)],
                        0.0,
                        STEP * power + f64::MIN_POSITIVE,
                    );
                }
                continue;
            }
            for node in 0..count.saturating_sub(2) {
                let [low, middle, high] = [0, 1, 2].map(|next| design.nodes[node + next]);
                let part = (middle - low) / (high - low);
                let weights = [1.0 - part, -1.0, part];
                let terms = [0, 1, 2].map(|next| (4 * (node + next) + i, weights[next]));
                let bend = (0..3)
                    .map(|next| weights[next] * at.0[node + next][i])
                    .sum::<f64>();
                self.add(&terms, -bend, BEND * power);
            }
        }
    }

    /// The bends of a table over displacement, and those along its other variable, where each step is `ratio` times as long
    /// as the one before.
    fn table(&mut self, first: usize, along: usize, ratio: f64, weight: f64) {
        for direction in 0..2 {
            for j in 0..along {
                for i in 0..DISPLACEMENTS {
                    let cell =
                        |i: usize, j: usize| first + (direction * along + j) * DISPLACEMENTS + i;
                    if i + 1 < DISPLACEMENTS {
                        self.add(
                            &[(cell(i, j), -1.0), (cell(i + 1, j), 1.0)],
                            0.0,
                            SLOPE * weight,
                        );
                    }
                    if j + 1 < along {
                        self.add(
                            &[(cell(i, j), -1.0), (cell(i, j + 1), 1.0)],
                            0.0,
                            SLOPE * weight,
                        );
                    }
                    if i + 2 < DISPLACEMENTS {
                        let bend = [
                            (cell(i, j), 1.0),
                            (cell(i + 1, j), -2.0),
                            (cell(i + 2, j), 1.0),
                        ];
                        self.add(&bend, 0.0, weight);
                    }
                    if j + 2 < along {
                        let bend = [
                            (cell(i, j), ratio),
                            (cell(i, j + 1), -1.0 - ratio),
                            (cell(i, j + 2), 1.0),
                        ];
                        self.add(&bend, 0.0, weight);
                    }
                }
            }
        }
    }

    /// Holds an unknown at `value`.
    fn pin(&mut self, unknown: usize, value: f64) {
        let weight = PIN * self.penalty[(unknown, unknown)].max(1.0);
        self.add(&[(unknown, 1.0)], value, weight);
    }

    /// The unknowns for these sums, of which the lower triangle is filled.
    fn solve(&self, mut gram: DMatrix<f64>, right: DVector<f64>) -> Option<DVector<f64>> {
        gram += &self.penalty;
        let scale = DVector::from_iterator(
            gram.nrows(),
            gram.diagonal()
                .iter()
                .map(|d| if *d > 0.0 { d.sqrt().recip() } else { 0.0 }),
        );
        for column in 0..gram.ncols() {
            for row in column..gram.nrows() {
                gram[(row, column)] *= scale[row] * scale[column];
            }
            gram[(column, column)] += RIDGE;
        }
        let right = (right + &self.pull).component_mul(&scale);
        let x = Cholesky::new(gram)?.solve(&right);
        Some(x.component_mul(&scale))
    }
}

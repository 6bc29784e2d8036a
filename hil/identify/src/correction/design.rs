//! The samples of a fit, as inputs of the table and of eq 13.

use mesh_damper::effects::ResidualTable;
use mesh_damper::effects::description::EffectKind;
use mesh_damper::effects::residual_table::{CELLS, ResidualTableParts, ResidualTableState};
use mesh_damper_model::correction::{MemoryAxis, Remembered};
use mesh_damper_model::predict::{motion_at, predict};
use mesh_damper_model::{Family, LawNode, Model, ModelError};
use mesh_damper_recording::cycles::same_amplitude;
use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_recording::trajectory::Trajectory;

use crate::rows::Purpose;

mesh_damper_recording::numbers! {
    /// The samples that a residual table is fitted to.
    DesignPolicy {
        /// A residual table over the frequency needs frequencies that span more than this many octaves.
        one_frequency: f64 = 0.1, Tuned("the blind trial");
        /// A residual table does not use a memory that changes by less than this fraction of its range.
        changes: f64 = 1e-3, Convention("a thousandth");
    }
}

/// At most this many blocks are left out of the fit of a residual table, one at a time. Convention: bounds time and memory, which
/// each block needs separately; if no cycles are alike, every cycle is a block.
const MOST_LEFT_OUT: usize = 48;

/// Where a moving average smoothed the channels, the mean over its window is computed from at most this many samples. Convention: the
/// mean of a cubic over the window is then right to one per cent.
const MOST_INSTANTS: usize = 9;

/// The range of the motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// mm
    pub displacement: f64,
    /// mm/s
    pub speed: f64,
}

/// Eq 13 at each amplitude: k1, k3, c and α.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Coefficients(pub Vec<[f64; 4]>);

impl Coefficients {
    pub fn of(model: &Model) -> Self {
        let node = |node: &LawNode| [node.k1, node.k3, node.c, node.alpha];
        Self(model.law.iter().map(node).collect())
    }

    /// The nodes of `model` with these coefficients.
    pub fn nodes(&self, model: &Model) -> Vec<LawNode> {
        let pairs = model.law.iter().zip(&self.0);
        pairs
            .map(|(node, &[k1, k3, c, alpha])| LawNode {
                amplitude: node.amplitude,
                k1,
                k3,
                c,
                alpha,
            })
            .collect()
    }
}

/// One sample of the force.
pub(crate) struct Row {
    pub block: usize,
    /// The node of eq 13 below the amplitude, and the weight of the one above.
    node: usize,
    above: f64,
    /// The instants that the sample averages.
    instants: Vec<Instant>,
    /// Measured force minus the force of the effects, kN.
    pub force: f64,
}

/// One sample of the motion.
struct Instant {
    /// Trajectory and sample.
    origin: (usize, usize),
    displacement: f64,
    log_speed: f64,
    direction: f64,
    /// Cells of a table over speed.
    cells: Cells,
}

/// The active cells of a table at an instant, each with its weight.
type Cells = [(usize, f64); 8];

/// All samples of a fit.
pub(crate) struct Design<'a> {
    pub trajectories: &'a [Trajectory],
    pub reach: Reach,
    pub rows: Vec<Row>,
    /// Amplitudes of eq 13's nodes, mm.
    pub nodes: Vec<f64>,
    /// Whether eq 13 is fitted again: no effect changes its force or its motion.
    pub fits_law: bool,
    /// Blocks that are left out one at a time, in order.
    pub left_out: Vec<usize>,
}

/// The memory at each row.
pub(crate) struct Recalled {
    /// The quantity in place of speed.
    pub of: Remembered,
    /// Its values at the first and at the last node.
    pub range: [f64; 2],
    /// Cells at each instant of each row.
    cells: Vec<Vec<Cells>>,
}

impl<'a> Design<'a> {
    /// The samples that `included` picks, for a table over their range. `None` if there are no samples, or if they do not move.
    pub fn new(
        trajectories: &'a [Trajectory],
        model: &Model,
        included: impl Fn(usize, usize) -> bool,
    ) -> Result<Option<Self>, ModelError> {
        let picked: Vec<(usize, usize)> = trajectories
            .iter()
            .enumerate()
            .flat_map(|(which, trajectory)| {
                (0..trajectory.len()).map(move |sample| (which, sample))
            })
            .filter(|&(which, sample)| {
                included(which, sample) && trajectories[which].is_telling(sample)
            })
            .collect();
        let largest = |channel: &dyn Fn(&Trajectory) -> &[f64]| {
            picked.iter().fold(0.0_f64, |most, &(which, sample)| {
                most.max(channel(&trajectories[which])[sample].abs())
            })
        };
        let reach = Reach {
            displacement: largest(&|t| &t.motion.displacement),
            speed: largest(&|t| &t.motion.velocity),
        };
        let Some(table) = empty(&reach, None, 1.0) else {
            return Ok(None);
        };

        // An effect that scales eq 13, or changes its motion, would also change the new coefficients.
        let fits_law = model
            .effects
            .iter()
            .all(|effect| adds_a_force(effect.family));
        let law = Coefficients::of(model);
        let predicted = trajectories.iter().map(|t| predict(model, t));
        let beside_law: Vec<Vec<f64>> = predicted.collect::<Result<_, _>>()?;
        let first_block: Vec<usize> = trajectories
            .iter()
            .scan(0, |next, trajectory| {
                *next += trajectory.blocks.len();
                Some(*next - trajectory.blocks.len())
            })
            .collect();
        let nodes: Vec<f64> = model.law.iter().map(|node| node.amplitude).collect();
        let every = picked.len().div_ceil(Purpose::Search.rows()).max(1);
        let rows: Vec<Row> = picked
            .iter()
            .step_by(every)
            .map(|&(which, sample)| {
                let trajectory = &trajectories[which];
                let after = trajectory
                    .blocks
                    .partition_point(|block| block.samples.start <= sample);
                let (node, above) = between(&nodes, trajectory.amplitude[sample]);
                let instant = |sample: usize| {
                    let motion = motion_at(trajectory, sample);
                    Instant {
                        origin: (which, sample),
                        displacement: motion.displacement,
                        log_speed: motion.velocity.abs().max(f64::MIN_POSITIVE).ln(),
                        // There is none at rest.
                        direction: if motion.velocity == 0.0 {
                            0.0
                        } else {
                            motion.velocity.signum()
                        },
                        cells: table
                            .support(&mut { ResidualTableState::NEW }, &motion.clamped())
                            .cells,
                    }
                };
                let mut row = Row {
                    block: first_block[which] + after.saturating_sub(1),
                    node,
                    above,
                    instants: seen_at(trajectory, sample).map(instant).collect(),
                    force: 0.0,
                };
                let beside = if fits_law { row.law_force(&law) } else { 0.0 };
                row.force = trajectory.force[sample] - (beside_law[which][sample] - beside);
                row
            })
            .collect();
        Ok(Some(Self {
            trajectories,
            reach,
            left_out: left_out(trajectories, &rows),
            rows,
            nodes,
            fits_law,
        }))
    }

    /// Variance of the force's noise at a row, kN².
    pub fn noise_of(&self, row: &Row) -> f64 {
        let (which, sample) = row.instants[0].origin;
        self.trajectories[which].tolerance(sample)
    }

    /// The mean of that variance.
    pub fn noise(&self) -> f64 {
        let noise = self.rows.iter().map(|row| self.noise_of(row));
        noise.sum::<f64>() / self.rows.len() as f64
    }

    /// The memory at each row; `None` if it never changes.
    pub fn recall(&self, of: Remembered) -> Option<Recalled> {
        let longest = self
            .trajectories
            .iter()
            .map(|t| t.len() as f64 * t.tick)
            .fold(0.0, f64::max);
        let wide = match of {
            Remembered::Lag { .. } => [-self.reach.displacement, self.reach.displacement],
            Remembered::Travel { .. } => [0.0, self.reach.speed],
            Remembered::Largest => [0.0, self.reach.displacement],
            Remembered::Age { time } => [0.0, 1.0 + (longest / time).log2().max(0.0)],
            Remembered::Temperature => self.temperatures()?,
            Remembered::Slip { limit } => return self.recall_within(of, [-limit, limit]),
            Remembered::Place | Remembered::Sides { .. } => {
                return self.recall_within(of, [-self.reach.displacement, self.reach.displacement]);
            }
            Remembered::Frequency { .. } => {
                let (slowest, fastest) = self.frequencies();
                let range = [slowest.log2(), fastest.log2()];
                return (range[1] - range[0] > DesignPolicy::in_use().one_frequency)
                    .then(|| self.recall_within(of, range))?;
            }
        };
        let memories = self.through(of, wide, |memory, _| memory)?;
        let (low, high) = least_and_largest(memories.into_iter().flatten());
        let place = |memory: f64| wide[0] + memory * (wide[1] - wide[0]);
        let range = [place(low), place(high)];
        if high - low < DesignPolicy::in_use().changes {
            return None;
        }
        self.recall_within(of, range)
    }

    /// As [`Design::recall`], in a table over `range`.
    fn recall_within(&self, of: Remembered, range: [f64; 2]) -> Option<Recalled> {
        let cells = self.through(of, range, |_, cells| cells)?;
        Some(Recalled { of, range, cells })
    }

    /// Cells as zones of displacement with a friction each, kN, followed by as many zones with a dashpot each, kN·s/mm; and how
    /// much the rows say about each of them.
    pub fn zones(&self, count: usize) -> (Recalled, [Vec<f64>; 2]) {
        let mut power = [vec![0.0; count], vec![0.0; count]];
        let mut cells_at = |instant: &Instant| {
            let part = 0.5 * (instant.displacement / self.reach.displacement + 1.0);
            let zone = ((part * count as f64) as usize).min(count - 1);
            let velocity = instant.direction * instant.log_speed.exp();
            power[0][zone] += 1.0;
            power[1][zone] += velocity * velocity;
            let mut cells = [(0, 0.0); 8];
            cells[..2].copy_from_slice(&[(zone, instant.direction), (count + zone, velocity)]);
            cells
        };
        let rows = self.rows.iter();
        let cells = rows.map(|row| row.instants.iter().map(&mut cells_at).collect());
        let zones = Recalled {
            of: Remembered::Place,
            range: [-self.reach.displacement, self.reach.displacement],
            cells: cells.collect(),
        };
        (zones, power)
    }

    /// The lowest and the highest frequency of the blocks that have rows, Hz.
    pub fn frequencies(&self) -> (f64, f64) {
        let blocks = self.trajectories.iter().flat_map(|t| &t.blocks);
        let frequencies: Vec<f64> = blocks.map(|block| block.frequency).collect();
        least_and_largest(self.rows.iter().map(|row| frequencies[row.block]))
    }

    /// The lowest and the highest temperature of the rows, °C, at least as far apart as the crate can distinguish; `None` if all
    /// are equal.
    fn temperatures(&self) -> Option<[f64; 2]> {
        let (low, high) = self.least_and_largest(Trajectory::temperature_at);
        let least = low.abs().max(high.abs()).max(1.0) / 32.0;
        (low < high).then_some([low, high.max(low + least)])
    }

    /// The range of a channel at the rows.
    fn least_and_largest(&self, channel: fn(&Trajectory, usize) -> f64) -> (f64, f64) {
        let instants = self.rows.iter().flat_map(|row| &row.instants);
        least_and_largest(instants.map(|instant| {
            let (which, sample) = instant.origin;
            channel(&self.trajectories[which], sample)
        }))
    }

    /// Calls `take` with the place within the range and the cells, at every instant of every row, and collects its results.
    fn through<T>(
        &self,
        of: Remembered,
        range: [f64; 2],
        take: impl Fn(f64, Cells) -> T,
    ) -> Option<Vec<Vec<T>>> {
        let mut wanted: Vec<((usize, usize), usize)> = Vec::new();
        for (index, row) in self.rows.iter().enumerate() {
            wanted.extend(row.instants.iter().map(|instant| (instant.origin, index)));
        }
        wanted.sort_unstable();
        let mut wanted = wanted.into_iter().peekable();
        let room = self.rows.iter().map(|row| row.instants.len());
        let mut taken: Vec<Vec<T>> = room.map(Vec::with_capacity).collect();
        for (which, trajectory) in self.trajectories.iter().enumerate() {
            let table = empty(&self.reach, Some((of, range)), trajectory.tick)?;
            let mut state = ResidualTableState::NEW;
            for sample in 0..trajectory.len() {
                let support = table.support(&mut state, &motion_at(trajectory, sample).clamped());
                while let Some((_, row)) = wanted.next_if(|(at, _)| *at == (which, sample)) {
                    taken[row].push(take(support.memory, support.cells));
                }
            }
        }
        Some(taken)
    }
}

impl Recalled {
    /// The axis of the table over it.
    pub fn axis(&self) -> MemoryAxis {
        MemoryAxis {
            of: self.of,
            range: self.range,
        }
    }

    /// The cells that act on the force at a row.
    pub fn cells_of(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let cells = &self.cells[row];
        let part = 1.0 / cells.len() as f64;
        cells
            .iter()
            .flatten()
            .map(move |(cell, weight)| (*cell, part * weight))
    }
}

impl Row {
    /// Eq 13's force, kN.
    pub fn law_force(&self, law: &Coefficients) -> f64 {
        let [k1, k3, c, alpha] = self.at_amplitude(law);
        let [y, y3, damping, _] = self.shown(alpha);
        k1 * y + k3 * y3 + c * damping
    }

    /// The derivatives of that force with respect to the coefficients of every node.
    pub fn law_derivatives(&self, law: &Coefficients, entries: &mut Vec<(usize, f64)>) {
        let [_, _, c, alpha] = self.at_amplitude(law);
        let [y, y3, damping, by_exponent] = self.shown(alpha);
        let derivatives = [y, y3, damping, c * by_exponent];
        for (node, weight) in [(self.node, 1.0 - self.above), (self.node + 1, self.above)] {
            if weight > 0.0 {
                let own = derivatives.iter().enumerate();
                entries.extend(own.map(|(i, d)| (4 * node + i, weight * d)));
            }
        }
    }

    /// The cells that act on the force, for a table over speed.
    pub fn cells(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let part = 1.0 / self.instants.len() as f64;
        let cells = self.instants.iter().flat_map(|instant| instant.cells);
        cells.map(move |(cell, weight)| (cell, part * weight))
    }

    /// The means of y, y³, |v|^α·sgn v and of the derivative of the last with respect to α.
    fn shown(&self, alpha: f64) -> [f64; 4] {
        let mut sums = [0.0; 4];
        for instant in &self.instants {
            let y = instant.displacement;
            let damping = instant.direction * (alpha * instant.log_speed).exp();
            let own = [y, y.powi(3), damping, instant.log_speed * damping];
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        sums.map(|sum| sum / self.instants.len() as f64)
    }

    /// The coefficients at the row's amplitude.
    fn at_amplitude(&self, law: &Coefficients) -> [f64; 4] {
        let low = law.0[self.node];
        let high = law.0[(self.node + 1).min(law.0.len() - 1)];
        std::array::from_fn(|i| low[i] + self.above * (high[i] - low[i]))
    }
}

/// The samples of the motion that the force at a sample depends on: that sample, or those within a moving average.
fn seen_at(trajectory: &Trajectory, sample: usize) -> impl Iterator<Item = usize> {
    let window = trajectory.average.map_or(1.0, |average| average.window);
    let count = (window as usize).clamp(1, MOST_INSTANTS);
    let last = trajectory.len() - 1;
    (0..count).map(move |place| {
        let place = (place as f64 + 0.5) / count as f64 - 0.5;
        let at = sample as f64 + place * window;
        (at.round().max(0.0) as usize).min(last)
    })
}

/// The node below `amplitude` and the weight of the node above, with the interpolation of [`Model::law_at`].
fn between(nodes: &[f64], amplitude: f64) -> (usize, f64) {
    let above = nodes.partition_point(|&node| node < amplitude);
    let low = above.saturating_sub(1);
    let high = above.min(nodes.len() - 1);
    let span = nodes[high] - nodes[low];
    let weight = if span > 0.0 {
        (amplitude - nodes[low]) / span
    } else {
        0.0
    };
    (low, weight.clamp(0.0, 1.0))
}

/// A table of zeros.
fn empty(
    reach: &Reach,
    memory: Option<(Remembered, [f64; 2])>,
    tick: f64,
) -> Option<ResidualTable<f64>> {
    let memory = memory.map(|(of, range)| (of.memory(), range));
    let parts = ResidualTableParts {
        reach: reach.displacement,
        speed: reach.speed,
        unit: 1.0,
        cells: &[0; CELLS],
        memory,
    };
    ResidualTable::new(&parts, tick).ok()
}

/// Whether an effect only adds a force to the law.
fn adds_a_force(family: Family) -> bool {
    family.first().kind == EffectKind::Force
}

/// Blocks to leave out one at a time. Each has an amplitude that another block has too, so eq 13 is known there, and none is the
/// only block at its high speed, where the table cannot know the force. If there are no such blocks, all of them; if there are
/// many, a selection spread evenly over the recordings.
fn left_out(trajectories: &[Trajectory], rows: &[Row]) -> Vec<usize> {
    let blocks: Vec<(f64, f64)> = trajectories
        .iter()
        .flat_map(|t| {
            t.blocks
                .iter()
                .map(|b| (b.amplitude, b.amplitude * b.frequency))
        })
        .collect();
    let others = |own: usize| {
        let all = blocks.iter().enumerate();
        all.filter(move |(other, _)| *other != own)
            .map(|(_, block)| *block)
    };
    let fitted = |block: &usize| rows.iter().any(|row| row.block == *block);
    let all: Vec<usize> = (0..blocks.len()).filter(fitted).collect();
    let inner: Vec<usize> = all
        .iter()
        .copied()
        .filter(|&block| {
            let (amplitude, speed) = blocks[block];
            others(block).any(|(other, _)| same_amplitude(other, amplitude))
                && others(block).any(|(_, other)| other > speed || same_amplitude(other, speed))
        })
        .collect();
    let known = if inner.is_empty() { all } else { inner };
    let count = known.len().min(MOST_LEFT_OUT);
    (0..count)
        .map(|place| known[(2 * place + 1) * known.len() / (2 * count)])
        .collect()
}

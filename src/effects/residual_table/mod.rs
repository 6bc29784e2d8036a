//! The residual table: a bounded table of the force that the law still lacks where no known effect explains it.
//!
//! F = T(y, sgn v, s). T is tabulated over displacement, once for each direction of motion, so that the jump of friction at rest is
//! exact, and over s. s is the speed, or in its place the earlier motion, the rate of its reversals, or the temperature.
//! Alternatively T is a finer line over displacement alone, for an effect at one position, or lines over speed beyond edges, for a
//! contact.
//!
//! Nodes over displacement are evenly spaced over ±reach, nodes over speed by half octaves ([`part_of_speed`]), and nodes over
//! another variable evenly. Between nodes the table is linear in each of its variables; outside, the value at its edge holds. The
//! force is therefore bounded by the largest cells for every motion. At rest, which has no direction, it is the mean of both
//! directions.
//!
//! After one or two conversions the computation is in integers. `f32` and `f64` thus differ only by rounding in these conversions:
//! by a 4096th of the distance between two nodes.

mod memory;
mod packed;

use super::ClampedMotion;
use super::description::Growth;
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};
use memory::{Beside, MemoryKind, Recall};

pub use memory::{Memory, ResidualTableState};
pub(crate) use packed::LARGEST_TABLE;

/// Nodes over displacement.
pub const DISPLACEMENTS: usize = 9;
/// Nodes over speed, or over the variable in its place.
pub const NODES: usize = 17;
/// Number of cells. Displacement runs fastest, then speed, then direction, that of growing displacement first.
pub const CELLS: usize = 2 * NODES * DISPLACEMENTS;
/// Nodes over displacement where T is a line ([`Memory::Place`]).
pub const FINE: usize = 33;
/// Groups of cells in [`ResidualTable::drives`], runs of a group, and nodes of a run.
pub(crate) const GROUPS: usize = DISPLACEMENTS;
pub(crate) const RUNS: usize = NODES.div_ceil(RUN);
const RUN: usize = 6;
/// Largest speed over that of node 2.
const SPEEDS: f64 = 255.0;

/// The first cell for falling displacement.
const BACK: usize = NODES * DISPLACEMENTS;

/// Bits of the distance between two nodes.
const FRACTION: u32 = 12;
const ONE: i32 = 1 << FRACTION;
/// The place at the largest displacement; the place at 0 mm is 0.
const END: i32 = 4 * ONE;
/// The last place over speed, or over the variable in its place.
const LAST_NODE: i32 = 16 * ONE - 1;
/// Bits of the distance between two nodes of a line over displacement.
const FINE_FRACTION: u32 = FRACTION - 2;

/// The parts of a [`ResidualTable`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualTableParts<'t, R> {
    /// Largest displacement of the table, mm, 1e-9…1e4.
    pub reach: R,
    /// Largest speed, mm/s, 1e-9…1e6.
    pub speed: R,
    /// Force of one count in a cell, kN, 0…1e9.
    pub unit: R,
    /// The cells, [`CELLS`] of them.
    pub cells: &'t [i16],
    /// The variable in place of speed, and its values at the first and at the last node, ±1e9. The values must increase; they are
    /// not used with [`Memory::Slip`], [`Memory::Place`] and [`Memory::Sides`]. The values are clamped: lengths to at least an
    /// eighth of the reach apart and within four times of it, octaves to half an octave apart and within ±16, speeds to an eighth
    /// of the last apart, temperatures to a 32nd of the larger apart.
    pub memory: Option<(Memory<R>, [R; 2])>,
}

/// A force as a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualTable<R> {
    /// Places per mm.
    per_displacement: R,
    /// 1/(the speed of node 2).
    per_speed: R,
    /// kN
    unit: R,
    recall: Recall<R>,
    cells: [i16; CELLS],
}

/// The cells of a force and their weights: the force is `unit` times their weighted sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// Cells and weights: four of each direction at rest, else four of one direction. Some weights are 0.
    pub cells: [(usize, f64); 8],
    /// Position of speed, or of the variable in its place, among the nodes: 0 at or below the first, 1 at or above the last.
    pub memory: f64,
}

/// Position of a motion in the table, in addition to displacement and direction.
#[derive(Clone, Copy)]
enum Along {
    /// A place among [`NODES`] nodes.
    Nodes(i32),
    /// None: the table is a line of [`FINE`] nodes.
    Line,
    /// A place on the line of the side that contains the displacement.
    Side(i32),
}

/// Cells between which a closed cycle may lead.
#[derive(Clone, Copy)]
struct Group {
    first: usize,
    /// Cells from node to node.
    apart: usize,
    /// Number of nodes.
    count: usize,
    /// Whether a cycle stays at a node.
    is_each_alone: bool,
    /// Whether the variable is a stretch that follows the displacement: see [`ResidualTable::group`].
    is_stretch: bool,
    is_over_speed: bool,
}

impl Group {
    /// The cells at a node, for rising and for falling displacement.
    fn cells(&self, node: usize) -> [usize; 2] {
        let cell = self.first + node * self.apart;
        [cell, BACK + cell]
    }

    /// By how much a force for falling displacement is above one for rising displacement between which a cycle may lead: those of
    /// the next node, or of one before it. `bounds` keeps the least and the largest of these; the first node begins them.
    #[inline(always)]
    fn drives<R: Real>(&self, bounds: &mut [R; 2], is_first: bool, [rises, falls]: [R; 2]) -> R {
        let [rising, falling] = bounds;
        if self.is_each_alone || self.is_stretch || is_first || rises < *rising {
            *rising = rises;
        }
        if self.is_each_alone || is_first || falls > *falling {
            *falling = falls;
        }
        *falling - *rising
    }
}

impl<R: Real> ResidualTable<R> {
    /// How its force grows outside the operating range.
    pub const OUTSIDE: Growth = Growth::Held;
    /// A table without force. All bits are 0.
    pub(super) const NONE: Self = Self {
        per_displacement: R::ZERO,
        per_speed: R::ZERO,
        unit: R::ZERO,
        recall: Recall::SPEED,
        cells: [0; CELLS],
    };

    /// The residual table of these parts for a tick of `tick` s, 1e-7…1e3.
    ///
    /// # Errors
    /// The field that is not finite or out of range; too few or too many cells; a variable whose last node does not lie above its
    /// first.
    pub fn new(parts: &ResidualTableParts<'_, R>, tick: R) -> Result<Self, ConfigError> {
        let reach = in_range("reach", parts.reach, 1e-9, limits::DISPLACEMENT)?.to_f64();
        let speed = in_range("speed", parts.speed, 1e-9, limits::VELOCITY)?.to_f64();
        let seconds = in_range("tick", tick, 1e-7, 1e3)?.to_f64();
        let mut new = Self {
            per_displacement: R::from_f64(f64::from(END) / reach),
            per_speed: R::from_f64(SPEEDS / speed),
            unit: in_range("unit", parts.unit, 0.0, limits::COEFFICIENT)?,
            ..Self::NONE
        };
        new.cells = parts
            .cells
            .try_into()
            .map_err(|_| ConfigError::OutOfRange {
                field: "cells",
                value: parts.cells.len() as f64,
                low: CELLS as f64,
                high: CELLS as f64,
            })?;
        if let Some((memory, range)) = parts.memory {
            new.recall = Recall::new(memory, range, reach, seconds)?;
        }
        new.check()?;
        new.check_tick(tick)?;
        Ok(new)
    }

    /// Checks the numbers before the cells: whether they are finite and such as [`ResidualTable::new`] can give.
    ///
    /// # Errors
    /// The field that is not.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        let [nearest, furthest] = [f64::from(END) / limits::DISPLACEMENT, f64::from(END) / 1e-9];
        let [fastest, slowest] = [SPEEDS / limits::VELOCITY, SPEEDS / 1e-9];
        in_range(
            "per_displacement",
            self.per_displacement,
            0.999 * nearest,
            1.001 * furthest,
        )?;
        in_range(
            "per_speed",
            self.per_speed,
            0.999 * fastest,
            1.001 * slowest,
        )?;
        in_range("unit", self.unit, 0.0, limits::COEFFICIENT)?;
        self.recall.check()
    }

    /// Checks the numbers that follow from the tick, for one of `tick` s.
    ///
    /// # Errors
    /// The field that is of another tick.
    pub(crate) fn check_tick(&self, tick: R) -> Result<(), ConfigError> {
        self.recall.check_tick(tick)
    }

    /// A group of cells between which a closed cycle may lead, of [`GROUPS`].
    ///
    /// Along a line each place is on its own. So is a cell whose variable is constant in a closed cycle: a largest displacement, an
    /// age, a temperature or a frequency. Otherwise a cycle may rise at one value of the variable and fall at another.
    ///
    /// A slip and a lag are the stretch s of an element that moves as the displacement, less what slides or relaxes, which makes |s|
    /// smaller. With x = y − s, such a table stores P = ∫ₓ^y F(u, u − x) du + ∫ F(x, 0) dx, and ∂P/∂x = −∫ₓ^y ∂F/∂s du. So where F does
    /// not fall with s, sliding loses energy. What is above that F for rising displacement, or below it for falling, dissipates. There is
    /// such an F if no cell for falling displacement is above one for rising displacement at the same or a larger stretch.
    fn group(&self, group: usize) -> Group {
        let kind = self.recall.kind;
        let (first, apart, count) = match kind {
            MemoryKind::Place => (
                NODES * group,
                1,
                FINE.saturating_sub(NODES * group).min(NODES),
            ),
            MemoryKind::Sides if group > 1 => (0, 1, 0),
            MemoryKind::Sides => (NODES * group, 1, NODES),
            _ => (group, DISPLACEMENTS, NODES),
        };
        Group {
            first,
            apart,
            count,
            is_each_alone: matches!(
                kind,
                MemoryKind::Place
                    | MemoryKind::Largest
                    | MemoryKind::Age
                    | MemoryKind::Temperature
                    | MemoryKind::Frequency
            ),
            is_stretch: matches!(kind, MemoryKind::Slip | MemoryKind::Lag),
            is_over_speed: matches!(kind, MemoryKind::Speed | MemoryKind::Sides),
        }
    }

    /// Speed at a node, mm/s.
    fn speed_at(&self, node: usize) -> R {
        let halves = ((2 + node as i32 % 2) << (node / 2)) - 2;
        R::from_i32(halves) * R::from_f64(0.5) / self.per_speed
    }

    /// The force in kN by which cells for falling displacement are above cells for rising displacement, which drives the motion; 0
    /// or below if none are. `damping` is what acts against the motion at a speed in mm/s beside the table. It is concave and the
    /// table linear between two nodes, so that the nodes suffice.
    ///
    /// For run `run` of [`RUNS`] of a group: the least force for rising displacement and the largest for falling displacement are
    /// kept in `bounds` from run to run.
    pub(crate) fn drives(
        &self,
        group: usize,
        run: usize,
        damping: impl Fn(R) -> R,
        bounds: &mut [R; 2],
    ) -> R {
        let group = self.group(group);
        let mut worst = R::ZERO;
        for node in (run * RUN..group.count).take(RUN) {
            let [rises, falls] = group.cells(node).map(|cell| {
                let count = self.cells.get(cell).copied().unwrap_or_default();
                R::from_i32(count.into()) * self.unit
            });
            let against = if group.is_over_speed {
                damping(self.speed_at(node))
            } else {
                R::ZERO
            };
            let forces = [rises + against, falls - against];
            let drives = group.drives(bounds, node == 0, forces);
            if drives > worst {
                worst = drives;
            }
        }
        worst
    }

    /// The table with which the check of [`crate::passivity`] finds no fault, with the least change of any cell. `damping` is what
    /// [`damping_beside_table`](crate::passivity::damping_beside_table) gives for its law, kN at a speed in mm/s.
    #[must_use]
    pub fn passive(mut self, damping: impl Fn(R) -> R) -> Self {
        for index in 0..GROUPS {
            let group = self.group(index);
            let against: [f64; NODES] = core::array::from_fn(|node| {
                let counts = damping(self.speed_at(node)).to_f64() / self.unit.to_f64();
                // Less by what rounding to f32 may take.
                let counts = 0.999 * counts - 1.0;
                if group.is_over_speed && counts > 0.0 {
                    counts
                } else {
                    0.0
                }
            });
            let sides = |cells: &[i16; CELLS], node: usize| {
                let [rises, falls] = group.cells(node).map(|cell| f64::from(cells[cell]));
                [rises + against[node], falls - against[node]]
            };
            let alone = if group.is_each_alone { 1 } else { NODES };
            for from in (0..group.count).step_by(alone) {
                let nodes = from..group.count.min(from + alone);
                let (mut bounds, mut drives) = ([0.0; 2], 0.0_f64);
                for node in nodes.clone() {
                    let forces = sides(&self.cells, node);
                    drives = drives.max(group.drives(&mut bounds, node == from, forces));
                }
                if drives <= 0.0 {
                    continue;
                }
                let mut below = if group.is_stretch {
                    f64::MIN
                } else {
                    bounds[1]
                };
                for node in nodes {
                    let [up, down] = group.cells(node);
                    below = below.max(sides(&self.cells, node)[1]);
                    let middle = below - 0.5 * drives;
                    let least = libm::ceil(middle - against[node]) as i16;
                    let most = libm::floor(middle + against[node]) as i16;
                    self.cells[up] = self.cells[up].max(least);
                    self.cells[down] = self.cells[down].min(most);
                }
            }
        }
        self
    }

    /// The cells, as in [`ResidualTableParts::cells`].
    pub fn cells(&self) -> &[i16] {
        &self.cells
    }

    /// Whether the table has a force.
    #[inline(always)]
    pub(super) fn is_there(&self) -> bool {
        self.unit > R::ZERO
    }

    /// Whether the state of `other` is valid here.
    pub(super) fn remembers_as(&self, other: &Self) -> bool {
        self.per_displacement == other.per_displacement && self.recall.is_like(&other.recall)
    }

    /// Force in kN on this tick of `motion`. Call it once per tick, in order.
    #[inline(always)]
    pub(super) fn force(&self, state: &mut ResidualTableState, motion: &ClampedMotion<R>) -> R {
        let (y, v) = (motion.displacement(), motion.velocity());
        let kind = self.recall.kind;
        if kind >= MemoryKind::FIRST_MEMORY {
            self.force_over_memory(state, y, v, Beside::of(motion))
        } else if kind == MemoryKind::Speed {
            self.force_over_speed(y, v)
        } else {
            self.force_on_lines(y, v)
        }
    }

    // None of these functions is inlined, so that other ticks do not load its registers and constants.
    #[inline(never)]
    fn force_over_speed(&self, displacement: R, velocity: R) -> R {
        let along = Along::Nodes(self.speed(velocity));
        self.force_at(self.across(displacement), along, velocity)
    }

    #[inline(never)]
    fn force_on_lines(&self, displacement: R, velocity: R) -> R {
        let along = match self.recall.kind {
            MemoryKind::Sides => Along::Side(self.speed(velocity)),
            _ => Along::Line,
        };
        self.force_at(self.across(displacement), along, velocity)
    }

    #[inline(never)]
    fn force_over_memory(
        &self,
        state: &mut ResidualTableState,
        displacement: R,
        velocity: R,
        beside: Beside<R>,
    ) -> R {
        let across = self.across(displacement);
        if velocity == R::ZERO {
            return self.force_at_standstill(state, across, velocity, beside);
        }
        match self.recall.along(state, across, velocity, beside) {
            Some(along) => self.force_at(across, Along::Nodes(along), velocity),
            None => self.force_at_standstill(state, across, velocity, beside),
        }
    }

    /// The same on the first tick, or at rest. A separate function, so that other ticks do not pay for it.
    #[cold]
    #[inline(never)]
    fn force_at_standstill(
        &self,
        state: &mut ResidualTableState,
        across: i32,
        velocity: R,
        beside: Beside<R>,
    ) -> R {
        let along = self.recalled(state, across, velocity, beside);
        self.force_at(across, Along::Nodes(along), velocity)
    }

    /// The place over the state's variable, on the first tick or a later one.
    fn recalled(
        &self,
        state: &mut ResidualTableState,
        across: i32,
        velocity: R,
        beside: Beside<R>,
    ) -> i32 {
        let recall = &self.recall;
        if !state.is_of(recall.kind) {
            *state = recall.begin(across, beside.cycles);
        }
        let along = recall.along(state, across, velocity, beside);
        along.unwrap_or_default()
    }

    /// The place over displacement.
    #[inline(always)]
    fn across(&self, displacement: R) -> i32 {
        (displacement * self.per_displacement)
            .to_i32()
            .clamp(-END, END - 1)
    }

    /// The place over speed.
    #[inline(always)]
    fn speed(&self, velocity: R) -> i32 {
        let half_octaves = (velocity.abs() * self.per_speed + R::ONE).half_octaves();
        half_octaves.clamp(0, LAST_NODE)
    }

    #[inline(always)]
    fn force_at(&self, across: i32, along: Along, velocity: R) -> R {
        if velocity == R::ZERO {
            return self.force_at_rest(across, along);
        }
        R::from_i32(self.counts(first_cell(velocity), across, along)) * self.unit
    }

    /// The force as the mean of both directions.
    #[cold]
    #[inline(never)]
    fn force_at_rest(&self, across: i32, along: Along) -> R {
        let both = self.counts(0, across, along) + self.counts(BACK, across, along);
        R::from_i32(both / 2) * self.unit
    }

    /// The force in units, for the direction whose cells begin at index `first`.
    #[inline(always)]
    fn counts(&self, first: usize, across: i32, along: Along) -> i32 {
        match along {
            Along::Nodes(along) => between(&self.cells, first, across, along),
            Along::Line => on_line(&self.cells, first, across + END, FINE_FRACTION),
            Along::Side(speed) => self.recall.side(across).map_or(0, |side| {
                on_line(&self.cells, first + side, speed, FRACTION)
            }),
        }
    }

    /// The cells that contribute to the force on this tick, for a fit of their values. `state` is [`ResidualTableState::NEW`]
    /// before the first tick.
    pub fn support(&self, state: &mut ResidualTableState, motion: &ClampedMotion<R>) -> Support {
        let velocity = motion.velocity();
        let across = self.across(motion.displacement());
        let part =
            |place: i32, bits: u32| f64::from(place & ((1 << bits) - 1)) / f64::from(1 << bits);
        let among_nodes = |first: usize, along: i32| {
            let (x, y) = (part(across, FRACTION), part(along, FRACTION));
            let corner = corner(first, across, along);
            [
                (corner, (1.0 - x) * (1.0 - y)),
                (corner + 1, x * (1.0 - y)),
                (corner + DISPLACEMENTS, (1.0 - x) * y),
                (corner + DISPLACEMENTS + 1, x * y),
            ]
        };
        let nothing = (0, 0.0);
        let on_line = |first: usize, along: i32, bits: u32| {
            let (first, x) = (first + (along >> bits) as usize, part(along, bits));
            [(first, 1.0 - x), (first + 1, x), nothing, nothing]
        };
        let along = if self.recall.kind < MemoryKind::FIRST_MEMORY {
            self.speed(velocity)
        } else {
            self.recalled(state, across, velocity, Beside::of(motion))
        };
        let of_direction = |first: usize| match self.recall.kind {
            MemoryKind::Place => on_line(first, across + END, FINE_FRACTION),
            MemoryKind::Sides => {
                let side = self.recall.side(across);
                side.map_or([nothing; 4], |side| on_line(first + side, along, FRACTION))
            }
            _ => among_nodes(first, along),
        };
        let mut cells = [nothing; 8];
        let (one, other) = cells.split_at_mut(4);
        one.copy_from_slice(&of_direction(first_cell(velocity)));
        if velocity == R::ZERO {
            one.copy_from_slice(&of_direction(0));
            other.copy_from_slice(&of_direction(BACK));
            cells.iter_mut().for_each(|(_, weight)| *weight *= 0.5);
        }
        let memory = f64::from(along) / f64::from(LAST_NODE);
        Support { cells, memory }
    }
}

/// The first cell of the direction.
#[inline(always)]
fn first_cell<R: Real>(velocity: R) -> usize {
    0_usize.wrapping_sub(velocity.sign_bit()) & BACK
}

/// The speed at a node, divided by the largest: (2ⁱ − 1)/255 at node 2i, and midway between these at the nodes in between.
pub fn part_of_speed(node: usize) -> f64 {
    let octave = f64::from(1u32 << (node / 2).min(8));
    let part = if node.is_multiple_of(2) {
        octave
    } else {
        1.5 * octave
    };
    (part - 1.0) / 255.0
}

/// Index of the first of the four cells around a place, in the direction whose cells begin at index `first`.
#[inline(always)]
fn corner(first: usize, across: i32, along: i32) -> usize {
    first + (along >> FRACTION) as usize * DISPLACEMENTS + ((across >> FRACTION) + 4) as usize
}

/// The interpolated value between the four cells around a place.
#[inline(always)]
fn between(cells: &[i16], first: usize, across: i32, along: i32) -> i32 {
    let corner = corner(first, across, along);
    let around = cells.get(corner..).and_then(<[i16]>::first_chunk);
    // Every place is within the table.
    let Some(&[a, b, .., c, d]): Option<&[i16; DISPLACEMENTS + 2]> = around else {
        return 0;
    };
    let [a, b, c, d] = [a, b, c, d].map(i32::from);
    let low = mix(a, b, across, FRACTION);
    mix(low, mix(c, d, across, FRACTION), along, FRACTION)
}

/// The interpolated value between two cells of a line that begins at index `first`, whose nodes are `bits` apart.
#[inline(always)]
fn on_line(cells: &[i16], first: usize, along: i32, bits: u32) -> i32 {
    let place = first + (along >> bits) as usize;
    let around = cells.get(place..).and_then(<[i16]>::first_chunk);
    // Every place is within the line.
    let Some(&[a, b]) = around else { return 0 };
    mix(i32::from(a), i32::from(b), along, bits)
}

/// The value between `a` and `b` at the fraction in the last `bits` of a place.
#[inline(always)]
fn mix(a: i32, b: i32, place: i32, bits: u32) -> i32 {
    a + (((b - a) * (place & ((1 << bits) - 1))) >> bits)
}

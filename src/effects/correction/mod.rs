//! A correction without a name: a table of what a law still lacks where no known effect explains it.
//!
//! F = T(y, v) + U(y, sgn v, z). T stands over displacement and velocity, once for each direction of motion, so that
//! friction's jump at rest is exact. U stands over displacement and over z, what the motion was before, how fast it goes to
//! and fro, or the temperature; without any of these it is 0. Or it is a finer line over displacement alone, for what happens
//! at one place, or one over speed beyond an edge, for what touches there.
//!
//! Displacement is divided evenly over ±reach, speed by half octaves ([`part_of_speed`]). Between nodes a table is a
//! straight line in each of its variables; outside, its edge holds. So the force is bounded by the largest cells, whatever
//! the motion. At rest, which has no direction, it is the mean of both.
//!
//! After two conversions everything is in integers, so that `f32` and `f64` differ only by where these round: to a 4096th
//! of the way between two nodes.

mod memory;
mod packed;

use super::ConfinedMotion;
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};
use memory::{Beside, Kind, Recall};

pub use memory::{CorrectionState, Memory};

/// Nodes over displacement.
pub const DISPLACEMENTS: usize = 9;
/// Nodes over speed.
pub const SPEEDS: usize = 17;
/// Nodes over what is remembered.
pub const MEMORIES: usize = 5;
/// Cells of T: displacement runs fastest, then speed, then direction, that of growing displacement first.
pub const CELLS: usize = 2 * SPEEDS * DISPLACEMENTS;
/// Nodes over displacement where U is a line: [`Memory::Place`].
pub const FINE: usize = 33;
/// Cells of U: displacement runs fastest, then memory, then direction.
pub const MEMORY_CELLS: usize = 2 * MEMORIES * DISPLACEMENTS;

/// The first cell of T for falling displacement,
const BACK: usize = SPEEDS * DISPLACEMENTS;
/// and that of U.
const MEMORY_BACK: usize = MEMORIES * DISPLACEMENTS;

/// Bits of the way between two nodes.
const FRACTION: u32 = 12;
const ONE: i32 = 1 << FRACTION;
/// The last place over displacement,
const LAST: i32 = 8 * ONE - 1;
/// and over speed.
const LAST_SPEED: i32 = 16 * ONE - 1;
/// Bits of the way between two nodes of a line over displacement.
const FINE_FRACTION: u32 = FRACTION - 2;
/// No displacement.
const MIDDLE: i32 = 4 * ONE;

/// The parts of a [`Correction`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectionParts<'t, R> {
    /// Largest displacement of the tables, mm, 1e-9…1e4.
    pub reach: R,
    /// Largest speed, mm/s, 1e-9…1e6.
    pub speed: R,
    /// kN of one count in a cell, 0…1e9.
    pub unit: R,
    /// [`CELLS`] cells of T.
    pub cells: &'t [i16],
    /// What U depends on, and the z of its first and of its last node, which are not used with [`Memory::Place`] but must rise.
    pub memory: Option<(Memory<R>, [R; 2])>,
    /// [`MEMORY_CELLS`] cells of U; none without a memory.
    pub memory_cells: &'t [i16],
}

/// A force as a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction<R> {
    /// Places per mm.
    per_displacement: R,
    /// 1/(the speed of node 2).
    per_speed: R,
    /// kN
    unit: R,
    recall: Recall<R>,
    cells: [i16; CELLS],
    memory_cells: [i16; MEMORY_CELLS],
}

/// Which cells make up a force, and with what weights: the force is `unit` times their weighted sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// Of T.
    pub cells: [(usize, f64); 4],
    /// Of U; all 0 without a memory.
    pub memory_cells: [(usize, f64); 4],
    /// Where z stands in its range: 0 at the first node of U, 1 at the last.
    pub memory: f64,
}

/// What U is over beside displacement and direction.
#[derive(Clone, Copy)]
enum Along {
    /// There is no U.
    Nothing,
    /// A place among [`MEMORIES`] nodes.
    Memory(i32),
    /// Nothing more: a line of [`FINE`] nodes.
    Line,
    /// Speed, on a side: a line of [`SPEEDS`] nodes.
    Sides,
}

/// Where a motion stands in the tables.
struct Place {
    displacement: i32,
    speed: i32,
    /// All bits where the displacement falls.
    back: usize,
}

impl<R: Real> Correction<R> {
    /// No force. All bits are 0.
    pub(super) const NONE: Self = Self {
        per_displacement: R::ZERO,
        per_speed: R::ZERO,
        unit: R::ZERO,
        recall: Recall::NONE,
        cells: [0; CELLS],
        memory_cells: [0; MEMORY_CELLS],
    };

    /// The correction of these parts for a tick of `tick` s, 1e-7…1e3.
    ///
    /// # Errors
    /// The field that is not finite or out of range; cells that are too few or too many; a memory whose last node does not
    /// lie above its first.
    pub fn new(parts: &CorrectionParts<'_, R>, tick: R) -> Result<Self, ConfigError> {
        let reach = in_range("reach", parts.reach, 1e-9, limits::DISPLACEMENT)?.to_f64();
        let speed = in_range("speed", parts.speed, 1e-9, limits::VELOCITY)?.to_f64();
        let tick = in_range("tick", tick, 1e-7, 1e3)?.to_f64();
        let mut new = Self {
            per_displacement: R::from_f64(f64::from(MIDDLE) / reach),
            per_speed: R::from_f64(255.0 / speed),
            unit: in_range("unit", parts.unit, 0.0, limits::COEFFICIENT)?,
            ..Self::NONE
        };
        copy("cells", parts.cells, &mut new.cells)?;
        if let Some((memory, range)) = parts.memory {
            copy("memory_cells", parts.memory_cells, &mut new.memory_cells)?;
            new.recall = Recall::new(memory, range, [reach, speed], tick)?;
        }
        Ok(new)
    }

    /// Whether there is any.
    #[inline(always)]
    pub(super) fn is_there(&self) -> bool {
        self.unit > R::ZERO
    }

    /// Whether `other` remembers the same.
    pub(super) fn remembers_as(&self, other: &Self) -> bool {
        self.recall.is_like(&other.recall)
    }

    #[inline(always)]
    fn place(&self, displacement: R, velocity: R) -> Place {
        let y = displacement * self.per_displacement + R::from_f64(f64::from(MIDDLE));
        let half_octaves = (velocity.abs() * self.per_speed + R::ONE).half_octaves();
        Place {
            displacement: y.to_i32().clamp(0, LAST),
            speed: half_octaves.clamp(0, LAST_SPEED),
            back: 0_usize.wrapping_sub(velocity.sign_bit()),
        }
    }

    /// Force in kN on this tick of `motion`, where the state is none before the first. Call it once per tick, in order.
    #[inline(always)]
    pub(super) fn force(
        &self,
        state: &mut Option<CorrectionState>,
        motion: &ConfinedMotion<R>,
    ) -> R {
        let (y, v) = (motion.displacement(), motion.velocity());
        match self.recall.kind {
            Kind::None => self.force_of_motion(y, v),
            Kind::Place => self.force_of_place(y, v),
            Kind::Sides => self.force_of_sides(y, v),
            _ => self.force_with_memory(state, y, v, Beside::of(motion)),
        }
    }

    /// That of T.
    // Not inlined: its registers and constants are no matter of ticks without it.
    #[inline(never)]
    fn force_of_motion(&self, displacement: R, velocity: R) -> R {
        self.force_over(displacement, velocity, Along::Nothing)
    }

    /// That of T and the line.
    #[inline(never)]
    fn force_of_place(&self, displacement: R, velocity: R) -> R {
        self.force_over(displacement, velocity, Along::Line)
    }

    /// That of T and of the line of a side.
    #[inline(never)]
    fn force_of_sides(&self, displacement: R, velocity: R) -> R {
        self.force_over(displacement, velocity, Along::Sides)
    }

    #[inline(always)]
    fn force_over(&self, displacement: R, velocity: R, along: Along) -> R {
        if velocity == R::ZERO {
            return self.force_at_rest(displacement, along);
        }
        self.force_at(&self.place(displacement, velocity), along)
    }

    /// That of T and U.
    #[inline(never)]
    fn force_with_memory(
        &self,
        state: &mut Option<CorrectionState>,
        displacement: R,
        velocity: R,
        beside: Beside<R>,
    ) -> R {
        // At once: after the rest every instruction would hang on it.
        if velocity == R::ZERO {
            let across = self.place(displacement, velocity).displacement;
            let reading = self.reading(state, across, velocity, beside);
            return self.force_at_rest(displacement, Along::Memory(self.recall.place(reading)));
        }
        let place = self.place(displacement, velocity);
        let reading = self.reading(state, place.displacement, velocity, beside);
        let along = Along::Memory(self.recall.place(reading));
        self.force_at(&place, along)
    }

    #[inline(always)]
    fn force_at(&self, place: &Place, along: Along) -> R {
        R::from_i32(self.counts(place, along)) * self.unit
    }

    /// What z is read off or remembered of.
    #[inline(always)]
    fn reading(
        &self,
        state: &mut Option<CorrectionState>,
        across: i32,
        velocity: R,
        beside: Beside<R>,
    ) -> i32 {
        let now = self.recall.now(across, velocity, beside.cycles);
        let state = state.get_or_insert_with(|| self.recall.begin(now));
        self.recall.reading(state, now, beside)
    }

    /// What both tables come to, in units.
    #[inline(always)]
    fn counts(&self, place: &Place, along: Along) -> i32 {
        let across = place.displacement;
        let counts = between(&self.cells, place.back & BACK, across, place.speed);
        let back = place.back & MEMORY_BACK;
        counts
            + match along {
                Along::Nothing => 0,
                Along::Memory(memory) => between(&self.memory_cells, back, across, memory),
                Along::Line => on_line(&self.memory_cells, back, across, FINE_FRACTION),
                Along::Sides => self.recall.side(across).map_or(0, |side| {
                    on_line(&self.memory_cells, back + side, place.speed, FRACTION)
                }),
            }
    }

    /// That of the mean of both directions.
    #[cold]
    #[inline(never)]
    fn force_at_rest(&self, displacement: R, along: Along) -> R {
        let mut place = self.place(displacement, R::ZERO);
        let forwards = self.counts(&place, along);
        place.back = usize::MAX;
        R::from_i32((forwards + self.counts(&place, along)) / 2) * self.unit
    }

    /// The cells that the force on this tick comes from, for one who seeks what should stand in them. `state` is `None`
    /// before the first tick.
    pub fn support(
        &self,
        state: &mut Option<CorrectionState>,
        motion: &ConfinedMotion<R>,
    ) -> Support {
        let place = self.place(motion.displacement(), motion.velocity());
        let across = place.displacement;
        let part =
            |place: i32, bits: u32| f64::from(place & ((1 << bits) - 1)) / f64::from(1 << bits);
        let weights = |first: usize, along: i32| {
            let (x, y) = (part(across, FRACTION), part(along, FRACTION));
            let corner = corner(first, across, along);
            [
                (corner, (1.0 - x) * (1.0 - y)),
                (corner + 1, x * (1.0 - y)),
                (corner + DISPLACEMENTS, (1.0 - x) * y),
                (corner + DISPLACEMENTS + 1, x * y),
            ]
        };
        let back = place.back & MEMORY_BACK;
        let nothing = (0, 0.0);
        let on_line = |first: usize, along: i32, bits: u32| {
            let (first, x) = (first + (along >> bits) as usize, part(along, bits));
            [(first, 1.0 - x), (first + 1, x), nothing, nothing]
        };
        let (memory_cells, memory) = match self.recall.kind {
            Kind::None => ([nothing; 4], 0.0),
            Kind::Place => (on_line(back, across, FINE_FRACTION), 0.0),
            Kind::Sides => {
                let side = self.recall.side(across);
                let line = side.map(|side| on_line(back + side, place.speed, FRACTION));
                (line.unwrap_or([nothing; 4]), 0.0)
            }
            _ => {
                let beside = Beside::of(motion);
                let reading = self.reading(state, across, motion.velocity(), beside);
                let cells = weights(back, self.recall.place(reading));
                (cells, self.recall.part(reading))
            }
        };
        Support {
            cells: weights(place.back & BACK, place.speed),
            memory_cells,
            memory,
        }
    }
}

/// The speed at `node` of T, over the largest: (2ⁱ − 1)/255 at node 2i, and the middle between these at those between.
pub fn part_of_speed(node: usize) -> f64 {
    let octave = f64::from(1u32 << (node / 2).min(8));
    let part = if node.is_multiple_of(2) {
        octave
    } else {
        1.5 * octave
    };
    (part - 1.0) / 255.0
}

fn copy<const N: usize>(
    field: &'static str,
    from: &[i16],
    to: &mut [i16; N],
) -> Result<(), ConfigError> {
    *to = from.try_into().map_err(|_| ConfigError::OutOfRange {
        field,
        value: from.len() as f64,
        low: N as f64,
        high: N as f64,
    })?;
    Ok(())
}

/// The first of the four cells around a place, in a table whose cells for this direction begin with cell `first`.
#[inline(always)]
fn corner(first: usize, across: i32, along: i32) -> usize {
    first + (along >> FRACTION) as usize * DISPLACEMENTS + (across >> FRACTION) as usize
}

/// The value between the four cells around a place.
#[inline(always)]
fn between(cells: &[i16], first: usize, across: i32, along: i32) -> i32 {
    let corner = corner(first, across, along);
    let around = cells.get(corner..).and_then(<[i16]>::first_chunk);
    // Every place is within the tables.
    let Some(&[a, b, .., c, d]): Option<&[i16; DISPLACEMENTS + 2]> = around else {
        return 0;
    };
    let [a, b, c, d] = [a, b, c, d].map(i32::from);
    let low = mix(a, b, across, FRACTION);
    mix(low, mix(c, d, across, FRACTION), along, FRACTION)
}

/// The value between two cells of a line whose cells for this direction begin with cell `first`, `bits` apart.
#[inline(always)]
fn on_line(cells: &[i16], first: usize, along: i32, bits: u32) -> i32 {
    let place = first + (along >> bits) as usize;
    let around = cells.get(place..).and_then(<[i16]>::first_chunk);
    // Every place is within the line.
    let Some(&[a, b]) = around else { return 0 };
    mix(i32::from(a), i32::from(b), along, bits)
}

/// The value between `a` and `b`, as far on the way as the last `bits` of a place say.
#[inline(always)]
fn mix(a: i32, b: i32, place: i32, bits: u32) -> i32 {
    a + (((b - a) * (place & ((1 << bits) - 1))) >> bits)
}

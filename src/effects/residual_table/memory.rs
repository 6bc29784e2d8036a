//! The variable of a residual table that replaces speed, in integers. Most of these variables are a memory of the motion.

use super::{END, LAST_NODE, NODES, ONE};
use crate::effects::{ClampedMotion, is_of_tick};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// Limit of a reading, in either direction.
const LARGEST_READING: i32 = 0xffff;
/// Bits of the fraction of a gain: it counts 512ths of a place per reading.
const GAIN: u32 = 9;
const LARGEST_GAIN: i32 = (1 << 14) - 1;
/// The same for a slip, of which only the stretch is multiplied by it.
const LARGEST_GAIN_OF_SLIP: i32 = 1 << 15;
/// The last place, in 512ths.
const LAST_GAINED: i32 = ((LAST_NODE + 1) << GAIN) - 1;
/// Bits of an average below the last bit of a place.
const AVERAGE: u32 = 15;
/// Resolution of a cycle.
const CYCLE: i32 = 1 << 16;
/// Cycles of a reading of 1.
const PER_CYCLE: f64 = 1.0 / ((CYCLE as i64) << AVERAGE) as f64;
/// Ticks of the longest average; with these its error is within a thousandth of the table's range.
const LONGEST: f64 = 1e7;
/// Parts that an average loses in a tick, as 2³² per 1: 1 − e^(−1/1e7) to 1 − e^(−1/2), the ticks of the longest and of the shortest.
const AVERAGED: [i32; 2] = [429, 1_689_937_948];

/// The variable that replaces speed. Displacements are clamped to ±reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Memory<R> {
    /// The stretch in mm of a spring that slips at `limit`, from −`limit` to `limit`, initially 0. It shows where the motion last
    /// reversed, at any rate.
    Slip {
        /// mm, 1e-9…1e4; values below a 32nd of the reach are raised to it.
        limit: R,
    },
    /// The displacement minus its average over `time`, mm. The average begins at the first displacement.
    Lag {
        /// s, 1e-6…1e6; clamped to 2…1e7 ticks.
        time: R,
    },
    /// The mean speed over `time`, from 0, mm/s.
    Travel {
        /// s, 1e-6…1e6; clamped to 2…1e7 ticks.
        time: R,
    },
    /// The largest displacement so far in either direction, mm.
    Largest,
    /// log₂(1 + t/`time`), t the time since the start, linear between powers of two.
    Age {
        /// s, 1e-6…1e6
        time: R,
    },
    /// The measured temperature, °C.
    Temperature,
    /// No variable: the force is a line over displacement alone, one per direction, with [`super::FINE`] nodes evenly spaced over
    /// ±reach. The line uses the first cells of each direction; the others are not read.
    Place,
    /// No variable: the force is a line over speed alone, one per direction, where the displacement lies above `above`, another
    /// where it lies below `below`, and 0 in between. This describes contact on one side, or on both. The two lines use the first
    /// [`super::NODES`] cells of each direction and the same number after them; the other cells are not read.
    Sides {
        /// mm, −1e4…1e4; at −`reach` or below this side does not exist.
        below: R,
        /// mm, `below`…1e4; at `reach` or above this side does not exist.
        above: R,
    },
    /// log₂ of the frequency in Hz, which is the cycles per second over `time`, linear between powers of two. On the first tick it
    /// is the frequency of the first node. An `f32` resolves the cycles too coarsely after 1e5 of them.
    Frequency {
        /// s, 1e-6…1e6; clamped to 2…1e7 ticks.
        time: R,
    },
}

/// Each kind with its number in a pack. Numbers of removed kinds are not reused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd)]
#[repr(u8)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum MemoryKind {
    Speed = 0,
    Place = 1,
    Sides = 2,
    Slip = 3,
    Lag = 4,
    Travel = 5,
    Largest = 6,
    Age = 7,
    Temperature = 10,
    Frequency = 11,
}

impl MemoryKind {
    /// This kind and those after it have a state.
    pub const FIRST_MEMORY: Self = Self::Slip;

    const ALL: [Self; 10] = [
        Self::Speed,
        Self::Place,
        Self::Sides,
        Self::Slip,
        Self::Lag,
        Self::Travel,
        Self::Largest,
        Self::Age,
        Self::Temperature,
        Self::Frequency,
    ];

    /// The kind with this number; `None` if the number was never in use.
    ///
    /// # Errors
    /// [`ConfigError::Removed`]
    pub fn of_number(number: u8) -> Option<Result<Self, ConfigError>> {
        let mut all = Self::ALL.into_iter();
        let Some(kind) = all.find(|kind| *kind as u8 == number) else {
            return Some(Err(ConfigError::Removed(match number {
                8 => "residual table over cycles",
                9 => "residual table over level",
                12 => "residual table over acceleration",
                _ => return None,
            })));
        };
        Some(Ok(kind))
    }
}

/// How the variable is computed, and its scale over the nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Recall<R> {
    pub kind: MemoryKind,
    /// 1/time in ticks, readings per °C, parts of a speed per mm/s, or Hz of an average of 1; unused for a slip and the others.
    pub rate: R,
    /// The place above which there is a side, or the part that an average loses in a tick, as 2³² per 1.
    pub step: i32,
    /// Place of a reading of 0, in 512ths; or the place below which there is a side.
    pub origin: i32,
    /// 512ths of a place per reading.
    pub gain: i32,
}

/// Variables that are not part of the motion.
#[derive(Clone, Copy)]
pub(super) struct Beside<R> {
    pub cycles: R,
    /// Temperature, °C.
    pub temperature: R,
}

impl<R: Real> Beside<R> {
    #[inline(always)]
    pub fn of(motion: &ClampedMotion<R>) -> Self {
        Self {
            cycles: motion.cycles(),
            temperature: motion.temperature(),
        }
    }
}

/// State of a residual table.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ResidualTableState {
    /// Kind of the variable, [`MemoryKind::Speed`] before the first tick. The work of a tick follows from it alone.
    kind: MemoryKind,
    /// Place on the tick before, or part of its cycle.
    previous: i32,
    /// Stretch, average, largest displacement or ticks.
    value: i32,
}

impl ResidualTableState {
    /// Empty, as before the first tick. All bits are 0.
    pub const NEW: Self = Self {
        kind: MemoryKind::Speed,
        previous: 0,
        value: 0,
    };

    /// Whether the state is of this kind.
    pub(super) fn is_of(&self, kind: MemoryKind) -> bool {
        self.kind == kind
    }
}

impl<R: Real> Recall<R> {
    pub const SPEED: Self = Self {
        kind: MemoryKind::Speed,
        rate: R::ZERO,
        step: 0,
        origin: 0,
        gain: 0,
    };

    /// `memory` from `low` to `high`, with places of which 8·4096 are ±`reach` mm, for a tick of `tick` s.
    ///
    /// # Errors
    /// As for [`super::ResidualTable::new`].
    pub fn new(
        memory: Memory<R>,
        [low, high]: [R; 2],
        reach: f64,
        tick: f64,
    ) -> Result<Self, ConfigError> {
        let most = limits::ACCELERATION;
        let low = in_range("low", low, -most, most)?.to_f64();
        let high = in_range("high", high, -most, most)?.to_f64();
        if low >= high {
            return Err(ConfigError::OutOfRange {
                field: "high",
                value: high,
                low,
                high: most,
            });
        }
        let loss = |time: R| -> Result<i32, ConfigError> {
            let time = in_range("time", time, 1e-6, 1e6)?.to_f64();
            Ok(
                (-libm::expm1(-tick / time.clamp(2.0 * tick, LONGEST * tick)) * 4_294_967_296.0)
                    as i32,
            )
        };
        let largest = f64::from(LARGEST_READING);
        let mut new = Self::SPEED;
        let mut per_reading = reach / f64::from(END);
        match memory {
            Memory::Slip { limit } => {
                let limit = in_range("limit", limit, 1e-9, limits::DISPLACEMENT)?.to_f64();
                let gain = f64::from(LAST_GAINED) * per_reading / (2.0 * limit);
                return Ok(Self {
                    kind: MemoryKind::Slip,
                    gain: gain.min(f64::from(LARGEST_GAIN_OF_SLIP)) as i32,
                    ..Self::SPEED
                });
            }
            Memory::Lag { time } => {
                new.kind = MemoryKind::Lag;
                new.step = loss(time)?;
            }
            Memory::Travel { time } => {
                new.kind = MemoryKind::Travel;
                new.step = loss(time)?;
                // Four times the last node stays below 2³¹.
                let rate = (f64::from(1 << 29) / high.max(1e-9)).min(limits::COEFFICIENT);
                new.rate = R::from_f64(rate);
                per_reading = f64::from(1 << AVERAGE) / rate;
            }
            Memory::Largest => new.kind = MemoryKind::Largest,
            Memory::Age { time } => {
                let time = in_range("time", time, 1e-6, 1e6)?.to_f64();
                new.kind = MemoryKind::Age;
                new.rate = R::from_f64(tick / time);
                per_reading = 1.0 / f64::from(ONE);
            }
            Memory::Temperature => {
                new.kind = MemoryKind::Temperature;
                per_reading = low.abs().max(high.abs()).max(1.0) / largest;
                new.rate = R::from_f64(1.0 / per_reading);
            }
            Memory::Place => new.kind = MemoryKind::Place,
            Memory::Sides { below, above } => {
                let most = limits::DISPLACEMENT;
                let below = in_range("below", below, -most, most)?;
                let above = in_range("above", above, below.to_f64(), most)?;
                let place = |edge: R| {
                    let place = edge.to_f64() / per_reading;
                    place.clamp(f64::from(-END), f64::from(END - 1)) as i32
                };
                return Ok(Self {
                    kind: MemoryKind::Sides,
                    step: place(above),
                    origin: place(below),
                    ..Self::SPEED
                });
            }
            Memory::Frequency { time } => {
                new.kind = MemoryKind::Frequency;
                new.step = loss(time)?;
                new.rate = R::from_f64(PER_CYCLE / tick);
                per_reading = 1.0 / f64::from(ONE);
            }
        }
        let (low, high) = (low / per_reading, high / per_reading);
        let gain = f64::from(LAST_GAINED) / (high - low);
        new.gain = gain.min(f64::from(LARGEST_GAIN)) as i32;
        // Two readings differ by less than 2¹⁷, so nothing overflows.
        new.origin = -(low.clamp(-largest, largest) as i32) * new.gain;
        Ok(new)
    }

    /// Checks that [`Self::new`] could give these numbers.
    ///
    /// # Errors
    /// The field that it could not give.
    pub fn check(&self) -> Result<(), ConfigError> {
        let in_range = |field, value: i32, [low, high]: [i32; 2]| {
            if (low..=high).contains(&value) {
                return Ok(());
            }
            Err(ConfigError::OutOfRange {
                field,
                value: f64::from(value),
                low: f64::from(low),
                high: f64::from(high),
            })
        };
        let unused = [0; 2];
        // Rate in R, step.
        let ([slowest, fastest], step) = match self.kind {
            MemoryKind::Speed | MemoryKind::Place | MemoryKind::Slip | MemoryKind::Largest => {
                ([0.0; 2], unused)
            }
            MemoryKind::Sides => ([0.0; 2], [-END, END - 1]),
            MemoryKind::Lag => ([0.0; 2], AVERAGED),
            MemoryKind::Travel => ([0.5, limits::COEFFICIENT], AVERAGED),
            MemoryKind::Age => ([1e-14, limits::COEFFICIENT], unused),
            MemoryKind::Temperature => ([1e-5, f64::from(LARGEST_READING)], unused),
            MemoryKind::Frequency => ([1e-14, limits::COEFFICIENT], AVERAGED),
        };
        self::in_range("rate", self.rate, slowest, fastest)?;
        in_range("step", self.step, step)?;
        let (origin, gain) = match self.kind {
            MemoryKind::Speed => (unused, unused),
            MemoryKind::Slip => (unused, [0, LARGEST_GAIN_OF_SLIP]),
            // The side below ends where the side above begins, or earlier.
            MemoryKind::Sides => ([-END, self.step], unused),
            _ => {
                let most = LARGEST_READING * self.gain.clamp(0, LARGEST_GAIN);
                ([-most, most], [0, LARGEST_GAIN])
            }
        };
        in_range("gain", self.gain, gain)?;
        in_range("origin", self.origin, origin)?;
        // It is the gain times the reading of the first node.
        let rest = self.origin.checked_rem(self.gain).unwrap_or_default();
        in_range("origin", self.origin, [self.origin - rest; 2])
    }

    /// Checks the number that counts cycles per second, for a tick of `tick` s.
    ///
    /// # Errors
    /// It is of another tick.
    pub fn check_tick(&self, tick: R) -> Result<(), ConfigError> {
        if self.kind == MemoryKind::Frequency {
            return is_of_tick("rate", self.rate, R::from_f64(PER_CYCLE) / tick);
        }
        Ok(())
    }

    /// Whether a state of `other`, over places of the same length, is valid here; the positions of the nodes may differ.
    pub fn is_like(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|recall| Self {
            origin: 0,
            gain: if recall.kind == MemoryKind::Slip {
                recall.gain
            } else {
                0
            },
            ..*recall
        });
        own == others
    }

    /// The state before the first tick.
    #[cold]
    #[inline(never)]
    pub fn begin(&self, across: i32, cycles: R) -> ResidualTableState {
        ResidualTableState {
            kind: self.kind,
            previous: match self.kind {
                MemoryKind::Frequency => part_of_cycle(cycles),
                _ => across,
            },
            value: match self.kind {
                MemoryKind::Lag => across << AVERAGE,
                MemoryKind::Slip => LAST_GAINED / 2,
                _ => 0,
            },
        }
    }

    /// The place among the nodes on this tick, for a place over displacement; `None` before the first tick. A limit that is a power
    /// of two takes one instruction.
    #[inline(always)]
    pub fn along(
        &self,
        state: &mut ResidualTableState,
        across: i32,
        velocity: R,
        beside: Beside<R>,
    ) -> Option<i32> {
        let ResidualTableState {
            kind,
            previous,
            value,
        } = *state;
        let toward = |target: i32| {
            let change = i64::from(target.wrapping_sub(value)) * i64::from(self.step);
            value.wrapping_add(((change + (1 << 31)) >> 32) as i32)
        };
        let reading = match kind {
            MemoryKind::Speed | MemoryKind::Place | MemoryKind::Sides => return None,
            MemoryKind::Slip => {
                state.previous = across;
                let moved = across.wrapping_sub(previous).wrapping_mul(self.gain);
                state.value = value.wrapping_add(moved).clamp(0, LAST_GAINED);
                return Some(state.value >> GAIN);
            }
            MemoryKind::Lag => {
                state.value = toward(across << AVERAGE);
                across - (state.value >> AVERAGE)
            }
            MemoryKind::Travel => {
                state.value = toward((velocity.abs() * self.rate).to_i32());
                state.value >> AVERAGE
            }
            MemoryKind::Largest => {
                state.value = value.max(across.abs());
                state.value
            }
            MemoryKind::Age => {
                state.value = value.saturating_add(1);
                octaves(R::from_i32(value) * self.rate + R::ONE).clamp(0, LARGEST_READING)
            }
            MemoryKind::Frequency => {
                let now = part_of_cycle(beside.cycles);
                state.previous = now;
                let passed = (now.wrapping_sub(previous) & (CYCLE - 1)) << AVERAGE;
                // The first cycles are not faster than those after.
                state.value = if value == 0 { passed } else { toward(passed) };
                within(octaves(R::from_i32(state.value) * self.rate))
            }
            MemoryKind::Temperature => within((beside.temperature * self.rate).to_i32()),
        };
        // Within (2·65536 − 1)·(2¹⁴ − 1) < 2³¹.
        let gained = reading.wrapping_mul(self.gain).wrapping_add(self.origin);
        Some((gained >> GAIN).clamp(0, LAST_NODE))
    }

    /// The first cell of the side that contains a place.
    #[inline(always)]
    pub fn side(&self, place: i32) -> Option<usize> {
        if place > self.step {
            Some(0)
        } else if place < self.origin {
            Some(NODES)
        } else {
            None
        }
    }
}

/// Part of the current cycle, in 65536ths.
#[inline(always)]
fn part_of_cycle<R: Real>(cycles: R) -> i32 {
    let part = cycles - R::from_i32(cycles.to_i32());
    (part * R::from_f64(f64::from(CYCLE))).to_i32()
}

/// Clamps a reading.
#[inline(always)]
fn within(value: i32) -> i32 {
    value.clamp(!LARGEST_READING, LARGEST_READING)
}

/// 4096·log₂, linear between powers of two.
#[inline(always)]
fn octaves<R: Real>(value: R) -> i32 {
    value.half_octaves() >> 1
}

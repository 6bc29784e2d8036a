//! What a correction remembers of the motion or is over beside it, in integers.

use super::{FRACTION, LAST, MIDDLE, ONE, SPEEDS};
use crate::effects::ConfinedMotion;
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// The last place over what is remembered.
const LAST_MEMORY: i32 = 4 * ONE - 1;
/// Readings are within ± this.
const LARGEST_READING: i32 = 0xffff;
/// A gain is in 1024ths of a place per reading.
const GAIN: u32 = 10;
const LARGEST_GAIN: i32 = 1 << 13;
/// Bits of an average below the last of a place.
const AVERAGE: u32 = 15;
/// Parts of a cycle that are told apart.
const CYCLE: i32 = 1 << 16;

/// What z is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Memory<R> {
    /// The stretch in mm of a spring that slips at `limit`: where the motion last turned, whatever its rate.
    Slip {
        /// mm, 1e-9…1e4
        limit: R,
    },
    /// The displacement less its average over `time`, mm.
    Lag {
        /// s, 1e-6…1e6; at least two ticks are taken.
        time: R,
    },
    /// The mean speed over `time`, mm/s.
    Travel {
        /// s, 1e-6…1e6; at least two ticks are taken.
        time: R,
    },
    /// The largest displacement so far to either side, mm.
    Largest,
    /// log₂(1 + t/`time`), t the time since the start, by straight lines between powers of two.
    Age {
        /// s, 1e-6…1e6
        time: R,
    },
    /// log₂(1 + n/`cycles`), n the cycles since the test began, likewise.
    Cycles {
        /// 0.01…1e9
        cycles: R,
    },
    /// The mean of |displacement| over `time`, mm: how wide the motion has been.
    Level {
        /// s, 1e-6…1e6; at least two ticks are taken.
        time: R,
    },
    /// The temperature that is measured, °C.
    Temperature,
    /// The acceleration, mm/s²: what the velocity has changed by since the tick before.
    Acceleration,
    /// Nothing: U is a line over displacement alone, once for each direction, of [`super::FINE`] nodes evenly over ±reach in
    /// the place of T's [`super::DISPLACEMENTS`]. It has the first so many of each direction's cells, the others are not read.
    Place,
    /// Nothing: U is a line over speed alone, of T's nodes, once for each direction, where the displacement lies above `above`,
    /// another where it lies below `below`, and 0 between: what touches on one side, or on both. Of each direction's cells it has
    /// the first [`super::SPEEDS`], and as many after them; the others are not read.
    Sides {
        /// mm, −1e4…1e4; at −`reach` or below there is no such side.
        below: R,
        /// mm, `below`…1e4; likewise at `reach`.
        above: R,
    },
    /// log₂ of the frequency in Hz, the cycles per second over `time`, by straight lines between powers of two.
    Frequency {
        /// s, 1e-6…1e6; at least two ticks are taken.
        time: R,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    None,
    Slip,
    Lag,
    Travel,
    Largest,
    Age,
    Cycles,
    Level,
    Temperature,
    Place,
    Sides,
    Frequency,
    Acceleration,
}

impl Kind {
    /// By their numbers in a pack.
    pub const ALL: [Self; 13] = [
        Self::None,
        Self::Slip,
        Self::Lag,
        Self::Travel,
        Self::Largest,
        Self::Age,
        Self::Cycles,
        Self::Level,
        Self::Temperature,
        Self::Place,
        Self::Sides,
        Self::Frequency,
        Self::Acceleration,
    ];
}

/// How z is remembered, and where it stands in its table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Recall<R> {
    pub kind: Kind,
    /// 1/time in ticks, 1/cycles, readings per °C, parts of a speed per mm/s, or Hz of an average of 1.
    pub rate: R,
    /// Slip limit in places, the place above which there is a side, or what an average loses in a tick, of 2³².
    pub step: i32,
    /// Bits of an average or of a change of speed that a reading leaves out.
    pub shift: i32,
    /// The reading of node 0, or the place below which there is a side.
    pub low: i32,
    /// 1024ths of a place per reading.
    pub gain: i32,
}

/// What U may be over beside the motion.
#[derive(Clone, Copy)]
pub(super) struct Beside<R> {
    pub cycles: R,
    /// °C
    pub temperature: R,
}

impl<R: Real> Beside<R> {
    #[inline(always)]
    pub fn of(motion: &ConfinedMotion<R>) -> Self {
        Self {
            cycles: motion.cycles(),
            temperature: motion.temperature(),
        }
    }
}

/// What a correction remembers.
#[derive(Clone, Copy, Debug, Default)]
pub struct CorrectionState {
    /// Place of the tick before, or part of its cycle, or its speed.
    previous: i32,
    /// Stretch, average, largest displacement or ticks.
    value: i32,
}

impl<R: Real> Recall<R> {
    pub const NONE: Self = Self {
        kind: Kind::None,
        rate: R::ZERO,
        step: 0,
        shift: 0,
        low: 0,
        gain: 0,
    };

    /// `memory` from `low` to `high`, over places of which ±`reach` mm are 8·4096, every `tick` s, of a motion of about `speed`
    /// mm/s at most.
    ///
    /// # Errors
    /// As for [`super::Correction::new`].
    pub fn new(
        memory: Memory<R>,
        [low, high]: [R; 2],
        [reach, speed]: [f64; 2],
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
            Ok((-libm::expm1(-tick / time.max(2.0 * tick)) * 4_294_967_296.0) as i32)
        };
        let largest = f64::from(LARGEST_READING);
        let mut new = Self::NONE;
        let mut per_reading = reach / f64::from(MIDDLE);
        match memory {
            Memory::Slip { limit } => {
                let limit = in_range("limit", limit, 1e-9, limits::DISPLACEMENT)?.to_f64();
                new.kind = Kind::Slip;
                new.step = ((limit / per_reading) as i32).clamp(1, LAST);
            }
            Memory::Lag { time } => {
                new.kind = Kind::Lag;
                new.step = loss(time)?;
            }
            Memory::Travel { time } => {
                new.kind = Kind::Travel;
                new.step = loss(time)?;
                per_reading /= tick;
                new.shift = AVERAGE as i32;
                // As fine as the largest reading allows.
                while new.shift > 0 && high / per_reading < f64::from(LARGEST_READING / 2) {
                    per_reading /= 2.0;
                    new.shift -= 1;
                }
            }
            Memory::Level { time } => {
                new.kind = Kind::Level;
                new.step = loss(time)?;
            }
            Memory::Largest => new.kind = Kind::Largest,
            Memory::Age { time } => {
                let time = in_range("time", time, 1e-6, 1e6)?.to_f64();
                new.kind = Kind::Age;
                new.rate = R::from_f64(tick / time);
                per_reading = 1.0 / f64::from(ONE);
            }
            Memory::Cycles { cycles } => {
                let cycles = in_range("cycles", cycles, 0.01, limits::CYCLES)?;
                new.kind = Kind::Cycles;
                new.rate = R::ONE / cycles;
                per_reading = 1.0 / f64::from(ONE);
            }
            Memory::Temperature => {
                new.kind = Kind::Temperature;
                per_reading = low.abs().max(high.abs()).max(1.0) / largest;
                new.rate = R::from_f64(1.0 / per_reading);
            }
            Memory::Acceleration => {
                new.kind = Kind::Acceleration;
                // Four times the largest speed of the tables is within 2³⁰.
                let rate = (f64::from(1 << 28) / speed).min(limits::COEFFICIENT);
                new.rate = R::from_f64(rate);
                per_reading = 1.0 / (rate * tick);
                let most = low.abs().max(high.abs());
                while new.shift < AVERAGE as i32 && most / per_reading > largest {
                    per_reading *= 2.0;
                    new.shift += 1;
                }
            }
            Memory::Place => new.kind = Kind::Place,
            Memory::Sides { below, above } => {
                let most = limits::DISPLACEMENT;
                let below = in_range("below", below, -most, most)?;
                let above = in_range("above", above, below.to_f64(), most)?;
                let place = |edge: R| {
                    let place = edge.to_f64() / per_reading + f64::from(MIDDLE);
                    place.clamp(0.0, f64::from(LAST)) as i32
                };
                return Ok(Self {
                    kind: Kind::Sides,
                    step: place(above),
                    low: place(below),
                    ..Self::NONE
                });
            }
            Memory::Frequency { time } => {
                new.kind = Kind::Frequency;
                new.step = loss(time)?;
                new.rate = R::from_f64(1.0 / (f64::from(CYCLE) * f64::from(1 << AVERAGE) * tick));
                per_reading = 1.0 / f64::from(ONE);
            }
        }
        let (low, high) = (low / per_reading, high / per_reading);
        new.low = low.clamp(-largest, largest) as i32;
        let gain = f64::from(LAST_MEMORY << GAIN) / (high - low);
        new.gain = gain.min(f64::from(LARGEST_GAIN)) as i32;
        Ok(new)
    }

    /// Whether these are numbers that [`Self::new`] could give.
    ///
    /// # Errors
    /// The field that is not.
    pub fn check(&self) -> Result<(), ConfigError> {
        let in_range = |field, value: i32, low: i32, high: i32| {
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
        self::in_range("rate", self.rate, 0.0, limits::COEFFICIENT)?;
        let most = if self.kind == Kind::Slip {
            LAST
        } else {
            i32::MAX
        };
        in_range("step", self.step, 0, most)?;
        in_range("shift", self.shift, 0, AVERAGE as i32)?;
        in_range("low", self.low, -LARGEST_READING, LARGEST_READING)?;
        in_range("gain", self.gain, 0, LARGEST_GAIN)
    }

    pub fn is_like(&self, other: &Self) -> bool {
        self.kind == other.kind
    }

    /// What is compared with the tick before: the displacement's place, the part of the cycle, or the velocity.
    #[inline(always)]
    pub fn now(&self, place: i32, velocity: R, cycles: R) -> i32 {
        match self.kind {
            Kind::Acceleration => (velocity * self.rate).to_i32(),
            Kind::Frequency => {
                let part = cycles - R::from_i32(cycles.to_i32());
                (part * R::from_f64(f64::from(CYCLE))).to_i32()
            }
            _ => place,
        }
    }

    /// Before the first tick.
    #[inline(always)]
    pub fn begin(&self, now: i32) -> CorrectionState {
        CorrectionState {
            previous: now,
            value: match self.kind {
                Kind::Lag => now << AVERAGE,
                _ => 0,
            },
        }
    }

    /// What is read on this tick, within ±[`LARGEST_READING`] or one less. Limits that are powers of two are one instruction.
    ///
    /// An average follows within a loss of 2⁻³²: over 60 s at 10 kHz it stands still within 6e-4 of the tables' range.
    #[inline(always)]
    pub fn reading(&self, state: &mut CorrectionState, now: i32, beside: Beside<R>) -> i32 {
        let value = state.value;
        let toward = |target: i32| {
            let change = i64::from(target.wrapping_sub(value)) * i64::from(self.step);
            value.wrapping_add((change >> 32) as i32)
        };
        let before = state.previous;
        state.previous = now;
        match self.kind {
            Kind::None | Kind::Place | Kind::Sides => 0,
            Kind::Slip => {
                let stretch = value.wrapping_add(now - before);
                state.value = stretch.min(self.step).max(-self.step);
                state.value
            }
            Kind::Lag => {
                state.value = toward(now << AVERAGE);
                now - (state.value >> AVERAGE)
            }
            Kind::Travel => {
                state.value = toward((now - before).abs() << AVERAGE);
                (state.value >> self.shift).clamp(0, LARGEST_READING)
            }
            Kind::Level => {
                state.value = toward((now - MIDDLE).abs() << AVERAGE);
                state.value >> AVERAGE
            }
            Kind::Largest => {
                state.value = value.max((now - MIDDLE).abs());
                state.value
            }
            Kind::Age => {
                state.value = value.saturating_add(1);
                self.age(R::from_i32(value))
            }
            Kind::Cycles => self.age(beside.cycles),
            Kind::Frequency => {
                let passed = (now.wrapping_sub(before) & (CYCLE - 1)) << AVERAGE;
                // The first cycles are no faster than those after.
                state.value = if value == 0 { passed } else { toward(passed) };
                within(octaves(R::from_i32(state.value) * self.rate))
            }
            Kind::Temperature => within((beside.temperature * self.rate).to_i32()),
            Kind::Acceleration => within(now.saturating_sub(before) >> self.shift),
        }
    }

    #[inline(always)]
    fn age(&self, elapsed: R) -> i32 {
        octaves(elapsed * self.rate + R::ONE).clamp(0, LARGEST_READING)
    }

    /// The first cell of the side that a place is on.
    #[inline(always)]
    pub fn side(&self, place: i32) -> Option<usize> {
        if place > self.step {
            Some(0)
        } else if place < self.low {
            Some(SPEEDS)
        } else {
            None
        }
    }

    /// Where a reading stands in the table.
    #[inline(always)]
    pub fn place(&self, reading: i32) -> i32 {
        // Within 2·65536·2¹³.
        let gained = (reading - self.low).wrapping_mul(self.gain);
        (gained >> GAIN).clamp(0, LAST_MEMORY)
    }

    /// The same as a part of the table's range, below 0 and above 1 outside.
    pub fn part(&self, reading: i32) -> f64 {
        let gained = f64::from(reading - self.low) * f64::from(self.gain);
        gained / f64::from(4 << (FRACTION + GAIN))
    }
}

/// A reading.
#[inline(always)]
fn within(value: i32) -> i32 {
    value.clamp(!LARGEST_READING, LARGEST_READING)
}

/// 4096·log₂ by straight lines between powers of two.
#[inline(always)]
fn octaves<R: Real>(value: R) -> i32 {
    value.half_octaves() >> 1
}

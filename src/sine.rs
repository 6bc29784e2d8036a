//! The excitation: a programme of sines and sweeps, with ramps between them.
//!
//! y(θ) = a(θ)·sin 2πθ, where θ counts the cycles. A block keeps a constant. Between two blocks, before the first and after the
//! last there are ramps of whole cycles. A ramp leads a from one amplitude to the next by the quintic 10s³ − 15s⁴ + 6s⁵, where s is
//! the completed part of the ramp. A block of n cycles thus has n cycles at full amplitude, and its ramps are additional.
//!
//! In a sweep, and in a ramp between two frequencies, the frequency is linear in the cycles: f = f₀ + k·θ. This is the logarithmic
//! sweep f = f₀·eᵏᵗ. One tick of length h advances θ by
//!
//! Δθ = (f₀/k + θ)·(eᵏʰ − 1),
//!
//! exactly, wherever in the tick the sweep began. Position, velocity and frequency are continuous throughout. The acceleration is
//! continuous too, except where a change of frequency begins or ends, where k jumps.

use core::borrow::Borrow;

use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer, halves, whole};
use crate::real::in_range;

/// Smallest amplitude, mm.
pub const AMPLITUDE_MIN: f64 = 1e-6;
/// Largest amplitude, mm.
pub const AMPLITUDE_MAX: f64 = 1e4;
/// Lowest frequency, Hz. The highest is a quarter of the tick rate.
pub const FREQUENCY_MIN: f64 = 1e-6;
/// Highest tick rate, Hz.
pub const TICK_RATE_MAX: f64 = 1e6;

const NODES: usize = 512;
const QUARTER: usize = NODES / 4;
const ENTRIES: usize = NODES + QUARTER + SECTOR_NODES;

/// sin at 512 nodes over the cycle, and at the further nodes that [`Sector`] reads, computed in f64. The cosine of a node is the
/// sine a quarter of a cycle further.
///
/// The nodes lie on the zeros and the extremes, which are exact. With nodes half a step away, the zero crossings would be a
/// difference of nearly equal numbers, and |v|^α would turn the error into percents of the peak force.
static SINE: [f32; ENTRIES] = sine_table();

const fn sine_table() -> [f32; ENTRIES] {
    let mut table = [0.0; ENTRIES];
    let mut i = 0;
    while i <= QUARTER {
        let value = quarter_sine(i, NODES) as f32;
        table[i] = value;
        table[NODES / 2 - i] = value;
        table[(NODES / 2 + i) % NODES] = -value;
        table[(NODES - i) % NODES] = -value;
        i += 1;
    }
    table[0] = 0.0;
    table[NODES / 2] = 0.0;
    let mut i = 0;
    while i < ENTRIES - NODES {
        table[NODES + i] = table[i];
        i += 1;
    }
    table
}

/// sin 2π·node/nodes in f64, for up to a quarter of the nodes.
pub(crate) const fn quarter_sine(node: usize, nodes: usize) -> f64 {
    let step = core::f64::consts::TAU / nodes as f64;
    // Up to an eighth of the cycle by the series of the sine, beyond it by that of the cosine: both converge fast there.
    if node <= nodes / 8 {
        let x = node as f64 * step;
        power_series(x, 1.0, x)
    } else {
        power_series((nodes / 4 - node) as f64 * step, 0.0, 1.0)
    }
}

/// first·(1 − x²/((n+1)(n+2)) + x⁴/(…) − …): the sine for n = 1, first = x, the cosine for n = 0, first = 1. The first omitted term
/// is below (π/4)²⁰/20! = 3e-21.
const fn power_series(x: f64, n: f64, first: f64) -> f64 {
    let (mut sum, mut term, mut n) = (first, first, n);
    let mut count = 0;
    while count < 10 {
        term *= -x * x / ((n + 1.0) * (n + 2.0));
        sum += term;
        n += 2.0;
        count += 1;
    }
    sum
}

/// sin and cos of `phase`, 2⁶⁴ per cycle. Each error is within 1e-7; near a zero it is within 2e-7 of the value or 1e-11, whichever
/// is larger.
///
/// The value at the nearest node is rotated by the remaining ±π/512 with three terms of the Taylor series; the omitted terms are
/// below (π/512)⁴/24 = 6e-11.
#[inline(always)]
pub fn sin_cos(phase: u64) -> (f32, f32) {
    // Adds half a node step, so that the nearest node is the one below, and half of the remainder's unit, to round it.
    let shifted = phase.wrapping_add((1 << 54) + (1 << 22));
    let node = (shifted >> 55) as usize;
    let remainder = ((shifted >> 23) as u32 ^ (1 << 31)) as i32;
    // 2⁴¹ units of the remainder per cycle.
    let x = remainder as f32 * (core::f64::consts::TAU / (1u64 << 41) as f64) as f32;
    let half_square = 0.5 * x * x;
    let turn = x - x * half_square * (1.0 / 3.0);
    let sin = SINE[node % NODES];
    let cos = SINE[node % NODES + QUARTER];
    (
        sin + (cos * turn - sin * half_square),
        cos - (sin * turn + cos * half_square),
    )
}

/// Sectors per cycle, each with a whole number of nodes.
pub(crate) const SECTORS: usize = 16;
const SECTOR_NODES: usize = NODES / SECTORS;
/// One sector, in units of the phase within it.
pub(crate) const SECTOR: u64 = 1 << 63;
/// Half of the unit to which [`Sector::sin_cos`] truncates the phase, so that it is rounded. A tick that misses the end of a sector
/// only by the rounding of its phase thus belongs to the next sector.
pub(crate) const SECTOR_ROUNDING: u64 = 1 << 31;

/// One sector's table: its nodes and those of the next sector, and their cosines, which lie a quarter of a cycle further.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sector(&'static [f32; 2 * SECTOR_NODES + QUARTER]);

impl Sector {
    /// The first sector.
    pub(crate) const FIRST: Self = match SINE.first_chunk() {
        Some(nodes) => Self(nodes),
        None => Self(&[0.0; _]),
    };

    /// Sector `index`, modulo the cycle.
    #[inline(always)]
    pub(crate) fn new(index: usize) -> Self {
        let first = index % SECTORS * SECTOR_NODES;
        Self(SINE[first..].first_chunk().unwrap_or(&[0.0; _]))
    }

    /// sin and cos at `phase` within the sector, [`SECTOR`] per sector.
    ///
    /// The value at the nearest node is rotated by the remaining ±π/512 = x with sin x ≈ x·(1 − (π/512)²/12) and cos x ≈ 1 − x²/2.
    /// The error is within 2e-8 of the sine's own cubic, and within 3.1e-6 of the value next to a zero, from which |v|^α makes at
    /// most 2.2e-7 of its peak.
    #[inline(always)]
    pub(crate) fn sin_cos(self, phase: u64) -> (f32, f32) {
        const NODE_BITS: u32 = SECTOR_NODES.ilog2();
        const HALF_STEP: f64 = core::f64::consts::PI / NODES as f64;
        const SCALE: f64 = HALF_STEP / (1u64 << 32) as f64 * (1.0 - HALF_STEP * HALF_STEP / 12.0);
        let upper = (phase >> 32) as u32;
        // Adds half a node step, so that the nearest node is the one below.
        let nearest = upper.wrapping_add(1 << (30 - NODE_BITS)) >> (31 - NODE_BITS);
        let nearest = nearest as usize % (2 * SECTOR_NODES);
        // Above half a node step the remainder is negative, from the next node.
        let remainder = (upper << (NODE_BITS + 1)) as i32;
        let half = remainder as f32 * SCALE as f32;
        let x = half + half;
        let (sin, cos) = (self.0[nearest], self.0[nearest + QUARTER]);
        (sin + x * (cos - half * sin), cos - x * (sin + half * cos))
    }
}

/// One block of a programme: whole cycles at one amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct Block {
    amplitude: f64,
    from: f64,
    to: f64,
    cycles: u32,
}

/// A [`Block`] as read, before it is validated.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename = "Block")]
struct Unchecked {
    amplitude: f64,
    from: f64,
    to: f64,
    cycles: u32,
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for Block {
    type Error = ConfigError;

    fn try_from(read: Unchecked) -> Result<Self, ConfigError> {
        Self::sweep(read.amplitude, read.from, read.to, read.cycles)
    }
}

impl Block {
    /// A sine.
    ///
    /// * `amplitude`: mm, [`AMPLITUDE_MIN`]…[`AMPLITUDE_MAX`]
    /// * `frequency`: Hz, [`FREQUENCY_MIN`] to a quarter of the programme's tick rate
    /// * `cycles`: at full amplitude, at least 1
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn sine(amplitude: f64, frequency: f64, cycles: u32) -> Result<Self, ConfigError> {
        Self::new(
            amplitude,
            ("frequency", frequency),
            ("frequency", frequency),
            cycles,
        )
    }

    /// A logarithmic sweep up or down: the frequency changes by the same factor in equal times. Units and ranges as in
    /// [`Block::sine`].
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn sweep(amplitude: f64, from: f64, to: f64, cycles: u32) -> Result<Self, ConfigError> {
        Self::new(amplitude, ("from", from), ("to", to), cycles)
    }

    fn new(
        amplitude: f64,
        from: (&'static str, f64),
        to: (&'static str, f64),
        cycles: u32,
    ) -> Result<Self, ConfigError> {
        let frequency = |(field, value)| in_range(field, value, FREQUENCY_MIN, TICK_RATE_MAX / 4.0);
        in_range("cycles", f64::from(cycles), 1.0, f64::from(u32::MAX))?;
        Ok(Self {
            amplitude: in_range("amplitude", amplitude, AMPLITUDE_MIN, AMPLITUDE_MAX)?,
            from: frequency(from)?,
            to: frequency(to)?,
            cycles,
        })
    }

    /// Amplitude, mm.
    pub fn amplitude(&self) -> f64 {
        self.amplitude
    }
    /// Frequency at the start, Hz.
    pub fn from(&self) -> f64 {
        self.from
    }
    /// Frequency at the end, Hz: that at the start unless the block is a sweep.
    pub fn to(&self) -> f64 {
        self.to
    }
    /// Cycles at full amplitude.
    pub fn cycles(&self) -> u32 {
        self.cycles
    }
}

/// Whole cycles with one function for amplitude and one for frequency, as the generator runs through them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Segment {
    cycles: u32,
    /// Cycles per tick at θ = 0, 2¹²⁸ per cycle.
    increment: u128,
    /// eᵏʰ − 1, 2⁶⁴ per 1: each completed cycle adds this to the increment.
    growth: i64,
    /// Frequency at θ = 0, Hz.
    frequency: f32,
    /// Frequency at the end, Hz.
    frequency_end: f32,
    /// k, Hz per cycle travelled.
    chirp: f32,
    /// Amplitude at θ = 0, mm.
    amplitude: f32,
    /// Amplitude at the end minus amplitude at the start, mm.
    rise: f32,
    /// 1 / cycles.
    inverse_length: f32,
    /// ω at θ = 0, rad/s.
    angular: f32,
    /// Neither amplitude nor frequency changes.
    steady: bool,
}

impl Segment {
    const EMPTY: Self = Self {
        cycles: 0,
        increment: 0,
        growth: 0,
        frequency: 0.0,
        frequency_end: 0.0,
        chirp: 0.0,
        amplitude: 0.0,
        rise: 0.0,
        inverse_length: 0.0,
        angular: 0.0,
        steady: false,
    };

    fn new(amplitude: (f64, f64), frequency: (f64, f64), cycles: u32, tick_rate: f64) -> Self {
        let chirp = (frequency.1 - frequency.0) / f64::from(cycles);
        let kh = chirp / tick_rate;
        let factor = libm::expm1(kh);
        Self {
            cycles,
            increment: if kh == 0.0 {
                increment(frequency.0, tick_rate)
            } else {
                let step = frequency.0 / tick_rate * (factor / kh);
                fraction(step)
            },
            growth: (factor * (1u128 << 64) as f64) as i64,
            frequency: frequency.0 as f32,
            frequency_end: frequency.1 as f32,
            chirp: chirp as f32,
            amplitude: amplitude.0 as f32,
            rise: (amplitude.1 - amplitude.0) as f32,
            inverse_length: (1.0 / f64::from(cycles)) as f32,
            angular: (core::f64::consts::TAU * frequency.0) as f32,
            steady: kh == 0.0 && amplitude.0 == amplitude.1,
        }
    }

    /// Phase increment of one tick after `travelled` cycles and `phase`.
    #[inline(always)]
    fn step(&self, travelled: u32, phase: u128) -> u128 {
        if self.growth == 0 {
            return self.increment;
        }
        // The product of 2⁶⁴ per cycle and 2⁶⁴ per 1. Whole turns of it drop out, because the step is less than half a cycle.
        let theta = ((i128::from(travelled) << 64) | i128::from((phase >> 64) as u64))
            - (ROUNDING >> 64) as i128;
        self.increment
            .wrapping_add(i128::from(self.growth).wrapping_mul(theta) as u128)
    }

    /// Frequency in Hz, computed from the end with the lower frequency: a sum of positive terms, each with the relative accuracy of
    /// a float. From the higher end the low frequencies would be small differences.
    #[inline(always)]
    fn frequency(&self, travelled: u32, phase: u32) -> f32 {
        if self.chirp < 0.0 {
            // One whole cycle minus the phase, as an integer, so that no digits are lost.
            let rest = (!phase as f32 + 1.0) * CYCLES_PER_UNIT;
            let ahead = self.cycles.wrapping_sub(travelled).wrapping_sub(1) as f32 + rest;
            self.frequency_end - self.chirp * ahead
        } else {
            self.frequency + self.chirp * (travelled as f32 + phase as f32 * CYCLES_PER_UNIT)
        }
    }

    /// Position, velocity and acceleration where amplitude or frequency changes, after `travelled` cycles and the phase in
    /// `excitation`.
    #[inline]
    fn changing(&self, travelled: u32, sin: f32, cos: f32, excitation: &mut Excitation) {
        use core::f32::consts::TAU;
        let theta = travelled as f32 + excitation.phase as f32 * CYCLES_PER_UNIT;
        let frequency = self.frequency(travelled, excitation.phase);
        let angular = TAU * frequency;
        let angular_rate = TAU * self.chirp * frequency;
        // s and its first two time derivatives.
        let part = theta * self.inverse_length;
        let part = if part > 1.0 { 1.0 } else { part };
        let part_rate = frequency * self.inverse_length;
        let part_acceleration = self.chirp * part_rate;
        // 10s³ − 15s⁴ + 6s⁵ and its first two derivatives.
        let rest = 1.0 - part;
        let lower_half = |s: f32| s * s * s * (10.0 - s * (15.0 - 6.0 * s));
        // Above one half by symmetry, where the difference of the terms would lose digits.
        let step = if part > 0.5 {
            1.0 - lower_half(rest)
        } else {
            lower_half(part)
        };
        let slope = 30.0 * part * part * rest * rest;
        let curvature = 60.0 * part * rest * (rest - part);
        let a = self.amplitude + self.rise * step;
        let a_rate = self.rise * slope * part_rate;
        let a_acceleration =
            self.rise * (curvature * part_rate * part_rate + slope * part_acceleration);
        excitation.displacement = a * sin;
        excitation.velocity = a_rate * sin + a * angular * cos;
        excitation.acceleration = (a_acceleration - a * angular * angular) * sin
            + (2.0 * a_rate * angular + a * angular_rate) * cos;
    }
}

/// Duration of `cycles` in s while the frequency changes from `from` to `to`.
fn duration(from: f64, to: f64, cycles: u32) -> f64 {
    let change = (to - from) / from;
    // ln(1 + x)/x, which is 1 for a constant frequency.
    let slowing = if change == 0.0 {
        1.0
    } else {
        libm::log1p(change) / change
    };
    f64::from(cycles) / from * slowing
}

/// `part` of a cycle, below 1, in units of 2⁻¹²⁸, rounded down, with the last bit cleared. Computed in two digits of 64 bits, each
/// exact, because a direct cast from f64 to u128 is a function that the C libraries of 32-bit targets lack.
fn fraction(part: f64) -> u128 {
    const DIGIT: f64 = (1u128 << 64) as f64;
    let scaled = part * DIGIT;
    let high = scaled as u64;
    let low = ((scaled - high as f64) * DIGIT) as u64;
    (u128::from(high) << 64 | u128::from(low)) & !1
}

/// frequency/tick_rate · 2¹²⁸, rounded down from the exact quotient of the two floats. Needs frequency < tick_rate/2.
pub(crate) fn increment(frequency: f64, tick_rate: f64) -> u128 {
    // Both are normal and positive: mantissa · 2^exponent.
    let split = |value: f64| {
        let bits = value.to_bits();
        let mantissa = (bits & ((1 << 52) - 1)) | (1 << 52);
        (u128::from(mantissa), (bits >> 52) as u32)
    };
    let ((n, n_exponent), (d, d_exponent)) = (split(frequency), split(tick_rate));
    let divide = |value: u128| {
        (
            value.checked_div(d).unwrap_or(0),
            value.checked_rem(d).unwrap_or(0),
        )
    };
    // Long division with digits of 64 bits: n·2¹²⁷/d.
    let (high, rest) = divide(n << 63);
    let (low, _) = divide(rest << 64);
    let quotient = (high << 64) | low;
    let shift = d_exponent.saturating_sub(n_exponent).saturating_sub(1);
    quotient.checked_shr(shift).unwrap_or(0)
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Planned {
    block: Block,
    ramp: Segment,
    steady: Segment,
}

/// A [`Programme`] without its blocks: the part of it that goes over a link first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgrammeHead {
    tick_rate: f64,
    ramp_cycles: u32,
    to_rest: Segment,
    duration: f64,
}

/// A block of a [`Programme`] with the ramp before it, as it goes over a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedBlock(Planned);

impl Fields for Segment {
    fn write(&self, writer: &mut Writer<'_>) {
        let [low, high] = [self.increment as u64, (self.increment >> 64) as u64].map(halves);
        let growth = halves(self.growth as u64);
        writer.words([
            self.cycles,
            low[0],
            low[1],
            high[0],
            high[1],
            growth[0],
            growth[1],
        ]);
        let floats = [
            self.frequency,
            self.frequency_end,
            self.chirp,
            self.amplitude,
            self.rise,
            self.inverse_length,
            self.angular,
        ];
        writer.words(floats.map(f32::to_bits));
        writer.words([u32::from(self.steady)]);
    }

    #[inline(never)]
    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [cycles, a, b, c, d, growth_low, growth_high] = reader.words()?;
        let floats = reader.words()?.map(f32::from_bits);
        let [
            frequency,
            frequency_end,
            chirp,
            amplitude,
            rise,
            inverse_length,
            angular,
        ] = floats;
        if !floats.iter().all(|value| value.is_finite()) {
            return None;
        }
        Some(Self {
            cycles,
            increment: u128::from(whole([a, b])) | u128::from(whole([c, d])) << 64,
            growth: whole([growth_low, growth_high]) as i64,
            frequency,
            frequency_end,
            chirp,
            amplitude,
            rise,
            inverse_length,
            angular,
            steady: reader.u32()? != 0,
        })
    }
}

impl Fields for ProgrammeHead {
    fn write(&self, writer: &mut Writer<'_>) {
        writer.words(halves(self.tick_rate.to_bits()));
        writer.words(halves(self.duration.to_bits()));
        writer.u32(self.ramp_cycles);
        self.to_rest.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            tick_rate: f64::from_bits(whole(reader.words()?)),
            duration: f64::from_bits(whole(reader.words()?)),
            ramp_cycles: reader.u32()?,
            to_rest: Segment::read(reader)?,
        })
    }
}

impl Fields for PlannedBlock {
    fn write(&self, writer: &mut Writer<'_>) {
        let Planned {
            block,
            ramp,
            steady,
        } = &self.0;
        for value in [block.amplitude, block.from, block.to] {
            writer.words(halves(value.to_bits()));
        }
        writer.u32(block.cycles);
        ramp.write(writer);
        steady.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let mut value = || reader.words().map(whole).map(f64::from_bits);
        let (amplitude, from, to) = (value()?, value()?, value()?);
        Some(Self(Planned {
            block: Block {
                amplitude,
                from,
                to,
                cycles: reader.u32()?,
            },
            ramp: Segment::read(reader)?,
            steady: Segment::read(reader)?,
        }))
    }
}

/// Up to `N` blocks with the ramps around them.
///
/// A target without f64 receives one in parts: its [`Programme::head`] and its [`Programme::planned`] blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Programme<const N: usize> {
    tick_rate: f64,
    ramp_cycles: u32,
    planned: heapless::Vec<Planned, N>,
    /// The ramp after the last block.
    to_rest: Segment,
    duration: f64,
}

#[cfg(feature = "defmt")]
impl<const N: usize> defmt::Format for Programme<N> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(
            f,
            "Programme {{ tick_rate: {=f64}, ramp_cycles: {=u32}, blocks: {=usize} }}",
            self.tick_rate,
            self.ramp_cycles,
            self.planned.len()
        );
        for planned in &self.planned {
            defmt::write!(f, " {}", planned.block);
        }
    }
}

impl<const N: usize> Programme<N> {
    /// A programme without blocks.
    ///
    /// * `tick_rate`: Hz, 1…[`TICK_RATE_MAX`]
    /// * `ramp_cycles`: cycles of each ramp, at least 1. A ramp has the frequency of its block, or changes from the frequency of
    ///   one block to that of the next.
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(tick_rate: f64, ramp_cycles: u32) -> Result<Self, ConfigError> {
        in_range(
            "ramp_cycles",
            f64::from(ramp_cycles),
            1.0,
            f64::from(u32::MAX),
        )?;
        Ok(Self {
            tick_rate: in_range("tick_rate", tick_rate, 1.0, TICK_RATE_MAX)?,
            ramp_cycles,
            ..Self::empty()
        })
    }

    /// A programme that takes no block before [`Programme::begin_planned`]. All bits are 0, so that it takes no flash in a static.
    pub const fn empty() -> Self {
        Self {
            tick_rate: 0.0,
            ramp_cycles: 0,
            planned: heapless::Vec::new(),
            to_rest: Segment::EMPTY,
            duration: 0.0,
        }
    }

    /// Adds one block at the end.
    ///
    /// # Errors
    /// [`ConfigError::OutOfRange`] if a frequency exceeds a quarter of the tick rate, [`ConfigError::Full`] if the programme has
    /// `N` blocks already.
    pub fn with(mut self, block: Block) -> Result<Self, ConfigError> {
        for (field, frequency) in [("from", block.from), ("to", block.to)] {
            let field = if block.from == block.to {
                "frequency"
            } else {
                field
            };
            in_range(field, frequency, FREQUENCY_MIN, self.tick_rate / 4.0)?;
        }
        let segment = |amplitude, frequency, cycles| {
            Segment::new(amplitude, frequency, cycles, self.tick_rate)
        };
        let (amplitude, frequency) = match self.planned.last() {
            Some(last) => (last.block.amplitude, last.block.to),
            None => (0.0, block.from),
        };
        let planned = Planned {
            block,
            ramp: segment(
                (amplitude, block.amplitude),
                (frequency, block.from),
                self.ramp_cycles,
            ),
            steady: segment(
                (block.amplitude, block.amplitude),
                (block.from, block.to),
                block.cycles,
            ),
        };
        let to_rest = segment(
            (block.amplitude, 0.0),
            (block.to, block.to),
            self.ramp_cycles,
        );
        self.planned.push(planned).map_err(|_| ConfigError::Full {
            field: "blocks",
            capacity: N,
        })?;
        self.to_rest = to_rest;
        self.duration += duration(frequency, block.from, self.ramp_cycles)
            + duration(block.from, block.to, block.cycles);
        Ok(self)
    }

    /// Everything except the blocks.
    pub fn head(&self) -> ProgrammeHead {
        ProgrammeHead {
            tick_rate: self.tick_rate,
            ramp_cycles: self.ramp_cycles,
            to_rest: self.to_rest,
            duration: self.duration,
        }
    }

    /// The blocks with their ramps, in order.
    pub fn planned(&self) -> impl ExactSizeIterator<Item = PlannedBlock> {
        self.planned.iter().copied().map(PlannedBlock)
    }

    /// Replaces this programme with that of `head`, without its blocks.
    pub fn begin_planned(&mut self, head: &ProgrammeHead) {
        self.tick_rate = head.tick_rate;
        self.ramp_cycles = head.ramp_cycles;
        self.to_rest = head.to_rest;
        self.duration = head.duration;
        self.planned.clear();
    }

    /// Adds the next block of the programme to which `head` belongs.
    ///
    /// # Errors
    /// [`ConfigError::Full`] if the programme has `N` blocks already.
    pub fn push_planned(&mut self, block: &PlannedBlock) -> Result<(), ConfigError> {
        self.planned.push(block.0).map_err(|_| ConfigError::Full {
            field: "blocks",
            capacity: N,
        })
    }

    /// Ticks per second.
    pub fn tick_rate(&self) -> f64 {
        self.tick_rate
    }

    /// Cycles of each ramp.
    pub fn ramp_cycles(&self) -> u32 {
        self.ramp_cycles
    }

    /// The blocks, in order.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = &Block> {
        self.planned.iter().map(|planned| &planned.block)
    }

    /// Time from rest to rest, s.
    pub fn duration(&self) -> f64 {
        match self.planned.last() {
            Some(last) => self.duration + duration(last.block.to, last.block.to, self.ramp_cycles),
            None => 0.0,
        }
    }
}

/// Demand of the generator at one tick. Velocity and acceleration are the time derivatives of the position, also in ramps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Excitation {
    /// Position, mm.
    pub displacement: f32,
    /// Velocity, mm/s.
    pub velocity: f32,
    /// Acceleration, mm/s².
    pub acceleration: f32,
    /// Phase, 2³² per cycle, rounded to the nearest.
    pub phase: u32,
    /// Cycles completed since the start, ramps included.
    pub cycle: u32,
    /// Index of the block: in a ramp that of the block ahead, in the final ramp and after it that of the last block.
    pub block: usize,
    /// Whether the tick is in a ramp.
    pub ramp: bool,
    /// Whether a cycle ended since the tick before, so that this tick is the first of the next cycle.
    pub cycle_end: bool,
    /// Whether the programme is over; everything stays at 0.
    pub done: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Ramp,
    Steady,
    ToRest,
    Done,
}

/// Runs through a [`Programme`], tick by tick.
///
/// The phase is an integer, 2¹²⁸ per cycle. The increment of a constant frequency is exact to one unit, so that after n ticks the
/// phase is within n units of the exact quotient: after 10¹⁰ ticks (10⁶ cycles of 1 Hz at 10 kHz) within 3e-29 of a cycle.
#[derive(Clone, Debug)]
pub struct SineGenerator<const N: usize, P = Programme<N>> {
    programme: P,
    at: Place,
}

/// A block of constant amplitude and frequency that has begun, for callers that compute its ticks by other means.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SteadyBlock {
    /// Amplitude, mm.
    pub(crate) amplitude: f32,
    /// ω, rad/s.
    pub(crate) angular: f32,
    /// Whole cycles.
    pub(crate) cycles: u32,
    /// Phase of its first tick, 2¹²⁸ per cycle.
    pub(crate) phase: u128,
    /// Increment of the phase per tick, 2¹²⁸ per cycle.
    pub(crate) increment: u128,
}

/// Position of the generator in the programme.
#[derive(Clone, Copy, Debug)]
struct Place {
    segment: Segment,
    stage: Stage,
    block: usize,
    /// Phase, with [`ROUNDING`] added.
    phase: u128,
    /// Cycles completed in this segment.
    travelled: u32,
    cycle: u32,
    cycle_end: bool,
}

/// Half a unit of [`Excitation::phase`], so that its upper 32 bits are rounded to the nearest. A tick that misses the end of a
/// cycle only by the rounding of a decimal frequency thus belongs to the next cycle.
const ROUNDING: u128 = 1 << 95;

/// Cycles per unit of [`Excitation::phase`].
const CYCLES_PER_UNIT: f32 = 1.0 / (1u64 << 32) as f32;

impl Place {
    fn start(first: Segment) -> Self {
        Self {
            segment: first,
            stage: Stage::Ramp,
            block: 0,
            phase: ROUNDING,
            travelled: 0,
            cycle: 0,
            cycle_end: false,
        }
    }
}

impl<const N: usize, P: Borrow<Programme<N>>> SineGenerator<N, P> {
    /// A generator at rest, at the start of `programme`, which is the programme itself or a reference to it.
    ///
    /// # Errors
    /// [`ConfigError::Empty`] for a programme without a block.
    pub fn new(programme: P) -> Result<Self, ConfigError> {
        let first = programme
            .borrow()
            .planned
            .first()
            .ok_or(ConfigError::Empty("blocks"))?
            .ramp;
        Ok(Self {
            programme,
            at: Place::start(first),
        })
    }

    /// The programme.
    pub fn programme(&self) -> &Programme<N> {
        self.programme.borrow()
    }

    /// Returns to the start of the programme, at rest.
    pub fn restart(&mut self) {
        if let Some(first) = self.programme.borrow().planned.first() {
            self.at = Place::start(first.ramp);
        }
    }

    /// The excitation at this tick; the first call gives the start, at rest. After the end it stays at 0.
    #[inline]
    pub fn tick(&mut self) -> Excitation {
        let at = &self.at;
        let mut excitation = Excitation {
            phase: (at.phase >> 96) as u32,
            cycle: at.cycle,
            block: at.block,
            ramp: matches!(at.stage, Stage::Ramp | Stage::ToRest),
            cycle_end: at.cycle_end,
            done: at.stage == Stage::Done,
            ..Excitation::default()
        };
        if excitation.done {
            self.at.cycle_end = false;
            return excitation;
        }
        let (sin, cos) = sin_cos((at.phase.wrapping_sub(ROUNDING) >> 64) as u64);
        let segment = &at.segment;
        if segment.steady {
            excitation.displacement = segment.amplitude * sin;
            let speed = segment.amplitude * segment.angular;
            excitation.velocity = speed * cos;
            excitation.acceleration = -(speed * segment.angular) * sin;
        } else {
            segment.changing(at.travelled, sin, cos, &mut excitation);
        }
        self.advance();
        excitation
    }

    /// The steady block that began with the last tick's excitation, if one did.
    pub(crate) fn steady_begun(&self) -> Option<SteadyBlock> {
        let at = &self.at;
        if at.stage != Stage::Steady || !at.segment.steady || at.travelled > 0 || at.cycle_end {
            return None;
        }
        let segment = &at.segment;
        // The generator is one tick ahead; its phase shows that the block began with the tick before.
        let phase = at.phase.checked_sub(segment.increment)?;
        (phase < segment.increment).then_some(SteadyBlock {
            amplitude: segment.amplitude,
            angular: segment.angular,
            cycles: segment.cycles,
            phase: phase.saturating_sub(ROUNDING),
            increment: segment.increment,
        })
    }

    /// Skips to the end of the current steady block, and `past` into the next cycle, 2¹²⁸ per cycle: the next tick is there.
    pub(crate) fn steady_ended(&mut self, past: u128) {
        let at = &mut self.at;
        at.cycle = at.cycle.wrapping_add(at.segment.cycles);
        at.phase = past.wrapping_add(ROUNDING);
        at.cycle_end = true;
        self.next_segment();
    }

    #[inline]
    fn advance(&mut self) {
        let at = &mut self.at;
        let (phase, wrapped) = at
            .phase
            .overflowing_add(at.segment.step(at.travelled, at.phase));
        at.phase = phase;
        at.cycle_end = wrapped;
        if wrapped {
            at.cycle = at.cycle.wrapping_add(1);
            at.travelled = at.travelled.wrapping_add(1);
            if at.travelled >= at.segment.cycles {
                self.next_segment();
            }
        }
    }

    /// Continues in the next segment, with the phase that is already past the end of this one.
    fn next_segment(&mut self) {
        let programme = self.programme.borrow();
        let planned = &programme.planned;
        let at = &mut self.at;
        let (stage, block, segment) =
            match (at.stage, planned.get(at.block), planned.get(at.block + 1)) {
                (Stage::Ramp, Some(this), _) => (Stage::Steady, at.block, Some(this.steady)),
                (Stage::Steady, _, Some(next)) => (Stage::Ramp, at.block + 1, Some(next.ramp)),
                (Stage::Steady, _, None) => (Stage::ToRest, at.block, Some(programme.to_rest)),
                _ => (Stage::Done, at.block, None),
            };
        at.stage = stage;
        at.block = block;
        at.travelled = 0;
        match segment {
            Some(segment) => {
                let past = (at.phase >> 96) as u32 as f32 * CYCLES_PER_UNIT;
                // The time past the boundary is the same before and after it, but the rate of change of frequency is not: k'·f·t²/2
                // − k·f·t²/2 with t = past/f. The omitted terms are of third order in the tick.
                let correction =
                    (segment.chirp - at.segment.chirp) * past * past / (2.0 * segment.frequency);
                let correction = (correction * (1u64 << 63) as f32) as i64;
                at.phase = at
                    .phase
                    .wrapping_add(((i128::from(correction)) << 65) as u128);
                at.segment = segment;
            }
            None => at.phase = ROUNDING,
        }
    }
}

#[cfg(test)]
mod tests;

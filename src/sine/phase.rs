//! A table and a short series give the sine and cosine of an integer phase.

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

//! sin and cos in integers.

use crate::sine::quarter_sine;

const NODES: usize = 256;

/// sin at 256 nodes over the cycle, 2³⁰ per 1, computed in f64. As in [`crate::sine`] zeros and extremes are nodes.
static SINE: [i32; NODES] = sine_table();

const fn sine_table() -> [i32; NODES] {
    let mut table = [0; NODES];
    let mut i = 0;
    while i <= NODES / 4 {
        let value = (quarter_sine(i, NODES) * (1u32 << 30) as f64 + 0.5) as i32;
        table[i] = value;
        table[NODES / 2 - i] = value;
        table[(NODES / 2 + i) % NODES] = -value;
        table[(NODES - i) % NODES] = -value;
        i += 1;
    }
    table
}

/// sin and cos of `phase`, 2³² per cycle, 2³⁰ per 1, each with an error within 1.6e-6; exact at 0.
///
/// The value at the nearest node is rotated by the remaining angle x of up to π/256 with two terms of the Taylor series. The
/// omitted terms are below (π/256)³/6 = 3e-7, and the rest of the error is rounding.
#[inline(always)]
pub(super) fn sin_cos(phase: u32) -> (i32, i32) {
    // Adds half a node step, so that the nearest node is the one below.
    let shifted = phase.wrapping_add(1 << 23);
    let node = (shifted >> 24) as usize;
    // 2¹⁶ per half step; times π/4 it has 2²² per 1.
    let remainder = ((shifted << 8) ^ (1 << 31)) as i32 >> 15;
    let x = (remainder * QUARTER_PI) >> 15;
    let sin = SINE[node % NODES];
    let cos = SINE[(node + NODES / 4) % NODES];
    // 2¹⁵ per 1: the mean slope over x, from the node's own slope.
    let mean_cos = (cos >> 15) - (((sin >> 15) * x) >> 23);
    let mean_sin = (sin >> 15) + (((cos >> 15) * x) >> 23);
    (sin + ((mean_cos * x) >> 7), cos - ((mean_sin * x) >> 7))
}

/// π/4, 2¹⁵ per 1.
const QUARTER_PI: i32 = (core::f64::consts::FRAC_PI_4 * (1 << 15) as f64 + 0.5) as i32;

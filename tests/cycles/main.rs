//! The sine generator and the cycle accumulator.

mod cycle;
mod sine;

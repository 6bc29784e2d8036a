//! The sine generator and the cycle accumulator.

mod crossing;
mod cycle;
mod rounding;
mod sine;
mod support;

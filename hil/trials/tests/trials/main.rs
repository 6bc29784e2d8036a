//! The results of the trials.

mod averaging;
mod bench;
mod blind;
mod bouc_wen;
mod conditions;
mod cost_of_effects;
#[path = "../../../link/tests/emulated/mod.rs"]
mod emulated;
mod intervals;
mod motions;

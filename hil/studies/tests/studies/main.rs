//! The results of the studies.

mod amplitude_independent;
mod averaging;
mod bench;
mod blind;
mod bouc_wen;
mod cost_of_effects;
mod design;
#[path = "../../../link/tests/emulated/mod.rs"]
mod emulated;
mod intervals;
mod motions;
mod orthogonal;
mod surfaces;

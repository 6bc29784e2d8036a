//! The results of the recomputed paper.

mod amplitude_independent;
mod design;
mod orthogonal;
mod surfaces;

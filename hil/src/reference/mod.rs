//! The paper's equations in `f64`, straight from its text. Shares no code with the crate, so that it can be its oracle.

pub mod law;
pub mod tables;

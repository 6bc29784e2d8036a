//! The paper's equations in `f64`, straight from its text. Shares no code with the crate, so that it can be its oracle.
//!
//! Equations 8–12 (finite elements) are in [`crate::finite_element`].

pub mod comparison;
pub mod cubic_fit;
pub mod dynamic_test;
pub mod law;
pub mod orthogonal_test;
pub mod static_test;
pub mod surfaces;
pub mod tables;
pub mod turn;

//! Identification: coefficients of eq 13 and of added effects from recorded motion and force.

mod basis;
pub(crate) mod beyond_noise;
pub mod correction;
mod exact;
mod known_forces;
mod moved;
mod normal;
pub mod problem;
pub mod rows;
pub mod screen;
pub mod shape;
pub mod solution;
pub mod staged;
mod tangent;
pub mod term;
pub mod uncertainty;

//! Identification: coefficients of eq 13 and of added effects from recorded motion and force.

pub mod problem;
pub mod rows;
pub mod solution;
pub mod staged;
pub mod term;
pub mod uncertainty;

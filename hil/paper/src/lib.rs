//! The paper, recomputed. Each module answers one question about it.
//!
//! | module | question |
//! |---|---|
//! | [`mod@claims`] | does every table, equation and claim of the paper hold, recomputed? |
//! | [`mod@finite_element`] | what do the finite elements give that the paper compares with its law? |
//! | [`mod@orthogonal`] | which factor of a test matters, and can the data show it? |
//! | [`mod@surfaces`] | how good are the published coefficients as surfaces over density and amplitude? |
//! | [`mod@amplitude_independent`] | how good is one law for every amplitude on the published loops? |
//! | [`mod@design`] | which density gives a stiffness and a loss factor? |
//!
//! ```
//! use mesh_damper_paper::design::{DesignError, Wanted, design};
//!
//! let solution = &design(&Wanted::new(4.0, 0.3)?)?.solutions[0];
//! assert!((2.0..4.0).contains(&solution.point.density), "g/cm³");
//! # Ok::<(), DesignError>(())
//! ```
#![forbid(unsafe_code)]

pub mod amplitude_independent;
pub mod claims;
pub mod design;
pub mod finite_element;
mod nonnegative;
pub mod orthogonal;
pub mod surfaces;

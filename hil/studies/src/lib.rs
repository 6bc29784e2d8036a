//! Studies of the metal mesh damper. Each answers one question with the other crates.
//!
//! | module | question |
//! |---|---|
//! | [`mod@paper`] | does every table, equation and claim of the paper hold, recomputed? |
//! | [`mod@finite_element`] | what do the finite elements give that the paper compares with its law? |
//! | [`mod@orthogonal`] | which factor of a test matters, and can the data show it? |
//! | [`mod@surfaces`] | how good are the published coefficients as surfaces over density and amplitude? |
//! | [`mod@amplitude_independent`] | how good is one law for every amplitude on the published loops? |
//! | [`mod@design`] | which density gives a stiffness and a loss factor? |
//! | [`mod@blind`] | does a trace name effects that it does not know? |
//! | [`mod@bouc_wen`] | does a trace find the oscillator of the Bouc–Wen benchmark? |
//! | [`size`] | how much time and memory does a trace take? |
//! | [`numbers`] | how much does each policy number matter? |
//! | [`mod@bench`] | how many instructions does the crate take, compared to its peers? |
//!
//! ```
//! use mesh_damper_studies::design::{DesignError, Wanted, design};
//!
//! let solution = &design(&Wanted::new(4.0, 0.3)?)?.solutions[0];
//! assert!((2.0..4.0).contains(&solution.point.density), "g/cm³");
//! # Ok::<(), DesignError>(())
//! ```
#![forbid(unsafe_code)]

pub mod amplitude_independent;
pub mod bench;
pub mod blind;
pub mod bouc_wen;
pub mod design;
pub mod finite_element;
mod nonnegative;
pub mod numbers;
pub mod orthogonal;
pub mod paper;
pub mod size;
pub mod surfaces;

//! Studies of the metal mesh damper, each of which puts the other crates to one question.
//!
//! | module | what it asks |
//! |---|---|
//! | [`mod@paper`] | does every table, equation and claim of the paper hold, recomputed? |
//! | [`mod@finite_element`] | what do the finite elements say that the paper sets beside its law? |
//! | [`mod@orthogonal`] | which factor of a test matters, and can that be told? |
//! | [`mod@surfaces`] | what are the published coefficients worth as surfaces over density and amplitude? |
//! | [`mod@amplitude_independent`] | what is one law for every amplitude worth on the published loops? |
//! | [`mod@design`] | which density gives a stiffness and a loss factor? |
//! | [`mod@blind`] | does a trace name effects that it was never told of? |
//! | [`mod@bouc_wen`] | is the oscillator of the Bouc–Wen benchmark found? |
//! | [`size`] | how much time and memory does a trace take? |
//! | [`numbers`] | what is each number that decides worth? |
//! | [`mod@bench`] | how many instructions does the crate take, beside its peers? |
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

//! The harness of mesh-damper: a simulated rig around the crate, and the way from a recording to a better law.
//!
//! ```text
//! recording ─▶ identify ─▶ trace ─▶ model_file ─▶ the crate's law in f32 ─▶ link, on the simulated rig ─▶ recording
//! ```
//!
//! | for | use |
//! |---|---|
//! | the paper's equations in f64, sharing no code with the crate | [`mod@reference`] |
//! | a specimen with an effect that the law does not know, and the rig that tests it | [`specimen`], [`actuator`] |
//! | the crate in the loop with them, tick by tick | [`link`] |
//! | recordings as files; their motion and its cycles | [`recording`] |
//! | fitting coefficients with their uncertainty | [`identify`] |
//! | which effect is missing, and by how much the law is better with it | [`mod@trace`], [`report`] |
//! | stiffness and loss factor of a recording, eqs 1–7 | [`mod@characterize`] |
//! | which factor of a test matters, and whether that can be told | [`mod@orthogonal`] |
//! | the density that gives a stiffness and a loss factor | [`mod@design`] |
//! | the published coefficients as surfaces over density and amplitude | [`mod@surfaces`] |
//! | the published loops by one law for every amplitude | [`mod@amplitude_free`] |
//! | every table, equation and claim of the paper, recomputed | [`mod@paper`] |
//! | a law as a file, and the force that it predicts | [`model`], [`model_file`], [`mod@predict`] |
//! | the finite elements that the paper sets beside its law | [`mod@finite_element`] |
//! | the crate as an image for a microcontroller: built, measured, emulated | [`mod@image`] |
//! | the instructions that it takes there, beside its peers' | [`mod@bench`] |
//! | faults put into all of it, and what the rig's monitor finds of them | [`mod@faults`] |
//! | how much of a file is read | [`read_limit`] |
//! | all of it once, from a seed | [`mod@demo`] |
//!
//! ```
//! let demo = hil::demo::demo(3, &|step| println!("{step}"))?;
//! assert!(demo.is_named() && demo.is_nearer());
//! # Ok::<(), hil::demo::DemoError>(())
//! ```
//!
//! Simulated parts use f64 and seeded noise: the same seed gives the same run. Bad input ends in an
//! [`error::InputError`], one line that says where, what and how to mend it.
#![forbid(unsafe_code)]

pub mod actuator;
pub mod amplitude_free;
pub mod bench;
pub mod blind;
pub mod characterize;
pub mod correction;
mod csv_text;
pub mod demo;
pub mod design;
pub mod error;
mod extremes;
pub mod faults;
pub mod finite_element;
pub mod identify;
pub mod image;
pub mod link;
pub mod model;
pub mod model_file;
mod nonnegative;
pub mod orthogonal;
pub mod output;
pub mod paper;
pub mod predict;
pub mod read_limit;
pub mod recording;
pub mod reference;
pub mod report;
pub mod specimen;
pub mod surfaces;
pub mod trace;

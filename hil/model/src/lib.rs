//! Models as files, and the force that they predict.
//!
//! A model is the mixed damping law (eq 13) with coefficients over amplitude, and the effects that were added to it. A trace
//! produces it, and the rig runs it. The crate computes its force: in f64, as it was fitted, or in f32, as the firmware runs it.
//!
//! | module | for |
//! |---|---|
//! | the root | the model itself, and the names of its effects |
//! | [`mod@file`] | `model.json`, read and written |
//! | [`correction`] | the residual table |
//! | [`export`] | a model as a pack, a Rust module, or C |
//! | [`extrapolation`] | the part of a motion outside the operating range |
//! | [`mod@predict`] | the force for a recorded motion, and its error |
//! | [`mod@respond`] | the motion of a mass on the damper |
//!
//! ```
//! use std::f64::consts::TAU;
//!
//! use mesh_damper_model::predict::{nrmse, predict};
//! use mesh_damper_model::{LawNode, Model};
//! use mesh_damper_recording::Recording;
//! use mesh_damper_recording::trajectory::Trajectory;
//!
//! // A spring of 8 kN/mm, and damping with the root of the speed, at 1 Hz.
//! let time: Vec<f64> = (0..1000).map(|i| 0.005 * f64::from(i)).collect();
//! let (displacement, force) = time
//!     .iter()
//!     .map(|t| (TAU * t).sin_cos())
//!     .map(|(sin, cos)| (0.1 * sin, 0.1 * TAU * cos))
//!     .map(|(y, v): (f64, f64)| (y, 8.0 * y + 0.1 * v.abs().sqrt() * v.signum()))
//!     .unzip();
//! let recording = Recording::new("a test", time, displacement, force)?;
//!
//! let model = Model {
//!     law: vec![LawNode { amplitude: 0.1, k1: 8.0, k3: 0.0, c: 0.1, alpha: 0.5 }],
//!     effects: Vec::new(),
//!     correction: None,
//!     controls: Vec::new(),
//! };
//! let trajectory = Trajectory::of(&recording)?;
//! let predicted = predict(&model, &trajectory)?;
//! assert!(nrmse(&predicted, &trajectory.force, |_| true) < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

pub mod correction;
pub mod export;
pub mod extrapolation;
mod family;
pub mod file;
mod model;
pub mod predict;
pub mod respond;

pub use family::{Family, base_name, parameter_unit};
pub use model::{AddedEffect, Control, LawNode, MAX_EFFECTS, Model, ModelError};

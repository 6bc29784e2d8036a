//! A law as a file, and the force that it predicts.
//!
//! A model is eq 13 with coefficients over amplitude, and the effects that were added to it. A trace ends in one, and the rig
//! runs it. What it predicts is computed by the crate: in f64 as it was fitted, or in f32 as the firmware runs it.
//!
//! | module | for |
//! |---|---|
//! | the root | the model itself, and the names of its effects |
//! | [`mod@file`] | `model.json`, read and written |
//! | [`correction`] | the table of what has no name |
//! | [`mod@predict`] | the force for a recorded motion, and how far it is off |
//!
//! ```
//! use mesh_damper_model::predict::{nrmse, predict};
//! use mesh_damper_model::{LawNode, Model};
//! use mesh_damper_recording::Recording;
//! use mesh_damper_recording::trajectory::Trajectory;
//!
//! // A spring of 8 kN/mm, pulled at 1 Hz.
//! let time: Vec<f64> = (0..1000).map(|i| 0.005 * f64::from(i)).collect();
//! let displacement: Vec<f64> = time.iter().map(|t| 0.1 * (6.2832 * t).sin()).collect();
//! let force: Vec<f64> = displacement.iter().map(|y| 8.0 * y).collect();
//! let recording = Recording::new("a spring", time, displacement, force)?;
//!
//! let spring = Model {
//!     law: vec![LawNode { amplitude: 0.1, k1: 8.0, k3: 0.0, c: 0.0, alpha: 0.3 }],
//!     effects: Vec::new(),
//!     correction: None,
//! };
//! let trajectory = Trajectory::of(&recording)?;
//! let predicted = predict(&spring, &trajectory)?;
//! assert!(nrmse(&predicted, &trajectory.force, |_| true) < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

pub mod correction;
pub mod file;
mod model;
pub mod predict;

pub use model::{AddedEffect, Family, LawNode, MAX_EFFECTS, Model, ModelError, parameter_unit};

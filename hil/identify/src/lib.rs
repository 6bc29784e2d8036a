//! Identification: coefficients of eq 13 and of added effects from recorded motion and force.
//!
//! A fit gives coefficients with their uncertainty. A trace goes further: it finds the effect that the law lacks, and how much
//! better the law is with it.
//!
//! | module | for |
//! |---|---|
//! | [`mod@trace`] | from recordings to a verdict and a model |
//! | [`families`] | how each family of effects enters a fit |
//! | [`term`], [`shape`] | an effect in a fit, and its parameters that are not linear |
//! | [`rows`], [`problem`], [`solution`] | the samples of the fit, the least squares, and their result |
//! | [`staged`], [`screen`] | the start of a fit, and the terms worth a fit |
//! | [`uncertainty`] | intervals of the fitted parameters |
//! | [`correction`] | the residual table |
//! | [`policy`] | the numbers behind all decisions, each with its source |
//!
//! ```
//! use mesh_damper_identify::trace::trace;
//! use mesh_damper_recording::Recording;
//! use mesh_damper_reference::protocol::{PROTOCOL, motion};
//! use mesh_damper_reference::tables;
//!
//! // Eq 13 and a moving mass of 20 kg, that nobody declared.
//! let law = tables::interpolate(3.0, 0.1);
//! let motion = motion(&PROTOCOL, 500.0);
//! let time = motion.iter().map(|m| m.time).collect();
//! let displacement = motion.iter().map(|m| m.displacement).collect();
//! let force = motion
//!     .iter()
//!     .map(|m| law.force(m.displacement, m.velocity) + 2e-5 * m.acceleration)
//!     .collect();
//! let recording = Recording::new("a test", time, displacement, force)?;
//! let found = trace(&[recording], &[], &|step| println!("{step}"))?;
//! assert_eq!(found.result.effects[0].family, "inertia");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub mod base_law;
mod basis;
pub(crate) mod beyond_noise;
pub mod correction;
mod exact;
pub mod families;
mod known_forces;
pub mod known_terms;
mod moved;
mod normal;
pub mod policy;
pub mod problem;
pub mod rows;
pub mod screen;
pub mod shape;
pub mod solution;
pub mod staged;
mod tangent;
pub mod term;
pub mod tolerance;
pub mod trace;
pub mod uncertainty;

//! The paper's equations in `f64`, directly from its text. The crate shares no code with `mesh-damper`, so that it can be its
//! oracle.
//!
//! Equations 8–12, the finite elements, are in `mesh_damper_paper::finite_element`.
//!
//! | module | for |
//! |---|---|
//! | [`law`], [`tables`] | eq 13, and its published coefficients |
//! | [`surfaces`] | eqs 16–18: the coefficients over density and amplitude |
//! | [`static_test`], [`dynamic_test`] | eqs 1–7: stiffness and loss factor |
//! | [`cubic_fit`] | eqs 14 and 15: the coefficients of a loop |
//! | [`orthogonal_test`], [`comparison`] | the published tests, and the difference between two curves |
//! | [`turn`], [`protocol`] | sines whose phase does not accumulate rounding, and tests made of them |
//!
//! ```
//! use mesh_damper_reference::tables;
//!
//! let law = tables::interpolate(3.0, 0.1);
//! // Pulled and at its fastest, it resists more than at rest.
//! assert!(law.force(0.05, 0.6) > law.force(0.05, 0.0));
//! ```

#![forbid(unsafe_code)]

pub mod comparison;
pub mod cubic_fit;
pub mod dynamic_test;
pub mod law;
pub mod orthogonal_test;
pub mod protocol;
pub mod static_test;
pub mod surfaces;
pub mod tables;
pub mod turn;

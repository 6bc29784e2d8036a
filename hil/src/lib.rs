//! The harness of mesh-damper.
#![forbid(unsafe_code)]

pub mod model;
pub mod reference;
pub mod specimen;

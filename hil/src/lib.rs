//! The harness of mesh-damper.
#![forbid(unsafe_code)]

pub mod actuator;
pub mod demo;
pub mod error;
pub mod identify;
pub mod link;
pub mod model;
pub mod model_file;
pub mod output;
pub mod predict;
pub mod recording;
pub mod reference;
pub mod report;
pub mod specimen;
pub mod trace;

//! The harness of mesh-damper.
#![forbid(unsafe_code)]

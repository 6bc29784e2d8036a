//! Types of the crate in the form that JSON has, for schemas, which the crate itself does not define.

use schemars::JsonSchema;

/// A measured quantity.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "stands for `mesh_damper::health::Channel`")]
pub(crate) enum ChannelName {
    /// Displacement, mm.
    Displacement,
    /// Force, kN.
    Force,
}

//! Types of the crate as JSON has them, for schemas: the crate itself has none.

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

//! Types in the form that JSON has, for schemas: of the crate, which itself defines none, and the kinds of a document.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};

use crate::campaign::Change;

/// A measured quantity.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "stands for `mesh_damper::health::Channel`")]
pub(crate) enum ChannelName {
    /// Displacement, mm.
    Displacement,
    /// Force, kN.
    Force,
}

/// A change that the monitor knows.
pub(crate) struct InjectedFault;

impl JsonSchema for InjectedFault {
    fn schema_name() -> Cow<'static, str> {
        "InjectedFault".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let description =
            "A kind of fault that the monitor knows. `Change::sizes` describes its size.";
        json_schema!({ "description": description, "type": "string", "enum": Change::known() })
    }
}

//! A constant force.

use mesh_damper::effects::Offset;

use super::{Form, FormSpec, one, run};

/// Its size is the force.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "offset",
    family: "offset",
    unit_forces: |_, path| Ok(vec![run(Offset::new(1.0), path)?]),
    elements: |value| one(vec![("force", value.size(0))]),
    ..FormSpec::PLAIN
})];

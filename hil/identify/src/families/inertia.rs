//! A moving mass, or one for which a load cell is compensated although it is not there.

use mesh_damper::effects::Inertia;

use super::{Form, FormSpec, one, run};

/// Its size is the mass.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "inertia",
    family: "inertia",
    unit_forces: |_, path| Ok(vec![run(Inertia::new(1.0), path)?]),
    elements: |value| one(vec![("mass", value.size(0))]),
    ..FormSpec::PLAIN
})];

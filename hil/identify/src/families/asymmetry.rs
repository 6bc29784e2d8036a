//! Even stiffness.

use mesh_damper::effects::Asymmetry;

use super::{Form, FormSpec, one, run};

/// Its size is the coefficient.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "asymmetry",
    family: "asymmetry",
    unit_forces: |_, path| Ok(vec![run(Asymmetry::new(1.0), path)?]),
    elements: |value| one(vec![("k2", value.size(0))]),
    ..FormSpec::PLAIN
})];

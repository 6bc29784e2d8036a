//! Stiffness of the fifth order.

use mesh_damper::effects::Hardening;

use super::{Form, FormSpec, one, run};

/// Its size is the coefficient.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "hardening",
    family: "hardening",
    unit_forces: |_, path| Ok(vec![run(Hardening::new(1.0), path)?]),
    elements: |value| one(vec![("k5", value.size(0))]),
    ..FormSpec::PLAIN
})];

//! A linear dashpot.

use mesh_damper::effects::Viscous;

use super::{Form, FormSpec, one, run};

/// Its size is the coefficient.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "viscous",
    family: "viscous",
    size_is_positive: true,
    unit_forces: |_, path| Ok(vec![run(Viscous::new(1.0), path)?]),
    elements: |value| one(vec![("c1", value.size(0))]),
    ..FormSpec::PLAIN
})];

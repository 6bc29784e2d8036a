//! A linear dashpot.

use mesh_damper::effects::Viscous;

use super::{Form, FormSpec, one, run};

/// Its size is the coefficient.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "viscous",
    family: "viscous",
    size_is_positive: true,
    unit_forces: |_, motion| Ok(vec![run(&Viscous::new(1.0)?, motion)]),
    elements: |value| one(vec![("c1", value.size(0))]),
    ..FormSpec::PLAIN
})];

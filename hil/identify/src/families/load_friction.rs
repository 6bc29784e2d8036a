//! Friction that grows with the displacement: it scales the law's damping force by 1 + λ·|y|.

use mesh_damper::limits;

use super::{Entry, Form, FormSpec, one};

/// Its size is λ.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "load_friction",
    family: "load_friction",
    entry: Entry::Scales(1),
    scale_range: [0.0, limits::LOAD],
    gains: |sizes, _, at| [0.0, sizes[0] * at.displacement.abs()],
    elements: |value| one(vec![("load", value.size(0))]),
    ..FormSpec::PLAIN
})];

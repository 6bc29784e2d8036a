//! Damping that differs between the directions: it scales the law's damping force by 1 + d·sgn v.

use super::{Entry, Form, FormSpec, one};

/// Its size is d.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "directional",
    family: "directional",
    entry: Entry::Scales(1),
    gains: |sizes, _, at| [0.0, sizes[0] * at.direction],
    elements: |value| one(vec![("difference", value.size(0))]),
    ..FormSpec::PLAIN
})];

//! One-sided contact, on either side of the motion.

use mesh_damper::effects::Stop;

use super::{Form, FormSpec, one, run};
use crate::shape::Shape;
use crate::shape::ShapePolicy;

/// On the side of positive displacement, and of negative.
pub const FORMS: [Form; 2] = [
    Form(&FormSpec {
        name: "stop_above",
        shapes: |extent| shapes(extent.above),
        unit_forces: |shapes, path| Ok(vec![run(Stop::new(&[(1.0, shapes[0])]), path)?]),
        elements: |value| one(vec![("stiffness", value.size(0)), ("gap", value.shape(0))]),
        ..STOP
    }),
    Form(&FormSpec {
        name: "stop_below",
        shapes: |extent| shapes(extent.below),
        unit_forces: |shapes, path| Ok(vec![run(Stop::new(&[(1.0, -shapes[0])]), path)?]),
        elements: |value| one(vec![("stiffness", value.size(0)), ("gap", -value.shape(0))]),
        ..STOP
    }),
];

/// For a contact on the side with this largest displacement, mm.
fn shapes(largest: f64) -> Vec<Shape> {
    let [nearest, farthest] = ShapePolicy::in_use().contact;
    vec![Shape::spread(
        nearest * largest,
        farthest * largest,
        ShapePolicy::in_use().contact_starts,
    )]
}

const STOP: FormSpec = FormSpec {
    family: "stop",
    shape_names: &["gap"],
    size_is_positive: true,
    stands_with_siblings: true,
    effect: "contacts",
    ..FormSpec::PLAIN
};

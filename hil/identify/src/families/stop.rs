//! One-sided contact, on either side of the motion.

use mesh_damper::effects::Stop;

use super::{Form, FormSpec, one, run};
use crate::shape::Shape;

/// On the side of positive displacement, and of negative.
pub const FORMS: [Form; 2] = [
    Form(&FormSpec {
        name: "stop_above",
        shapes: |extent| vec![Shape::spread(0.02 * extent.above, 0.98 * extent.above, 16)],
        unit_forces: |shapes, motions, _| Ok(vec![run(&Stop::new(&[(1.0, shapes[0])])?, motions)]),
        elements: |value| one(vec![("stiffness", value.size(0)), ("gap", value.shape(0))]),
        ..STOP
    }),
    Form(&FormSpec {
        name: "stop_below",
        shapes: |extent| vec![Shape::spread(0.02 * extent.below, 0.98 * extent.below, 16)],
        unit_forces: |shapes, motions, _| Ok(vec![run(&Stop::new(&[(1.0, -shapes[0])])?, motions)]),
        elements: |value| one(vec![("stiffness", value.size(0)), ("gap", -value.shape(0))]),
        ..STOP
    }),
];

const STOP: FormSpec = FormSpec {
    family: "stop",
    shape_names: &["gap"],
    size_is_positive: true,
    stands_with_siblings: true,
    effect: "contacts",
    ..FormSpec::PLAIN
};

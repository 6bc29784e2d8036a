//! A force that settles over the cycles: a stiffness, or the law's elastic and damping force separately.

use mesh_damper::effects::Drift;
use mesh_damper::limits;

use super::{Entry, Form, FormSpec, one, run};
use crate::shape::Shape;
use crate::shape::ShapePolicy;

/// A stiffness; both forces of the law.
pub const FORMS: [Form; 2] = [
    Form(&FormSpec {
        name: "drift",
        unit_forces: |shapes, path| Ok(vec![run(Drift::new(1.0, shapes[0]), path)?]),
        elements: |value| {
            one(vec![
                ("stiffness", value.size(0)),
                ("cycles", value.shape(0)),
            ])
        },
        ..DRIFT
    }),
    OF_EACH,
];

/// Both forces of the law, separately.
pub const OF_EACH: Form = Form(&FormSpec {
    name: "drift_of_each",
    entry: Entry::Scales(2),
    scale_range: [-1.0, limits::CHANGE],
    gains: |sizes, shapes, at| {
        let done = -(-at.cycles / shapes[0]).exp_m1();
        [sizes[0] * done, sizes[1] * done]
    },
    elements: |value| {
        one(vec![
            ("elastic_change", value.size(0)),
            ("damping_change", value.size(1)),
            ("cycles", value.shape(0)),
        ])
    },
    ..DRIFT
});

const DRIFT: FormSpec = FormSpec {
    family: "drift",
    shape_names: &["cycles"],
    shapes: |extent| {
        vec![Shape::spread(
            ShapePolicy::in_use().shortest_drift,
            ShapePolicy::in_use().longest_drift * extent.cycles,
            ShapePolicy::in_use().drift_starts,
        )]
    },
    ..FormSpec::PLAIN
};

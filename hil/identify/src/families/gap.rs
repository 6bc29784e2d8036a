//! A dead zone without force, or with friction only.

use mesh_damper::effects::Gap;

use super::{Entry, Form, FormSpec, one};
use crate::moved::through;
use crate::shape::Shape;
use crate::shape::ShapePolicy;

/// Without force; with friction only.
pub const FORMS: [Form; 2] = [
    Form(&FormSpec {
        name: "gap",
        moves: |trajectory, half_width, _| {
            // Outside the crate's range only if nothing moves any more.
            let gap = Gap::new(half_width, false).ok()?;
            through(trajectory, |motion| gap.transform(motion));
            None
        },
        elements: |value| one(vec![("half_width", value.shape(0)), ("damps_inside", 0.0)]),
        ..GAP
    }),
    Form(&FormSpec {
        name: "damped_gap",
        moves: |trajectory, half_width, _| {
            let gap = Gap::new(half_width, true).ok()?;
            through(trajectory, |motion| gap.transform(motion));
            None
        },
        elements: |value| one(vec![("half_width", value.shape(0)), ("damps_inside", 1.0)]),
        ..GAP
    }),
];

const GAP: FormSpec = FormSpec {
    family: "gap",
    entry: Entry::Moves,
    shape_names: &["half_width"],
    shapes: |extent| {
        vec![Shape::spread(
            ShapePolicy::in_use().gap_shortest * extent.shortest(),
            ShapePolicy::in_use().longest * extent.amplitude,
            ShapePolicy::in_use().gap_starts,
        )]
    },
    ..FormSpec::PLAIN
};

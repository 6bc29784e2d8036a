//! A dead zone without force, or with friction only.

use mesh_damper::effects::Gap;

use super::{Entry, Form, FormSpec, one};
use crate::moved::through;
use crate::policy::policy;
use crate::shape::Shape;

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
            policy().shape.gap_shortest * extent.shortest(),
            policy().shape.longest * extent.amplitude,
            policy().shape.gap_starts,
        )]
    },
    ..FormSpec::PLAIN
};

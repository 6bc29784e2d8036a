//! A dead zone: nothing is moved in it, or only friction works.

use mesh_damper::effects::Gap;

use super::{Entry, Form, FormSpec, one};
use crate::moved::through;
use crate::shape::Shape;

/// Nothing is moved; only friction works.
pub const FORMS: [Form; 2] = [
    Form(&FormSpec {
        name: "gap",
        moves: |trajectory, half_width, _| {
            // Out of the crate's range only where nothing moves any more.
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
            2.0 * extent.shortest(),
            0.9 * extent.amplitude,
            8,
        )]
    },
    ..FormSpec::PLAIN
};

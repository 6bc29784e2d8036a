//! A spring in series.

use super::{Entry, Form, FormSpec, one};
use crate::shape::Shape;

/// Its shape is the stiffness.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "compliance",
    family: "compliance",
    entry: Entry::Moves,
    shape_names: &["stiffness"],
    gives_way: true,
    // A softer spring would take up more than the whole displacement.
    shapes: |extent| {
        vec![Shape::spread(
            1.3 * extent.stiffness,
            200.0 * extent.stiffness,
            6,
        )]
    },
    // x = y − d
    moves: |trajectory, stiffness, deflection| {
        let known = deflection?;
        let part = known.stiffness / stiffness;
        for (index, (deflection, rate)) in known.deflection.iter().enumerate() {
            trajectory.motion.displacement[index] -= part * deflection;
            trajectory.motion.velocity[index] -= part * rate;
        }
        None
    },
    elements: |value| one(vec![("stiffness", value.shape(0))]),
    ..FormSpec::PLAIN
})];

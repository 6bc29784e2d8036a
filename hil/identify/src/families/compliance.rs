//! A spring in series.

use super::{Entry, Form, FormSpec, one};
use crate::shape::Shape;
use crate::shape::ShapePolicy;

/// Its shape is the stiffness.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "compliance",
    family: "compliance",
    entry: Entry::Moves,
    shape_names: &["stiffness"],
    gives_way: true,
    shapes: |extent| {
        let [softest, stiffest] = ShapePolicy::in_use().series;
        vec![Shape::spread(
            softest * extent.stiffness,
            stiffest * extent.stiffness,
            ShapePolicy::in_use().series_starts,
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

//! Maxwell branches: a spring behind a dashpot.

use std::f64::consts::TAU;

use mesh_damper::effects::{MAX_BRANCHES, Relaxation};

use super::{Form, FormSpec, one, run_at};
use crate::shape::ShapePolicy;
use crate::shape::{Extent, Shape};

/// Its size is the stiffness.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "relaxation",
    family: "relaxation",
    shape_names: &["time"],
    size_is_positive: true,
    most: MAX_BRANCHES,
    shapes,
    unit_forces: |shapes, path| {
        let branch = |tick| Relaxation::new(&[(1.0, shapes[0])], tick);
        Ok(vec![run_at(branch, path)?])
    },
    elements: |value| one(vec![("stiffness", value.size(0)), ("time", value.shape(0))]),
    ..FormSpec::PLAIN
})];

/// A fast branch looks like a dashpot, a slow one like a spring. At a single frequency any branch looks like a spring and a
/// dashpot, and none is simpler than the truth may be.
fn shapes(extent: &Extent) -> Vec<Shape> {
    let spread = Shape::spread(
        ShapePolicy::in_use().shortest_relaxation * extent.tick,
        extent.duration,
        ShapePolicy::in_use().relaxation_starts,
    );
    if extent.highest_frequency < ShapePolicy::in_use().several * extent.lowest_frequency {
        return vec![spread];
    }
    vec![Shape {
        simple_below: ShapePolicy::in_use().dashpot / (TAU * extent.highest_frequency),
        simple_above: ShapePolicy::in_use().spring / (TAU * extent.lowest_frequency),
        ..spread
    }]
}

//! Maxwell branches: a spring behind a dashpot.

use std::f64::consts::TAU;

use mesh_damper::effects::{MAX_BRANCHES, Relaxation};

use super::{Form, FormSpec, one, run};
use crate::shape::{Extent, Shape};

/// Its size is the stiffness.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "relaxation",
    family: "relaxation",
    shape_names: &["time"],
    size_is_positive: true,
    most: MAX_BRANCHES,
    shapes,
    unit_forces: |shapes, motions, tick| {
        Ok(vec![run(
            &Relaxation::new(&[(1.0, shapes[0])], tick)?,
            motions,
        )])
    },
    elements: |value| one(vec![("stiffness", value.size(0)), ("time", value.shape(0))]),
    ..FormSpec::PLAIN
})];

/// The highest frequency is so many times the lowest where there are several.
const SEVERAL: f64 = 1.2;

/// With ω·time below 0.3 the branch is a dashpot within a tenth, beyond 1/0.1 a spring. At one frequency any branch is a spring
/// and a dashpot, and none of them is simpler than the truth may be.
fn shapes(extent: &Extent) -> Vec<Shape> {
    let spread = Shape::spread(0.5 * extent.tick, extent.duration, 12);
    if extent.highest_frequency < SEVERAL * extent.lowest_frequency {
        return vec![spread];
    }
    vec![Shape {
        simple_below: 0.2 / (TAU * extent.highest_frequency),
        simple_above: 10.0 / (TAU * extent.lowest_frequency),
        ..spread
    }]
}

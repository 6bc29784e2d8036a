//! A slider behind a spring and a play that travels with the slider. Without the play it is a Jenkins element.

use mesh_damper::effects::Backlash;

use super::{Form, FormSpec, one, run};
use crate::policy::policy;
use crate::shape::{Extent, Shape};

/// Its size is the stiffness.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "backlash",
    family: "backlash",
    shape_names: &["slip_limit", "slack"],
    size_is_positive: true,
    rank: 1,
    special_cases: &["stick_slip"],
    shapes,
    unit_forces: |shapes, motion| {
        let backlash = Backlash::new(1.0, shapes[0], shapes[1])?;
        Ok(vec![run(&backlash, motion)])
    },
    elements: |value| {
        one(vec![
            ("stiffness", value.size(0)),
            ("slip_limit", value.shape(0)),
            ("slack", value.shape(1)),
        ])
    },
    ..FormSpec::PLAIN
})];

fn shapes(extent: &Extent) -> Vec<Shape> {
    let policy = &policy().shape;
    vec![
        Shape::spread(
            extent.shortest(),
            policy.longest * extent.amplitude,
            policy.backlash_starts,
        ),
        // Half of the play on each side of the start.
        Shape::spread(
            2.0 * extent
                .shortest()
                .max(policy.shortest_slack * extent.amplitude),
            2.0 * policy.longest * extent.amplitude,
            policy.slack_starts,
        ),
    ]
}

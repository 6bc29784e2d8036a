//! A slider behind a spring and a play that travels with the slider. Without the play it is a Jenkins element.

use mesh_damper::effects::Backlash;

use super::{Form, FormSpec, one, run};
use crate::shape::ShapePolicy;
use crate::shape::{Extent, Shape};

/// Number of starting values of a free play. Convention: each is four times the one before: a fit goes on from there.
const SLACK_STARTS: usize = 3;

/// Number of starting values of the slip limit of friction behind free play. Convention: each is three times the one before: a fit
/// goes on from there.
const BACKLASH_STARTS: usize = 4;

/// Its size is the stiffness.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "backlash",
    family: "backlash",
    shape_names: &["slip_limit", "slack"],
    size_is_positive: true,
    rank: 1,
    special_cases: &["stick_slip"],
    shapes,
    unit_forces: |shapes, path| {
        let backlash = Backlash::new(1.0, shapes[0], shapes[1]);
        Ok(vec![run(backlash, path)?])
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
    let policy = ShapePolicy::in_use();
    vec![
        Shape::spread(
            extent.shortest(),
            policy.longest * extent.amplitude,
            BACKLASH_STARTS,
        ),
        // Half of the play on each side of the start.
        Shape::spread(
            2.0 * extent
                .shortest()
                .max(policy.shortest_slack * extent.amplitude),
            2.0 * policy.longest * extent.amplitude,
            SLACK_STARTS,
        ),
    ]
}

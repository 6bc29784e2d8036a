//! A dashpot that yields, behind a spring: relaxation and a slider are what it is at the ends of its shapes.

use mesh_damper::effects::Yielding;

use super::{Form, FormSpec, one, run};
use crate::policy::policy;
use crate::shape::{Extent, Shape};

/// Its size is the stiffness, with which the force at which it yields and its viscosity grow.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "yielding",
    family: "yielding",
    shape_names: &["yield_stretch", "rate", "time"],
    size_is_positive: true,
    rank: 1,
    special_cases: &["relaxation", "stick_slip", "viscous"],
    shapes,
    unit_forces: |shapes, motion| {
        let [yield_stretch, rate, time] = [shapes[0], shapes[1], shapes[2]];
        let branch = Yielding::new(1.0, yield_stretch, rate, time, motion.tick)?;
        Ok(vec![run(&branch, motion)])
    },
    elements: |value| {
        one(vec![
            ("stiffness", value.size(0)),
            ("yield_stretch", value.shape(0)),
            ("rate", value.shape(1)),
            ("time", value.shape(2)),
        ])
    },
    ..FormSpec::PLAIN
})];

fn shapes(extent: &Extent) -> Vec<Shape> {
    let policy = &policy().shape;
    let [slowest, fastest] = policy.yield_rate;
    let swing = extent.amplitude / extent.velocity;
    let [briefest, longest] = policy.yield_time;
    let time = Shape::spread(briefest * swing, longest * swing, policy.yield_time_starts);
    vec![
        Shape::spread(
            policy.shortest_yield * extent.amplitude,
            policy.longest * extent.amplitude,
            policy.yield_starts,
        ),
        Shape::spread(
            slowest * extent.velocity,
            fastest * extent.velocity,
            policy.yield_rate_starts,
        ),
        // A branch without viscosity is as little simpler as one that hardly has any.
        Shape {
            simple_below: 0.0,
            ..time
        },
    ]
}

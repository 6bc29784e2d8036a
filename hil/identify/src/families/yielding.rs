//! A dashpot that yields, behind a spring. At the ends of its shapes it is a Maxwell branch or a slider.

use mesh_damper::effects::Yielding;

use super::{Form, FormSpec, one, run_at};
use crate::shape::ShapePolicy;
use crate::shape::{Extent, Shape};

/// Number of starting values of the ratio of viscosity to stiffness of a yielding dashpot. Convention: stretch and rate determine
/// where the dashpot yields.
const YIELD_TIME_STARTS: usize = 1;

/// Number of starting values of the rate at which a dashpot yields. Convention: each is four times the one before: a fit goes on from
/// there.
const YIELD_RATE_STARTS: usize = 3;

/// Number of starting values of the stretch at which a dashpot yields. Convention: each is four times the one before: a fit goes on
/// from there.
const YIELD_STARTS: usize = 4;

/// Without viscosity, and with it. Its size is the stiffness; the yield force and the viscosity are proportional to it.
pub const FORMS: [Form; 2] = [
    Form(&FormSpec {
        name: "yielding",
        shape_names: &["yield_stretch", "rate"],
        shapes: |extent| shapes(extent)[..2].to_vec(),
        ..BRANCH
    }),
    Form(&FormSpec {
        name: "viscous_yielding",
        shape_names: &["yield_stretch", "rate", "time"],
        rank: 2,
        special_cases: &["yielding"],
        refines: true,
        shapes,
        ..BRANCH
    }),
];

const BRANCH: FormSpec = FormSpec {
    family: "yielding",
    size_is_positive: true,
    rank: 1,
    special_cases: &["relaxation", "stick_slip", "viscous"],
    unit_forces: |shapes, path| {
        let time = shapes.get(2).copied().unwrap_or_default();
        let branch = |tick| Yielding::new(1.0, shapes[0], shapes[1], time, tick);
        Ok(vec![run_at(branch, path)?])
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
};

fn shapes(extent: &Extent) -> Vec<Shape> {
    let policy = ShapePolicy::in_use();
    let swing = extent.amplitude / extent.velocity;
    let [briefest, longest] = policy.yield_time;
    let time = Shape::spread(briefest * swing, longest * swing, YIELD_TIME_STARTS);
    stretch_and_rate(extent).into_iter().chain([time]).collect()
}

/// The stretch at which a dashpot yields and its rate, for any branch.
pub(super) fn stretch_and_rate(extent: &Extent) -> [Shape; 2] {
    let policy = ShapePolicy::in_use();
    let [slowest, fastest] = policy.yield_rate;
    [
        Shape::spread(
            policy.shortest_yield * extent.amplitude,
            policy.longest * extent.amplitude,
            YIELD_STARTS,
        ),
        Shape::spread(
            slowest * extent.velocity,
            fastest * extent.velocity,
            YIELD_RATE_STARTS,
        ),
    ]
}

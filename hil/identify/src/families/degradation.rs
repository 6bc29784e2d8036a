//! Elements that lose stiffness or strength with use: a spring with the largest displacement so far, a slider with the energy that
//! it has dissipated.

use mesh_damper::effects::{Degradation, Weakening};

use super::{Form, FormSpec, one, run};
use crate::shape::ShapePolicy;
use crate::shape::{Extent, Shape};

/// Starting values of the fraction of its strength that a weakening slider finally loses. Convention: a third and two thirds.
const STRENGTH_LOSS_STARTS: [f64; 2] = [0.3, 0.7];

/// Number of starting values of the energy after which a weakening slider has lost half of its final loss. Convention: the fewest
/// that tell early from late.
const LOSS_ENERGY_STARTS: usize = 3;

/// Number of starting values of the slip limit of a slider that weakens. Convention: each is two to three times the one before: a fit
/// goes on from there.
const WEAKENING_STARTS: usize = 6;

/// Number of starting values of the pinching of a spring that degrades. Convention: the softening is known by then.
const PINCHING_STARTS: usize = 2;

/// Number of starting values of the displacement at which a degrading spring has lost half of its stiffness. Convention: each is
/// three times the one before: a fit goes on from there.
const SOFTENING_STARTS: usize = 4;

/// A spring; a spring that pinches; a slider. The size of each is the stiffness.
pub const FORMS: [Form; 3] = [
    Form(&FormSpec {
        name: "degradation",
        shape_names: &["softening"],
        shapes: |extent| spring_shapes(extent)[..1].to_vec(),
        elements: |value| {
            one(vec![
                ("stiffness", value.size(0)),
                ("softening", value.shape(0)),
            ])
        },
        ..SPRING
    }),
    Form(&FormSpec {
        name: "pinched_degradation",
        shape_names: &["softening", "pinching"],
        rank: 2,
        special_cases: &["degradation"],
        refines: true,
        shapes: spring_shapes,
        ..SPRING
    }),
    Form(&FormSpec {
        name: "weakening",
        shape_names: &["slip_limit", "loss", "energy"],
        rank: 1,
        special_cases: &["stick_slip"],
        refines: true,
        shapes: slider_shapes,
        unit_forces: |shapes, path| {
            let slider = Weakening::new(1.0, shapes[0], shapes[1], shapes[2]);
            Ok(vec![run(slider, path)?])
        },
        // The energy is proportional to the stiffness: the search uses that for a stiffness of 1.
        elements: |value| {
            one(vec![
                ("stiffness", value.size(0)),
                ("slip_limit", value.shape(0)),
                ("loss", value.shape(1)),
                ("energy", value.size(0) * value.shape(2)),
            ])
        },
        shape_of: |element, name| {
            let parameter = element.get(name)?.abs();
            match name {
                "energy" => Some(parameter / element.get("stiffness")?.abs()),
                _ => Some(parameter),
            }
        },
        ..DEGRADATION
    }),
];

const DEGRADATION: FormSpec = FormSpec {
    family: "degradation",
    size_is_positive: true,
    ..FormSpec::PLAIN
};

const SPRING: FormSpec = FormSpec {
    rank: 1,
    unit_forces: |shapes, path| {
        let pinching = shapes.get(1).copied().unwrap_or_default();
        let spring = Degradation::new(1.0, shapes[0], pinching);
        Ok(vec![run(spring, path)?])
    },
    elements: |value| {
        one(vec![
            ("stiffness", value.size(0)),
            ("softening", value.shape(0)),
            ("pinching", value.shape(1)),
        ])
    },
    ..DEGRADATION
};

fn spring_shapes(extent: &Extent) -> Vec<Shape> {
    let policy = ShapePolicy::in_use();
    let [least, most] = policy.softening;
    let [slightest, whole] = policy.pinching;
    vec![
        Shape::spread(
            least * extent.amplitude,
            most * extent.amplitude,
            SOFTENING_STARTS,
        ),
        Shape {
            // A total loss does not make it a simpler spring.
            simple_above: f64::INFINITY,
            ..Shape::spread(slightest, whole, PINCHING_STARTS)
        },
    ]
}

fn slider_shapes(extent: &Extent) -> Vec<Shape> {
    let policy = ShapePolicy::in_use();
    let [slightest, whole] = policy.strength_loss;
    let [soonest, latest] = policy.loss_energy;
    // The most energy that a cycle of a slider of stiffness 1 dissipates.
    let cycle = extent.amplitude.powi(2);
    vec![
        Shape::spread(
            extent.shortest(),
            policy.longest * extent.amplitude,
            WEAKENING_STARTS,
        ),
        Shape {
            starts: STRENGTH_LOSS_STARTS.to_vec(),
            // A total loss of strength does not make it a simpler slider.
            simple_above: f64::INFINITY,
            ..Shape::spread(slightest, whole, 1)
        },
        Shape::spread(
            soonest * cycle,
            latest * extent.cycles.max(1.0) * cycle,
            LOSS_ENERGY_STARTS,
        ),
    ]
}

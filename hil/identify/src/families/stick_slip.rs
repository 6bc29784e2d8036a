//! Rate-independent friction with elastic pre-sliding, in four forms.

mod curve;

use mesh_damper::effects::{BoucWen, HardeningFriction, MAX_STICK_SLIP_ELEMENTS, StickSlip};

use super::{Element, Entry, Form, FormSpec, one, run};
use crate::shape::ShapePolicy;
use crate::shape::{Extent, Shape};
use crate::term::TermValue;

/// One Jenkins element; Bouc–Wen friction that yields; Jenkins elements with evenly spread slip limits (Iwan 1966); Bouc–Wen
/// friction that hardens.
pub const FORMS: [Form; 4] = [
    Form(&FormSpec {
        name: "jenkins",
        shape_names: &["slip_limit"],
        most: MAX_STICK_SLIP_ELEMENTS,
        effect: "elements",
        // An element that hardly slips is a spring.
        shapes: |extent| {
            vec![Shape::spread(
                extent.shortest(),
                ShapePolicy::in_use().longest * extent.amplitude,
                ShapePolicy::in_use().slip_starts,
            )]
        },
        unit_forces: |shapes, path| Ok(vec![run(StickSlip::new(&[(1.0, shapes[0])]), path)?]),
        elements: |value| {
            one(vec![
                ("stiffness", value.size(0)),
                ("slip_limit", value.shape(0)),
            ])
        },
        ..SLIDER
    }),
    Form(&FormSpec {
        name: "bouc_wen",
        shape_names: &["slip_limit", "sharpness"],
        rank: 1,
        shapes: bouc_wen_shapes,
        unit_forces: |shapes, path| Ok(vec![run(BoucWen::new(1.0, shapes[0], shapes[1]), path)?]),
        elements: |value| {
            one(vec![
                ("stiffness", value.size(0)),
                ("slip_limit", value.shape(0)),
                ("sharpness", value.shape(1)),
            ])
        },
        ..SLIDER
    }),
    Form(&FormSpec {
        name: "iwan",
        entry: Entry::Adds(MAX_STICK_SLIP_ELEMENTS),
        elements_may_miss: true,
        shape_names: &["slip_limit"],
        rank: 1,
        effect: "elements",
        // The largest of the limits; the others are equal fractions of it.
        shapes: |extent| {
            vec![Shape::spread(
                ShapePolicy::in_use().iwan_shortest * extent.shortest(),
                ShapePolicy::in_use().longest * extent.amplitude,
                ShapePolicy::in_use().iwan_starts,
            )]
        },
        unit_forces: |shapes, path| {
            iwan_limits(shapes[0])
                .map(|limit| run(StickSlip::new(&[(1.0, limit)]), path))
                .collect()
        },
        elements: iwan_elements,
        ..SLIDER
    }),
    Form(&FormSpec {
        name: "hardening_friction",
        shape_names: &["stretch_limit", "sharpness", "loss"],
        rank: 1,
        shapes: |extent| {
            let policy = ShapePolicy::in_use();
            let [shortest, longest] = policy.stretch_limit;
            let [bluntest, sharpest] = policy.hardening_sharpness;
            let [least, most] = policy.hardening_loss;
            vec![
                Shape::spread(
                    shortest * extent.amplitude,
                    longest * extent.amplitude,
                    policy.stretch_limit_starts,
                ),
                Shape {
                    starts: vec![1.0],
                    ..Shape::spread(bluntest, sharpest, 1)
                },
                Shape::spread(least, most, policy.hardening_loss_starts),
            ]
        },
        unit_forces: |shapes, path| {
            let hardening = ShapePolicy::in_use().hardening;
            let [limit, sharpness, loss] = [shapes[0], shapes[1], shapes[2]];
            // The crate's limits hold along the curves too.
            HardeningFriction::new(1.0, limit, sharpness, hardening, loss)?;
            let stretched = curve::stretched(limit, sharpness, hardening, loss, path);
            Ok(vec![stretched])
        },
        elements: |value| {
            one(vec![
                ("stiffness", value.size(0)),
                ("stretch_limit", value.shape(0)),
                ("sharpness", value.shape(1)),
                ("hardening", ShapePolicy::in_use().hardening),
                ("loss", value.shape(2)),
            ])
        },
        ..SLIDER
    }),
];

const SLIDER: FormSpec = FormSpec {
    family: "stick_slip",
    size_is_positive: true,
    ..FormSpec::PLAIN
};

fn bouc_wen_shapes(extent: &Extent) -> Vec<Shape> {
    let policy = ShapePolicy::in_use();
    let [bluntest, sharpest] = policy.sharpness;
    let starts = policy.sharpness_starts.to_vec();
    vec![
        Shape::spread(
            extent.shortest(),
            policy.bouc_wen_longest * extent.amplitude,
            policy.bouc_wen_starts,
        ),
        Shape {
            starts,
            ..Shape::spread(bluntest, sharpest, 1)
        },
    ]
}

/// The slip limits of an Iwan model's elements, evenly spread up to `largest`.
fn iwan_limits(largest: f64) -> impl Iterator<Item = f64> {
    let count = MAX_STICK_SLIP_ELEMENTS;
    (1..=count).map(move |i| largest * i as f64 / count as f64)
}

/// The elements that are present.
fn iwan_elements(value: &TermValue) -> Vec<Element> {
    let elements = value
        .sizes
        .iter()
        .zip(iwan_limits(value.shape(0)))
        .enumerate();
    elements
        .filter(|(_, (size, _))| **size > 0.0)
        .map(|(index, (&size, limit))| (index, vec![("stiffness", size), ("slip_limit", limit)]))
        .collect()
}

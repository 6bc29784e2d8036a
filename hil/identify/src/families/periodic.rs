//! Tones.

use std::f64::consts::TAU;

use mesh_damper::effects::{MAX_TONES, Periodic};

use super::{Entry, Form, FormSpec, Step, one, run_at};
use crate::shape::Shape;
use crate::shape::ShapePolicy;

/// Its sizes are those of a sine and of a cosine.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "periodic",
    family: "periodic",
    entry: Entry::Adds(2),
    shape_names: &["frequency"],
    most: MAX_TONES,
    shapes: |extent| {
        vec![Shape {
            starts: extent.tones.clone(),
            ..Shape::spread(
                ShapePolicy::in_use().fewest_periods / extent.duration,
                ShapePolicy::in_use().highest_tone / extent.tick,
                1,
            )
        }]
    },
    unit_forces: |shapes, path| {
        let tone = |phase| {
            let tone = |tick| Periodic::new(&[(1.0, shapes[0], phase)], tick);
            run_at(tone, path)
        };
        Ok(vec![tone(0.0)?, tone(0.25 * TAU)?])
    },
    follows_clock: true,
    // At the end of a recording, the phase of a tone is its frequency times thousands of periods.
    step: Step::Part(1e-7),
    // a·sin x + b·cos x = √(a² + b²)·sin(x + φ), tan φ = b/a
    elements: |value| {
        one(vec![
            ("amplitude", value.size(0).hypot(value.size(1))),
            ("frequency", value.shape(0)),
            ("phase", value.size(1).atan2(value.size(0))),
        ])
    },
    ..FormSpec::PLAIN
})];

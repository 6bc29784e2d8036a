//! A force that scales with temperature: both forces of the law together, or separately.

use super::{Entry, Form, FormSpec, one};

/// Both together; separately.
pub const FORMS: [Form; 2] = [
    Form(&FormSpec {
        name: "temperature",
        entry: Entry::Scales(1),
        gains: |sizes, _, at| [sizes[0] * (at.reference - at.temperature); 2],
        elements: |value| {
            one(vec![
                ("beta", value.size(0)),
                ("reference", value.term.reference),
            ])
        },
        ..TEMPERATURE
    }),
    Form(&FormSpec {
        name: "temperature_of_each",
        entry: Entry::Scales(2),
        gains: |sizes, _, at| {
            let cooler = at.reference - at.temperature;
            [sizes[0] * cooler, sizes[1] * cooler]
        },
        elements: |value| {
            one(vec![
                ("beta", value.size(0)),
                ("beta_damping", value.size(1)),
                ("reference", value.term.reference),
            ])
        },
        ..TEMPERATURE
    }),
];

const TEMPERATURE: FormSpec = FormSpec {
    family: "temperature",
    ..FormSpec::PLAIN
};

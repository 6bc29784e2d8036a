//! Section 2.

use super::Row;

pub const ROWS: &[Row] = &[
    (
        "equations_1_and_2",
        "holds",
        &[("largest relative error", 0.0)],
    ),
    (
        "equation_7",
        "holds",
        &[("largest relative difference", 0.0)],
    ),
    ("one_loss_factor", "fails", &[("eq 2 over eq 4", 0.515)]),
    (
        "excitation_at_1_hz",
        "fails",
        &[
            ("frequency of sin(πt), Hz", 0.5),
            ("largest ratio of damping force", 0.8962),
            ("least ratio of damping force", 0.6797),
        ],
    ),
    (
        "frequency_does_not_matter",
        "fails",
        &[
            ("largest NRMSE between 1 and 10 Hz", 2.197),
            ("largest ratio of energy", 3.607),
            ("least NRMSE between 1 and 10 Hz", 0.1476),
            ("least ratio of energy", 1.439),
        ],
    ),
    (
        "static_stiffness_of_table_3",
        "cannot_tell",
        &[
            ("largest travel, mm", 45.45),
            ("least travel, mm", 2.083),
            ("runs beyond the wall", 6.0),
        ],
    ),
];

//! Section 4.1 and Table 3.

use super::Row;

pub const ROWS: &[Row] = &[
    (
        "table_3_is_an_l9",
        "holds",
        &[("pairs of levels that meet", 54.0)],
    ),
    (
        "table_3_sums_of_loss_factor",
        "fails",
        &[
            ("R of crisscross angle", 0.1362),
            ("R of wire diameter", 0.1825),
            ("figures that differ", 5.0),
            ("ΣK_1 of wire diameter", 0.0976),
            ("ΣK_3 of crisscross angle", 0.2603),
            ("ΣK_3 of wire diameter", 0.2801),
        ],
    ),
    (
        "table_3_sums_of_stiffness",
        "holds",
        &[("figures that differ", 0.0)],
    ),
    (
        "order_for_loss_factor",
        "fails",
        &[
            ("R of crisscross angle", 0.1362),
            ("R of mesh density", 0.1985),
            ("R of test load", 0.215),
            ("R of wire diameter", 0.1825),
        ],
    ),
    (
        "order_for_stiffness",
        "fails",
        &[
            ("R of crisscross angle", 0.2438),
            ("R of mesh density", 0.8555),
            ("R of test load", 0.3401),
            ("R of wire diameter", 0.3224),
        ],
    ),
    (
        "order_of_fabrication",
        "fails",
        &[
            ("R of the loss factor by crisscross angle", 0.1362),
            ("R of the loss factor by mesh density", 0.1985),
            ("R of the loss factor by test load", 0.215),
            ("R of the loss factor by wire diameter", 0.1825),
            ("R of the stiffness by crisscross angle", 0.2438),
            ("R of the stiffness by mesh density", 0.8555),
            ("R of the stiffness by test load", 0.3401),
            ("R of the stiffness by wire diameter", 0.3224),
        ],
    ),
    (
        "density_dominates",
        "fails",
        &[
            ("R of density over that of load, loss factor", 0.9233),
            ("R of density over that of load, stiffness", 2.515),
        ],
    ),
    (
        "significance",
        "cannot_tell",
        &[
            ("factors told from error", 0.0),
            ("p of the largest effect, loss factor", 0.9162),
            ("p of the largest effect, stiffness", 0.1007),
            ("share of crisscross angle, loss factor", 0.1145),
            ("share of crisscross angle, stiffness", 0.06358),
            ("share of mesh density, loss factor", 0.3185),
            ("share of mesh density, stiffness", 0.7069),
            ("share of test load, loss factor", 0.3603),
            ("share of test load, stiffness", 0.1101),
            ("share of wire diameter, loss factor", 0.2067),
            ("share of wire diameter, stiffness", 0.1194),
        ],
    ),
    (
        "density_over_wire",
        "cannot_tell",
        &[
            ("R of mesh density over wire diameter, loss factor", 1.088),
            ("R of mesh density over wire diameter, stiffness", 2.654),
        ],
    ),
];

//! Sections 4.4 to 5.2: trends of stiffness and loss factor.

use super::Row;

pub const ROWS: &[Row] = &[
    (
        "stiffness_rises_with_density",
        "holds",
        &[
            ("K, kN/mm, at 2", 0.6743),
            ("K, kN/mm, at 2.5", 1.671),
            ("K, kN/mm, at 3", 1.691),
            ("K, kN/mm, at 3.5", 4.331),
            ("K, kN/mm, at 4", 11.41),
        ],
    ),
    (
        "area_changes_with_density",
        "holds",
        &[
            ("ΔW, J, at 2", 0.01179),
            ("ΔW, J, at 2.5", 0.02527),
            ("ΔW, J, at 3", 0.03321),
            ("ΔW, J, at 3.5", 0.04229),
            ("ΔW, J, at 4", 0.092),
        ],
    ),
    (
        "loss_factor_falls_with_density",
        "fails",
        &[
            ("K at 3.0 with k3 = 105, kN/mm", 2.511),
            ("η at 2", 0.5565),
            ("η at 2.5", 0.4813),
            ("η at 3", 0.6249),
            ("η at 3.0 with k3 = 105", 0.421),
            ("η at 3.5", 0.3108),
            ("η at 4", 0.2566),
        ],
    ),
    (
        "stiffness_up_loss_factor_down",
        "holds",
        &[
            ("ratio of η at 4.0 to 2.0 g/cm³ at 0.05", 0.451),
            ("ratio of η at 4.0 to 2.0 g/cm³ at 0.1", 0.461),
            ("ratio of η at 4.0 to 2.0 g/cm³ at 0.15", 0.6402),
            ("ratio of η at 4.0 to 2.0 g/cm³ at 0.2", 0.7489),
            ("ratio of η at 4.0 to 2.0 g/cm³ at 0.25", 0.7977),
        ],
    ),
    (
        "stiffness_rises_with_density_at_every_amplitude",
        "fails",
        &[
            ("K at 0.25 mm, kN/mm, at 2", 1.411),
            ("K at 0.25 mm, kN/mm, at 2.5", 3.662),
            ("K at 0.25 mm, kN/mm, at 3", 1.077),
            ("K at 0.25 mm, kN/mm, at 3.5", 2.083),
            ("K at 0.25 mm, kN/mm, at 4", 12.47),
            ("amplitudes where it rises", 2.0),
        ],
    ),
    (
        "earlier_work_on_density",
        "fails",
        &[
            ("η at 2", 0.5565),
            ("η at 2.5", 0.4813),
            ("η at 3", 0.6249),
            ("η at 3.5", 0.3108),
            ("η at 4", 0.2566),
        ],
    ),
    (
        "figure_11_is_of_the_tables",
        "fails",
        &[
            ("K of the tables at 60°, kN/mm", 1.691),
            ("η of the tables at 60°", 0.6249),
        ],
    ),
    (
        "angle_lowers_stiffness_and_loss_factor",
        "fails",
        &[
            ("ΣK of the loss factor, °, at 15", 0.1241),
            ("ΣK of the loss factor, °, at 45", 0.1944),
            ("ΣK of the loss factor, °, at 75", 0.2603),
            ("ΣK of the stiffness, °, at 15", 0.4972),
            ("ΣK of the stiffness, °, at 45", 0.4495),
            ("ΣK of the stiffness, °, at 75", 0.6933),
        ],
    ),
    (
        "angle_changes_loss_factor_slightly",
        "cannot_tell",
        &[
            ("fall in the text", 0.3),
            ("ratio of level sums, static", 2.098),
        ],
    ),
    (
        "thicker_wire_raises_stiffness_only",
        "cannot_tell",
        &[
            ("ΣK of the loss factor, mm, at 0.1", 0.0976),
            ("ΣK of the loss factor, mm, at 0.15", 0.2011),
            ("ΣK of the loss factor, mm, at 0.3", 0.2801),
            ("ΣK of the stiffness, mm, at 0.1", 0.3432),
            ("ΣK of the stiffness, mm, at 0.15", 0.6656),
            ("ΣK of the stiffness, mm, at 0.3", 0.6312),
        ],
    ),
    (
        "peak_force_varies_least_with_wire",
        "cannot_tell",
        &[
            ("by angle, by the text", 3.5),
            ("largest over smallest, by density", 16.93),
        ],
    ),
    (
        "stiffness_falls_with_amplitude",
        "fails",
        &[
            ("K at 2.0 g/cm³, kN/mm, at 0.05", 0.6921),
            ("K at 2.0 g/cm³, kN/mm, at 0.1", 0.6743),
            ("K at 2.0 g/cm³, kN/mm, at 0.15", 0.6978),
            ("K at 2.0 g/cm³, kN/mm, at 0.2", 1.045),
            ("K at 2.0 g/cm³, kN/mm, at 0.25", 1.411),
            ("K at 3.0 g/cm³, kN/mm, at 0.05", 2.773),
            ("K at 3.0 g/cm³, kN/mm, at 0.1", 1.691),
            ("K at 3.0 g/cm³, kN/mm, at 0.15", 1.392),
            ("K at 3.0 g/cm³, kN/mm, at 0.2", 1.186),
            ("K at 3.0 g/cm³, kN/mm, at 0.25", 1.077),
        ],
    ),
    (
        "peak_force_rises_with_amplitude",
        "fails",
        &[
            ("largest force at 3.5 g/cm³, kN, at 0.05", 0.2791),
            ("largest force at 3.5 g/cm³, kN, at 0.1", 0.4331),
            ("largest force at 3.5 g/cm³, kN, at 0.15", 0.544),
            ("largest force at 3.5 g/cm³, kN, at 0.2", 0.5898),
            ("largest force at 3.5 g/cm³, kN, at 0.25", 0.5207),
        ],
    ),
    (
        "one_set_of_constants_does_not_do",
        "holds",
        &[("largest K over smallest, 0.1 mm", 16.93)],
    ),
    (
        "outside_the_range",
        "cannot_tell",
        &[
            ("c of eq 18 corrected at 1.8 g/cm³, at 0.05", -0.1706),
            ("c of eq 18 corrected at 1.8 g/cm³, at 0.1", -0.1217),
            ("c of eq 18 corrected at 1.8 g/cm³, at 0.15", -0.06764),
            ("c of eq 18 corrected at 1.8 g/cm³, at 0.2", -0.008342),
            ("c of eq 18 corrected at 1.8 g/cm³, at 0.25", 0.05616),
        ],
    ),
    (
        "reverse_use",
        "fails",
        &[
            ("densities with 1.5 kN/mm at 0.05", 1.0),
            ("densities with 1.5 kN/mm at 0.1", 1.0),
            ("densities with 1.5 kN/mm at 0.15", 1.0),
            ("densities with 1.5 kN/mm at 0.2", 3.0),
            ("densities with 1.5 kN/mm at 0.25", 3.0),
        ],
    ),
];

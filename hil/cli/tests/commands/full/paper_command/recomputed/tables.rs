//! Sections 3.2 to 4.3 and Tables 6–9.

use super::Row;

pub const ROWS: &[Row] = &[
    (
        "limits_of_the_exponent",
        "holds",
        &[("largest relative error", 0.0)],
    ),
    (
        "asymmetric_restoring_force",
        "fails",
        &[("largest F(y, v) + F(−y, −v), kN", 0.0)],
    ),
    (
        "identification",
        "holds",
        &[("largest relative error of a coefficient", 0.0)],
    ),
    (
        "last_row_of_table_7",
        "cannot_tell",
        &[
            ("left by the next, kN/mm³", 1.591),
            ("left by this reading, kN/mm³", 0.7328),
            ("of these, falling with amplitude", 2.0),
            ("orders that rounding allows", 6.0),
        ],
    ),
    (
        "units_of_k3_and_c",
        "fails",
        &[("largest α of Table 9", 0.5571)],
    ),
    (
        "equation_16",
        "fails",
        &[
            ("R²", 0.9606),
            ("largest ratio at 2.0 g/cm³", 39.6),
            ("least ratio at 2.0 g/cm³", 18.39),
        ],
    ),
    (
        "k1_hardly_depends_on_amplitude",
        "fails",
        &[
            ("ratio of eq 16", 1.088),
            ("spread of Table 6 at 2", 2.259),
            ("spread of Table 6 at 2.5", 4.289),
            ("spread of Table 6 at 3", 3.281),
            ("spread of Table 6 at 3.5", 3.452),
            ("spread of Table 6 at 4", 1.239),
        ],
    ),
    (
        "equation_17",
        "fails",
        &[
            ("R²", 0.7792),
            ("R² of the best fit", 0.7918),
            ("by rounding, RMS", 1.673),
            ("by rounding, most", 4.936),
            ("left in the span", 34.2),
            ("left with one cell free", 0.7328),
            ("left with the next cell free", 30.6),
        ],
    ),
    (
        "equation_18_printed",
        "fails",
        &[("R²", -5161.0), ("largest c", -2.184), ("least c", -19.04)],
    ),
    (
        "equation_18_corrected",
        "fails",
        &[
            ("R²", 0.9109),
            ("R² of the best fit", 0.9226),
            ("by rounding, RMS", 0.01684),
            ("by rounding, most", 0.0506),
            ("left in the span", 0.08068),
            ("left with one cell free", 0.009665),
            ("left with the next cell free", 0.06786),
        ],
    ),
    (
        "equation_18_corrected_is_passive",
        "fails",
        &[
            ("c at 2.0 g/cm³, 0.05 mm", -0.01283),
            ("part of the range with c < 0", 0.001677),
            ("part of the range with k3 < 0", 0.0157),
        ],
    ),
    (
        "equation_19",
        "holds",
        &[
            ("R²", 0.8481),
            ("R² of the best fit", 0.8483),
            ("by rounding, RMS", 0.004736),
            ("by rounding, most", 0.01195),
            ("left in the span", 0.006728),
            ("left with one cell free", 0.003412),
            ("left with the next cell free", 0.003741),
        ],
    ),
    (
        "cell_at_4_0_and_0_05",
        "fails",
        &[
            ("c as fitted, kN·(s/mm)^α", 0.2049),
            ("c: left with this cell free over the next", 0.1424),
            ("k3 as fitted, kN/mm³", 200.6),
            ("k3: left with this cell free over the next", 0.02395),
            ("η as fitted", 0.3638),
            ("η as printed", 0.2194),
        ],
    ),
    (
        "cells_apart",
        "fails",
        &[
            ("Table 6 at 2.5 g/cm³, 0.15 mm", -2.578),
            ("Table 6 at 2.5 g/cm³, 0.25 mm", 3.032),
            ("Table 7 at 4 g/cm³, 0.15 mm", -2.584),
            ("Table 9 at 2.5 g/cm³, 0.25 mm", -3.141),
            ("Table 9 at 4 g/cm³, 0.05 mm", -2.78),
        ],
    ),
    (
        "equation_20",
        "fails",
        &[
            ("cells that give energy", 25.0),
            ("largest NRMSE", 54.32),
            ("mean NRMSE", 30.86),
        ],
    ),
    (
        "excellent_predictive_accuracy",
        "fails",
        &[("largest NRMSE", 1.119), ("mean NRMSE", 0.3812)],
    ),
    (
        "stiffness_depends_on_density_not_amplitude",
        "fails",
        &[
            ("share of amplitude in ln k1", 0.0058),
            ("share of amplitude in ln k3", 0.5984),
            ("share of density in ln k1", 0.9039),
            ("share of density in ln k3", 0.2216),
        ],
    ),
];

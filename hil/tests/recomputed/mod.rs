//! What became of every claim of the paper: read off runs that were looked at, so that a change shows.

/// Name, verdict, and numbers to four digits.
pub type Row = (&'static str, &'static str, &'static [(&'static str, f64)]);

/// Every claim, in the order of the report.
pub const ROWS: &[Row] = &[
    ("equations_1_and_2", "holds", &[]),
    ("equation_7", "holds", &[]),
    (
        "excitation_at_1_hz",
        "fails",
        &[
            ("least ratio of damping force", 0.6797),
            ("largest ratio of damping force", 0.8962),
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
        &[("largest travel, mm", 45.45), ("runs beyond the wall", 6.0)],
    ),
    ("equation_10", "holds", &[]),
    (
        "equation_10_of_table_4",
        "fails",
        &[
            ("part of the stress that eq 10 lacks at 2", 0.2689),
            ("part of the stress that eq 10 lacks at 2.5", 0.5296),
            ("part of the stress that eq 10 lacks at 3", 0.291),
            ("part of the stress that eq 10 lacks at 3.5", 0.5),
            ("part of the stress that eq 10 lacks at 4", 0.04213),
        ],
    ),
    (
        "table_4_stiffens_with_density",
        "fails",
        &[
            ("shear modulus, MPa, at 2", 2.8),
            ("shear modulus, MPa, at 2.5", 12.0),
            ("shear modulus, MPa, at 3", 7.8),
            ("shear modulus, MPa, at 3.5", 12.0),
            ("shear modulus, MPa, at 4", 52.0),
        ],
    ),
    (
        "d1_is_in_mpa",
        "cannot_tell",
        &[
            ("Poisson's ratio, in MPa, at 2", -0.3571),
            ("Poisson's ratio, in MPa, at 2.5", -0.7766),
            ("Poisson's ratio, in MPa, at 3", -0.6818),
            ("Poisson's ratio, in MPa, at 3.5", -0.7766),
            ("Poisson's ratio, in MPa, at 4", -0.9418),
        ],
    ),
    (
        "table_5_fits_the_curves",
        "cannot_tell",
        &[
            ("lasting part", 0.0116),
            ("loss factor in shear, 1 Hz", 0.5315),
            ("loss modulus over the sudden one, 1 Hz", 0.4018),
            ("storage modulus over the sudden one, 1 Hz", 0.7561),
        ],
    ),
    (
        "tables_4_and_5_belong_together",
        "cannot_tell",
        &[("shear left after 6 s", 0.0116)],
    ),
    (
        "table_3_is_an_l9",
        "holds",
        &[("pairs of levels that meet", 54.0)],
    ),
    (
        "table_3_sums_of_loss_factor",
        "fails",
        &[
            ("figures that differ", 5.0),
            ("ΣK_3 of crisscross angle", 0.2603),
            ("R of wire diameter", 0.1825),
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
            ("R of wire diameter", 0.1825),
            ("R of mesh density", 0.1985),
            ("R of test load", 0.215),
        ],
    ),
    (
        "order_for_stiffness",
        "fails",
        &[
            ("R of crisscross angle", 0.2438),
            ("R of wire diameter", 0.3224),
            ("R of mesh density", 0.8555),
            ("R of test load", 0.3401),
        ],
    ),
    (
        "order_of_fabrication",
        "fails",
        &[
            ("R of the stiffness by crisscross angle", 0.2438),
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
    ("limits_of_the_exponent", "holds", &[]),
    (
        "asymmetric_restoring_force",
        "fails",
        &[("largest F(y, v) + F(−y, −v), kN", 0.0)],
    ),
    ("identification", "holds", &[]),
    (
        "last_row_of_table_7",
        "cannot_tell",
        &[
            ("left by this reading, kN/mm³", 0.7328),
            ("left by the next, kN/mm³", 1.591),
            ("orders that rounding allows", 6.0),
            ("of these, falling with amplitude", 2.0),
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
            ("left in the span", 34.2),
            ("by rounding, most", 4.936),
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
            ("left in the span", 0.08068),
            ("by rounding, most", 0.0506),
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
            ("left in the span", 0.006728),
            ("by rounding, most", 0.01195),
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
    (
        "law_error_below_0_375_by_density",
        "fails",
        &[
            ("σ, eq 20 corrected, at 2", 0.5986),
            ("σ, eq 20 corrected, at 2.5", 1.312),
            ("σ, eq 20 corrected, at 3", 0.2399),
            ("σ, eq 20 corrected, at 3.5", 0.2241),
            ("σ, eq 20 corrected, at 4", 0.1155),
        ],
    ),
    (
        "law_error_below_0_375_by_amplitude",
        "fails",
        &[
            ("σ, eq 20 corrected, at 0.05", 1.489),
            ("σ, eq 20 corrected, at 0.1", 0.5986),
            ("σ, eq 20 corrected, at 0.15", 0.9218),
            ("σ, eq 20 corrected, at 0.2", 1.49),
            ("σ, eq 20 corrected, at 0.25", 1.155),
        ],
    ),
    (
        "equation_21_is_a_measure",
        "fails",
        &[
            ("largest σ, eq 20 corrected, guard at 0", 49.46),
            ("largest σ, eq 20 corrected, guard at 0.05", 1.312),
            ("largest σ, eq 20 corrected, guard at 0.1", 0.9629),
            ("largest σ, eq 20 corrected, guard at 0.2", 0.6738),
        ],
    ),
    (
        "law_is_in_accordance_at_every_density",
        "fails",
        &[
            ("NRMSE, eq 20 corrected, at 2", 0.4759),
            ("NRMSE, eq 20 corrected, at 2.5", 0.4659),
            ("NRMSE, eq 20 corrected, at 3", 0.1302),
            ("NRMSE, eq 20 corrected, at 3.5", 0.1186),
            ("NRMSE, eq 20 corrected, at 4", 0.05655),
        ],
    ),
    (
        "law_has_inflections",
        "fails",
        &[("loops with inflections", 22.0)],
    ),
    (
        "law_predicts_stiffness_and_loss_factor",
        "fails",
        &[
            ("ratio of η at 2", 0.4697),
            ("ratio of η at 2.5", 1.856),
            ("ratio of η at 3", 0.886),
            ("ratio of η at 3.5", 0.8777),
            ("ratio of η at 4", 1.142),
        ],
    ),
    (
        "law_agrees_on_stiffness_by_amplitude",
        "fails",
        &[
            ("K, tables, kN/mm, at 0.05", 0.6921),
            ("K, tables, kN/mm, at 0.1", 0.6743),
            ("K, tables, kN/mm, at 0.15", 0.6978),
            ("K, tables, kN/mm, at 0.2", 1.045),
            ("K, tables, kN/mm, at 0.25", 1.411),
        ],
    ),
    ("finite_elements_err_2_to_30_times_more", "cannot_tell", &[]),
    ("law_agrees_better_than_finite_elements", "cannot_tell", &[]),
    ("finite_elements_turn_with_density", "cannot_tell", &[]),
    ("finite_elements_exaggerate_the_area", "cannot_tell", &[]),
    ("finite_elements_miss_the_loss_factor", "cannot_tell", &[]),
    ("finite_elements_give_ellipses", "cannot_tell", &[]),
    ("finite_elements_are_concave", "cannot_tell", &[]),
    (
        "finite_elements_miss_the_loss_factor_by_amplitude",
        "cannot_tell",
        &[],
    ),
];

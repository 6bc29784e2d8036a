//! Table 3 recomputed: its sums, ranges and orders from its own nine runs, compared to the printed ones.

use mesh_damper_reference::orthogonal_test::{FACTORS, Printed};
use serde::Serialize;

use super::{Experiment, analyse, order};

/// Half of the last printed digit, with a margin for rounding: some cells are printed with one digit less, and are compared to all
/// four places, as Table 3 prints its runs.
const HALF_DIGIT: f64 = 0.501e-4;

/// A figure of Table 3 that does not follow from its runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Misprint {
    /// The name of the figure: `ΣK_1` to `ΣK_3`, or `R`.
    pub figure: String,
    /// The factor that the figure belongs to.
    pub factor: &'static str,
    /// The printed value, in the result's unit.
    pub printed: f64,
    /// The value recomputed from the runs, in the same unit.
    pub recomputed: f64,
}

/// One result of Table 3, from its runs and as printed.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AgainstPrint {
    /// The name of the result.
    pub response: &'static str,
    /// Figures that differ in the fourth decimal or earlier.
    pub misprints: Vec<Misprint>,
    /// The factors in the order of the ranges from the runs.
    pub order_of_runs: [&'static str; 4],
    /// The factors in the order of the printed ranges.
    pub order_of_printed_ranges: [&'static str; 4],
    /// The factors in the order stated in the text.
    pub order_in_text: [&'static str; 4],
}

/// Compares one result of Table 3 with its runs.
pub fn against_print(printed: &Printed) -> AgainstPrint {
    let ranges: Vec<_> = analyse(&Experiment::published(&[*printed]))
        .into_iter()
        .flat_map(|analysis| analysis.ranges)
        .collect();
    let mut misprints = Vec::new();
    for (index, recomputed) in ranges.iter().enumerate() {
        let sums = printed.sums[index].into_iter().zip(recomputed.sums);
        let figures = (1..)
            .zip(sums)
            .map(|(level, pair)| (format!("ΣK_{level}"), pair))
            .chain([("R".into(), (printed.ranges[index], recomputed.range))]);
        misprints.extend(
            figures
                .filter(|(_, (printed, recomputed))| (printed - recomputed).abs() > HALF_DIGIT)
                .map(|(figure, (printed, recomputed))| Misprint {
                    figure,
                    factor: FACTORS[index],
                    printed,
                    recomputed,
                }),
        );
    }
    let recomputed: Vec<f64> = ranges.iter().map(|one| one.range).collect();
    let named = |order: &[usize]| std::array::from_fn(|place| FACTORS[order[place]]);
    AgainstPrint {
        response: printed.name,
        misprints,
        order_of_runs: named(&order(&recomputed)),
        order_of_printed_ranges: named(&order(&printed.ranges)),
        order_in_text: named(&printed.order),
    }
}

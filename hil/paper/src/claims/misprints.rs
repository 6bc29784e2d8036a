//! Cells of Tables 6–9 that differ from the values to which the paper's own surfaces were fitted, and cells that stand apart from
//! the others.
//!
//! Eqs 17–19 are least-squares fits. If they were fitted to the tables as printed, the residual between table and surface would
//! have no component in the span of the surface's terms, except from the rounding of the printed coefficients. If it has one, each
//! cell is made free in turn. If exactly one cell removes that component, it is printed with another value than the fitted one, and
//! the fit gives that value.
//!
//! In addition, every cell is predicted from the 24 others of its table.

use mesh_damper_reference::comparison::r_squared;
use mesh_damper_reference::surfaces::{self, Equation18};
use mesh_damper_reference::tables::{self, AMPLITUDES, DENSITIES, cells};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// An equation that is linear in its coefficients, and its table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// Eq 17 and Table 7.
    K3,
    /// Eq 18, corrected, and Table 8.
    C,
    /// Eq 19 and Table 9.
    Alpha,
}

/// A cell and its fitted value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FreeCell {
    /// Density, g/cm³.
    pub density: f64,
    /// Amplitude, mm.
    pub amplitude: f64,
    /// The printed value, in the table's unit.
    pub printed: f64,
    /// The value at which the printed surface would be the fit, in the table's unit.
    pub fitted: f64,
    /// The remaining component in the span of the terms, in the table's unit.
    pub left: f64,
}

/// Whether a printed surface is the least-squares fit of its table.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FitCheck {
    /// Name of the equation.
    pub equation: &'static str,
    /// R² of the printed surface against the printed table.
    pub r_squared: f64,
    /// R² of the best surface with the same terms.
    pub best_r_squared: f64,
    /// Norm of the residual's component in the span of the terms, in the table's unit.
    pub left: f64,
    /// The same norm from the rounding of the printed coefficients alone: root mean square, and largest value.
    pub rounding: (f64, f64),
    /// Every cell with its value fitted, the cell with the smallest remainder first.
    pub free: Vec<FreeCell>,
}

impl FitCheck {
    /// Whether rounding explains the component: then the surface was fitted to the table as printed.
    pub fn is_of_the_table(&self) -> bool {
        self.left <= self.rounding.1
    }
}

/// A cell compared with its prediction from the other cells of its table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeftOut {
    /// Number of the table, 6–9.
    pub table: usize,
    /// Density, g/cm³.
    pub density: f64,
    /// Amplitude, mm.
    pub amplitude: f64,
    /// The printed value, in the table's unit.
    pub printed: f64,
    /// The value predicted from the other cells, in the table's unit.
    pub predicted: f64,
    /// The difference over the standard deviation of the other cells' differences (externally studentised). By chance, one cell in
    /// 42 is beyond 2.5.
    pub ratio: f64,
}

/// A printed surface, its terms and its table.
struct Fit {
    equation: &'static str,
    terms: DMatrix<f64>,
    printed: Vec<f64>,
    table: DVector<f64>,
}

impl Fit {
    fn of(surface: Surface) -> Self {
        let terms = |density, amplitude| -> Vec<f64> {
            match surface {
                Surface::K3 => surfaces::terms_17(density, amplitude).to_vec(),
                Surface::C => {
                    surfaces::terms_18(density, amplitude, Equation18::Corrected).to_vec()
                }
                Surface::Alpha => surfaces::terms_19(density, amplitude).to_vec(),
            }
        };
        let (equation, printed): (_, &[f64]) = match surface {
            Surface::K3 => ("eq 17", &surfaces::EQUATION_17),
            Surface::C => ("eq 18, corrected", &surfaces::EQUATION_18),
            Surface::Alpha => ("eq 19", &surfaces::EQUATION_19),
        };
        let rows: Vec<Vec<f64>> = cells().map(|(r, a, _)| terms(r, a)).collect();
        let value = |index: usize| match surface {
            Surface::K3 => tables::K3[index / 5][index % 5],
            Surface::C => tables::C[index / 5][index % 5],
            Surface::Alpha => tables::ALPHA[index / 5][index % 5],
        };
        Self {
            equation,
            terms: DMatrix::from_fn(25, printed.len(), |i, j| rows[i][j]),
            printed: printed.to_vec(),
            table: DVector::from_fn(25, |i, _| value(i)),
        }
    }

    /// An orthonormal basis of the span of the terms, by column.
    fn basis(&self) -> DMatrix<f64> {
        self.terms.clone().qr().q()
    }

    fn surface(&self) -> DVector<f64> {
        &self.terms * DVector::from_column_slice(&self.printed)
    }

    fn r_squared(&self, surface: &DVector<f64>) -> f64 {
        let pairs: Vec<(f64, f64)> = self
            .table
            .iter()
            .copied()
            .zip(surface.iter().copied())
            .collect();
        r_squared(&pairs)
    }

    fn check(&self) -> FitCheck {
        let printed = self.surface();
        let basis = self.basis();
        let best = &basis * basis.tr_mul(&self.table);
        let left = basis.tr_mul(&(&self.table - &printed));
        let mut free: Vec<FreeCell> = cells()
            .enumerate()
            .map(|(index, (density, amplitude, _))| {
                let direction = basis.row(index).transpose();
                let change = -direction.dot(&left) / direction.norm_squared();
                FreeCell {
                    density,
                    amplitude,
                    printed: self.table[index],
                    fitted: self.table[index] + change,
                    left: (&left + direction * change).norm(),
                }
            })
            .collect();
        free.sort_by(|a, b| a.left.total_cmp(&b.left));
        FitCheck {
            equation: self.equation,
            r_squared: self.r_squared(&printed),
            best_r_squared: self.r_squared(&best),
            left: left.norm(),
            rounding: self.rounding(),
            free,
        }
    }

    /// Root mean square, and largest value, of the component in the span that rounding to the printed digits leaves.
    fn rounding(&self) -> (f64, f64) {
        let halves: Vec<f64> = self
            .printed
            .iter()
            // Four digits are printed.
            .map(|b| 0.5 * 10_f64.powf(b.abs().log10().floor() - 3.0))
            .collect();
        let columns = self.terms.column_iter().zip(&halves);
        // Each coefficient is off by up to half a digit, uniformly.
        let mean_square: f64 = columns
            .clone()
            .map(|(column, half)| column.norm_squared() * half * half / 3.0)
            .sum();
        // The largest is at a corner of the box of all roundings.
        let count = halves.len();
        let corners = (0..1_usize << count).map(|signs| {
            let mut sum = DVector::zeros(25);
            for (index, (column, half)) in columns.clone().enumerate() {
                let sign = if signs >> index & 1 == 1 { 1.0 } else { -1.0 };
                sum += column * (sign * half);
            }
            sum.norm()
        });
        (mean_square.sqrt(), corners.fold(0.0, f64::max))
    }
}

/// Whether the printed `surface` is the fit of its printed table, and which cell would make it so.
pub fn check(surface: Surface) -> FitCheck {
    Fit::of(surface).check()
}

/// Every reading of Table 7's last row, whose cells are scattered over the page, with the component of eq 17 in the span of its
/// terms when the cell at 4.0 g/cm³ and 0.05 mm is free; the smallest first.
pub fn last_row_readings() -> Vec<([f64; 5], f64)> {
    let mut fit = Fit::of(Surface::K3);
    let printed = fit.surface();
    let basis = fit.basis();
    let free = basis.row(4).transpose();
    let row = tables::K3[4];
    let mut readings = Vec::new();
    for order in permutations() {
        let reading = order.map(|i| row[i]);
        for (column, value) in reading.into_iter().enumerate() {
            fit.table[20 + column] = value;
        }
        let left = basis.tr_mul(&(&fit.table - &printed));
        let change = free.dot(&left) / free.norm_squared();
        readings.push((reading, (left - &free * change).norm()));
    }
    readings.sort_by(|a, b| a.1.total_cmp(&b.1));
    readings
}

/// The permutations of five items.
fn permutations() -> Vec<[usize; 5]> {
    (0..3125)
        .map(|code| [625, 125, 25, 5, 1].map(|place| code / place % 5))
        .filter(|order| (0..5).all(|i| order.contains(&i)))
        .collect()
}

/// Every cell of every table compared to the others, by a fit of degree 3 in density and 1 in ln A to the logarithm (for α to the
/// value itself), the largest ratio first.
pub fn left_out() -> Vec<LeftOut> {
    let terms = DMatrix::from_fn(25, 8, |cell, term| {
        let (density, amplitude) = (DENSITIES[cell % 5] - 3.0, AMPLITUDES[cell / 5]);
        density.powi(term as i32 / 2) * (amplitude / 0.1).ln().powi(term as i32 % 2)
    });
    let basis = terms.qr().q();
    let mut all = Vec::new();
    for (table, values) in [
        (6, &tables::K1),
        (7, &tables::K3),
        (8, &tables::C),
        (9, &tables::ALPHA),
    ] {
        let scale = |value: f64| if table == 9 { value } else { value.ln() };
        let back = |value: f64| if table == 9 { value } else { value.exp() };
        let measured = DVector::from_fn(25, |cell, _| scale(values[cell / 5][cell % 5]));
        let left = &measured - &basis * basis.tr_mul(&measured);
        let squares = left.norm_squared();
        for cell in 0..25 {
            let free = 1.0 - basis.row(cell).norm_squared();
            let others = (squares - left[cell].powi(2) / free) / f64::from(25 - 8 - 1);
            all.push(LeftOut {
                table,
                density: DENSITIES[cell % 5],
                amplitude: AMPLITUDES[cell / 5],
                printed: values[cell / 5][cell % 5],
                predicted: back(measured[cell] - left[cell] / free),
                ratio: left[cell] / (free * others).sqrt(),
            });
        }
    }
    all.sort_by(|a, b| b.ratio.abs().total_cmp(&a.ratio.abs()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// If the printed surface is the fit of a table except for one cell, the check finds the cell and its value.
        #[test]
        fn a_planted_misprint_is_found(
            planted in 0usize..25,
            by in prop_oneof![-0.3..-0.1f64, 0.1..0.3f64],
            scatter in prop::collection::vec(-0.05..0.05f64, 25),
        ) {
            let mut fit = Fit::of(Surface::C);
            let basis = fit.basis();
            let scatter = DVector::from_vec(scatter);
            let beside = &scatter - &basis * basis.tr_mul(&scatter);
            fit.table = fit.surface() + beside;
            prop_assert!(fit.check().is_of_the_table());
            let own = fit.table[planted];
            fit.table[planted] += by;
            let found = fit.check();
            let (density, amplitude, _) = cells().nth(planted).unwrap();
            prop_assert_eq!((found.free[0].density, found.free[0].amplitude), (density, amplitude));
            prop_assert!((found.free[0].fitted - own).abs() < 1e-9);
        }
    }

    /// Compared to a fit without the cell.
    #[test]
    fn what_the_others_predict_is_a_fit_without_the_cell() {
        let term = |cell: usize, term: usize| {
            let (density, amplitude) = (DENSITIES[cell % 5] - 3.0, AMPLITUDES[cell / 5]);
            density.powi(term as i32 / 2) * (amplitude / 0.1).ln().powi(term as i32 % 2)
        };
        let all = left_out();
        for one in all.iter().filter(|one| one.table == 8) {
            let others: Vec<usize> = (0..25)
                .filter(|cell| {
                    (DENSITIES[cell % 5], AMPLITUDES[cell / 5]) != (one.density, one.amplitude)
                })
                .collect();
            let matrix = DMatrix::from_fn(24, 8, |i, j| term(others[i], j));
            let values = DVector::from_fn(24, |i, _| tables::C[others[i] / 5][others[i] % 5].ln());
            let fit = matrix.svd(true, true).solve(&values, 1e-12).unwrap();
            let cell = (0..25).find(|cell| !others.contains(cell)).unwrap();
            let predicted: f64 = (0..8).map(|j| fit[j] * term(cell, j)).sum();
            assert!(
                (predicted.exp() / one.predicted - 1.0).abs() < 1e-9,
                "{one:?}"
            );
        }
    }
}

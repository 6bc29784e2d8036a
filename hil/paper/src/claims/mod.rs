//! The paper, recomputed: every table, equation and claim, and whether it holds.
//!
//! Tables 6–9 take the place of the tests, whose recordings are not published. Each statement becomes a [`Claim`] with the deciding
//! numbers. If the paper does not give the data for a decision, it is [`Verdict::CannotTell`].

mod cells;
mod characterization;
mod claim;
mod comparison;
mod element_claims;
mod elements;
mod material;
mod methods;
mod misprints;
mod orthogonal;
mod tables;
mod trends;

use serde::Serialize;

pub use cells::{Cell, Dynamics};
pub use claim::{Claim, Verdict};
pub use comparison::{Compared, Comparison, Condition, GUARDS, JUDGED};
pub use elements::{Compression, ElementStudy, TriedBore, TriedMesh, TriedReading};
pub use methods::BOUND;
pub use misprints::{FitCheck, FreeCell, LeftOut};
pub use trends::{ANGLE_LOSS_FACTORS, ANGLE_STIFFNESS};

use mesh_damper_reference::surfaces::{self as published, Equation18};

use crate::orthogonal::Analysis;
use crate::surfaces::{self, Surfaces};
use cells::FREQUENCY;

/// All results of the study of the paper.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Paper {
    /// Every statement, in the order of the paper.
    pub claims: Vec<Claim>,
    /// The cells of Tables 6–9: rows are amplitudes, columns densities.
    pub cells: [[Cell; 5]; 5],
    /// Table 3 analysed by ranges and variance: first the loss factor, then the stiffness.
    pub orthogonal_test: Vec<Analysis>,
    /// Whether eqs 17–19 are the fits of their tables.
    pub fits: [FitCheck; 3],
    /// Every cell compared with the other cells of its table, the farthest first.
    pub left_out: Vec<LeftOut>,
    /// The crate's surfaces.
    pub surfaces: Surfaces,
    /// Errors of each set of surfaces.
    pub surface_errors: Vec<SurfaceErrors>,
    /// Comparison of the law with finite elements.
    pub comparison: Comparison,
    /// The influence of the assumptions on the finite elements.
    pub elements: ElementStudy,
}

/// The errors of a set of surfaces in each cell.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SurfaceErrors {
    /// Name of the set.
    pub name: &'static str,
    /// NRMSE of the loop; rows are amplitudes, columns densities.
    pub loop_error: [[f64; 5]; 5],
    /// Mean of the loop errors.
    pub mean: f64,
    /// Largest of the loop errors.
    pub largest: f64,
    /// Error of k1, k3, c and α in each cell, as a fraction of the printed value; null for surfaces that were fitted without the
    /// cell.
    pub coefficient_errors: Option<[[[f64; 4]; 5]; 5]>,
}

impl SurfaceErrors {
    fn new(name: &'static str, loop_error: [[f64; 5]; 5]) -> Self {
        let (mean, largest) = surfaces::mean_and_largest(&loop_error);
        Self {
            name,
            loop_error,
            mean,
            largest,
            coefficient_errors: None,
        }
    }

    fn of(
        name: &'static str,
        cells: &[[Cell; 5]; 5],
        law: impl Fn(f64, f64) -> mesh_damper_reference::law::Coefficients,
    ) -> Self {
        let relative = cells.each_ref().map(|row| {
            row.each_ref().map(|cell| {
                let (found, own) = (law(cell.density, cell.amplitude), cell.coefficients);
                [
                    found.k1 / own.k1 - 1.0,
                    found.k3 / own.k3 - 1.0,
                    found.c / own.c - 1.0,
                    found.alpha / own.alpha - 1.0,
                ]
            })
        });
        Self {
            coefficient_errors: Some(relative),
            ..Self::new(name, surfaces::loop_errors(law))
        }
    }
}

/// Recomputes everything; `progress` receives a description of each step.
pub fn recompute(progress: &(dyn Fn(&str) + Sync)) -> Paper {
    progress("recomputing tables and equations");
    let cells = cells::cells();
    let orthogonal_test = orthogonal::recompute();
    let fits = [
        misprints::Surface::K3,
        misprints::Surface::C,
        misprints::Surface::Alpha,
    ]
    .map(misprints::check);
    let left_out = misprints::left_out();
    progress("fitting surfaces");
    let own = surfaces::fit(surfaces::DEGREE, None);
    let eq_20 = |reading| move |r: f64, a: f64| published::coefficients(r, a, reading);
    let surface_errors = vec![
        SurfaceErrors::of("eqs 16–19 as printed", &cells, eq_20(Equation18::Printed)),
        SurfaceErrors::of(
            "eqs 16–19, eq 18 corrected",
            &cells,
            eq_20(Equation18::Corrected),
        ),
        SurfaceErrors::of("the crate's", &cells, |r, a| own.coefficients(r, a)),
        SurfaceErrors::new(
            "the crate's, each cell left out of the fit in turn",
            surfaces::left_out_errors(surfaces::DEGREE),
        ),
    ];
    let comparison = comparison::compare(&cells, &own, |density, amplitude| {
        progress(&format!(
            "finite elements at {density} g/cm³, {amplitude} mm"
        ));
        let found = elements::model(density).steady_loop(amplitude, FREQUENCY);
        found.map_err(|error| error.to_string())
    });
    progress("finite elements by every reading of Table 4, bore and mesh");
    let study = elements::study();
    let readings = misprints::last_row_readings();
    let evidence = tables::Evidence {
        checks: &fits,
        readings: &readings,
        left_out: &left_out,
    };
    let claims = [
        characterization::claims(&cells),
        material::claims(&cells, &study),
        orthogonal::claims(&orthogonal_test),
        tables::claims(&cells, &evidence),
        trends::claims(&cells, &orthogonal_test),
        methods::claims(&cells, &comparison),
        element_claims::claims(&comparison, &study),
    ]
    .concat();
    Paper {
        claims,
        cells,
        orthogonal_test: orthogonal_test.analyses,
        fits,
        left_out,
        surfaces: own,
        surface_errors,
        comparison,
        elements: study,
    }
}

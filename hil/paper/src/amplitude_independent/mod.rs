//! A law without amplitude: one set of coefficients for cycles of any size, compared to the laws that need the size beforehand.
//!
//! The published coefficients depend on a cycle's amplitude, which a law knows beforehand only for a declared sine. Here one law
//! with stick-slip and load-dependent friction is fitted to loops of Tables 6–9 at 0.05, 0.10, 0.20 and 0.25 mm. The loop at 0.15
//! mm then tests each of these laws:
//!
//! - one set of eq 13,
//! - the tables, interpolated between the rows on either side (the row of 0.15 mm itself is the loop: its error is 0),
//! - the surfaces, eqs 16–19 with eq 18 corrected, which were fitted to all rows including the held-out one,
//! - the law without amplitude.
//!
//! Its structure is the same for every density. It is chosen by leaving out 0.10 and 0.20 mm in turn; the loop at 0.15 mm has no
//! part in the choice. No law of this kind can be expected to do better than the loops themselves, interpolated phase by phase
//! between those on either side; the study reports that error too. The paper tested at 1 Hz. Loops of other frequencies are the
//! tables' own extrapolation by |v|^α.

mod compare;
mod fit;
mod loops;

pub use compare::{embedded_force, ticks_of};
pub use fit::{FittedLaw, Structure};
pub use loops::Sine;

use std::f64::consts::TAU;

use mesh_damper_model::ModelError;
use mesh_damper_model::file::{FittedRange, ModelFile};
use mesh_damper_model::predict::nrmse;
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES};
use rayon::prelude::*;
use serde::Serialize;

use compare::{interpolated, loop_between, of_surfaces};
use fit::{Loops, structures};
use loops::{BETWEEN, FITTED, HELD_OUT, amplitude};

/// The amplitude-independent law at every density, and its errors.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Study {
    /// Frequencies of the loops, Hz.
    pub frequencies: Vec<f64>,
    /// The structure of the law.
    pub structure: Structure,
    /// Every structure that was tried, with its mean NRMSE at 0.10 and 0.20 mm, each of which was left out in turn.
    pub tried: Vec<(Structure, f64)>,
    /// Results by density.
    pub densities: Vec<DensityResult>,
}

/// The result for one density.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DensityResult {
    /// Density, g/cm³.
    pub density: f64,
    /// The amplitude-independent law.
    pub law: FittedLaw,
    /// Coefficients of eq 13 that are the same for all amplitudes.
    pub equation_13: FittedLaw,
    /// NRMSE of the amplitude-independent law on the fitted loops, by amplitude and frequency.
    pub fitted: Vec<f64>,
    /// NRMSE of each law at 0.15 mm, by frequency.
    pub held_out: Vec<HeldOut>,
}

/// NRMSE of each law on one held-out loop.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HeldOut {
    /// Frequency, Hz.
    pub frequency: f64,
    /// NRMSE of eq 13 with the same coefficients for all amplitudes.
    pub equation_13: f64,
    /// NRMSE of the tables, interpolated between the rows on both sides.
    pub tables: f64,
    /// NRMSE of the published surfaces, eqs 16–19.
    pub surfaces: f64,
    /// NRMSE of the measured loops, interpolated phase by phase. This is no law: it shows the limit set by the scatter of the
    /// tables.
    pub loops: f64,
    /// NRMSE of the amplitude-independent law, computed by the crate in f32.
    pub law: f64,
}

/// The forces of one loop at the held-out amplitude, kN, for pictures.
#[derive(Clone, Debug)]
pub struct HeldOutLoop {
    /// mm
    pub displacement: Vec<f64>,
    /// The tables' own row.
    pub measured: Vec<f64>,
    /// As in [`HeldOut`].
    pub equation_13: Vec<f64>,
    /// As in [`HeldOut`].
    pub tables: Vec<f64>,
    /// As in [`HeldOut`].
    pub surfaces: Vec<f64>,
    /// As in [`HeldOut`].
    pub law: Vec<f64>,
}

/// Fits and compares at `frequencies` Hz.
///
/// # Errors
/// The crate refuses a law with an exponent or a coefficient out of its range.
pub fn study(frequencies: &[f64]) -> Result<Study, ModelError> {
    let loops: Vec<Loops> = (0..DENSITIES.len())
        .into_par_iter()
        .map(|density| Loops::of_tables(density, &FITTED, frequencies))
        .collect();
    let tried: Vec<(Structure, f64)> = structures()
        .into_par_iter()
        .map(|structure| (structure, left_out_error(&loops, structure, frequencies)))
        .collect();
    let structure = tried
        .iter()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .expect("there are structures to try")
        .0;
    let densities = loops
        .par_iter()
        .enumerate()
        .map(|(density, loops)| {
            DensityResult::new(
                density,
                loops.fit(structure, None),
                loops.fit(Structure::EQUATION_13, None),
                frequencies,
            )
        })
        .collect::<Result<_, _>>()?;
    Ok(Study {
        frequencies: frequencies.to_vec(),
        structure,
        tried,
        densities,
    })
}

/// Mean NRMSE over the densities and the two amplitudes between fitted ones, each with a law that was fitted to the other three.
fn left_out_error(loops: &[Loops], structure: Structure, frequencies: &[f64]) -> f64 {
    let errors = loops.iter().enumerate().flat_map(|(density, loops)| {
        BETWEEN.iter().flat_map(move |&row| {
            let law = loops.fit(structure, Some(row));
            frequencies
                .iter()
                .map(move |&frequency| law.error(density, row, frequency))
        })
    });
    let errors: Vec<f64> = errors.collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

impl Study {
    /// Means over the densities at frequency number `index`.
    pub fn mean(&self, index: usize) -> HeldOut {
        let count = self.densities.len() as f64;
        let mean = |of: fn(&HeldOut) -> f64| {
            let each = self.densities.iter().map(|one| of(&one.held_out[index]));
            each.sum::<f64>() / count
        };
        HeldOut {
            frequency: self.frequencies[index],
            equation_13: mean(|one| one.equation_13),
            tables: mean(|one| one.tables),
            surfaces: mean(|one| one.surfaces),
            loops: mean(|one| one.loops),
            law: mean(|one| one.law),
        }
    }
}

impl DensityResult {
    fn new(
        density: usize,
        law: FittedLaw,
        equation_13: FittedLaw,
        frequencies: &[f64],
    ) -> Result<Self, ModelError> {
        let mut result = Self {
            density: DENSITIES[density],
            fitted: Vec::new(),
            held_out: Vec::new(),
            law,
            equation_13,
        };
        for &row in &FITTED {
            for &frequency in frequencies {
                result
                    .fitted
                    .push(result.law.error(density, row, frequency));
            }
        }
        for &frequency in frequencies {
            let forces = result.held_out_loop(frequency)?;
            let error = |force: &[f64]| nrmse(force, &forces.measured, |_| true);
            result.held_out.push(HeldOut {
                frequency,
                equation_13: error(&forces.equation_13),
                tables: error(&forces.tables),
                surfaces: error(&forces.surfaces),
                loops: error(&loop_between(density, frequency)),
                law: error(&forces.law),
            });
        }
        Ok(result)
    }

    /// Every law's force over the held-out loop at `frequency` Hz.
    ///
    /// # Errors
    /// A law that the crate refuses.
    pub fn held_out_loop(&self, frequency: f64) -> Result<HeldOutLoop, ModelError> {
        let density = DENSITIES
            .iter()
            .position(|&density| density == self.density);
        let density = density.expect("a density of the tables");
        let sine = ticks_of(amplitude(HELD_OUT), frequency);
        Ok(HeldOutLoop {
            measured: sine.force_of_cell(HELD_OUT, density),
            equation_13: embedded_force(&self.equation_13.model(), &sine)?,
            tables: sine.force(&interpolated(density)),
            surfaces: sine.force(&of_surfaces(density)),
            law: embedded_force(&self.law.model(), &sine)?,
            displacement: sine.displacement,
        })
    }

    /// The law as a file for `hil predict` and `hil run`.
    pub fn model_file(&self, frequencies: &[f64]) -> ModelFile {
        let reach = AMPLITUDES.iter().copied().fold(0.0, f64::max);
        let fastest = frequencies.iter().copied().fold(0.0, f64::max);
        let speed = TAU * fastest * reach;
        let range = FittedRange {
            displacement: [-reach, reach],
            velocity: [-speed, speed],
        };
        ModelFile::new(self.law.model(), range)
    }
}

impl FittedLaw {
    /// NRMSE in f64 on the loop of the tables in row `row` and column `density`.
    fn error(&self, density: usize, row: usize, frequency: f64) -> f64 {
        let sine = Sine::new(amplitude(row), frequency, fit::SAMPLES);
        let measured = sine.force_of_cell(row, density);
        nrmse(&self.force(&sine), &measured, |_| true)
    }
}

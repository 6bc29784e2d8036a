//! The dependence of the finite elements on the gaps in the paper: the readings of Table 4, the contact between bore and mandrel,
//! and the mesh; and the static compression to which Table 4 was fitted.

use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES, cell};
use rayon::prelude::*;
use serde::Serialize;

use super::cells::FREQUENCY;
use super::comparison::{Compared, compared_on_its_samples};
use super::trends::TENTH;
use crate::finite_element::{
    Bore, Divisions, FiniteElementError, ForceLoop, Reading, RingModel, StaticCurve,
};

/// End of the compression in section 4.2, mm.
const COMPRESSION: f64 = 0.5;
/// Equal steps of it.
const POINTS: usize = 10;
/// Elements through the wall that are tried.
const MESHES: [usize; 4] = [1, 2, 3, 4];
/// Displacement for the comparison of meshes, mm: the largest amplitude of the tests.
const MESHES_AT: f64 = AMPLITUDES[4];

/// The results of the finite elements for each assumption.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ElementStudy {
    /// Results for every reading of Table 4.
    pub readings: Vec<TriedReading>,
    /// Results for every contact of the bore.
    pub bores: Vec<TriedBore>,
    /// Results for every mesh, from coarse to fine.
    pub meshes: Vec<TriedMesh>,
    /// Compressions, by density.
    pub compressions: Vec<Compression>,
}

/// The result for a reading of Table 4.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TriedReading {
    /// The reading.
    pub reading: Reading,
    /// Comparison of its steady loops at 0.1 mm with the tables' loops, by density, or the reason why there is none.
    pub by_density: Vec<Result<Compared, String>>,
}

/// The result for a bore, at 2.0 g/cm³ and 0.1 mm.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TriedBore {
    /// The contact between bore and mandrel.
    pub bore: Bore,
    /// The cycle counted from rest; null for the steady loop.
    pub cycle: Option<usize>,
    /// Comparison of the loop with the tables' loop, or the reason why there is none.
    pub found: Result<Compared, String>,
}

/// The result for a mesh, at 2.0 g/cm³.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TriedMesh {
    /// Elements through the wall.
    pub through: usize,
    /// Force of a sudden compression to 0.25 mm, kN, or the reason why there is none.
    pub force: Result<f64, String>,
}

/// The compression to 0.5 mm from Table 4 alone, with the bore as in the paper.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compression {
    /// Density, g/cm³.
    pub density: f64,
    /// The curve, or the reason why there is none.
    pub curve: Result<StaticCurve, String>,
}

impl ElementStudy {
    /// The result of `reading`.
    ///
    /// # Panics
    /// Never: every reading is tried.
    pub fn reading(&self, reading: Reading) -> &TriedReading {
        let found = self.readings.iter().find(|one| one.reading == reading);
        found.expect("every reading is tried")
    }

    /// The result of `bore`, in a cycle from rest or steady.
    ///
    /// # Panics
    /// If that was not tried.
    pub fn bore(&self, bore: Bore, cycle: Option<usize>) -> &TriedBore {
        let found = self
            .bores
            .iter()
            .find(|one| (one.bore, one.cycle) == (bore, cycle));
        found.expect("a bore that is tried")
    }
}

impl TriedReading {
    /// Mean NRMSE over the densities; none if a density has no loop.
    pub fn mean_error(&self) -> Option<f64> {
        let errors = self.by_density.iter().map(|one| one.as_ref().ok());
        let errors: Vec<f64> = errors.map(|one| Some(one?.nrmse)).collect::<Option<_>>()?;
        Some(errors.iter().sum::<f64>() / errors.len() as f64)
    }

    /// K of its loops, kN/mm; none if a density has no loop.
    pub fn stiffness(&self) -> Option<Vec<f64>> {
        let loops = self.by_density.iter().map(|one| one.as_ref().ok());
        loops.map(|one| Some(one?.dynamics.stiffness)).collect()
    }
}

impl Compression {
    /// Force at its point nearest to `displacement` mm, kN.
    pub fn force_at(&self, displacement: f64) -> Option<f64> {
        let point = displacement / COMPRESSION * POINTS as f64;
        self.curve
            .as_ref()
            .ok()?
            .force
            .get(point.round() as usize)
            .copied()
    }
}

/// The model for the comparison with the law: a ring that stays on its mandrel. A ring that may leave it has no steady loop, as
/// [`Bore::Separable`] explains.
pub fn model(density: f64) -> RingModel {
    RingModel {
        bore: Bore::Gliding,
        ..RingModel::new(density)
    }
}

/// Tries every choice separately, with everything else as in [`model`].
pub fn study() -> ElementStudy {
    let readings: Vec<(Reading, f64)> = Reading::ALL
        .into_iter()
        .flat_map(|reading| DENSITIES.map(|density| (reading, density)))
        .collect();
    let loops: Vec<Result<Compared, String>> = readings
        .into_par_iter()
        .map(|(reading, density)| {
            let model = RingModel {
                reading,
                ..model(density)
            };
            compared(&model, None)
        })
        .collect();
    let readings = Reading::ALL.into_iter().zip(loops.chunks(DENSITIES.len()));
    let bores = [
        (Bore::Separable, Some(1)),
        (Bore::Separable, Some(3)),
        (Bore::Gliding, None),
        (Bore::Bonded, None),
    ];
    ElementStudy {
        readings: readings
            .map(|(reading, loops)| TriedReading {
                reading,
                by_density: loops.to_vec(),
            })
            .collect(),
        bores: bores
            .into_par_iter()
            .map(|(bore, cycle)| TriedBore {
                bore,
                cycle,
                found: compared(
                    &RingModel {
                        bore,
                        ..model(DENSITIES[0])
                    },
                    cycle,
                ),
            })
            .collect(),
        meshes: MESHES
            .into_par_iter()
            .map(|through| TriedMesh {
                through,
                force: force(&RingModel {
                    divisions: Divisions::through_wall(through),
                    ..model(DENSITIES[0])
                }),
            })
            .collect(),
        compressions: DENSITIES
            .into_par_iter()
            .map(|density| Compression {
                density,
                curve: RingModel::new(density)
                    .static_curve(COMPRESSION, POINTS)
                    .map_err(in_words),
            })
            .collect(),
    }
}

/// The loop at 0.1 mm of a cycle from rest, or the steady one, compared to the tables'.
fn compared(model: &RingModel, cycle: Option<usize>) -> Result<Compared, String> {
    let column = DENSITIES.iter().position(|&one| one == model.density);
    let law = cell(TENTH, column.expect("a density of the tables"));
    let amplitude = AMPLITUDES[TENTH];
    let found: Result<ForceLoop, FiniteElementError> = match cycle {
        Some(cycle) => model.loop_of_cycle(amplitude, FREQUENCY, cycle),
        None => model.steady_loop(amplitude, FREQUENCY),
    };
    let found = found.map_err(in_words)?;
    Ok(compared_on_its_samples(&found, &law))
}

fn force(model: &RingModel) -> Result<f64, String> {
    let curve = model
        .static_curve(MESHES_AT, POINTS / 2)
        .map_err(in_words)?;
    Ok(curve.force[POINTS / 2])
}

fn in_words(error: FiniteElementError) -> String {
    error.to_string()
}

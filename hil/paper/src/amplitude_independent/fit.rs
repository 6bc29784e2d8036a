//! One law for every amplitude, fitted to loops of several amplitudes.
//!
//! F = k1·y + k3·y³ + c·(1 + λ·|y|)·|v|^α·sgn v + Σ kᵢ·zᵢ
//!
//! λ is the share of the load in the friction, and kᵢ, zᵢ are Jenkins elements. For a given α the force is linear in everything
//! except the slip limits. So the search depends on no start: α runs over a grid, the slip limits are picked from another grid, and
//! the rest is least squares with c, λ and kᵢ not below 0, which keeps the law passive.

use std::collections::BTreeMap;

use mesh_damper::effects::{
    AugmentedLaw, Effect, Equations as _, LoadFriction, MAX_STICK_SLIP_ELEMENTS, Motion, StickSlip,
};
use mesh_damper::law::Law;
use mesh_damper_model::{AddedEffect, Family, LawNode, Model};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::loops::{Sine, amplitude};
use crate::nonnegative;

/// Samples of a cycle in a fit.
pub const SAMPLES: usize = 200;
/// Candidate slip limits, and their ends, mm: a tenth of the smallest amplitude, and nearly the largest.
const LIMITS: usize = 12;
const LIMIT_RANGE: (f64, f64) = (0.005, 0.2);
/// Below this |y|, mm, friction does not depend on the load. So λ is at most its inverse, and c is not 0 even if all friction comes
/// from the load.
const UNLOADED: f64 = 1e-3;
/// Step of the exponent, and how many of them the search takes at once until it is near.
const FINE: f64 = 0.01;
const COARSE: usize = 5;

/// Places of the columns: first those that may be negative.
const K1: usize = 0;
const K3: usize = 1;
const FREE: usize = 2;
const C: usize = 2;
const LOAD: usize = 3;
const ELEMENTS: usize = 4;
const WIDTH: usize = ELEMENTS + LIMITS;

/// The structure of a law: its terms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Structure {
    /// Whether the law has friction that grows with |y|.
    pub load_friction: bool,
    /// Largest number of Jenkins elements, up to [`MAX_STICK_SLIP_ELEMENTS`].
    pub elements: usize,
    /// Weight of the penalty on coefficients, which is added to the error. The penalty is the square of a coefficient's part of a
    /// loop's force, times the square of this weight.
    pub ridge: f64,
}

impl Structure {
    /// Eq 13 alone.
    pub const EQUATION_13: Self = Self {
        load_friction: false,
        elements: 0,
        ridge: 1e-6,
    };
}

/// The normal equations of one loop at one exponent. Its force has norm 1, so that every loop counts by its relative error.
#[derive(Clone, Debug)]
struct Equations {
    gram: DMatrix<f64>,
    right: DVector<f64>,
}

/// Loops of one density for the fit of laws, as normal equations.
pub struct Loops {
    /// By loop, then by exponent in steps of [`FINE`].
    equations: Vec<Vec<Equations>>,
    rows: Vec<usize>,
}

/// One set of coefficients of a law.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedLaw {
    /// Linear stiffness, kN/mm.
    pub k1: f64,
    /// Cubic stiffness, kN/mm³.
    pub k3: f64,
    /// Damping coefficient, kN·(s/mm)^α.
    pub c: f64,
    /// Damping exponent α of the velocity, dimensionless.
    pub alpha: f64,
    /// Load coefficient λ of the friction, 1/mm.
    pub load: f64,
    /// Jenkins elements: stiffness, kN/mm, and slip limit, mm.
    pub elements: Vec<(f64, f64)>,
}

impl Loops {
    /// The loops of column `density` of the tables in `rows`, each at all `frequencies` in Hz.
    pub fn of_tables(density: usize, rows: &[usize], frequencies: &[f64]) -> Self {
        let each = rows
            .iter()
            .flat_map(|&row| frequencies.iter().map(move |&frequency| (row, frequency)));
        let (rows, equations) = each
            .map(|(row, frequency)| {
                let sine = Sine::new(amplitude(row), frequency, SAMPLES);
                let force = sine.force_of_cell(row, density);
                (row, equations(&sine, &force))
            })
            .unzip();
        Self { equations, rows }
    }

    /// The best law of `structure` over all loops except those of the row `left_out`.
    ///
    /// # Panics
    /// Without a loop.
    pub fn fit(&self, structure: Structure, left_out: Option<usize>) -> FittedLaw {
        let sums = self.sums(left_out);
        let last = sums.len() - 1;
        let best = |exponents: &mut dyn Iterator<Item = usize>| {
            exponents
                .filter_map(|exponent| sums[exponent].fit(&structure, exponent))
                .min_by(|a, b| a.cost.total_cmp(&b.cost))
                .expect("a sine's columns are independent, and the ridge makes sure")
        };
        let near = best(&mut (0..=last).step_by(COARSE)).exponent;
        best(&mut (near.saturating_sub(COARSE)..=(near + COARSE).min(last))).law()
    }

    /// The equations of all loops except those of the row `left_out`, by exponent.
    fn sums(&self, left_out: Option<usize>) -> Vec<Equations> {
        let taken = self.rows.iter().zip(&self.equations);
        let taken = taken.filter(|&(&row, _)| Some(row) != left_out);
        taken
            .map(|(_, equations)| equations.clone())
            .reduce(|mut sums, equations| {
                for (sum, one) in sums.iter_mut().zip(equations) {
                    sum.gram += one.gram;
                    sum.right += one.right;
                }
                sums
            })
            .expect("there is a loop")
    }
}

impl Equations {
    /// The best law of `structure` at this exponent.
    fn fit(&self, structure: &Structure, exponent: usize) -> Option<Fit> {
        let mut columns: Vec<usize> = (0..WIDTH)
            .filter(|&column| match column {
                LOAD => structure.load_friction,
                ELEMENTS.. => structure.elements > 0,
                _ => true,
            })
            .collect();
        let mut fit = self.solve(&columns, structure, exponent)?;
        loop {
            columns.retain(|&column| column < ELEMENTS || fit.coefficients[column] > 0.0);
            let elements = columns.iter().filter(|&&column| column >= ELEMENTS);
            if elements.clone().count() <= structure.elements {
                return Some(fit);
            }
            // The element with the smallest effect is removed.
            let without = |gone: usize| {
                let rest = columns.iter().copied().filter(|&column| column != gone);
                self.solve(&rest.collect::<Vec<_>>(), structure, exponent)
            };
            fit = elements
                .filter_map(|&gone| without(gone))
                .min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        }
    }

    /// The minimum of the squared error and the ridge over `columns`. The cost leaves out the squares of the forces, which are the
    /// same for all.
    fn solve(&self, columns: &[usize], structure: &Structure, exponent: usize) -> Option<Fit> {
        let count = columns.len();
        let scale = |i: usize| 1.0 / self.gram[(columns[i], columns[i])].sqrt();
        let gram = DMatrix::from_fn(count, count, |i, j| {
            let ridge = if i == j { structure.ridge.powi(2) } else { 0.0 };
            self.gram[(columns[i], columns[j])] * scale(i) * scale(j) + ridge
        });
        let right = DVector::from_fn(count, |i, _| self.right[columns[i]] * scale(i));
        let x = nonnegative::solve(&gram, &right, FREE)?;
        let cost = (&gram * &x - 2.0 * &right).dot(&x);
        let mut coefficients = [0.0; WIDTH];
        for (i, &column) in columns.iter().enumerate() {
            coefficients[column] = x[i] * scale(i);
        }
        Some(Fit {
            cost,
            exponent,
            coefficients,
        })
    }
}

/// A law at one exponent.
struct Fit {
    cost: f64,
    exponent: usize,
    coefficients: [f64; WIDTH],
}

impl Fit {
    fn law(&self) -> FittedLaw {
        let x = &self.coefficients;
        let c = x[C] + UNLOADED * x[LOAD];
        FittedLaw {
            k1: x[K1],
            k3: x[K3],
            c,
            alpha: FINE * self.exponent as f64,
            load: if x[LOAD] > 0.0 { x[LOAD] / c } else { 0.0 },
            elements: (0..LIMITS)
                .map(|index| (x[ELEMENTS + index], slip_limit(index)))
                .filter(|&(stiffness, _)| stiffness > 0.0)
                .collect(),
        }
    }
}

impl FittedLaw {
    /// The force in kN on the closed loop under `sine`, in f64.
    pub fn force(&self, sine: &Sine) -> Vec<f64> {
        let mut force: Vec<f64> = sine
            .displacement
            .iter()
            .zip(&sine.velocity)
            .map(|(&y, &v)| {
                let friction = self.c * v.abs().powf(self.alpha) * v.signum();
                self.k1 * y + self.k3 * y.powi(3) + friction * (1.0 + self.load * y.abs())
            })
            .collect();
        for &(stiffness, slip_limit) in &self.elements {
            for (force, stretch) in force.iter_mut().zip(steady_stretch(sine, slip_limit)) {
                *force += stiffness * stretch;
            }
        }
        force
    }

    /// As a model for the rig: one node, which no amplitude selects.
    pub fn model(&self) -> Model {
        let mut effects = Vec::new();
        let mut add = |family, parameters: BTreeMap<String, f64>| {
            effects.push(AddedEffect { family, parameters });
        };
        if !self.elements.is_empty() {
            let parameters = (1..)
                .zip(&self.elements)
                .flat_map(|(number, &(stiffness, limit))| {
                    let name = |of: &str| match number {
                        1 => of.to_owned(),
                        _ => format!("{of}_{number}"),
                    };
                    [(name("stiffness"), stiffness), (name("slip_limit"), limit)]
                });
            add(
                Family::of(&StickSlip::<f64>::DESCRIPTION),
                parameters.collect(),
            );
        }
        if self.load > 0.0 {
            add(
                Family::of(&LoadFriction::<f64>::DESCRIPTION),
                [("load".to_owned(), self.load)].into(),
            );
        }
        Model {
            law: vec![LawNode {
                amplitude: 0.0,
                k1: self.k1,
                k3: self.k3,
                c: self.c,
                alpha: self.alpha,
            }],
            effects,
            correction: None,
            controls: Vec::new(),
        }
    }
}

/// Candidate slip limit `index`, mm.
fn slip_limit(index: usize) -> f64 {
    let (least, largest) = LIMIT_RANGE;
    least * (largest / least).powf(index as f64 / (LIMITS - 1) as f64)
}

/// The equations of `force` kN under `sine`, for every exponent.
fn equations(sine: &Sine, force: &[f64]) -> Vec<Equations> {
    let norm = force.iter().map(|f| f * f).sum::<f64>().sqrt();
    let target = DVector::from_fn(SAMPLES, |n, _| force[n] / norm);
    let mut columns = DMatrix::zeros(SAMPLES, WIDTH);
    for index in 0..LIMITS {
        let stretch = steady_stretch(sine, slip_limit(index));
        columns.set_column(ELEMENTS + index, &(DVector::from_vec(stretch) / norm));
    }
    for n in 0..SAMPLES {
        let y = sine.displacement[n];
        columns[(n, K1)] = y / norm;
        columns[(n, K3)] = y.powi(3) / norm;
    }
    let last = (1.0 / FINE).round() as usize;
    (0..=last)
        .map(|exponent| {
            for n in 0..SAMPLES {
                let (y, v) = (sine.displacement[n], sine.velocity[n]);
                let friction = v.abs().powf(FINE * exponent as f64) * v.signum() / norm;
                columns[(n, C)] = friction;
                columns[(n, LOAD)] = (UNLOADED + y.abs()) * friction;
            }
            Equations {
                gram: columns.tr_mul(&columns),
                right: columns.tr_mul(&target),
            }
        })
        .collect()
}

/// The stretch in mm of a Jenkins element on its closed loop, taken from the second cycle, after which nothing changes.
fn steady_stretch(sine: &Sine, slip_limit: f64) -> Vec<f64> {
    let law = Law::new(0.0, 0.0, 0.0, 0.0).and_then(|nothing| {
        let element = StickSlip::new(&[(1.0, slip_limit)])?;
        AugmentedLaw::<f64, 1>::new(nothing).with(Effect::StickSlip(element))
    });
    let law = law.expect("a stiffness of 1 kN/mm and the slip limits are in range");
    let mut state = law.at_rest();
    let mut cycle = || -> Vec<f64> {
        let samples = sine.displacement.iter();
        samples
            .map(|&displacement| {
                let motion = Motion::at(displacement, 0.0);
                law.force(&mut state, &motion)
            })
            .collect()
    };
    cycle();
    cycle()
}

/// All structures that are tried.
pub fn structures() -> Vec<Structure> {
    let mut all = Vec::new();
    for load_friction in [false, true] {
        for elements in [0, 1, 2, 3, MAX_STICK_SLIP_ELEMENTS] {
            for ridge in [0.03, 0.1, 0.3] {
                all.push(Structure {
                    load_friction,
                    elements,
                    ridge,
                });
            }
        }
    }
    all
}

//! Section 3.1: eqs 8–12 and Tables 4 and 5, as far as no mesh is needed.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::cells::Cell;
use super::claim::{Claim, Verdict, is_rising, least_and_largest, listed};
use crate::reference::tables::DENSITIES;

/// Table 4: C10, C01 and C11 in MPa by density.
const TABLE_4: [[f64; 3]; 5] = [
    [1.9, -0.5, 31.0],
    [60.0, -54.0, 100.0],
    [4.0, -0.1, 60.0],
    [60.0, -54.0, 90.0],
    [40.0, -14.0, 36.0],
];

/// Table 4, D1, at every density.
const D1: f64 = 0.35;

/// Table 5: shares of the sudden shear modulus, and relaxation times in s.
const TABLE_5: [(f64, f64); 2] = [(0.5548, 0.4), (0.4336, 0.2)];

/// The constants of eq 9, MPa.
#[derive(Clone, Copy, Debug)]
struct MooneyRivlin {
    c10: f64,
    c01: f64,
    c11: f64,
    /// Half the bulk modulus.
    d: f64,
}

impl MooneyRivlin {
    /// Of column `density` of Tables 6–9.
    fn of_table_4(density: usize, d: f64) -> Self {
        let [c10, c01, c11] = TABLE_4[density];
        Self { c10, c01, c11, d }
    }

    /// 2·(C10 + C01), MPa.
    fn shear_modulus(&self) -> f64 {
        2.0 * (self.c10 + self.c01)
    }

    /// Where nothing is deformed.
    fn poisson_ratio(&self) -> f64 {
        let (bulk, shear) = (2.0 * self.d, self.shear_modulus());
        (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear))
    }
}

/// The static test's end, s: 0.5 mm at 5 mm/min.
const STATIC_TEST: f64 = 6.0;

/// The claims of section 3.1 and of Tables 4 and 5.
pub fn claims(cells: &[[Cell; 5]; 5]) -> Vec<Claim> {
    vec![
        stress(),
        stress_of_table_4(),
        stiffness_by_density(),
        compressibility(),
        relaxation(cells),
        static_fit(),
    ]
}

/// Energy of eq 9 with C10, C01, C11 and D, MPa.
fn energy(material: &MooneyRivlin, deformation: &Matrix3<f64>) -> f64 {
    let j = deformation.determinant();
    let b = deformation * deformation.transpose() * j.powf(-2.0 / 3.0);
    let (i1, i2) = (b.trace(), 0.5 * (b.trace().powi(2) - (b * b).trace()));
    material.c10 * (i1 - 3.0)
        + material.c01 * (i2 - 3.0)
        + material.c11 * (i1 - 3.0) * (i2 - 3.0)
        + material.d * (j - 1.0).powi(2)
}

/// Cauchy stress from it, ∂W/∂F·Fᵀ/J by central differences, MPa.
fn stress_of_energy(material: &MooneyRivlin, deformation: &Matrix3<f64>) -> Matrix3<f64> {
    let step = 1e-6;
    let slope = Matrix3::from_fn(|i, j| {
        let moved = |by: f64| {
            let mut moved = *deformation;
            moved[(i, j)] += by;
            energy(material, &moved)
        };
        (moved(step) - moved(-step)) / (2.0 * step)
    });
    slope * deformation.transpose() / deformation.determinant()
}

/// Eq 10, MPa.
fn stress_of_equation_10(material: &MooneyRivlin, deformation: &Matrix3<f64>) -> Matrix3<f64> {
    let MooneyRivlin { c10, c01, d, .. } = *material;
    let j = deformation.determinant();
    let b = deformation * deformation.transpose() * j.powf(-2.0 / 3.0);
    let (i1, i2) = (b.trace(), 0.5 * (b.trace().powi(2) - (b * b).trace()));
    let pressure = 2.0 * d * (j - 1.0) - 2.0 * i1 * c10 / (3.0 * j) - 4.0 * i2 * c01 / (3.0 * j);
    b * (2.0 / j * (c10 + c01 * i1)) - b * b * (2.0 * c01 / j) + Matrix3::identity() * pressure
}

/// A deformation without any symmetry.
fn general() -> Matrix3<f64> {
    Matrix3::new(1.12, 0.08, -0.03, 0.05, 0.91, 0.11, -0.04, 0.07, 1.03)
}

fn stress() -> Claim {
    let material = MooneyRivlin {
        c11: 0.0,
        ..MooneyRivlin::of_table_4(0, D1)
    };
    let of_energy = stress_of_energy(&material, &general());
    let difference =
        (stress_of_equation_10(&material, &general()) - of_energy).norm() / of_energy.norm();
    Claim::new(
        "equation_10",
        "§3.1.1, eqs 8–10",
        "Eq 10 is the Cauchy stress of the Mooney–Rivlin energy.",
        Verdict::of(difference < 1e-6),
        "of C10, C01 and D, with b the left Cauchy–Green tensor: of second order and of the deformation, not of fourth order and \
         of material parameters as the text has it",
    )
    .with("relative difference to the energy's slope", difference)
}

fn stress_of_table_4() -> Claim {
    // 0.5 mm of the 5 mm wall.
    let pressed = Matrix3::from_diagonal(&Vector3::new(0.9, 1.0, 1.0));
    let shares: Vec<f64> = (0..5)
        .map(|density| {
            let material = MooneyRivlin::of_table_4(density, 1.0 / D1);
            let of_energy = stress_of_energy(&material, &pressed);
            (stress_of_equation_10(&material, &pressed) - of_energy).norm() / of_energy.norm()
        })
        .collect();
    Claim::new(
        "equation_10_of_table_4",
        "eq 10, Table 4",
        "Eq 10 is the stress of the material that Table 4 gives constants of.",
        Verdict::of(shares.iter().all(|&share| share < 1e-6)),
        format!(
            "it lacks C11 of Table 4: in a wall pressed by a tenth {} of the stress",
            listed(&shares, 3)
        ),
    )
    .with_each("part of the stress that eq 10 lacks", &DENSITIES, &shares)
}

fn stiffness_by_density() -> Claim {
    let shear: Vec<f64> = (0..5)
        .map(|density| MooneyRivlin::of_table_4(density, D1).shear_modulus())
        .collect();
    Claim::new(
        "table_4_stiffens_with_density",
        "Table 4, for §4.7",
        "The constants make a denser mesh stiffer.",
        Verdict::of(is_rising(&shear)),
        format!(
            "the shear modulus 2(C10 + C01) is {} MPa: equal at 2.5 and 3.5 g/cm³, lower between",
            listed(&shear, 1)
        ),
    )
    .with_each("shear modulus, MPa,", &DENSITIES, &shear)
}

fn compressibility() -> Claim {
    let by = |d| -> Vec<f64> {
        (0..5)
            .map(|density| MooneyRivlin::of_table_4(density, d).poisson_ratio())
            .collect()
    };
    // W = D·(J − 1)² of eq 8, and (J − 1)²/D1 of the program that the paper used.
    let (as_modulus, as_parameter) = (by(D1), by(1.0 / D1));
    Claim::new(
        "d1_is_in_mpa",
        "Table 4, eq 8",
        "D1 = 0.35 is a constant in MPa.",
        Verdict::CannotTell,
        format!(
            "as eq 8 has it, Poisson's ratio is {}; as the program's parameter in 1/MPa it is {}. Neither is above 0 at every \
             density",
            listed(&as_modulus, 2),
            listed(&as_parameter, 2)
        ),
    )
    .with_each("Poisson's ratio, in MPa,", &DENSITIES, &as_modulus)
    .with_each("Poisson's ratio, in 1/MPa,", &DENSITIES, &as_parameter)
}

/// What is left of the shear modulus after any time.
fn lasting() -> f64 {
    1.0 - TABLE_5.iter().map(|(share, _)| share).sum::<f64>()
}

fn relaxation(cells: &[[Cell; 5]; 5]) -> Claim {
    let all = cells.iter().flatten().map(|cell| cell.dynamics.loss_factor);
    let (least, most) = least_and_largest(all);
    // Of the series at 1 Hz: g∞ + Σ g·x²/(1 + x²) and Σ g·x/(1 + x²) with x = ωτ.
    let (storage, loss) =
        TABLE_5
            .iter()
            .fold((lasting(), 0.0), |(storage, loss), (share, time)| {
                let x = TAU * time;
                let part = share * x / (1.0 + x * x);
                (storage + part * x, loss + part)
            });
    Claim::new(
        "table_5_fits_the_curves",
        "§4.2, Table 5",
        "The Prony parameters are calibrated so that the curves are well fitted.",
        Verdict::CannotTell,
        format!(
            "the curves are not given. At 1 Hz the series has a loss factor of {:.2} in shear at every density and amplitude, \
             where the loops have {least:.2} to {most:.2}",
            loss / storage
        ),
    )
    .with("storage modulus over the sudden one, 1 Hz", storage)
    .with("loss modulus over the sudden one, 1 Hz", loss)
    .with("loss factor in shear, 1 Hz", loss / storage)
    .with("lasting part", lasting())
}

fn static_fit() -> Claim {
    let left: f64 = TABLE_5
        .iter()
        .map(|(share, time)| share * (-STATIC_TEST / time).exp())
        .sum::<f64>()
        + lasting();
    Claim::new(
        "tables_4_and_5_belong_together",
        "§4.2, Tables 4, 5",
        "One material has the constants of Table 4 in the compression to 0.5 mm and those of Table 5 in the sine.",
        Verdict::CannotTell,
        format!(
            "the compression at 5 mm/min takes 6 s, in which Table 5 lets the shear relax to {:.1} % of its sudden stiffness: the \
             constants fitted there can't be the sudden ones of the sine; which they are is not said, nor is the curve given",
            100.0 * left
        ),
    )
    .with("shear left after 6 s", left)
}

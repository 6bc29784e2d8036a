//! Section 3.1: eqs 8–12, Tables 4 and 5, and their results for the ring.

use std::f64::consts::TAU;

use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_reference::tables::{DENSITIES, cell};
use nalgebra::{Matrix3, Vector3};

use super::cells::{Cell, FREQUENCY};
use super::claim::{Claim, Verdict, is_rising, listed};
use super::elements::{ElementStudy, TriedReading};
use super::methods::WELL;
use crate::finite_element::{Bore, MooneyRivlin, Reading, SignReading, TABLE_5, VolumetricReading};

/// The static test's end, s: 0.5 mm at 5 mm/min.
const STATIC_TEST: f64 = 6.0;

/// The claims of section 3.1 and of Tables 4 and 5.
pub fn claims(cells: &[[Cell; 5]; 5], study: &ElementStudy) -> Vec<Claim> {
    vec![
        stress(),
        stress_of_table_4(),
        stiffness_by_density(),
        compressibility(study),
        signs(study),
        integral(),
        relaxation(cells),
        static_fit(),
        compression(study),
        separable_contact(study),
    ]
}

fn material(density: f64, volumetric: VolumetricReading) -> MooneyRivlin {
    let reading = Reading {
        volumetric,
        sign: SignReading::AsPrinted,
    };
    reading
        .material(density)
        .expect("Table 4 has the densities of Tables 6–9")
}

/// Energy of eq 9 with C10, C01, C11 and D, MPa.
fn energy(material: &MooneyRivlin, deformation: &Matrix3<f64>) -> f64 {
    let c = deformation.transpose() * deformation;
    material.isochoric_energy(&c) + material.volumetric_energy(deformation.determinant())
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
        ..material(2.0, VolumetricReading::Equation8)
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
    let shares: Vec<f64> = DENSITIES
        .iter()
        .map(|&density| {
            let material = material(density, VolumetricReading::Incompressibility);
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
    let shear =
        DENSITIES.map(|density| material(density, VolumetricReading::Equation8).shear_modulus());
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

/// Mean NRMSE of the loops at 0.1 mm for a reading, for the text.
fn error_of(tried: &TriedReading) -> String {
    match tried.mean_error() {
        Some(error) => format!("{error:.2}"),
        None => "no loop at some density".to_owned(),
    }
}

/// As [`Claim::with`] for a reading's mean error, if it has loops at every density.
fn with_error(claim: Claim, reading: &str, tried: &TriedReading) -> Claim {
    match tried.mean_error() {
        Some(error) => claim.with(format!("mean NRMSE at 0.1 mm, {reading}"), error),
        None => claim,
    }
}

/// Whether the loops distinguish the printed reading from `others`: a reading that fits them holds only if it is the only one.
fn told(printed: &TriedReading, others: &[&TriedReading]) -> Verdict {
    let meets = |tried: &TriedReading| tried.mean_error().is_some_and(|error| error < WELL);
    match (meets(printed), others.iter().any(|other| meets(other))) {
        (true, false) => Verdict::Holds,
        (false, true) => Verdict::Fails,
        (true, true) | (false, false) => Verdict::CannotTell,
    }
}

fn compressibility(study: &ElementStudy) -> Claim {
    let by = |reading| DENSITIES.map(|density| material(density, reading).poisson_ratio());
    let (as_modulus, as_parameter) = (
        by(VolumetricReading::Equation8),
        by(VolumetricReading::Incompressibility),
    );
    let tried = |volumetric| {
        study.reading(Reading {
            volumetric,
            sign: SignReading::AsPrinted,
        })
    };
    let readings = [
        ("D1 in MPa", tried(VolumetricReading::Equation8)),
        ("D1 in 1/MPa", tried(VolumetricReading::Incompressibility)),
        (
            "D1 as Poisson's ratio",
            tried(VolumetricReading::PoissonRatio),
        ),
    ];
    let [modulus, parameter, ratio] = readings.map(|(_, tried)| error_of(tried));
    let [(_, printed), others @ ..] = readings;
    let claim = Claim::new(
        "d1_is_in_mpa",
        "Table 4, eq 8",
        "D1 = 0.35 is a constant in MPa.",
        told(printed, &others.map(|(_, tried)| tried)),
        format!(
            "as eq 8 has it, Poisson's ratio is {}; as the program's parameter in 1/MPa it is {}. Neither is above 0 at every \
             density. The loops at 0.1 mm then err by {modulus} and {parameter} on average, with 0.35 as Poisson's ratio by {ratio} \
             (NRMSE): no reading makes them right at every density",
            listed(&as_modulus, 2),
            listed(&as_parameter, 2)
        ),
    )
    .with_each("Poisson's ratio, in MPa,", &DENSITIES, &as_modulus)
    .with_each("Poisson's ratio, in 1/MPa,", &DENSITIES, &as_parameter);
    readings
        .into_iter()
        .fold(claim, |claim, (name, tried)| with_error(claim, name, tried))
}

fn signs(study: &ElementStudy) -> Claim {
    let (printed, positive) = [SignReading::AsPrinted, SignReading::Positive]
        .map(|sign| {
            study.reading(Reading {
                volumetric: VolumetricReading::Incompressibility,
                sign,
            })
        })
        .into();
    let stiffness = |tried: &TriedReading| tried.stiffness().unwrap_or_default();
    let (k_printed, k_positive) = (stiffness(printed), stiffness(positive));
    let claim = Claim::new(
        "c01_is_negative",
        "Table 4",
        "C01 is below 0 at every density.",
        told(printed, &[positive]),
        format!(
            "the signs may be dashes. As printed the ring at 0.1 mm has K = {} kN/mm and its loops err by {} on average; with \
             positive ones K = {} kN/mm, stiffest at 2.5 and 3.5 g/cm³, and they err by {} (NRMSE)",
            listed(&k_printed, 2),
            error_of(printed),
            listed(&k_positive, 2),
            error_of(positive)
        ),
    )
    .with_each("K as printed, kN/mm,", &DENSITIES, &k_printed)
    .with_each("K with positive signs, kN/mm,", &DENSITIES, &k_positive);
    let claim = with_error(claim, "signs as printed", printed);
    with_error(claim, "positive signs", positive)
}

/// The result of eq 11 for a quarter of the sine after rest, over the instantaneous modulus and the strain's amplitude: integrated
/// over the past τ, and over dt as printed. The latter leaves τ undefined: the start of the motion, or now.
fn integral() -> Claim {
    let (steps, now) = (10_000, 0.25 / FREQUENCY);
    let rate = |time: f64| TAU * FREQUENCY * (TAU * FREQUENCY * time).cos();
    let over = |integrand: &dyn Fn(f64) -> f64| -> f64 {
        let step = now / f64::from(steps);
        let middles = (0..steps).map(|i| (f64::from(i) + 0.5) * step);
        middles.map(integrand).sum::<f64>() * step
    };
    let past = over(&|tau| TABLE_5.left_after(now - tau) * rate(tau));
    let printed = |tau: f64| over(&|time| TABLE_5.left_after(time - tau) * rate(tau));
    let (from_start, from_now) = (printed(0.0), printed(now));
    let same = |value: f64| (value / past - 1.0).abs() < 1e-3;
    Claim::new(
        "equation_11",
        "§3.1.1, eqs 11, 12",
        "The stress is an integral over dt of G(t − τ) and K(t − τ) times the rate of strain.",
        Verdict::of(same(from_start) && same(from_now)),
        format!(
            "over dτ: over the past. A quarter of a sine at 1 Hz after rest the series of Table 5 leaves {past:.2} of the sudden \
             stress; over dt it is {from_start:.2} with τ at the start and {from_now:.2} with τ at the end. Eq 12 lets G and K \
             relax, Table 5 gives a series for G alone, so that here the volume does not"
        ),
    )
    .with("stress over dτ", past)
    .with("stress over dt, τ at the start", from_start)
    .with("stress over dt, τ at the end", from_now)
}

fn relaxation(cells: &[[Cell; 5]; 5]) -> Claim {
    let all = cells.iter().flatten().map(|cell| cell.dynamics.loss_factor);
    let (least, most) = least_and_largest(all);
    let (storage, loss) = TABLE_5.moduli(FREQUENCY);
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
    .with("lasting part", TABLE_5.lasting())
}

fn static_fit() -> Claim {
    let left = TABLE_5.left_after(STATIC_TEST);
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

fn compression(study: &ElementStudy) -> Claim {
    let at = |displacement| -> Vec<f64> {
        let all = study.compressions.iter();
        all.filter_map(|one| one.force_at(displacement)).collect()
    };
    let (halfway, forces) = (at(0.25), at(0.5));
    // The elastic force of Tables 6 and 7 at the largest amplitude.
    let elastic: Vec<f64> = (0..5)
        .map(|column| cell(4, column).elastic_force(0.25))
        .collect();
    Claim::new(
        "table_4_fits_the_compression",
        "§4.2, Table 4",
        "The constants are fitted against the compression to 0.5 mm.",
        Verdict::CannotTell,
        format!(
            "the curve is not given. By Table 4 the ring takes {} kN at 0.5 mm, and at 0.25 mm {} kN, where the elastic part of \
             Tables 6 and 7 has {} kN",
            listed(&forces, 2),
            listed(&halfway, 2),
            listed(&elastic, 2)
        ),
    )
    .with_each("force at 0.5 mm, kN,", &DENSITIES, &forces)
    .with_each("force at 0.25 mm, kN,", &DENSITIES, &halfway)
    .with_each("elastic force of the tables at 0.25 mm, kN,", &DENSITIES, &elastic)
}

fn separable_contact(study: &ElementStudy) -> Claim {
    let (name, place, says) = (
        "separable_contact",
        "§3.1.2",
        "The ring may leave the mandrel, without friction, as in the test.",
    );
    let stiffness = |bore, cycle| -> Result<f64, &str> {
        let found = study.bore(bore, cycle).found.as_ref();
        Ok(found.map_err(String::as_str)?.dynamics.stiffness)
    };
    let of_all = || {
        Ok::<_, &str>([
            stiffness(Bore::Separable, Some(1))?,
            stiffness(Bore::Separable, Some(3))?,
            stiffness(Bore::Gliding, None)?,
            stiffness(Bore::Bonded, None)?,
        ])
    };
    match of_all() {
        Err(why) => Claim::new(name, place, says, Verdict::CannotTell, why),
        Ok([first, third, gliding, bonded]) => Claim::new(
            name,
            place,
            says,
            Verdict::CannotTell,
            format!(
                "then no loop of the model is steady: nothing presses the bore on and 1.2 % of the stiffness lasts, so that K at \
                 2.0 g/cm³, 0.1 mm is {first:.3} kN/mm in the first cycle and {third:.3} in the third. Which cycle is meant is \
                 not said; below, the bore stays on the mandrel, without friction ({gliding:.3}; bonded to it {bonded:.3})"
            ),
        )
        .with("K of the first cycle, kN/mm", first)
        .with("K of the third cycle, kN/mm", third)
        .with("K of a bore that stays on, kN/mm", gliding)
        .with("K of a bonded bore, kN/mm", bonded),
    }
}

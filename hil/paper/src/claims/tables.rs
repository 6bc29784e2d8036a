//! Sections 3.2 and 4.3: the law, its identification, Tables 6–9 and eqs 16–20.

use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_reference::comparison::r_squared;
use mesh_damper_reference::cubic_fit;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::surfaces::{self, Equation18};
use mesh_damper_reference::tables::{self, AMPLITUDES, DENSITIES};

use super::cells::{Cell, dynamics};
use super::claim::{Claim, Verdict, spread};
use super::misprints::{FitCheck, LeftOut};
use crate::amplitude_independent::Sine;
use crate::surfaces::{loop_errors, mean_and_largest};

/// The evidence for misprints.
pub struct Evidence<'a> {
    /// For eqs 17, 18 and 19.
    pub checks: &'a [FitCheck; 3],
    /// For Table 7's last row.
    pub readings: &'a [([f64; 5], f64)],
    /// For every cell.
    pub left_out: &'a [LeftOut],
}

/// The claims of sections 3.2 and 4.3.
pub fn claims(cells: &[[Cell; 5]; 5], evidence: &Evidence<'_>) -> Vec<Claim> {
    let [k3, c, alpha] = evidence.checks;
    vec![
        limits(),
        asymmetric(),
        identification(cells),
        last_row(evidence.readings, k3.rounding.1),
        units(),
        equation_16(),
        amplitude_of_k1(),
        fitted(
            "equation_17",
            "eq 17, Table 7",
            "k3 of Table 7 is fitted by eq 17.",
            k3,
        ),
        equation_18_printed(),
        fitted(
            "equation_18_corrected",
            "eq 18, Table 8",
            "With its last three terms read as A²ρ, Aρ², ρ³, eq 18 is the fit of Table 8.",
            c,
        ),
        positive_damping(),
        fitted(
            "equation_19",
            "eq 19, Table 9",
            "α of Table 9 is fitted by eq 19.",
            alpha,
        ),
        misprinted_cell(k3, c),
        cells_apart(evidence.left_out),
        equation_20(),
        equation_20_corrected(),
        density_over_amplitude(),
    ]
}

/// The effect of the law's exponent on the energy: 4·c·X at α = 0, π·c·ω·X² at α = 1.
fn limits() -> Claim {
    let law = |alpha| Coefficients::new(0.0, 0.0, 0.1, alpha);
    let dissipated = |alpha| dynamics(&law(alpha), 0.1, 1.0).dissipated;
    let errors = [
        (dissipated(0.0) / (4.0 * 0.1 * 0.1) - 1.0).abs(),
        (dissipated(1.0) / (2.0 * std::f64::consts::PI.powi(2) * 0.1 * 0.01) - 1.0).abs(),
    ];
    let (_, largest) = least_and_largest(errors);
    Claim::new(
        "limits_of_the_exponent",
        "§3.2",
        "The damping of eq 13 is Coulomb friction at α = 0 and linear at α = 1.",
        Verdict::of(largest < 1e-5),
        "the energy of a cycle is 4cX and πcωX²",
    )
    .with("largest relative error", largest)
}

fn asymmetric() -> Claim {
    let odd = tables::cells().map(|(_, amplitude, law)| {
        let (y, v) = (0.7 * amplitude, 0.5);
        (law.force(y, v) + law.force(-y, -v)).abs()
    });
    let (_, largest) = least_and_largest(odd);
    Claim::new(
        "asymmetric_restoring_force",
        "§3.2, eqs 13, 14",
        "The restoring force of the law is asymmetric.",
        Verdict::of(largest > 0.0),
        "eq 13 is odd in motion: eq 14 fits a0 and a2, and both are dropped",
    )
    .with("largest F(y, v) + F(−y, −v), kN", largest)
}

fn identification(cells: &[[Cell; 5]; 5]) -> Claim {
    let errors = cells.iter().flatten().map(|cell| {
        let law = cell.coefficients;
        let sine = Sine::new(cell.amplitude, 1.0, 1000);
        cubic_fit::identify(&sine.displacement, &sine.velocity, &sine.force(&law)).map_or(
            f64::INFINITY,
            |found| {
                [
                    found.k1 / law.k1,
                    found.k3 / law.k3,
                    found.c / law.c,
                    found.alpha / law.alpha,
                ]
                .iter()
                .fold(0.0, |most: f64, ratio| most.max((ratio - 1.0).abs()))
            },
        )
    });
    let (_, largest) = least_and_largest(errors);
    Claim::new(
        "identification",
        "§3.2, eqs 14, 15",
        "The cubic of eq 14 and Gauss–Newton on what eq 15 leaves identify k1, k3, c and α.",
        Verdict::of(largest < 1e-6),
        "over a whole cycle the friction is orthogonal to every power of the displacement: all 25 cells come back",
    )
    .with("largest relative error of a coefficient", largest)
}

fn last_row(readings: &[([f64; 5], f64)], rounding: f64) -> Claim {
    let as_read = readings[0].0 == tables::K3[4];
    let possible = readings.iter().filter(|(_, left)| *left <= rounding);
    let count = possible.clone().count();
    // Falling with amplitude everywhere except at 4.0 g/cm³, like the rows above.
    let falling =
        possible.filter(|(row, _)| (0..4).all(|column| row[column] < tables::K3[3][column]));
    let falling = falling.count();
    Claim::new(
        "last_row_of_table_7",
        "Table 7",
        "The scattered last row reads 9.4, 34.9, 4.7, 8.1, 18.5.",
        if as_read && falling == 1 {
            Verdict::Holds
        } else {
            Verdict::CannotTell
        },
        format!(
            "of all 120 orders it leaves least of eq 17 unexplained, with the cell at 4.0 g/cm³, 0.05 mm free; rounding allows \
             {count}, of which {falling} have the first four columns fall with amplitude as the rows above do: 9.4 and 8.1 may \
             be exchanged"
        ),
    )
    .with("left by this reading, kN/mm³", readings[0].1)
    .with("left by the next, kN/mm³", readings[1].1)
    .with("orders that rounding allows", count as f64)
    .with("of these, falling with amplitude", falling as f64)
}

fn units() -> Claim {
    let largest = tables::ALPHA
        .iter()
        .flatten()
        .fold(0.0_f64, |m, &a| m.max(a));
    Claim::new(
        "units_of_k3_and_c",
        "Tables 7, 8",
        "k3 is in kN and c in kN·s/mm.",
        Verdict::of(largest >= 1.0),
        format!(
            "eq 13 asks for kN/mm³, and for kN·(s/mm)^α, which is kN·s/mm at α = 1 only; Table 9 has no α above {largest:.2}"
        ),
    )
    .with("largest α of Table 9", largest)
}

fn equation_16() -> Claim {
    let pairs: Vec<(f64, f64)> = tables::cells()
        .map(|(r, a, law)| (law.k1, surfaces::k1(r, a)))
        .collect();
    let r_squared = r_squared(&pairs);
    let at_2: Vec<f64> = AMPLITUDES
        .iter()
        .zip(&tables::K1)
        .map(|(&a, row)| row[0] / surfaces::k1(2.0, a))
        .collect();
    let (least, most) = least_and_largest(at_2);
    Claim::new(
        "equation_16",
        "eq 16, Table 6",
        "k1 of Table 6 is well fitted by eq 16.",
        Verdict::of(most < 2.0),
        format!(
            "R² = {r_squared:.2} comes of the large cells: at 2.0 g/cm³ the table is {least:.0} to {most:.0} times the surface"
        ),
    )
    .with("R²", r_squared)
    .with("least ratio at 2.0 g/cm³", least)
    .with("largest ratio at 2.0 g/cm³", most)
}

fn amplitude_of_k1() -> Claim {
    let surface = surfaces::k1(3.0, 0.25) / surfaces::k1(3.0, 0.05);
    let spreads: Vec<f64> = (0..5)
        .map(|column| spread(tables::K1.map(|row| row[column])))
        .collect();
    let (least, most) = least_and_largest(spreads.iter().copied());
    Claim::new(
        "k1_hardly_depends_on_amplitude",
        "§4.3, below eq 17",
        "The low order of A in eq 16 lets k1 depend little on amplitude, so that the points are well fitted.",
        Verdict::of(most < 2.0),
        format!(
            "eq 16 changes by {:.0} % from 0.05 to 0.25 mm, where Table 6 changes {least:.1} to {most:.1} times",
            100.0 * (surface - 1.0)
        ),
    )
    .with("ratio of eq 16", surface)
    .with_each("spread of Table 6", &DENSITIES, &spreads)
}

fn fitted(name: &'static str, place: &'static str, says: &'static str, check: &FitCheck) -> Claim {
    let is_fit = check.is_of_the_table();
    let reason = if is_fit {
        format!(
            "R² = {:.3}, the best of these terms to the digits printed",
            check.r_squared
        )
    } else {
        let cell = &check.free[0];
        format!(
            "R² = {:.3} where these terms reach {:.3}; it is the fit of a table with {:.3} at {} g/cm³, {} mm, where {} is printed",
            check.r_squared,
            check.best_r_squared,
            cell.fitted,
            cell.density,
            cell.amplitude,
            cell.printed
        )
    };
    Claim::new(name, place, says, Verdict::of(is_fit), reason)
        .with("R²", check.r_squared)
        .with("R² of the best fit", check.best_r_squared)
        .with("left in the span", check.left)
        .with("by rounding, RMS", check.rounding.0)
        .with("by rounding, most", check.rounding.1)
        .with("left with one cell free", check.free[0].left)
        .with("left with the next cell free", check.free[1].left)
}

fn equation_18_printed() -> Claim {
    let values = tables::cells().map(|(r, a, _)| surfaces::c(r, a, Equation18::Printed));
    let (least, most) = least_and_largest(values);
    let pairs: Vec<(f64, f64)> = tables::cells()
        .map(|(r, a, law)| (law.c, surfaces::c(r, a, Equation18::Printed)))
        .collect();
    Claim::new(
        "equation_18_printed",
        "eq 18, Table 8",
        "c of Table 8 is fitted by eq 18 as printed.",
        Verdict::of(least > 0.0),
        format!("it gives c between {least:.0} and {most:.0}, a damper that drives")
            .replace('-', "−"),
    )
    .with("least c", least)
    .with("largest c", most)
    .with("R²", r_squared(&pairs))
}

fn positive_damping() -> Claim {
    let dense = || {
        (0..=80).flat_map(|i| {
            (0..=80).map(move |j| (2.0 + 0.025 * f64::from(i), 0.05 + 0.0025 * f64::from(j)))
        })
    };
    let negative = dense()
        .filter(|&(r, a)| surfaces::c(r, a, Equation18::Corrected) < 0.0)
        .count();
    let k3_negative = dense().filter(|&(r, a)| surfaces::k3(r, a) < 0.0).count();
    let total = dense().count() as f64;
    let least = surfaces::c(2.0, 0.05, Equation18::Corrected);
    Claim::new(
        "equation_18_corrected_is_passive",
        "eq 18, corrected",
        "Corrected, eq 18 is a damping coefficient over the whole range.",
        Verdict::of(negative == 0),
        format!(
            "c is below 0 about 2.0 g/cm³, 0.05 mm ({least:.4} where Table 8 has 0.0235), on {:.1} % of the range",
            100.0 * negative as f64 / total
        )
        .replace('-', "−"),
    )
    .with("c at 2.0 g/cm³, 0.05 mm", least)
    .with("part of the range with c < 0", negative as f64 / total)
    .with("part of the range with k3 < 0", k3_negative as f64 / total)
}

fn misprinted_cell(k3: &FitCheck, c: &FitCheck) -> Claim {
    let [of_k3, of_c] = [&k3.free[0], &c.free[0]];
    let same = (of_k3.density, of_k3.amplitude) == (of_c.density, of_c.amplitude);
    let printed = tables::interpolate(of_c.density, of_c.amplitude);
    let fitted = Coefficients {
        k3: of_k3.fitted,
        c: of_c.fitted,
        ..printed
    };
    let of = |law: &Coefficients| dynamics(law, of_c.amplitude, 1.0);
    Claim::new(
        "cell_at_4_0_and_0_05",
        "Tables 7, 8 against eqs 17, 18",
        "The tables are those that the surfaces were fitted to.",
        Verdict::of(!same),
        format!(
            "both surfaces, each for itself, were fitted to another cell at 4.0 g/cm³, 0.05 mm: k3 = {:.1} (printed {}) and \
             c = {:.3} (printed {}); no other cell comes near to explaining either, and α is as fitted. Its loss factor would be \
             {:.2} instead of {:.2}",
            of_k3.fitted,
            of_k3.printed,
            of_c.fitted,
            of_c.printed,
            of(&fitted).loss_factor,
            of(&printed).loss_factor
        ),
    )
    .with("k3 as fitted, kN/mm³", of_k3.fitted)
    .with("c as fitted, kN·(s/mm)^α", of_c.fitted)
    .with("k3: left with this cell free over the next", of_k3.left / k3.free[1].left)
    .with("c: left with this cell free over the next", of_c.left / c.free[1].left)
    .with("η as printed", of(&printed).loss_factor)
    .with("η as fitted", of(&fitted).loss_factor)
}

/// Ratio above which a cell is named.
pub const APART: f64 = 2.5;

fn cells_apart(left_out: &[LeftOut]) -> Claim {
    let apart: Vec<&LeftOut> = left_out
        .iter()
        .filter(|one| one.ratio.abs() > APART)
        .collect();
    let named: Vec<String> = apart
        .iter()
        .map(|one| {
            format!(
                "Table {} at {} g/cm³, {} mm: {} where the others predict {:.3}",
                one.table, one.density, one.amplitude, one.printed, one.predicted
            )
        })
        .collect();
    let mut claim = Claim::new(
        "cells_apart",
        "Tables 6–9",
        "Every cell follows from its neighbours.",
        Verdict::of(apart.is_empty()),
        format!(
            "{} of 100 stand more than {APART} standard deviations off: {}. Of those in Tables 7 and 9 eqs 17 and 19 \
             were fitted to the values printed, so that there the test or its identification scatters",
            apart.len(),
            named.join("; ")
        ),
    );
    for one in apart {
        let name = format!(
            "Table {} at {} g/cm³, {} mm",
            one.table, one.density, one.amplitude
        );
        claim = claim.with(name, one.ratio);
    }
    claim
}

fn equation_20() -> Claim {
    let energy = |r: f64, a: f64| {
        dynamics(&surfaces::coefficients(r, a, Equation18::Printed), a, 1.0).dissipated
    };
    let driving = tables::cells()
        .filter(|&(r, a, _)| energy(r, a) < 0.0)
        .count();
    let (mean, most) = mean_and_largest(&loop_errors(|r, a| {
        surfaces::coefficients(r, a, Equation18::Printed)
    }));
    Claim::new(
        "equation_20",
        "eq 20",
        "Eq 20 is the mixed damping law of the damper.",
        Verdict::of(driving == 0),
        format!(
            "as printed it gives energy in {driving} of 25 cells; its mean NRMSE is {mean:.0}. Of its exponent only the last \
             three terms are printed"
        ),
    )
    .with("cells that give energy", driving as f64)
    .with("mean NRMSE", mean)
    .with("largest NRMSE", most)
}

fn equation_20_corrected() -> Claim {
    let (mean, most) = mean_and_largest(&loop_errors(|r, a| {
        surfaces::coefficients(r, a, Equation18::Corrected)
    }));
    Claim::new(
        "excellent_predictive_accuracy",
        "abstract, eq 20 with eq 18 corrected",
        "The law demonstrates excellent predictive accuracy under different excitation conditions.",
        Verdict::of(mean < 0.1),
        format!(
            "even corrected, eq 20 misses the loops of the tables that it was fitted to by {:.0} % of their RMS on average and \
             by {:.0} % at worst",
            100.0 * mean,
            100.0 * most
        ),
    )
    .with("mean NRMSE", mean)
    .with("largest NRMSE", most)
}

/// Fraction of the variance of the logarithm that the means by density and by amplitude explain.
fn shares(table: &[[f64; 5]; 5]) -> (f64, f64) {
    let log = table.map(|row| row.map(f64::ln));
    let mean = log.iter().flatten().sum::<f64>() / 25.0;
    let total: f64 = log.iter().flatten().map(|v| (v - mean).powi(2)).sum();
    let by = |line: &dyn Fn(usize) -> f64| -> f64 {
        (0..5)
            .map(|i| 5.0 * (line(i) / 5.0 - mean).powi(2))
            .sum::<f64>()
            / total
    };
    let density = by(&|column| log.iter().map(|row| row[column]).sum());
    let amplitude = by(&|row| log[row].iter().sum());
    (density, amplitude)
}

fn density_over_amplitude() -> Claim {
    let (k1_density, k1_amplitude) = shares(&tables::K1);
    let (k3_density, k3_amplitude) = shares(&tables::K3);
    Claim::new(
        "stiffness_depends_on_density_not_amplitude",
        "§5.1",
        "k1 and k3 depend heavily on density, other than on amplitude.",
        Verdict::of(k1_density > k1_amplitude && k3_density > k3_amplitude),
        format!(
            "k1 does; of the variance of ln k3 amplitude has {:.0} % and density {:.0} %",
            100.0 * k3_amplitude,
            100.0 * k3_density
        ),
    )
    .with("share of density in ln k1", k1_density)
    .with("share of amplitude in ln k1", k1_amplitude)
    .with("share of density in ln k3", k3_density)
    .with("share of amplitude in ln k3", k3_amplitude)
}

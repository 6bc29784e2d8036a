//! The claims of section 4.7 about the law.

use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_reference::surfaces::{self, Equation18};
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES};

use super::cells::{Cell, inflections};
use super::claim::{Claim, Verdict, listed};
use super::comparison::{Compared, Comparison, Condition, GUARDS, JUDGED};
use super::trends::TENTH;

/// The paper's bound for the law's error.
pub const BOUND: f64 = 0.375;
/// NRMSE below which the prediction of a loop counts as good.
pub(super) const WELL: f64 = 0.15;

/// The claims of section 4.7.
pub fn claims(cells: &[[Cell; 5]; 5], comparison: &Comparison) -> Vec<Claim> {
    let Comparison {
        by_density,
        by_amplitude,
        ..
    } = comparison;
    vec![
        below_bound(
            "law_error_below_0_375_by_density",
            "§4.7, eq 21, Fig 15(a)",
            "For every density the error of the law by eq 21 is below 0.375.",
            by_density,
        ),
        below_bound(
            "law_error_below_0_375_by_amplitude",
            "§4.7, eq 21, Fig 15(b)",
            "For every amplitude at 2.0 g/cm³ the error of the law by eq 21 is that low as well.",
            by_amplitude,
        ),
        guard_matters(by_density),
        in_accordance(by_density),
        law_inflections(cells),
        law_predicts_trends(by_density),
        law_follows_amplitude(by_amplitude),
        higher_agreement(by_density, by_amplitude),
    ]
}

fn sigmas(conditions: &[Condition], of: fn(&Condition) -> &Compared, guard: usize) -> Vec<f64> {
    conditions.iter().map(|one| of(one).sigma[guard]).collect()
}

fn printed(one: &Condition) -> &Compared {
    &one.printed
}

pub(super) fn corrected(one: &Condition) -> &Compared {
    &one.corrected
}

pub(super) fn own(one: &Condition) -> &Compared {
    &one.surfaces
}

/// The finite elements at every condition, or the first reason for having none.
pub(super) fn elements(conditions: &[Condition]) -> Result<Vec<&Compared>, &str> {
    conditions
        .iter()
        .map(|one| one.finite_elements.as_ref().map_err(String::as_str))
        .collect()
}

pub(super) fn at(conditions: &[Condition]) -> &'static [f64; 5] {
    if conditions[0].density == conditions[1].density {
        &AMPLITUDES
    } else {
        &DENSITIES
    }
}

fn below_bound(
    name: &'static str,
    place: &'static str,
    says: &'static str,
    conditions: &[Condition],
) -> Claim {
    let values = sigmas(conditions, corrected, JUDGED);
    let surfaces = sigmas(conditions, own, JUDGED);
    let (_, most) = least_and_largest(values.iter().copied());
    let (_, most_printed) = least_and_largest(sigmas(conditions, printed, JUDGED));
    let (_, most_own) = least_and_largest(surfaces.iter().copied());
    Claim::new(
        name,
        place,
        says,
        Verdict::of(most < BOUND),
        format!(
            "leaving out samples below 5 % of the peak: eq 20 as printed reaches {most_printed:.0}, corrected {}; the crate's \
             surfaces reach {most_own:.2}",
            listed(&values, 2)
        ),
    )
    .with_each("σ, eq 20 corrected,", at(conditions), &values)
    .with_each("σ, crate's surfaces,", at(conditions), &surfaces)
    .with("σ, eq 20 as printed, most", most_printed)
}

fn guard_matters(by_density: &[Condition]) -> Claim {
    let worst: Vec<f64> = (0..GUARDS.len())
        .map(|guard| least_and_largest(sigmas(by_density, corrected, guard)).1)
        .collect();
    let best: Vec<f64> = (0..GUARDS.len())
        .map(|guard| least_and_largest(sigmas(by_density, own, guard)).1)
        .collect();
    Claim::new(
        "equation_21_is_a_measure",
        "§4.7, eq 21",
        "Eq 21 evaluates the error between loops.",
        Verdict::of(worst[0] < 1.5 * worst[3] && best[0] < 1.5 * best[3]),
        format!(
            "it divides by a force that passes through 0 twice a cycle: with samples below 0, 5, 10, 20 % of the peak left \
             out, the largest error of the crate's surfaces is {}, of eq 20 corrected {}. The paper states no guard",
            listed(&best, 2),
            listed(&worst, 2)
        ),
    )
    .with_each("largest σ, crate's surfaces, guard", &GUARDS, &best)
    .with_each("largest σ, eq 20 corrected, guard", &GUARDS, &worst)
}

fn in_accordance(by_density: &[Condition]) -> Claim {
    let errors: Vec<f64> = by_density.iter().map(|one| one.corrected.nrmse).collect();
    let ours: Vec<f64> = by_density.iter().map(|one| one.surfaces.nrmse).collect();
    let (_, most) = least_and_largest(errors.iter().copied());
    Claim::new(
        "law_is_in_accordance_at_every_density",
        "§4.7, Fig 14",
        "The law is well in accordance with the experimental loops in every single case of density.",
        Verdict::of(most < WELL),
        format!(
            "NRMSE of eq 20, corrected: {}; of the crate's surfaces: {}",
            listed(&errors, 2),
            listed(&ours, 2)
        ),
    )
    .with_each("NRMSE, eq 20 corrected,", &DENSITIES, &errors)
    .with_each("NRMSE, crate's surfaces,", &DENSITIES, &ours)
}

fn law_inflections(cells: &[[Cell; 5]; 5]) -> Claim {
    // The loops of Figures 14 and 17; both have 2.0 g/cm³ at 0.1 mm.
    let (of_figure_14, of_figure_17) = (&cells[TENTH], cells.iter().map(|row| &row[0]));
    let others = of_figure_17.filter(|cell| cell.amplitude != AMPLITUDES[TENTH]);
    let loops: Vec<&Cell> = of_figure_14.iter().chain(others).collect();
    let law =
        |cell: &Cell| surfaces::coefficients(cell.density, cell.amplitude, Equation18::Corrected);
    let differing: Vec<String> = loops
        .iter()
        .filter_map(|cell| {
            let by_law = inflections(&law(cell), cell.amplitude);
            ((by_law > 0) != (cell.inflections > 0)).then(|| {
                format!(
                    "{by_law} and {} at {} g/cm³, {} mm",
                    cell.inflections, cell.density, cell.amplitude
                )
            })
        })
        .collect();
    let negative = loops.iter().filter(|cell| law(cell).c < 0.0).count();
    let having = cells.iter().flatten().filter(|cell| cell.inflections > 0);
    let count = having.count();
    Claim::new(
        "law_has_inflections",
        "§4.7, Figs 14, 17",
        "The law gives the inflection points of the loops.",
        Verdict::of(differing.is_empty()),
        if differing.is_empty() {
            "eq 20, corrected, has them where the tables have".to_owned()
        } else {
            format!(
                "of the nine loops, eq 20, corrected, and the tables have {}; by the tables {count} of all 25 loops have them",
                differing.join("; ")
            )
        },
    )
    .with("loops with inflections", count as f64)
    .with("loops of Figures 14 and 17 where the law differs", differing.len() as f64)
    .with("of these nine, eq 20 with c below 0", negative as f64)
}

fn law_predicts_trends(by_density: &[Condition]) -> Claim {
    let ratio = |of: fn(&Condition) -> f64| -> Vec<f64> { by_density.iter().map(of).collect() };
    let stiffness = ratio(|one| one.corrected.dynamics.stiffness / one.measured.stiffness);
    let loss = ratio(|one| one.corrected.dynamics.loss_factor / one.measured.loss_factor);
    let near = |values: &[f64]| values.iter().all(|ratio| (ratio - 1.0).abs() < 0.2);
    Claim::new(
        "law_predicts_stiffness_and_loss_factor",
        "§4.7, Fig 16",
        "The law predicts how stiffness and loss factor change with density.",
        Verdict::of(near(&stiffness) && near(&loss)),
        format!(
            "K and η of eq 20, corrected, over those of the tables: {} and {}",
            listed(&stiffness, 2),
            listed(&loss, 2)
        ),
    )
    .with_each("ratio of K", &DENSITIES, &stiffness)
    .with_each("ratio of η", &DENSITIES, &loss)
}

fn law_follows_amplitude(by_amplitude: &[Condition]) -> Claim {
    let stiffness: Vec<f64> = by_amplitude
        .iter()
        .map(|one| one.corrected.dynamics.stiffness)
        .collect();
    let measured: Vec<f64> = by_amplitude
        .iter()
        .map(|one| one.measured.stiffness)
        .collect();
    let near = stiffness
        .iter()
        .zip(&measured)
        .all(|(k, m)| (k / m - 1.0).abs() < 0.2);
    Claim::new(
        "law_agrees_on_stiffness_by_amplitude",
        "§4.7, Fig 18(a)",
        "The stiffness by the law shows good agreement over the amplitude at 2.0 g/cm³.",
        Verdict::of(near),
        format!(
            "K of eq 20, corrected, is {} kN/mm, of the tables {} kN/mm",
            listed(&stiffness, 2),
            listed(&measured, 2)
        ),
    )
    .with_each("K, eq 20 corrected, kN/mm,", &AMPLITUDES, &stiffness)
    .with_each("K, tables, kN/mm,", &AMPLITUDES, &measured)
}

fn higher_agreement(by_density: &[Condition], by_amplitude: &[Condition]) -> Claim {
    // Both have 2.0 g/cm³ at 0.1 mm.
    let others = by_amplitude
        .iter()
        .filter(|one| one.amplitude != by_density[0].amplitude);
    let all: Vec<Condition> = by_density.iter().chain(others).cloned().collect();
    let (name, place, says) = (
        "law_agrees_better_than_finite_elements",
        "conclusion 3",
        "The law exhibits higher agreement with the experimental loops than finite elements.",
    );
    match elements(&all) {
        Err(why) => Claim::new(name, place, says, Verdict::CannotTell, why),
        Ok(found) => {
            let pairs = || found.iter().zip(&all);
            let worse = pairs()
                .filter(|(one, c)| one.nrmse <= c.corrected.nrmse)
                .count();
            let worse_own = pairs()
                .filter(|(one, c)| one.nrmse <= c.surfaces.nrmse)
                .count();
            let mean = |of: &dyn Fn((&&Compared, &Condition)) -> f64| -> f64 {
                pairs().map(of).sum::<f64>() / all.len() as f64
            };
            let of_elements = mean(&|(one, _)| one.nrmse);
            let of_law = mean(&|(_, c)| c.corrected.nrmse);
            let of_own = mean(&|(_, c)| c.surfaces.nrmse);
            Claim::new(
                name,
                place,
                says,
                Verdict::of(worse == 0),
                format!(
                    "mean NRMSE {of_law:.2} of eq 20, corrected, {of_own:.2} of the crate's surfaces, {of_elements:.2} of finite \
                     elements, which are nearer than eq 20 in {worse} of {} loops and than the surfaces in {worse_own}",
                    all.len()
                ),
            )
            .with("mean NRMSE, eq 20 corrected", of_law)
            .with("mean NRMSE, crate's surfaces", of_own)
            .with("mean NRMSE, finite elements", of_elements)
            .with("loops where finite elements are nearer than eq 20", worse as f64)
            .with("loops where finite elements are nearer than the surfaces", worse_own as f64)
        }
    }
}

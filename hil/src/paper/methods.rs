//! The claims of section 4.7 and of the discussion: which method predicts what.

use super::cells::Cell;
use super::claim::{Claim, Verdict, is_falling, is_rising, listed};
use super::comparison::{Compared, Comparison, Condition, GUARDS, JUDGED};
use crate::extremes::least_and_largest;
use crate::reference::comparison::r_squared;
use crate::reference::tables::{AMPLITUDES, DENSITIES};

/// The bound that the paper gives for the law's error.
pub const BOUND: f64 = 0.375;
/// How many times larger it has the error of finite elements.
const TIMES: (f64, f64) = (2.0, 30.0);
/// Part of a loop's RMS beside an ellipse below which it counts as one.
const ELLIPSE: f64 = 0.05;
/// NRMSE below which a loop counts as well predicted.
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
        inflections(cells),
        law_predicts_trends(by_density),
        law_follows_amplitude(by_amplitude),
        times_larger(
            "finite_elements_err_2_to_30_times_more",
            "§4.7, Fig 15(a)",
            "For every density the error of finite elements is 2 to 30 times that of the law.",
            by_density,
        ),
        times_larger(
            "finite_elements_err_more_by_amplitude",
            "§4.7, Fig 15(b)",
            "For every amplitude at 2.0 g/cm³ the error of finite elements is that much larger as well.",
            by_amplitude,
        ),
        higher_agreement(by_density, by_amplitude),
        elements_turn(by_density),
        exaggerated_area(by_density),
        elements_loss_factor(by_density),
        ellipses(by_density, by_amplitude),
        concave(by_amplitude),
        elements_loss_factor_by_amplitude(by_amplitude),
    ]
}

fn sigmas(conditions: &[Condition], of: fn(&Condition) -> &Compared, guard: usize) -> Vec<f64> {
    conditions.iter().map(|one| of(one).sigma[guard]).collect()
}

fn printed(one: &Condition) -> &Compared {
    &one.printed
}

fn corrected(one: &Condition) -> &Compared {
    &one.corrected
}

fn own(one: &Condition) -> &Compared {
    &one.surfaces
}

/// What finite elements gave at every condition, or the first reason why not.
fn elements(conditions: &[Condition]) -> Result<Vec<&Compared>, &str> {
    conditions
        .iter()
        .map(|one| one.finite_elements.as_ref().map_err(String::as_str))
        .collect()
}

fn at(conditions: &[Condition]) -> &'static [f64; 5] {
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

fn inflections(cells: &[[Cell; 5]; 5]) -> Claim {
    let having = cells.iter().flatten().filter(|cell| cell.inflections > 0);
    let without: Vec<String> = cells
        .iter()
        .flatten()
        .filter(|cell| cell.inflections == 0)
        .map(|cell| format!("{} g/cm³ {} mm", cell.density, cell.amplitude))
        .collect();
    let count = having.count();
    let shown = cells[super::trends::TENTH]
        .iter()
        .all(|cell| cell.inflections > 0)
        && cells.iter().all(|row| row[0].inflections > 0);
    Claim::new(
        "law_has_inflections",
        "§4.7, Figs 14, 17",
        "The law gives the inflection points of the loops.",
        Verdict::of(shown),
        format!(
            "{count} of 25 loops have them; not those of {}",
            if without.is_empty() {
                "none".to_owned()
            } else {
                without.join(", ")
            }
        ),
    )
    .with("loops with inflections", count as f64)
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

/// A claim about finite elements, which can't be told where they gave nothing.
fn of_elements(
    name: &'static str,
    place: &'static str,
    says: &'static str,
    conditions: &[Condition],
    judge: impl FnOnce(&[&Compared]) -> (bool, String, Vec<(&'static str, Vec<f64>)>),
) -> Claim {
    match elements(conditions) {
        Err(why) => Claim::new(name, place, says, Verdict::CannotTell, why),
        Ok(found) => {
            let (holds, reason, figures) = judge(&found);
            let claim = Claim::new(name, place, says, Verdict::of(holds), reason);
            figures.iter().fold(claim, |claim, (figure, values)| {
                claim.with_each(figure, at(conditions), values)
            })
        }
    }
}

fn times_larger(
    name: &'static str,
    place: &'static str,
    says: &'static str,
    conditions: &[Condition],
) -> Claim {
    of_elements(name, place, says, conditions, |found| {
        let ratio = |law: fn(&Condition) -> &Compared| -> Vec<f64> {
            let pairs = found.iter().zip(conditions);
            pairs
                .map(|(one, c)| one.sigma[JUDGED] / law(c).sigma[JUDGED])
                .collect()
        };
        let (by_eq_20, by_own) = (ratio(corrected), ratio(own));
        let errors: Vec<f64> = found.iter().map(|one| one.nrmse).collect();
        let within = by_eq_20.iter().all(|r| (TIMES.0..=TIMES.1).contains(r));
        (
            within,
            format!(
                "σ of finite elements over that of eq 20, corrected: {}; over that of the crate's surfaces: {}",
                listed(&by_eq_20, 1),
                listed(&by_own, 1)
            ),
            vec![
                ("ratio to eq 20 corrected", by_eq_20),
                ("ratio to crate's surfaces", by_own),
                ("NRMSE of finite elements", errors),
            ],
        )
    })
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

fn elements_turn(by_density: &[Condition]) -> Claim {
    of_elements(
        "finite_elements_turn_with_density",
        "§4.7, Fig 14",
        "Finite elements capture the counterclockwise turn with density.",
        by_density,
        |found| {
            let k: Vec<f64> = found.iter().map(|one| one.dynamics.stiffness).collect();
            let reason = format!("their K = {} kN/mm", listed(&k, 2));
            (is_rising(&k), reason, vec![("K, kN/mm,", k)])
        },
    )
}

fn exaggerated_area(by_density: &[Condition]) -> Claim {
    of_elements(
        "finite_elements_exaggerate_the_area",
        "§4.7, Fig 14(e)",
        "At 4.0 g/cm³ finite elements give an exaggerated area of the loop.",
        by_density,
        |found| {
            let ratios: Vec<f64> = found
                .iter()
                .zip(by_density)
                .map(|(one, c)| one.dynamics.dissipated / c.measured.dissipated)
                .collect();
            let reason = format!("ΔW over that of the tables: {}", listed(&ratios, 2));
            (ratios[4] > 1.5, reason, vec![("ratio of ΔW", ratios)])
        },
    )
}

fn elements_loss_factor(by_density: &[Condition]) -> Claim {
    of_elements(
        "finite_elements_miss_the_loss_factor",
        "§4.7, Fig 16",
        "Finite elements deviate significantly, especially in the loss factor.",
        by_density,
        |found| {
            let ratios = |of: fn(&super::cells::Dynamics) -> f64| -> Vec<f64> {
                let pairs = found.iter().zip(by_density);
                pairs
                    .map(|(one, c)| of(&one.dynamics) / of(&c.measured))
                    .collect()
            };
            let (k, eta) = (ratios(|d| d.stiffness), ratios(|d| d.loss_factor));
            let off = |values: &[f64]| -> f64 {
                values.iter().map(|r| r.ln().abs()).sum::<f64>() / values.len() as f64
            };
            let reason = format!(
                "K and η over those of the tables: {} and {}; their η hardly changes, since a Prony series knows neither density \
                 nor amplitude",
                listed(&k, 2),
                listed(&eta, 2)
            );
            (
                off(&eta) > off(&k),
                reason,
                vec![("ratio of K", k), ("ratio of η", eta)],
            )
        },
    )
}

fn ellipses(by_density: &[Condition], by_amplitude: &[Condition]) -> Claim {
    let claim = of_elements(
        "finite_elements_give_ellipses",
        "§4.7, Figs 14, 17",
        "Finite elements omit the inflections and depict the loop as an ellipse.",
        by_amplitude,
        |found| {
            let beside: Vec<f64> = found.iter().map(|one| one.beside_ellipse).collect();
            let measured: Vec<f64> = by_amplitude
                .iter()
                .map(|one| one.measured_beside_ellipse)
                .collect();
            let reason = format!(
                "at 2.0 g/cm³ {} of their RMS is beside an ellipse, of the tables' loops {}",
                listed(&beside, 3),
                listed(&measured, 3)
            );
            let holds = beside.iter().all(|&part| part < ELLIPSE);
            (
                holds,
                reason,
                vec![
                    ("part beside an ellipse, finite elements,", beside),
                    ("part beside an ellipse, tables,", measured),
                ],
            )
        },
    );
    match elements(by_density) {
        Err(_) => claim,
        Ok(found) => {
            let (_, most) = least_and_largest(found.iter().map(|one| one.beside_ellipse));
            claim.with("largest part beside an ellipse over density", most)
        }
    }
}

fn concave(by_amplitude: &[Condition]) -> Claim {
    of_elements(
        "finite_elements_are_concave",
        "§4.7, Fig 18(a)",
        "The stiffness by finite elements falls with amplitude, ever more steeply.",
        by_amplitude,
        |found| {
            let k: Vec<f64> = found.iter().map(|one| one.dynamics.stiffness).collect();
            let steps: Vec<f64> = k.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let reason = format!("their K = {} kN/mm", listed(&k, 3));
            (
                is_falling(&k) && is_falling(&steps),
                reason,
                vec![("K, kN/mm,", k)],
            )
        },
    )
}

fn elements_loss_factor_by_amplitude(by_amplitude: &[Condition]) -> Claim {
    of_elements(
        "finite_elements_miss_the_loss_factor_by_amplitude",
        "§4.7, Fig 18(b)",
        "Finite elements fail to predict how the loss factor varies with amplitude.",
        by_amplitude,
        |found| {
            let eta: Vec<f64> = found.iter().map(|one| one.dynamics.loss_factor).collect();
            let measured: Vec<f64> = by_amplitude
                .iter()
                .map(|one| one.measured.loss_factor)
                .collect();
            // As good as their mean for all five is no prediction of how they vary.
            let pairs: Vec<(f64, f64)> =
                measured.iter().copied().zip(eta.iter().copied()).collect();
            let r_squared = r_squared(&pairs);
            let reason = format!(
                "η {} where the tables give {}: R² = {r_squared:.2}, where their mean for every amplitude has 0",
                listed(&eta, 3),
                listed(&measured, 3)
            );
            (
                r_squared <= 0.0,
                reason,
                vec![("η of finite elements", eta), ("η of the tables", measured)],
            )
        },
    )
}

//! The claims of section 4.7 about finite elements. The gaps in the paper, the readings of Table 4 and the contact between bore and
//! mandrel, may reverse a verdict: such a claim cannot be decided.

use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_reference::comparison::r_squared;

use super::claim::{Claim, Verdict, is_falling, is_rising, listed};
use super::comparison::{Compared, Comparison, Condition, JUDGED};
use super::elements::ElementStudy;
use super::methods::{at, corrected, elements, own};
use crate::finite_element::{Bore, Reading};

/// Ratio in the paper between the error of finite elements and that of the law.
const TIMES: (f64, f64) = (2.0, 30.0);
/// Fraction of a loop's RMS outside an ellipse, below which it counts as one.
const ELLIPSE: f64 = 0.05;
/// Area relative to the tables' loop above which it is exaggerated.
const EXAGGERATED: f64 = 1.5;

/// The claims; `study` has the results of other choices.
pub fn claims(comparison: &Comparison, study: &ElementStudy) -> Vec<Claim> {
    let Comparison {
        by_density,
        by_amplitude,
        ..
    } = comparison;
    vec![
        times_larger(
            "finite_elements_err_2_to_30_times_more",
            "§4.7, Fig 15(a)",
            "For every density the error of finite elements is 2 to 30 times that of the law.",
            by_density,
            Some(study),
        ),
        times_larger(
            "finite_elements_err_more_by_amplitude",
            "§4.7, Fig 15(b)",
            "For every amplitude at 2.0 g/cm³ the error of finite elements is that much larger as well.",
            by_amplitude,
            None,
        ),
        elements_turn(by_density, study),
        exaggerated_area(by_density, study),
        elements_loss_factor(by_density, study),
        ellipses(by_density, by_amplitude, study),
        concave(by_amplitude),
        elements_loss_factor_by_amplitude(by_amplitude),
    ]
}

/// A claim judged by some loops: whether it holds, the reason, and the figures.
type Judgement = (bool, String, Vec<(&'static str, Vec<f64>)>);

/// A claim about finite elements. It cannot be decided if they give no result, or if another reading of Table 4 gives another
/// verdict; `study` has the loops of the readings over density.
fn of_elements(
    name: &'static str,
    place: &'static str,
    says: &'static str,
    conditions: &[Condition],
    study: Option<&ElementStudy>,
    judge: impl Fn(&[&Compared]) -> Judgement,
) -> Claim {
    let found = match elements(conditions) {
        Err(why) => return Claim::new(name, place, says, Verdict::CannotTell, why),
        Ok(found) => found,
    };
    let (holds, reason, figures) = judge(&found);
    let readings = study.map_or(&[][..], |study| &study.readings);
    let others = readings.iter().filter_map(|one| {
        let loops = one.by_density.iter().map(|found| found.as_ref().ok());
        Some((one.reading, judge(&loops.collect::<Option<Vec<_>>>()?).0))
    });
    let turning: Vec<Reading> = others
        .filter(|(_, other)| *other != holds)
        .map(|(reading, _)| reading)
        .collect();
    let claim = if turning.is_empty() {
        Claim::new(name, place, says, Verdict::of(holds), reason)
    } else {
        let named: Vec<String> = turning.iter().map(in_words).collect();
        let otherwise = if holds { "fails" } else { "holds" };
        let reason = format!(
            "as compared it {}: {reason}. It {otherwise} with {}",
            Verdict::of(holds).in_words(),
            named.join("; ")
        );
        Claim::new(name, place, says, Verdict::CannotTell, reason)
    };
    let claim = match study {
        Some(_) => claim.with("readings of Table 4 that turn it", turning.len() as f64),
        None => claim,
    };
    figures.iter().fold(claim, |claim, (figure, values)| {
        claim.with_each(figure, at(conditions), values)
    })
}

fn in_words(reading: &Reading) -> String {
    format!(
        "D1 as {} and C01 {}",
        reading.volumetric.in_words(),
        reading.sign.in_words()
    )
}

fn times_larger(
    name: &'static str,
    place: &'static str,
    says: &'static str,
    conditions: &[Condition],
    study: Option<&ElementStudy>,
) -> Claim {
    of_elements(name, place, says, conditions, study, |found| {
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

fn elements_turn(by_density: &[Condition], study: &ElementStudy) -> Claim {
    of_elements(
        "finite_elements_turn_with_density",
        "§4.7, Fig 14",
        "Finite elements capture the counterclockwise turn with density.",
        by_density,
        Some(study),
        |found| {
            let k: Vec<f64> = found.iter().map(|one| one.dynamics.stiffness).collect();
            let reason = format!("their K = {} kN/mm", listed(&k, 2));
            (is_rising(&k), reason, vec![("K, kN/mm,", k)])
        },
    )
}

fn exaggerated_area(by_density: &[Condition], study: &ElementStudy) -> Claim {
    of_elements(
        "finite_elements_exaggerate_the_area",
        "§4.7, Fig 14(e)",
        "At 4.0 g/cm³ finite elements give an exaggerated area of the loop.",
        by_density,
        Some(study),
        |found| {
            let ratios: Vec<f64> = found
                .iter()
                .zip(by_density)
                .map(|(one, c)| one.dynamics.dissipated / c.measured.dissipated)
                .collect();
            let reason = format!("ΔW over that of the tables: {}", listed(&ratios, 2));
            (
                ratios[4] > EXAGGERATED,
                reason,
                vec![("ratio of ΔW", ratios)],
            )
        },
    )
}

fn elements_loss_factor(by_density: &[Condition], study: &ElementStudy) -> Claim {
    of_elements(
        "finite_elements_miss_the_loss_factor",
        "§4.7, Fig 16",
        "Finite elements deviate significantly, especially in the loss factor.",
        by_density,
        Some(study),
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
            let (off_k, off_eta) = (off(&k), off(&eta));
            let reason = format!(
                "K and η over those of the tables: {} and {}, on average {off_k:.2} and {off_eta:.2} off in logarithms: η \
                 deviates {}",
                listed(&k, 2),
                listed(&eta, 2),
                if off_eta > off_k { "more" } else { "no more" }
            );
            (
                off_eta > off_k,
                reason,
                vec![("ratio of K", k), ("ratio of η", eta)],
            )
        },
    )
}

fn ellipses(by_density: &[Condition], by_amplitude: &[Condition], study: &ElementStudy) -> Claim {
    let claim = of_elements(
        "finite_elements_give_ellipses",
        "§4.7, Figs 14, 17",
        "Finite elements omit the inflections and depict the loop as an ellipse.",
        by_amplitude,
        None,
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
    let mut claim = match elements(by_density) {
        Err(_) => claim,
        Ok(found) => {
            let (_, most) = least_and_largest(found.iter().map(|one| one.beside_ellipse));
            claim.with("largest part beside an ellipse over density", most)
        }
    };
    // The paper's bore may leave its mandrel, and then no cycle is steady.
    if let Ok(free) = &study.bore(Bore::Separable, Some(1)).found {
        let beside = free.beside_ellipse;
        if (beside < ELLIPSE) != (claim.verdict == Verdict::Holds) {
            claim.verdict = Verdict::CannotTell;
            claim.reason = format!(
                "on a mandrel that the bore stays on, {}; on one that it may leave, as in the paper, {beside:.3} in the first cycle at \
                 0.1 mm",
                claim.reason
            );
        }
        claim = claim.with("part beside an ellipse, bore free to leave", beside);
    }
    claim
}

fn concave(by_amplitude: &[Condition]) -> Claim {
    of_elements(
        "finite_elements_are_concave",
        "§4.7, Fig 18(a)",
        "The stiffness by finite elements falls with amplitude, ever more steeply.",
        by_amplitude,
        None,
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
        None,
        |found| {
            let eta: Vec<f64> = found.iter().map(|one| one.dynamics.loss_factor).collect();
            let measured: Vec<f64> = by_amplitude
                .iter()
                .map(|one| one.measured.loss_factor)
                .collect();
            // A result no better than the mean of all five does not predict their variation.
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

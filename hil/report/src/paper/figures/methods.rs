//! Law and finite elements beside what was measured: loops, errors, stiffness and loss factor.

use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES, cell};
use mesh_damper_studies::paper::{BOUND, Compared, Condition, GUARDS, JUDGED, Paper};
use plotters::style::RGBColor;

use super::{Figure, corrected, loop_of, trace};
use crate::plots::{self, BLUE, GREEN, GREY, Mark, ORANGE, PINK, Panel};

/// Measured, eq 20, own, and finite elements where there are any.
fn method_key(conditions: &[Condition]) -> Vec<(RGBColor, String)> {
    let mut key = vec![
        (GREY, "Tables 6–9".into()),
        (ORANGE, "eq 20, eq 18 corrected".into()),
        (BLUE, "the crate's surfaces".into()),
    ];
    if conditions.iter().any(|one| one.finite_elements.is_ok()) {
        key.push((GREEN, "finite elements".into()));
    }
    key
}

/// Where finite elements are missing, and why.
fn without_elements(conditions: &[Condition]) -> String {
    let missing = |one: &Condition| {
        Some((
            one.density,
            one.amplitude,
            one.finite_elements.as_ref().err()?.clone(),
        ))
    };
    let missing: Vec<(f64, f64, String)> = conditions.iter().filter_map(missing).collect();
    let Some((_, _, why)) = missing.first() else {
        return String::new();
    };
    let places: Vec<String> = missing
        .iter()
        .map(|(r, a, _)| format!("{r} g/cm³ {a} mm"))
        .collect();
    format!(" Without finite elements at {}: {why}.", places.join(", "))
}

pub(super) fn compared_loops(
    title: &'static str,
    said: &'static str,
    paper: &Paper,
    conditions: &[Condition],
) -> Figure {
    let panels: Vec<Panel> = conditions
        .iter()
        .map(|one| {
            let (r, a) = (one.density, one.amplitude);
            let row = AMPLITUDES.iter().position(|&amplitude| amplitude == a);
            let column = DENSITIES.iter().position(|&density| density == r);
            let measured = cell(row.unwrap_or(0), column.unwrap_or(0));
            let mut traces = vec![
                trace(GREY, Mark::Broad, loop_of(&measured, a)),
                trace(ORANGE, Mark::Line, loop_of(&corrected(r, a), a)),
                trace(
                    BLUE,
                    Mark::Line,
                    loop_of(&paper.surfaces.coefficients(r, a), a),
                ),
            ];
            if let Some(simulated) = &one.finite_element_loop {
                let samples = simulated.displacement.iter().zip(&simulated.force);
                let mut points: Vec<(f64, f64)> = samples.map(|(&y, &f)| (y, f)).collect();
                points.extend(points.first().copied());
                traces.push(trace(GREEN, Mark::Line, points));
            }
            Panel {
                title: format!("{r:.1} g/cm³, {a:.2} mm"),
                labels: ("displacement, mm", "force, kN"),
                traces,
                logarithmic: false,
            }
        })
        .collect();
    let errors = |of: fn(&Condition) -> f64| -> String {
        let each = conditions.iter().map(|one| match 100.0 * of(one) {
            error if error.is_nan() => "—".to_owned(),
            error => format!("{error:.0}"),
        });
        each.collect::<Vec<_>>().join(", ")
    };
    // Where there is no loop, the reason is told below.
    let of_elements = |one: &Condition| {
        let found = one.finite_elements.as_ref();
        found.map_or(f64::NAN, |found| found.nrmse)
    };
    Figure {
        title,
        said,
        svg: Some(plots::panels(&panels)),
        key: method_key(conditions),
        seen: format!(
            "Errors in the order of the panels: eq 20, corrected, {} %; the crate's surfaces {} %; finite elements {} %.{}",
            errors(|one| one.corrected.nrmse),
            errors(|one| one.surfaces.nrmse),
            errors(of_elements),
            without_elements(conditions)
        ),
    }
}

pub(super) fn errors(paper: &Paper) -> Figure {
    let panel = |title: &str, label, conditions: &[Condition], at: fn(&Condition) -> f64| {
        let (first, last) = (at(&conditions[0]), at(&conditions[conditions.len() - 1]));
        let by = |of: fn(&Condition) -> &Compared| -> Vec<(f64, f64)> {
            let points = conditions.iter();
            points
                .map(|one| (at(one), of(one).sigma[JUDGED].log10()))
                .collect()
        };
        let elements = conditions.iter().filter_map(|one| {
            let found = one.finite_elements.as_ref().ok()?;
            Some((at(one), found.sigma[JUDGED].log10()))
        });
        Panel {
            title: title.into(),
            labels: (label, "σ, eq 21"),
            traces: vec![
                trace(
                    PINK,
                    Mark::Line,
                    vec![(first, BOUND.log10()), (last, BOUND.log10())],
                ),
                trace(ORANGE, Mark::Both, by(|one| &one.corrected)),
                trace(BLUE, Mark::Both, by(|one| &one.surfaces)),
                trace(GREEN, Mark::Both, elements.collect()),
            ],
            logarithmic: true,
        }
    };
    let comparison = &paper.comparison;
    let mut key = method_key(&comparison.by_density);
    key[0] = (PINK, format!("{BOUND}, the law's bound"));
    Figure {
        title: "Figure 15: error by eq 21",
        said: "The law's error is steadily below 0.375, that of finite elements 2 to 30 times larger.",
        svg: Some(plots::panels(&[
            panel(
                "0.1 mm",
                "mesh density, g/cm³",
                &comparison.by_density,
                |one| one.density,
            ),
            panel(
                "2.0 g/cm³",
                "amplitude, mm",
                &comparison.by_amplitude,
                |one| one.amplitude,
            ),
        ])),
        key,
        seen: format!(
            "Samples below {:.0} % of the loop's largest force are left out, without which eq 21 is set by the few beside the \
             passages through 0.{}",
            100.0 * GUARDS[JUDGED],
            without_elements(&comparison.by_density)
        ),
    }
}

pub(super) fn compared_dynamics(
    title: &'static str,
    said: &'static str,
    label: &'static str,
    conditions: &[Condition],
    at: fn(&Condition) -> f64,
) -> Figure {
    let panel = |of: fn(&mesh_damper_studies::paper::Dynamics) -> f64, name| {
        let by =
            |dynamics: fn(&Condition) -> &mesh_damper_studies::paper::Dynamics| -> Vec<(f64, f64)> {
                let points = conditions.iter();
                points.map(|one| (at(one), of(dynamics(one)))).collect()
            };
        let elements = conditions.iter().filter_map(|one| {
            let found = one.finite_elements.as_ref().ok()?;
            Some((at(one), of(&found.dynamics)))
        });
        Panel {
            title: String::new(),
            labels: (label, name),
            traces: vec![
                trace(GREY, Mark::Both, by(|one| &one.measured)),
                trace(ORANGE, Mark::Both, by(|one| &one.corrected.dynamics)),
                trace(BLUE, Mark::Both, by(|one| &one.surfaces.dynamics)),
                trace(GREEN, Mark::Both, elements.collect()),
            ],
            logarithmic: false,
        }
    };
    Figure {
        title,
        said,
        svg: Some(plots::panels(&[
            panel(|dynamics| dynamics.stiffness, "K, kN/mm"),
            panel(|dynamics| dynamics.loss_factor, "loss factor"),
        ])),
        key: method_key(conditions),
        seen: if conditions[0].density == conditions[1].density {
            format!(
                "The tables' stiffness stays and then doubles: at 2.0 g/cm³ they don't show what is described. That of finite elements \
                 rises a little with the strain, and their loss factor is nearly the same at every amplitude.{}",
                without_elements(conditions)
            )
        } else {
            format!(
                "Eq 20's loss factor is half of the tables' at 2.0 g/cm³ and nearly double at 2.5 g/cm³, and near from 3.0 g/cm³ on. \
                 Finite elements have about half the stiffness or less at 3.5 and 4.0 g/cm³, and a loss factor that rises with density.{}",
                without_elements(conditions)
            )
        },
    }
}

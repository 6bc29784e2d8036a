//! Law and finite elements compared to measurements: loops, errors, stiffness and loss factor.

use mesh_damper_paper::claims::{BOUND, Compared, Condition, GUARDS, JUDGED, Paper};
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES, cell};

use super::{Figure, corrected, loop_of};
use crate::charts;
use crate::picture::{Axis, Panel};
use crate::plots::{self, ELEMENTS, EQUATION, SAID, SURFACES, TABLES};

/// Names of the compared methods.
const NAMES: [&str; 4] = [
    "Tables 6–9",
    "eq 20, eq 18 corrected",
    "the crate's surfaces",
    "finite elements",
];

/// The conditions without finite elements, with the reason.
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
            let own = loop_of(&paper.surfaces.coefficients(r, a), a);
            let mut layers = vec![
                TABLES.broad(NAMES[0], loop_of(&measured, a)),
                EQUATION.line(NAMES[1], loop_of(&corrected(r, a), a)),
                SURFACES.line(NAMES[2], own),
            ];
            if let Some(simulated) = &one.finite_element_loop {
                let samples = simulated.displacement.iter().zip(&simulated.force);
                let mut points: Vec<(f64, f64)> = samples.map(|(&y, &f)| (y, f)).collect();
                points.extend(points.first().copied());
                layers.push(ELEMENTS.line(NAMES[3], points));
            }
            plots::panel(
                format!("{r:.1} g/cm³, {a:.2} mm"),
                charts::displacement(),
                charts::force(),
                layers,
            )
        })
        .collect();
    let errors = |of: fn(&Condition) -> f64| -> String {
        let each = conditions.iter().map(|one| match 100.0 * of(one) {
            error if error.is_nan() => "—".to_owned(),
            error => format!("{error:.0}"),
        });
        each.collect::<Vec<_>>().join(", ")
    };
    // If there is no loop, the reason follows below.
    let of_elements = |one: &Condition| {
        let found = one.finite_elements.as_ref();
        found.map_or(f64::NAN, |found| found.nrmse)
    };
    Figure {
        title,
        said,
        pictures: plots::panels("Loops by the law and by finite elements", panels),
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
    let panel = |title: &str, x: Axis, conditions: &[Condition], at: fn(&Condition) -> f64| {
        let (first, last) = (at(&conditions[0]), at(&conditions[conditions.len() - 1]));
        let by = |of: fn(&Condition) -> &Compared| -> Vec<(f64, f64)> {
            let points = conditions.iter();
            points.map(|one| (at(one), of(one).sigma[JUDGED])).collect()
        };
        let elements = conditions.iter().filter_map(|one| {
            let found = one.finite_elements.as_ref().ok()?;
            Some((at(one), found.sigma[JUDGED]))
        });
        plots::panel(
            title,
            x,
            Axis::new("σ, eq 21", "").logarithmic(),
            vec![
                SAID.line(
                    format!("{BOUND}, the law's bound"),
                    vec![(first, BOUND), (last, BOUND)],
                ),
                EQUATION.both(NAMES[1], by(|one| &one.corrected)),
                SURFACES.both(NAMES[2], by(|one| &one.surfaces)),
                ELEMENTS.both(NAMES[3], elements.collect()),
            ],
        )
    };
    let comparison = &paper.comparison;
    Figure {
        title: "Figure 15: error by eq 21",
        said: "The law's error is steadily below 0.375, that of finite elements 2 to 30 times larger.",
        pictures: plots::panels(
            "Error by eq 21 over density and over amplitude",
            vec![
                panel(
                    "0.1 mm",
                    Axis::new("mesh density", "g/cm³"),
                    &comparison.by_density,
                    |one| one.density,
                ),
                panel(
                    "2.0 g/cm³",
                    Axis::new("amplitude", "mm"),
                    &comparison.by_amplitude,
                    |one| one.amplitude,
                ),
            ],
        ),
        seen: format!(
            "Samples below {:.0} % of the loop's largest force are left out: otherwise the few samples near zero force would dominate \
             eq 21.{}",
            100.0 * GUARDS[JUDGED],
            without_elements(&comparison.by_density)
        ),
    }
}

pub(super) fn compared_dynamics(
    title: &'static str,
    said: &'static str,
    (along, unit): (&str, &str),
    conditions: &[Condition],
    at: fn(&Condition) -> f64,
) -> Figure {
    let panel = |of: fn(&mesh_damper_paper::claims::Dynamics) -> f64, y: Axis| {
        let by =
            |dynamics: fn(&Condition) -> &mesh_damper_paper::claims::Dynamics| -> Vec<(f64, f64)> {
                let points = conditions.iter();
                points.map(|one| (at(one), of(dynamics(one)))).collect()
            };
        let elements = conditions.iter().filter_map(|one| {
            let found = one.finite_elements.as_ref().ok()?;
            Some((at(one), of(&found.dynamics)))
        });
        plots::panel(
            "",
            Axis::new(along, unit),
            y,
            vec![
                TABLES.both(NAMES[0], by(|one| &one.measured)),
                EQUATION.both(NAMES[1], by(|one| &one.corrected.dynamics)),
                SURFACES.both(NAMES[2], by(|one| &one.surfaces.dynamics)),
                ELEMENTS.both(NAMES[3], elements.collect()),
            ],
        )
    };
    Figure {
        title,
        said,
        pictures: plots::panels(
            "Stiffness and loss factor by the law and by finite elements",
            vec![
                panel(|dynamics| dynamics.stiffness, Axis::new("K", "kN/mm")),
                panel(
                    |dynamics| dynamics.loss_factor,
                    Axis::new("loss factor", ""),
                ),
            ],
        ),
        seen: if conditions[0].density == conditions[1].density {
            format!(
                "The tables' stiffness stays and then doubles: at 2.0 g/cm³ the tables do not show the described trend. The stiffness by \
                 finite elements rises a little with the strain, and their loss factor is nearly the same at every amplitude.{}",
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

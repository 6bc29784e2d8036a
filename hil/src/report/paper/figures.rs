//! The paper's figures, drawn from what was recomputed, beside what the text says of them.
//!
//! Figures 1, 2 and 4 show the fabrication, the test rig and a mesh, Figure 3 sketches eqs 1 and 2: there is nothing in them to
//! compute.

use std::f64::consts::TAU;

use plotters::style::RGBColor;

use crate::paper::{
    ANGLE_LOSS_FACTORS, ANGLE_STIFFNESS, BOUND, Compared, Condition, GUARDS, JUDGED, Paper,
};
use crate::reference::law::Coefficients;
use crate::reference::orthogonal_test::LEVELS;
use crate::reference::surfaces::{self, Equation18};
use crate::reference::tables::{AMPLITUDES, DENSITIES, cell};
use crate::report::plots::{self, BLUE, GREEN, GREY, Mark, ORANGE, PINK, Panel, SHADES, Trace};

/// One figure, or why there is none.
pub struct Figure {
    /// Its number and what it shows.
    pub title: &'static str,
    /// What the paper says of it.
    pub said: &'static str,
    /// The picture.
    pub svg: Option<String>,
    /// Its colours.
    pub key: Vec<(RGBColor, String)>,
    /// What is to be seen, or what it would take.
    pub seen: String,
}

/// Every figure that shows a result.
pub fn all(paper: &Paper) -> Vec<Figure> {
    vec![
        compression(paper),
        coefficients(paper),
        loops_by_density(),
        dynamics_by_density(paper),
        angle(paper),
        wire(paper),
        compared_loops(
            "Figure 14: loops by density, law and finite elements, 0.1 mm",
            "Both capture the counterclockwise turn; finite elements exaggerate the area at 4.0 g/cm³ and omit the inflections, \
             the law is well in accordance in every single case.",
            paper,
            &paper.comparison.by_density,
        ),
        errors(paper),
        compared_dynamics(
            "Figure 16: stiffness and loss factor by density, 0.1 mm",
            "The law predicts how both change; finite elements deviate significantly, especially in the loss factor.",
            "mesh density, g/cm³",
            &paper.comparison.by_density,
            |one| one.density,
        ),
        compared_loops(
            "Figure 17: loops by amplitude, law and finite elements, 2.0 g/cm³",
            "Finite elements neglect the inflections and depict the loop as an ellipse.",
            paper,
            &paper.comparison.by_amplitude,
        ),
        compared_dynamics(
            "Figure 18: stiffness and loss factor by amplitude, 2.0 g/cm³",
            "The stiffness falls rapidly first and then slowly approaches a steady value; by finite elements it falls ever more \
             steeply, and their loss factor differs considerably.",
            "amplitude, mm",
            &paper.comparison.by_amplitude,
            |one| one.amplitude,
        ),
    ]
}

fn trace(colour: RGBColor, mark: Mark, points: Vec<(f64, f64)>) -> Trace {
    Trace {
        points,
        colour,
        mark,
    }
}

fn corrected(density: f64, amplitude: f64) -> Coefficients {
    surfaces::coefficients(density, amplitude, Equation18::Corrected)
}

/// The whole loop at 1 Hz, closed.
fn loop_of(law: &Coefficients, amplitude: f64) -> Vec<(f64, f64)> {
    let steps = 400;
    (0..=steps)
        .map(|i| {
            // Half a step beside the extremes, where the damping force jumps.
            let (sin, cos) = (TAU * (f64::from(i) + 0.5) / f64::from(steps)).sin_cos();
            let y = amplitude * sin;
            (y, law.force(y, amplitude * TAU * cos))
        })
        .collect()
}

fn compression(paper: &Paper) -> Figure {
    let curves = paper.elements.compressions.iter().zip(SHADES);
    let traces = curves.filter_map(|(one, colour)| {
        let curve = one.curve.as_ref().ok()?;
        let points = curve.displacement.iter().copied();
        let points = points.zip(curve.force.iter().copied()).collect();
        Some(trace(colour, Mark::Both, points))
    });
    Figure {
        title: "The model of Figure 4: compression to 0.5 mm",
        said: "The constants of Table 4 are fitted against the compression curve.",
        svg: Some(plots::panels(&[Panel {
            title: "Table 4, D1 in 1/MPa, sudden".into(),
            labels: ("displacement, mm", "force, kN"),
            traces: traces.collect(),
            logarithmic: false,
        }])),
        key: density_key(),
        seen: "The measured curve is not given. All stiffen; those of 2.5 and 3.5 g/cm³ lie nearly on each other, since their \
               constants differ in C11 alone."
            .into(),
    }
}

fn density_key() -> Vec<(RGBColor, String)> {
    let shades = SHADES.into_iter().zip(DENSITIES);
    shades
        .map(|(colour, density)| (colour, format!("{density:.1} g/cm³")))
        .collect()
}

fn coefficients(paper: &Paper) -> Figure {
    let own = |r: f64, a: f64| paper.surfaces.coefficients(r, a);
    type Coefficient = (&'static str, fn(&Coefficients) -> f64);
    let all: [Coefficient; 4] = [
        ("k1, kN/mm", |law| law.k1),
        ("k3, kN/mm³", |law| law.k3),
        ("c, kN·(s/mm)^α", |law| law.c),
        ("α", |law| law.alpha),
    ];
    let mut panels = Vec::new();
    for (label, of) in all {
        for amplitude in [0, 2, 4] {
            let a = AMPLITUDES[amplitude];
            let points = |column: usize| (DENSITIES[column], of(&cell(amplitude, column)));
            let along = |law: &dyn Fn(f64, f64) -> Coefficients| -> Vec<(f64, f64)> {
                let densities = (0..=80).map(|i| 2.0 + 0.025 * f64::from(i));
                densities.map(|r| (r, of(&law(r, a)))).collect()
            };
            panels.push(Panel {
                title: format!("{a:.2} mm"),
                labels: ("mesh density, g/cm³", label),
                traces: vec![
                    trace(ORANGE, Mark::Line, along(&corrected)),
                    trace(BLUE, Mark::Line, along(&own)),
                    trace(GREY, Mark::Points, (0..5).map(points).collect()),
                ],
                logarithmic: false,
            });
        }
    }
    Figure {
        title: "Figures 5–7: the coefficients and their surfaces",
        said: "Eqs 16–19 describe how k1, k3, c and α evolve with density and amplitude.",
        svg: Some(plots::panels(&panels)),
        key: vec![
            (GREY, "Tables 6–9".into()),
            (ORANGE, "eqs 16–19, eq 18 corrected".into()),
            (BLUE, "the crate's surfaces".into()),
        ],
        seen: "Cuts at three amplitudes. Eq 18 as printed lies between −19 and −2, outside of every panel. Eq 16 is nearly 0 at the \
               low densities, where the tables are not."
            .into(),
    }
}

fn loops_by_density() -> Figure {
    let traces = (0..5).map(|column| {
        trace(
            SHADES[column],
            Mark::Line,
            loop_of(&cell(1, column), AMPLITUDES[1]),
        )
    });
    Figure {
        title: "Figure 8: loops by density, 0.1 mm",
        said: "The loops turn counterclockwise as density increases, and their area differs.",
        svg: Some(plots::panels(&[Panel {
            title: "Tables 6–9, 1 Hz".into(),
            labels: ("displacement, mm", "force, kN"),
            traces: traces.collect(),
            logarithmic: false,
        }])),
        key: density_key(),
        seen: "They turn, and their area grows; those of 2.5 and 3.0 g/cm³ end at the same force."
            .into(),
    }
}

fn dynamics_by_density(paper: &Paper) -> Figure {
    let panel = |title: &str, label, of: fn(&crate::paper::Cell) -> f64| Panel {
        title: title.into(),
        labels: ("mesh density, g/cm³", label),
        traces: (0..5)
            .map(|row| {
                let points = paper.cells[row].iter().map(|cell| (cell.density, of(cell)));
                trace(SHADES[row], Mark::Both, points.collect())
            })
            .collect(),
        logarithmic: false,
    };
    Figure {
        title: "Figure 9: stiffness and loss factor by density",
        said: "At 0.1 mm stiffness rises and loss factor falls, both monotonically.",
        svg: Some(plots::panels(&[
            panel("", "K, kN/mm", |cell| cell.dynamics.stiffness),
            panel("", "loss factor", |cell| cell.dynamics.loss_factor),
        ])),
        key: SHADES
            .into_iter()
            .zip(AMPLITUDES)
            .map(|(colour, amplitude)| (colour, format!("{amplitude:.2} mm")))
            .collect(),
        seen: "At 0.1 mm the stiffness rises, the loss factor has its highest value at 3.0 g/cm³. At 0.15 mm and above the \
               stiffness falls from 2.5 to 3.0 g/cm³."
            .into(),
    }
}

/// Means of Table 3 by level of a factor.
fn static_means(paper: &Paper, factor: usize) -> [Vec<(f64, f64)>; 2] {
    // Loss factor first in the analyses; stiffness first in the figures.
    [1, 0].map(|index| {
        let sums = paper.orthogonal_test[index].ranges[factor].sums;
        LEVELS[factor]
            .into_iter()
            .zip(sums.map(|sum| sum / 3.0))
            .collect()
    })
}

fn angle(paper: &Paper) -> Figure {
    let [stiffness, loss] = static_means(paper, 1);
    let of_tables = &paper.cells[1][2].dynamics;
    let [high, low] = ANGLE_LOSS_FACTORS;
    let panel = |title: &str, label, said: Vec<(f64, f64)>, own, means| Panel {
        title: title.into(),
        labels: ("crisscross angle, °", label),
        traces: vec![
            trace(PINK, Mark::Both, said),
            trace(GREY, Mark::Points, vec![(60.0, own)]),
            trace(ORANGE, Mark::Both, means),
        ],
        logarithmic: false,
    };
    Figure {
        title: "Figures 10 and 11: the crisscross angle, 3.0 g/cm³, wire 0.3 mm",
        said: "The loops turn clockwise with the angle; K falls from 3.5 to 1.0 kN/mm from 15° to 45° and stays low, the loss factor \
               falls slowly from 0.5 to 0.35 and bounces back.",
        svg: Some(plots::panels(&[
            panel("", "K, kN/mm", ANGLE_STIFFNESS.to_vec(), of_tables.stiffness, stiffness),
            panel(
                "",
                "loss factor",
                // Its lowest place is not said.
                vec![(15.0, high), (45.0, low)],
                of_tables.loss_factor,
                loss,
            ),
        ])),
        key: vec![
            (PINK, "numbers of the text; the angle of 0.35 is not said".into()),
            (GREY, "Tables 6–9 at 0.1 mm".into()),
            (ORANGE, "static means of Table 3".into()),
        ],
        seen: "The loops can't be drawn: of angles other than 60° no coefficients are given. What the tables give at 60° lies above \
               what the text says of Figure 11 in both; the static means of Table 3, over all densities, have another trend."
            .into(),
    }
}

fn wire(paper: &Paper) -> Figure {
    let [stiffness, loss] = static_means(paper, 2);
    let of_tables = &paper.cells[1][2].dynamics;
    let panel = |label, own, means| Panel {
        title: String::new(),
        labels: ("wire diameter, mm", label),
        traces: vec![
            trace(GREY, Mark::Points, vec![(0.3, own)]),
            trace(ORANGE, Mark::Both, means),
        ],
        logarithmic: false,
    };
    Figure {
        title: "Figures 12 and 13: the wire diameter",
        said: "The loops turn a little counterclockwise with the wire: the stiffness improves a little, the loss factor falls \
               slightly.",
        svg: Some(plots::panels(&[
            panel("K, kN/mm", of_tables.stiffness, stiffness),
            panel("loss factor", of_tables.loss_factor, loss),
        ])),
        key: vec![
            (GREY, "Tables 6–9 at 3.0 g/cm³, 0.1 mm".into()),
            (ORANGE, "static means of Table 3".into()),
        ],
        seen: "Neither the loops nor the trends can be drawn: all coefficients are of the 0.3 mm wire, and the text gives no number. \
               The static loss factor rises with the wire."
            .into(),
    }
}

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

fn compared_loops(
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

fn errors(paper: &Paper) -> Figure {
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

fn compared_dynamics(
    title: &'static str,
    said: &'static str,
    label: &'static str,
    conditions: &[Condition],
    at: fn(&Condition) -> f64,
) -> Figure {
    let panel = |of: fn(&crate::paper::Dynamics) -> f64, name| {
        let by = |dynamics: fn(&Condition) -> &crate::paper::Dynamics| -> Vec<(f64, f64)> {
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
                 rises a little with the strain, and their loss factor is the series' at every amplitude.{}",
                without_elements(conditions)
            )
        } else {
            format!(
                "Eq 20's loss factor is half of the tables' at 2.0 g/cm³ and nearly double at 2.5 g/cm³, and near from 3.0 g/cm³ on. \
                 Finite elements have half the stiffness or less at 3.5 and 4.0 g/cm³, and a loss factor that hardly changes.{}",
                without_elements(conditions)
            )
        },
    }
}

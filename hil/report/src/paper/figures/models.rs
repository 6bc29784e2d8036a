//! The inputs of the two methods: the material of the finite elements, and the coefficients of the law.

use mesh_damper_paper::claims::Paper;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES, cell};

use super::{Figure, corrected, of_density};
use crate::charts;
use crate::picture::Axis;
use crate::plots::{self, EQUATION, SHADES, SURFACES, TABLES};

pub(super) fn compression(paper: &Paper) -> Figure {
    let curves = paper.elements.compressions.iter().zip(SHADES);
    let curves = curves.zip(DENSITIES);
    let traces = curves.filter_map(|((one, style), density)| {
        let curve = one.curve.as_ref().ok()?;
        let points = curve.displacement.iter().copied();
        let points = points.zip(curve.force.iter().copied()).collect();
        Some(style.both(of_density(density), points))
    });
    Figure {
        title: "The model of Figure 4: compression to 0.5 mm",
        said: "The constants of Table 4 are fitted against the compression curve.",
        pictures: plots::panels(
            "Compression of the model of Figure 4",
            vec![plots::panel(
                "Table 4, D1 in 1/MPa, sudden",
                charts::displacement(),
                charts::force(),
                traces.collect(),
            )],
        ),
        seen: "The measured curve is not given. All stiffen; those of 2.5 and 3.5 g/cm³ lie nearly on each other, since their \
               constants differ in C11 alone."
            .into(),
    }
}

pub(super) fn coefficients(paper: &Paper) -> Figure {
    let own = |r: f64, a: f64| paper.surfaces.coefficients(r, a);
    type Coefficient = (&'static str, &'static str, fn(&Coefficients) -> f64);
    let all: [Coefficient; 4] = [
        ("k1", "kN/mm", |law| law.k1),
        ("k3", "kN/mm³", |law| law.k3),
        ("c", "kN·(s/mm)^α", |law| law.c),
        ("α", "", |law| law.alpha),
    ];
    let mut panels = Vec::new();
    for (name, unit, of) in all {
        for amplitude in [0, 2, 4] {
            let a = AMPLITUDES[amplitude];
            let points = |column: usize| (DENSITIES[column], of(&cell(amplitude, column)));
            let along = |law: &dyn Fn(f64, f64) -> Coefficients| -> Vec<(f64, f64)> {
                let densities = (0..=80).map(|i| 2.0 + 0.025 * f64::from(i));
                densities.map(|r| (r, of(&law(r, a)))).collect()
            };
            panels.push(plots::panel(
                format!("{name} at {a:.2} mm"),
                Axis::new("mesh density", "g/cm³"),
                Axis::new(name, unit),
                vec![
                    EQUATION.line("eqs 16–19, eq 18 corrected", along(&corrected)),
                    SURFACES.line("the crate's surfaces", along(&own)),
                    TABLES.points("Tables 6–9", (0..5).map(points).collect()),
                ],
            ));
        }
    }
    Figure {
        title: "Figures 5–7: the coefficients and their surfaces",
        said: "Eqs 16–19 describe how k1, k3, c and α evolve with density and amplitude.",
        pictures: plots::panels("Coefficients over density at three amplitudes", panels),
        seen: "Cuts at three amplitudes. Eq 18 as printed lies between −19 and −2, outside of every panel. Eq 16 is nearly 0 at the \
               low densities, where the tables are not."
            .into(),
    }
}

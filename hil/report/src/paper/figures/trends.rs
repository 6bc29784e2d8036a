//! Measured stiffness, loss factor and loops by density, angle and wire diameter.

use mesh_damper_paper::claims::{ANGLE_LOSS_FACTORS, ANGLE_STIFFNESS, Paper};
use mesh_damper_reference::orthogonal_test::LEVELS;
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES, cell};

use super::{Figure, loop_of, of_density};
use crate::charts;
use crate::picture::Axis;
use crate::plots::{self, EQUATION, SAID, SHADES, TABLES};

/// Names of the compared data.
const STATIC: &str = "static means of Table 3";

pub(super) fn loops_by_density() -> Figure {
    let traces = (0..5).map(|column| {
        let points = loop_of(&cell(1, column), AMPLITUDES[1]);
        SHADES[column].line(of_density(DENSITIES[column]), points)
    });
    Figure {
        title: "Figure 8: loops by density, 0.1 mm",
        said: "The loops turn counterclockwise as density increases, and their area differs.",
        pictures: plots::panels(
            "Loops by density at 0.1 mm",
            vec![plots::panel(
                "Tables 6–9, 1 Hz",
                charts::displacement(),
                charts::force(),
                traces.collect(),
            )],
        ),
        seen: "They turn, and their area grows; those of 2.5 and 3.0 g/cm³ end at the same force."
            .into(),
    }
}

pub(super) fn dynamics_by_density(paper: &Paper) -> Figure {
    let panel = |y: Axis, of: fn(&mesh_damper_paper::claims::Cell) -> f64| {
        let layers = (0..5).map(|row| {
            let points = paper.cells[row].iter().map(|cell| (cell.density, of(cell)));
            SHADES[row].both(format!("{:.2} mm", AMPLITUDES[row]), points.collect())
        });
        plots::panel("", Axis::new("mesh density", "g/cm³"), y, layers.collect())
    };
    Figure {
        title: "Figure 9: stiffness and loss factor by density",
        said: "At 0.1 mm stiffness rises and loss factor falls, both monotonically.",
        pictures: plots::panels(
            "Stiffness and loss factor over density",
            vec![
                panel(Axis::new("K", "kN/mm"), |cell| cell.dynamics.stiffness),
                panel(Axis::new("loss factor", ""), |cell| cell.dynamics.loss_factor),
            ],
        ),
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

pub(super) fn angle(paper: &Paper) -> Figure {
    let [stiffness, loss] = static_means(paper, 1);
    let of_tables = &paper.cells[1][2].dynamics;
    let [high, low] = ANGLE_LOSS_FACTORS;
    let panel = |y: Axis, said: Vec<(f64, f64)>, own, means| {
        plots::panel(
            "",
            Axis::new("crisscross angle", "°"),
            y,
            vec![
                SAID.both("numbers of the text; the angle of 0.35 is not said", said),
                TABLES.points("Tables 6–9 at 0.1 mm", vec![(60.0, own)]),
                EQUATION.both(STATIC, means),
            ],
        )
    };
    Figure {
        title: "Figures 10 and 11: the crisscross angle, 3.0 g/cm³, wire 0.3 mm",
        said: "The loops turn clockwise with the angle; K falls from 3.5 to 1.0 kN/mm from 15° to 45° and stays low, the loss factor \
               falls slowly from 0.5 to 0.35 and bounces back.",
        pictures: plots::panels(
            "Stiffness and loss factor over the crisscross angle",
            vec![
                panel(
                    Axis::new("K", "kN/mm"),
                    ANGLE_STIFFNESS.to_vec(),
                    of_tables.stiffness,
                    stiffness,
                ),
                panel(
                    Axis::new("loss factor", ""),
                    // The text does not give its lowest value.
                    vec![(15.0, high), (45.0, low)],
                    of_tables.loss_factor,
                    loss,
                ),
            ],
        ),
        seen: "The loops can't be drawn: of angles other than 60° no coefficients are given. What the tables give at 60° lies above \
               what the text says of Figure 11 in both; the static means of Table 3, over all densities, have another trend."
            .into(),
    }
}

pub(super) fn wire(paper: &Paper) -> Figure {
    let [stiffness, loss] = static_means(paper, 2);
    let of_tables = &paper.cells[1][2].dynamics;
    let panel = |y: Axis, own, means| {
        plots::panel(
            "",
            Axis::new("wire diameter", "mm"),
            y,
            vec![
                TABLES.points("Tables 6–9 at 3.0 g/cm³, 0.1 mm", vec![(0.3, own)]),
                EQUATION.both(STATIC, means),
            ],
        )
    };
    Figure {
        title: "Figures 12 and 13: the wire diameter",
        said: "The loops turn a little counterclockwise with the wire: the stiffness improves a little, the loss factor falls \
               slightly.",
        pictures: plots::panels(
            "Stiffness and loss factor over the wire diameter",
            vec![
                panel(Axis::new("K", "kN/mm"), of_tables.stiffness, stiffness),
                panel(Axis::new("loss factor", ""), of_tables.loss_factor, loss),
            ],
        ),
        seen: "Neither the loops nor the trends can be drawn: all coefficients are of the 0.3 mm wire, and the text gives no number. \
               The static loss factor rises with the wire."
            .into(),
    }
}

//! The paper's figures, drawn from recomputed values, next to the statements of the text.
//!
//! Figures 1, 2 and 4 show the fabrication, the test rig and a mesh, Figure 3 sketches eqs 1 and 2: they contain nothing to
//! compute.

mod methods;
mod models;
mod trends;

use std::f64::consts::TAU;

use mesh_damper_paper::claims::Paper;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::surfaces::{self, Equation18};

use crate::picture::Picture;
use methods::{compared_dynamics, compared_loops, errors};
use models::{coefficients, compression};
use trends::{angle, dynamics_by_density, loops_by_density, wire};

/// One figure.
pub struct Figure {
    /// Its number and its subject.
    pub title: &'static str,
    /// The paper's statement about it.
    pub said: &'static str,
    /// The pictures, each with its caption.
    pub pictures: Vec<(String, Picture)>,
    /// The observation, or the missing data.
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
            ("mesh density", "g/cm³"),
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
            ("amplitude", "mm"),
            &paper.comparison.by_amplitude,
            |one| one.amplitude,
        ),
    ]
}

fn corrected(density: f64, amplitude: f64) -> Coefficients {
    surfaces::coefficients(density, amplitude, Equation18::Corrected)
}

/// The whole loop at 1 Hz, closed.
fn loop_of(law: &Coefficients, amplitude: f64) -> Vec<(f64, f64)> {
    let steps = 400;
    (0..=steps)
        .map(|i| {
            // Half a step next to the extremes, where the damping force jumps.
            let (sin, cos) = (TAU * (f64::from(i) + 0.5) / f64::from(steps)).sin_cos();
            let y = amplitude * sin;
            (y, law.force(y, amplitude * TAU * cos))
        })
        .collect()
}

/// `2.0 g/cm³`
fn of_density(density: f64) -> String {
    format!("{density:.1} g/cm³")
}

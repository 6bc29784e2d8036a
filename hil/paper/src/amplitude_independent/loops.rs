//! Loops of the published tables: the law of one cell under a sine, in place of a measurement.

use std::f64::consts::TAU;

use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables::{self, AMPLITUDES};

/// Row of the tables whose amplitude, 0.15 mm, is held out.
pub const HELD_OUT: usize = 2;

/// Rows of the tables whose amplitudes are fitted.
pub const FITTED: [usize; 4] = [0, 1, 3, 4];

/// The fitted rows between others, like the held-out one. Left out in turn, they show how well a law interpolates between
/// amplitudes. Without an outer row, the test would judge a law by its extrapolation.
pub const BETWEEN: [usize; 2] = [1, 3];

/// One cycle of a sine that begins at y = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Sine {
    /// mm
    pub displacement: Vec<f64>,
    /// mm/s
    pub velocity: Vec<f64>,
}

impl Sine {
    /// `samples` of a cycle of `amplitude` mm at `frequency` Hz. They lie half a step from the extremes, so that no sample has v =
    /// 0, where rounding alone would decide the sign of the damping force.
    pub fn new(amplitude: f64, frequency: f64, samples: usize) -> Self {
        let phase = |n: usize| TAU * (n as f64 + 0.5) / samples as f64;
        Self {
            displacement: (0..samples).map(|n| amplitude * phase(n).sin()).collect(),
            velocity: (0..samples)
                .map(|n| amplitude * TAU * frequency * phase(n).cos())
                .collect(),
        }
    }

    /// The force in kN of the cell in row `row` and column `column` of Tables 6–9.
    pub fn force_of_cell(&self, row: usize, column: usize) -> Vec<f64> {
        self.force(&tables::cell(row, column))
    }

    /// The force in kN of eq 13.
    pub fn force(&self, law: &Coefficients) -> Vec<f64> {
        let samples = self.displacement.iter().zip(&self.velocity);
        samples.map(|(&y, &v)| law.force(y, v)).collect()
    }
}

/// Amplitude of row `row` of the tables, mm.
pub fn amplitude(row: usize) -> f64 {
    AMPLITUDES[row]
}

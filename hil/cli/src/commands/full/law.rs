//! The published law as an option of a command.

use clap::ValueEnum;
use mesh_damper::law::Law;
use mesh_damper::table::{PAPER, SMOOTHED};
use mesh_damper_paper::design::Source;

/// Source of the coefficients of eq 13.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum PublishedLaw {
    /// Tables 6–9 of the paper, with linear interpolation
    Tables,
    /// Surfaces fitted to the loops of these tables
    Surfaces,
}

impl PublishedLaw {
    /// The law of the crate at a density in g/cm³ and an amplitude in mm.
    pub fn at(self, density: f64, amplitude: f64) -> Law<f32> {
        let (density, amplitude) = (density as f32, amplitude as f32);
        match self {
            Self::Tables => PAPER.lookup(density, amplitude).law,
            Self::Surfaces => SMOOTHED.lookup(density, amplitude).law,
        }
    }

    /// The source of a design's coefficients, in f64.
    pub fn source(self) -> Source {
        match self {
            Self::Tables => Source::Tables,
            Self::Surfaces => Source::Surfaces,
        }
    }
}

//! The published law that a command takes.

use clap::ValueEnum;
use mesh_damper::law::Law;
use mesh_damper::table::{PAPER, SMOOTHED};
use mesh_damper_studies::design::Source;

/// Where eq 13's coefficients come from.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum PublishedLaw {
    /// Tables 6–9 of the paper, with linear interpolation
    Tables,
    /// Surfaces fitted to the loops of these tables
    Surfaces,
}

impl PublishedLaw {
    /// As the crate carries it, at a density in g/cm³ and an amplitude in mm.
    pub fn at(self, density: f64, amplitude: f64) -> Law<f32> {
        let (density, amplitude) = (density as f32, amplitude as f32);
        match self {
            Self::Tables => PAPER.lookup(density, amplitude).law,
            Self::Surfaces => SMOOTHED.lookup(density, amplitude).law,
        }
    }

    /// In f64, from which a design is made.
    pub fn source(self) -> Source {
        match self {
            Self::Tables => Source::Tables,
            Self::Surfaces => Source::Surfaces,
        }
    }
}

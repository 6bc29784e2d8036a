//! The source of a design's coefficients.

use std::sync::OnceLock;

use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables;
use serde::Serialize;

use crate::surfaces::{self, Surfaces};

/// A source of the coefficients of eq 13 over density and amplitude. Both sources come from the same tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Tables 6–9, interpolated linearly between their cells.
    Tables,
    /// The surfaces fitted to the loops of the tables.
    Surfaces,
}

impl Source {
    /// For a specimen of `density` g/cm³, 2…4, in cycles of `amplitude` mm, 0.05…0.25; beyond, those of the nearest edge.
    pub fn coefficients(self, density: f64, amplitude: f64) -> Coefficients {
        match self {
            Self::Tables => tables::interpolate(density, amplitude),
            Self::Surfaces => fitted().coefficients(density, amplitude),
        }
    }

    /// The other of the two.
    pub fn other(self) -> Self {
        match self {
            Self::Tables => Self::Surfaces,
            Self::Surfaces => Self::Tables,
        }
    }
}

fn fitted() -> &'static Surfaces {
    static FITTED: OnceLock<Surfaces> = OnceLock::new();
    FITTED.get_or_init(|| surfaces::fit(surfaces::DEGREE, None))
}

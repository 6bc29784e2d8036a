//! A residual table in a model: a correction over displacement and velocity, or over a memory of the motion.

use mesh_damper::effects::ResidualTable;
use mesh_damper::effects::residual_table::{Memory, ResidualTableParts};
use mesh_damper::error::ConfigError;
use mesh_damper::real::Real;
use serde::{Deserialize, Serialize};

/// The table of [`mesh_damper::effects::residual_table`], as JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CorrectionTable {
    /// Largest displacement of the table, mm. Beyond it, the value at the edge holds.
    pub reach: f64,
    /// Largest speed of the table, mm/s. Beyond it, the value at the edge holds.
    pub speed: f64,
    /// Force of one count in a cell, kN.
    pub unit: f64,
    /// The cells. Displacement varies fastest, then speed or the quantity in its place, then direction. A table over one line uses
    /// the first 33 of each direction's 153 cells, a table with two sides the first 34.
    pub cells: Vec<i16>,
    /// The axis in place of speed, with its memory or temperature. For a line it marks the shape of the table. Null for a table
    /// over speed.
    pub memory: Option<MemoryAxis>,
}

/// The axis of a table in place of speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MemoryAxis {
    /// The quantity on the axis.
    pub of: Remembered,
    /// Values of the quantity at the first and at the last node; unused for a line.
    pub range: [f64; 2],
}

/// The quantity on a residual table's axis in place of speed, as in [`Memory`]. Times are in s, the limit in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Remembered {
    /// Stretch of a spring that slips.
    Slip {
        /// Stretch at which it slips, mm.
        limit: f64,
    },
    /// Displacement minus its average.
    Lag {
        /// Averaging time, s.
        time: f64,
    },
    /// Mean speed.
    Travel {
        /// Averaging time, s.
        time: f64,
    },
    /// Largest displacement so far.
    Largest,
    /// Time since the start, on a scale of powers of two.
    Age {
        /// The first power on the scale, s.
        time: f64,
    },
    /// Temperature.
    Temperature,
    /// No memory: a finer line over displacement alone.
    Place,
    /// No memory: lines over speed alone on two sides of the displacement.
    Sides {
        /// Upper end of one side, mm.
        below: f64,
        /// Lower end of the other side, mm.
        above: f64,
    },
    /// Frequency, on a scale of powers of two.
    Frequency {
        /// Time over which cycles are counted, s.
        time: f64,
    },
}

impl Remembered {
    /// The quantity by its name in `trace.json`.
    pub fn is_of(self) -> &'static str {
        match self {
            Self::Slip { .. } | Self::Lag { .. } | Self::Travel { .. } | Self::Largest => "history",
            Self::Age { .. } => "time",
            Self::Temperature => "temperature",
            Self::Place | Self::Sides { .. } => "displacement",
            Self::Frequency { .. } => "frequency",
        }
    }

    /// As the crate's type.
    pub fn memory<R: Real>(self) -> Memory<R> {
        let real = R::from_f64;
        match self {
            Self::Slip { limit } => Memory::Slip { limit: real(limit) },
            Self::Lag { time } => Memory::Lag { time: real(time) },
            Self::Travel { time } => Memory::Travel { time: real(time) },
            Self::Largest => Memory::Largest,
            Self::Temperature => Memory::Temperature,
            Self::Place => Memory::Place,
            Self::Sides { below, above } => Memory::Sides {
                below: real(below),
                above: real(above),
            },
            Self::Frequency { time } => Memory::Frequency { time: real(time) },
            Self::Age { time } => Memory::Age { time: real(time) },
        }
    }
}

impl CorrectionTable {
    /// The effect for a tick of `tick` s.
    ///
    /// # Errors
    /// The field that the crate refuses.
    pub fn build<R: Real>(&self, tick: f64) -> Result<ResidualTable<R>, ConfigError> {
        let memory = self.memory;
        let parts = ResidualTableParts {
            reach: R::from_f64(self.reach),
            speed: R::from_f64(self.speed),
            unit: R::from_f64(self.unit),
            cells: &self.cells,
            memory: memory.map(|memory| (memory.of.memory(), memory.range.map(R::from_f64))),
        };
        ResidualTable::new(&parts, R::from_f64(tick))
    }
}

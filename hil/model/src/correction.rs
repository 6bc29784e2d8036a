//! A correction without a name as a model carries it: a table over displacement and velocity, or over what is remembered.

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
    /// Largest displacement of the table, mm; outside, its edge holds.
    pub reach: f64,
    /// Largest speed, mm/s; outside, its edge holds.
    pub speed: f64,
    /// kN of one count in a cell.
    pub unit: f64,
    /// Displacement runs fastest, then speed or what stands in its place, then direction. A line has the first 33 of each
    /// direction's 153, two sides the first 34.
    pub cells: Vec<i16>,
    /// What stands in the place of speed: what the motion was before, or the temperature; or that it is a line.
    pub memory: Option<MemoryAxis>,
}

/// What a table is over in the place of speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MemoryAxis {
    /// Which.
    pub of: Remembered,
    /// Its values at the first and at the last node; of a line unused.
    pub range: [f64; 2],
}

/// What a correction remembers or is over, as [`Memory`] says it: times in s, the limit in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Remembered {
    /// The stretch of a spring that slips.
    Slip {
        /// At which it slips, mm.
        limit: f64,
    },
    /// The displacement less its average.
    Lag {
        /// Over which it is averaged, s.
        time: f64,
    },
    /// The mean speed.
    Travel {
        /// Over which it is averaged, s.
        time: f64,
    },
    /// The largest displacement so far.
    Largest,
    /// How long it is since the start, by powers of two.
    Age {
        /// The first of them, s.
        time: f64,
    },
    /// The temperature.
    Temperature,
    /// Nothing: a finer line over displacement alone.
    Place,
    /// Nothing: lines over speed alone on two sides of the displacement.
    Sides {
        /// Below this is one side, mm.
        below: f64,
        /// Above this is the other, mm.
        above: f64,
    },
    /// The frequency, by powers of two.
    Frequency {
        /// Over which the cycles are counted, s.
        time: f64,
    },
}

impl Remembered {
    /// What it is of, by the names of `trace.json`.
    pub fn is_of(self) -> &'static str {
        match self {
            Self::Slip { .. } | Self::Lag { .. } | Self::Travel { .. } | Self::Largest => "history",
            Self::Age { .. } => "time",
            Self::Temperature => "temperature",
            Self::Place | Self::Sides { .. } => "displacement",
            Self::Frequency { .. } => "frequency",
        }
    }

    /// Whether the table is a line over displacement or over speed alone.
    pub fn is_line(self) -> bool {
        matches!(self, Self::Place | Self::Sides { .. })
    }

    /// As the crate takes it.
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

//! The channels of a recording.

use super::columns::spelling;
use super::units::{self, Unit, Units};

/// A channel of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// The samples' times.
    Time,
    /// Displacement.
    Displacement,
    /// Force.
    Force,
    /// Velocity.
    Velocity,
    /// Temperature.
    Temperature,
}

impl Channel {
    /// Every channel.
    pub const ALL: [Self; 5] = [
        Self::Time,
        Self::Displacement,
        Self::Force,
        Self::Velocity,
        Self::Temperature,
    ];

    /// Its name in a column's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Displacement => "displacement",
            Self::Force => "force",
            Self::Velocity => "velocity",
            Self::Temperature => "temperature",
        }
    }

    /// Its unit in the code.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Time => "s",
            Self::Displacement => "mm",
            Self::Force => "kN",
            Self::Velocity => "mm/s",
            Self::Temperature => "°C",
        }
    }

    /// The units that its column may have.
    pub fn units(self) -> &'static [Unit] {
        match self {
            Self::Time => units::TIME,
            Self::Displacement => units::DISPLACEMENT,
            Self::Force => units::FORCE,
            Self::Velocity => units::VELOCITY,
            Self::Temperature => units::TEMPERATURE,
        }
    }

    /// The unit of it with this spelling: by its symbol, or in another form that people and programs use, such as `newtons` and
    /// `µm`.
    pub fn unit_written(self, written: &str) -> Option<Unit> {
        spelling::unit_of(self, written)
    }

    /// Its unit among those of a recording.
    pub fn unit_in(self, units: &Units) -> Unit {
        match self {
            Self::Time => units.time,
            Self::Displacement => units.displacement,
            Self::Force => units.force,
            Self::Velocity => units.velocity,
            Self::Temperature => units.temperature,
        }
    }

    /// Whether a recording must have it.
    pub fn is_required(self) -> bool {
        matches!(self, Self::Time | Self::Displacement | Self::Force)
    }

    /// `displacement_mm, displacement_m, …`
    pub fn column_names(self) -> String {
        let names: Vec<String> = self
            .units()
            .iter()
            .map(|unit| format!("{}_{}", self.name(), unit.symbol))
            .collect();
        names.join(", ")
    }
}

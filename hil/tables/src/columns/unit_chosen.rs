//! Chooses the unit of a channel's column: the user's, the file's, or an assumed one.

use mesh_damper_output::error::{InputError, Place, quoted};

use super::choose::{Choice, said};
use super::unit_found::{self, UnitFound};
use super::{is_own, spelling};
use crate::channel::Channel;
use crate::files::Unmarked;
use crate::units::Unit;

impl Choice<'_> {
    /// The unit of a channel's column; `None` if nothing states it.
    pub(super) fn unit(
        &self,
        channel: Channel,
        column: usize,
        guesses: &mut Vec<String>,
    ) -> Result<Option<Unit>, InputError> {
        let source = &self.table.columns[column];
        let found = unit_found::unit_for(source, channel);
        if let Some(written) = said(&self.reading.units, channel.name()) {
            let unit = spelling::unit_of(channel, written)
                .ok_or_else(|| no_such_unit(channel, written))?;
            if !spelling::is_as_spelt(channel, unit, written) {
                guesses.push(format!(
                    "unit {} of {} is read as {}",
                    quoted(written),
                    channel.name(),
                    unit.symbol
                ));
            }
            match found {
                UnitFound::Known(other) if source.is_stamp && !other.is_same(unit) => {
                    let problem = format!(
                        "its dates or times of day are read as seconds, and --unit time={unit} says {unit}",
                        unit = unit.symbol
                    );
                    let place = Place::Column(source.name.clone());
                    return Err(InputError::new(self.file, problem, "leave the unit out").at(place));
                }
                UnitFound::Known(other) if !other.is_same(unit) => {
                    let (unit, other) = (unit.symbol, other.symbol);
                    if is_own(&source.name) {
                        let quantity = channel.name();
                        let problem = format!(
                            "its name says {other}, and --unit {quantity}={unit} says {unit}"
                        );
                        let remedy = "leave out --unit, or rename the column";
                        let place = Place::Column(source.name.clone());
                        return Err(InputError::new(self.file, problem, remedy).at(place));
                    }
                    guesses.push(format!(
                        "column {} is read in {unit}, as --unit says, not in {other}, as the column says",
                        quoted(&source.name)
                    ));
                }
                UnitFound::Known(_) => {}
                UnitFound::Unknown(other) | UnitFound::Unclear(other, _) => {
                    guesses.push(not_understood(&source.name, unit, &other));
                }
                UnitFound::None => guesses.extend(
                    unit_found::unknown_unit(source)
                        .map(|other| not_understood(&source.name, unit, &other)),
                ),
            }
            return Ok(Some(unit));
        }
        match found {
            UnitFound::Known(unit) => Ok(Some(unit)),
            UnitFound::Unknown(written) => Err(self.unknown(channel, column, &written)),
            UnitFound::Unclear(written, either) => {
                let problem = format!("the unit is not clear: {written}");
                Err(self.no_unit(channel, column, problem, &either))
            }
            UnitFound::None => Ok(None),
        }
    }

    /// A stated unit that the channel cannot have.
    fn unknown(&self, channel: Channel, column: usize, written: &str) -> InputError {
        if has_factor(written) {
            return self.scaled_unit(channel, column, written);
        }
        let problem = if spelling::is_quantity(written) {
            format!("{written} is no unit of a {}", channel.name())
        } else {
            format!("unknown unit {}", quoted(written))
        };
        self.no_unit(channel, column, problem, &longer(channel, written))
    }

    /// The unit of a channel's column without a stated unit. `assumed` records the assumption.
    pub(super) fn unmarked(
        &self,
        channel: Channel,
        column: usize,
        assumed: &mut Vec<String>,
    ) -> Result<Unit, InputError> {
        match &self.needs.unmarked {
            Unmarked::Refused => match unit_found::unknown_unit(&self.table.columns[column]) {
                Some(written) => Err(self.unknown(channel, column, &written)),
                None => {
                    let problem = "the name carries no unit".into();
                    Err(self.no_unit(channel, column, problem, &[]))
                }
            },
            Unmarked::Stated(units) => Ok(channel.unit_in(units)),
            Unmarked::Assumed(units) => {
                let unit = channel.unit_in(units);
                let name = quoted(&self.table.columns[column].name);
                assumed.push(format!(
                    "{} for column {name}",
                    unit.symbol.replace('_', "/")
                ));
                Ok(unit)
            }
        }
    }
}

/// The note on a column in the unit of an option, whose own unit is `other`.
fn not_understood(column: &str, unit: Unit, other: &str) -> String {
    format!(
        "column {} is read in {}, as --unit says; its own unit, {}, is not understood",
        quoted(column),
        unit.symbol,
        quoted(other)
    )
}

/// A unit in an option that the channel cannot have.
fn no_such_unit(channel: Channel, written: &str) -> InputError {
    let quantity = channel.name();
    let problem = if spelling::is_quantity(written) {
        format!("{written} is no unit of a {quantity}")
    } else {
        format!("unknown unit {}", quoted(written))
    };
    let units: Vec<&str> = channel.units().iter().map(|unit| unit.symbol).collect();
    InputError::new(
        format!("--unit {quantity}={written}"),
        problem,
        format!("give one of {}", units.join(", ")),
    )
}

/// Whether a unit is written with a factor: `1/100 mm`, `10 N`. An exponent is none: `mm^2`.
fn has_factor(written: &str) -> bool {
    written
        .trim_start()
        .starts_with(|c: char| c.is_ascii_digit())
}

/// The units that begin with the written one: `kgf` for `kg`.
fn longer(channel: Channel, written: &str) -> Vec<&'static str> {
    let units = channel.units().iter().map(|unit| unit.symbol);
    units.filter(|symbol| symbol.starts_with(written)).collect()
}

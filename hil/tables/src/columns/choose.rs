//! Chooses the columns of a recording.

use mesh_damper_output::error::{InputError, Place, quoted};

use super::listed::{listed, option};
use super::meaning::{Meaning, Meanings};
use super::taken::{self, Candidate, Rank};
use super::unit_found::UnitFound;
use crate::channel::Channel;
use crate::files::table::Clock;
use crate::files::{Needs, Reading, Table};
use crate::units::Unit;

/// A column used as a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Used {
    /// The channel.
    pub channel: Channel,
    /// Its index in the table.
    pub column: usize,
    /// The unit of its values.
    pub unit: Unit,
    /// How certain the choice is.
    pub rank: Rank,
}

/// A column used as a control input.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenControl {
    /// Its index in the table.
    pub column: usize,
    /// Its name in a recording: `current_A`.
    pub name: String,
    /// The unit of a length, which may also belong to the motion: it is an input only if it stays where it is.
    pub length: Option<Unit>,
}

/// The columns of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// The index of the table in the file.
    pub table: usize,
    /// At most one column of each channel.
    pub used: Vec<Used>,
    /// The control inputs, in the order of their columns.
    pub controls: Vec<ChosenControl>,
    /// The samples' times, if no column has them.
    pub clock: Option<Clock>,
    /// Uncertain choices, in words.
    pub guesses: Vec<String>,
    /// Units that were assumed, in words.
    pub assumed: Option<String>,
}

/// Chooses the columns of a recording among those of a file; the channels that it `needs` must be there.
///
/// # Errors
/// A channel that is missing, that two columns match, or whose unit is not known; a control input that is needed and not there; an
/// option that names no column; several tables that match. The message contains the option that decides.
pub fn choose(
    file: &str,
    tables: &[Table],
    reading: &Reading,
    needs: &Needs,
) -> Result<Chosen, InputError> {
    Meanings::of(tables).choose(file, reading, needs)
}

impl Meanings<'_> {
    /// [`choose`] among the columns whose meanings these are.
    ///
    /// # Errors
    /// As [`choose`].
    pub fn choose(
        &self,
        file: &str,
        reading: &Reading,
        needs: &Needs,
    ) -> Result<Chosen, InputError> {
        check_said(reading)?;
        let tables = self.tables;
        let meant = self.meant(file, reading)?;
        let mut found = None;
        let mut candidates = Vec::new();
        // A table without a column for each channel is refused, and its error is of use only if all are.
        for &index in meant
            .iter()
            .filter(|&&index| self.has_channels(index, reading, needs))
        {
            match self.of_table(file, index, reading, needs) {
                Ok(chosen) => {
                    found.get_or_insert(chosen);
                }
                // A table of which only an option's answer is missing is as likely the one.
                Err(error) if error.answer().is_some() => {}
                Err(_) => continue,
            }
            candidates.push(tables[index].name.as_str());
        }
        if let Some(found) = found {
            return match candidates.len() {
                1 => Ok(found),
                _ => Err(which_table(file, &candidates)),
            };
        }
        if let Some(error) = super::apart::apart(file, self, &meant, reading, needs) {
            return Err(error);
        }
        // The table that looks most like a recording gives the message about missing columns.
        let like = |&&index: &&usize| {
            let columns = self.of[index].iter();
            columns.filter(|each| !each.candidates.is_empty()).count()
        };
        let Some(&index) = meant.iter().rev().max_by_key(like) else {
            let problem = "holds no table";
            return Err(InputError::new(
                file,
                problem,
                "check that it is the right file",
            ));
        };
        let several = tables.len() > 1;
        let chosen = self.of_table(file, index, reading, needs);
        chosen.map_err(|error| error.in_table(several.then_some(&*tables[index].name)))
    }

    /// The tables that the user means.
    fn meant(&self, file: &str, reading: &Reading) -> Result<Vec<usize>, InputError> {
        let tables = self.tables;
        let of_name = |index: &usize| match &reading.table {
            Some(name) => tables[*index].name.eq_ignore_ascii_case(name),
            None => true,
        };
        let meant: Vec<usize> = (0..tables.len()).filter(of_name).collect();
        let Some(wanted) = reading.table.as_deref().filter(|_| meant.is_empty()) else {
            return Ok(meant);
        };
        let remedy = match tables {
            [only] if only.name.is_empty() => {
                "leave out --table: the file is one table without a name".into()
            }
            _ => {
                let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
                format!("give --table one of {}", listed(&names))
            }
        };
        let problem = format!("there is no table {}", quoted(wanted));
        Err(InputError::new(file, problem, remedy))
    }

    /// Whether some column could be each measured channel that is needed.
    fn has_channels(&self, index: usize, reading: &Reading, needs: &Needs) -> bool {
        let mut measured = (Channel::ALL.into_iter())
            .filter(|&channel| channel != Channel::Time && needs.has(channel));
        measured.all(|channel| {
            said(&reading.channels, channel.name()).is_some()
                || self.of[index].iter().any(|each| each.may_be(channel))
        })
    }

    fn of_table(
        &self,
        file: &str,
        index: usize,
        reading: &Reading,
        needs: &Needs,
    ) -> Result<Chosen, InputError> {
        let choice = Choice {
            file,
            table: &self.tables[index],
            meanings: &self.of[index],
            reading,
            needs,
        };
        choice.of_table(index)
    }
}

/// Question for the table, of those with these names.
pub fn which_table(file: &str, names: &[&str]) -> InputError {
    InputError::new(
        file,
        format!("{} tables hold a recording: {}", names.len(), listed(names)),
        "give the name of one with --table",
    )
    .answered_by("--table NAME")
}

/// Rejects a channel in other words, which would be read as a control input, and the unit of a quantity that is not a channel and
/// has no column, because it would have no effect.
fn check_said(reading: &Reading) -> Result<(), InputError> {
    for (quantity, column) in &reading.channels {
        let Some(channel) = taken::other_name_of(quantity) else {
            continue;
        };
        let channel = channel.name();
        return Err(InputError::new(
            format!("--channel {quantity}={column}"),
            format!("{} is another word for {channel}", quoted(quantity)),
            format!("give {}", option("channel", channel, column)),
        ));
    }
    let is_known = |quantity: &str| {
        Channel::ALL
            .into_iter()
            .any(|channel| channel.name() == quantity)
            || said(&reading.channels, quantity).is_some()
    };
    match reading
        .units
        .iter()
        .find(|(quantity, _)| !is_known(quantity))
    {
        Some((quantity, unit)) => Err(InputError::new(
            format!("--unit {quantity}={unit}"),
            format!(
                "{} is not a channel, and --channel gives no column for it",
                quoted(quantity)
            ),
            format!(
                "channels are time, displacement, force, velocity and temperature; for a control input, give its column too: \
                 --channel {quantity}=NAME"
            ),
        )),
        None => Ok(()),
    }
}

/// Basis of a choice.
pub(super) struct Choice<'a> {
    pub file: &'a str,
    pub table: &'a Table,
    /// What its columns may be.
    pub meanings: &'a [Meaning],
    pub reading: &'a Reading,
    pub needs: &'a Needs,
}

impl Choice<'_> {
    /// The columns of the table, whose place is `index`.
    fn of_table(&self, index: usize) -> Result<Chosen, InputError> {
        let table = self.table;
        let mut chosen = Chosen {
            table: index,
            used: Vec::new(),
            controls: Vec::new(),
            clock: None,
            guesses: table.guesses.clone(),
            assumed: None,
        };
        let mut assumed = Vec::new();
        for channel in Channel::ALL {
            if channel == Channel::Time && self.reading.rate.is_some() {
                let mut columns = table.columns.iter();
                let times = columns.find(|column| taken::of_times(column).is_time);
                chosen.guesses.extend(times.map(|column| {
                    format!(
                        "the times in column {} are not used, because --rate replaces them",
                        quoted(&column.name)
                    )
                }));
                continue;
            }
            let Some((column, rank)) =
                self.column(channel, self.needs.has(channel), &mut chosen.guesses)?
            else {
                continue;
            };
            // Columns that are not part of the recording need not be understood.
            let is_optional = rank < Rank::Own && !self.needs.has(channel);
            let unit = match self.unit(channel, column, &mut chosen.guesses) {
                Err(_) if is_optional => continue,
                Ok(None) if is_optional => {
                    let name = quoted(&table.columns[column].name);
                    let (channel, [unit, ..]) = (channel.name(), channel.units()) else {
                        continue;
                    };
                    chosen.guesses.push(format!(
                        "column {name} may be the {channel}; it states no unit, so it is not read; give it, such as --unit {channel}={}",
                        unit.symbol
                    ));
                    continue;
                }
                Ok(None) => self.unmarked(channel, column, &mut assumed)?,
                Ok(Some(unit)) => unit,
                Err(error) => return Err(error),
            };
            let source = &table.columns[column];
            // Dates that the table marks as its times are no guess.
            if rank < Rank::Own && !(source.is_time && source.is_stamp) {
                let name = quoted(&source.name);
                let how = if rank == Rank::Unit {
                    ", by its unit alone"
                } else {
                    ""
                };
                let (channel, unit) = (channel.name(), unit.symbol);
                chosen.guesses.push(format!(
                    "{channel} is read from column {name} in {unit}{how}"
                ));
            }
            chosen.used.push(Used {
                channel,
                column,
                unit,
                rank,
            });
        }
        if !chosen.used.iter().any(|used| used.channel == Channel::Time) {
            let step = self.reading.rate.map(|rate| Clock {
                start: 0.0,
                step: 1.0 / rate,
            });
            chosen.clock = step.or(table.clock);
        }
        for channel in Channel::ALL
            .into_iter()
            .filter(|&channel| self.needs.has(channel))
        {
            let is_there = chosen.used.iter().any(|used| used.channel == channel)
                || (channel == Channel::Time && chosen.clock.is_some());
            if !is_there {
                return Err(self.missing(channel));
            }
        }
        chosen.controls = self.controls(&chosen.used, &mut chosen.guesses)?;
        if !assumed.is_empty() {
            chosen.assumed = Some(format!(
                "no unit is given, so {} is assumed; give the unit, or put it into the name, such as force_kN",
                assumed.join(", ")
            ));
        }
        Ok(chosen)
    }

    /// The column of a channel, and the certainty of the choice.
    fn column(
        &self,
        channel: Channel,
        is_needed: bool,
        guesses: &mut Vec<String>,
    ) -> Result<Option<(usize, Rank)>, InputError> {
        if let Some(name) = said(&self.reading.channels, channel.name()) {
            return Ok(Some((self.named(name, channel.name())?, Rank::Stated)));
        }
        let all = self.meanings.iter().enumerate();
        let all = all.filter(|(column, meaning)| {
            !meaning.candidates.is_empty() && !self.is_spoken_for(*column)
        });
        let of_channel = all.flat_map(|(column, meaning)| {
            let candidates = meaning.candidates.iter();
            let mine = candidates.filter(|candidate| candidate.channel == channel);
            mine.map(move |candidate| (column, candidate.rank, &candidate.unit))
        });
        let mut found: Vec<(usize, Rank, &UnitFound)> = of_channel.collect();
        let Some(best) = found.iter().map(|&(_, rank, _)| rank).max() else {
            return Ok(None);
        };
        found.retain(|&(_, rank, _)| rank == best);
        // A unit that the channel cannot have means another column, if there is a better one. In a name of our own form it is a
        // mistake, unless another quantity has this unit: `force_V` is the raw signal beside `force_kN`.
        let is_another = |written: &str| best < Rank::Own || super::spelling::is_unit(written);
        if found.len() > 1
            && found
                .iter()
                .any(|(.., unit)| matches!(unit, UnitFound::Known(_)))
        {
            found.retain(
                |(.., unit)| !matches!(unit, UnitFound::Unknown(written) if is_another(written)),
            );
        }
        let name = |column: usize| self.table.columns[column].name.as_str();
        let rivals = match found[..] {
            [(column, ..)] if best < Rank::Own => self.rivals(channel, column, best),
            _ => Vec::new(),
        };
        match found[..] {
            [(column, ..)] if rivals.is_empty() => Ok(Some((column, best))),
            [(first, ..), (second, ..), ..] if best == Rank::Own => Err(InputError::new(
                self.file,
                format!("{} is also a {}", name(first), channel.name()),
                format!(
                    "keep one of them, rename the other, or give --channel {}={}",
                    channel.name(),
                    name(first)
                ),
            )
            .at(Place::Column(name(second).into()))
            .answered_by(format!("--channel {}=NAME", channel.name()))),
            _ => {
                let columns = found.iter().map(|&(column, ..)| column).chain(rivals);
                let columns: Vec<&str> = columns.map(name).collect();
                let error = self.several(channel, &columns);
                if is_needed {
                    return Err(error);
                }
                guesses.push(format!(
                    "{}, so none of them is read; {}",
                    error.problem, error.remedy
                ));
                Ok(None)
            }
        }
    }

    /// Whether the user assigned a column.
    pub(super) fn is_spoken_for(&self, column: usize) -> bool {
        let name = self.table.columns[column].name.as_str();
        self.reading.channels.iter().any(|(_, said)| said == name)
    }

    /// Columns that match a channel as well as the chosen one, though with less certainty.
    fn rivals(&self, channel: Channel, taken: usize, rank: Rank) -> Vec<usize> {
        let columns = &self.table.columns;
        if columns[taken].is_time || columns[taken].is_stamp {
            return Vec::new();
        }
        let is_sure = rank > Rank::Unit && taken::is_understood(&columns[taken], channel);
        let is_another =
            |candidate: &Candidate| candidate.channel != channel && candidate.rank >= Rank::Word;
        let is_rival = |&column: &usize| {
            let meaning = &self.meanings[column];
            column != taken
                && meaning.has_unit(channel)
                && !meaning.candidates.iter().any(is_another)
                && !meaning.is_clear_control
                && !self.is_spoken_for(column)
                && taken::could_be(&columns[column], channel, is_sure)
        };
        (0..columns.len()).filter(is_rival).collect()
    }

    /// The column with a name that the user gave.
    pub(super) fn named(&self, name: &str, quantity: &str) -> Result<usize, InputError> {
        let columns = &self.table.columns;
        let exact = columns.iter().position(|column| column.name == name);
        let alike: Vec<usize> = (columns.iter().enumerate())
            .filter(|(_, column)| column.name.trim().eq_ignore_ascii_case(name.trim()))
            .map(|(index, _)| index)
            .collect();
        match (exact, &alike[..]) {
            (Some(column), _) => Ok(column),
            (None, [column]) => Ok(*column),
            _ => {
                let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
                Err(InputError::new(
                    self.file,
                    format!(
                        "there is no column {}; found {}",
                        quoted(name),
                        listed(&names)
                    ),
                    format!(
                        "give one of these names: --channel {quantity}=NAME; the option applies to every file, so that the column \
                         must have the same name in all of them"
                    ),
                ))
            }
        }
    }
}

/// The user's setting for a quantity; the last one counts.
pub(super) fn said<'s>(said: &'s [(String, String)], quantity: &str) -> Option<&'s str> {
    let of_it = said.iter().rev().find(|(of, _)| of == quantity);
    of_it.map(|(_, what)| what.as_str())
}

#[cfg(test)]
mod tests;

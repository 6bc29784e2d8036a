//! Chooses the columns of a recording.

use super::asked::listed;
use super::taken::{self, Candidate, Rank};
use super::unit_found::{self, UnitFound};
use crate::channel::Channel;
use crate::error::{InputError, Place, quoted};
use crate::files::table::Clock;
use crate::files::{Needs, Reading, Table, Unmarked};
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
    check_said(reading)?;
    let of_name = |(_, table): &(usize, &Table)| match &reading.table {
        Some(name) => table.name.eq_ignore_ascii_case(name),
        None => true,
    };
    let meant: Vec<(usize, &Table)> = tables.iter().enumerate().filter(of_name).collect();
    let names = |tables: &mut dyn Iterator<Item = &Table>| -> String {
        let names: Vec<String> = tables.map(|table| quoted(&table.name)).collect();
        names.join(", ")
    };
    if meant.is_empty() {
        let wanted = reading.table.as_deref().unwrap_or_default();
        let remedy = match tables {
            [only] if only.name.is_empty() => {
                "leave out --table: the file is one table without a name".into()
            }
            _ => format!("give --table one of {}", names(&mut tables.iter())),
        };
        let problem = format!("there is no table {}", quoted(wanted));
        return Err(InputError::new(file, problem, remedy));
    }
    let tried: Vec<(usize, Result<Chosen, InputError>)> = meant
        .iter()
        .map(|&(index, table)| (index, of_table(file, index, table, reading, needs)))
        .collect();
    let whole: Vec<usize> = (tried.iter().filter(|(_, chosen)| chosen.is_ok()))
        .map(|&(index, _)| index)
        .collect();
    if whole.len() > 1 {
        let names: Vec<&str> = whole
            .iter()
            .map(|&index| tables[index].name.as_str())
            .collect();
        return Err(which_table(file, &names));
    }
    let several = tables.len() > 1;
    let mut failed = Vec::new();
    for (index, chosen) in tried {
        match chosen {
            Ok(chosen) => return Ok(chosen),
            Err(error) => failed.push((index, error)),
        }
    }
    if let Some(error) = super::apart::apart(file, &meant, reading, needs) {
        return Err(error);
    }
    // The table that looks most like a recording gives the message about missing columns.
    let like = |&&(index, _): &&(usize, InputError)| {
        let columns = tables[index].columns.iter();
        columns
            .filter(|column| !taken::candidates(column).is_empty())
            .count()
    };
    let best = failed.iter().rev().max_by_key(like);
    let (index, mut error) = match best {
        Some((index, error)) => (*index, error.clone()),
        None => (
            0,
            InputError::new(file, "holds no table", "check that it is the right file"),
        ),
    };
    if several {
        error.problem = format!("table {}: {}", quoted(&tables[index].name), error.problem);
    }
    Err(error)
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
            format!("give {}", super::asked::option("channel", channel, column)),
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

fn of_table(
    file: &str,
    index: usize,
    table: &Table,
    reading: &Reading,
    needs: &Needs,
) -> Result<Chosen, InputError> {
    let choice = Choice {
        file,
        table,
        reading,
        needs,
    };
    let mut chosen = Chosen {
        table: index,
        used: Vec::new(),
        controls: Vec::new(),
        clock: None,
        guesses: table.guesses.clone(),
        assumed: None,
    };
    let mut assumed = Vec::new();
    let candidates: Vec<Vec<Candidate>> = table.columns.iter().map(taken::candidates).collect();
    for channel in Channel::ALL {
        if channel == Channel::Time && reading.rate.is_some() {
            let times = table.columns.iter().find(|column| taken::is_time(column));
            chosen.guesses.extend(times.map(|column| {
                format!(
                    "the times in column {} are not used, because --rate replaces them",
                    quoted(&column.name)
                )
            }));
            continue;
        }
        let Some((column, rank)) = choice.column(
            channel,
            &candidates,
            needs.has(channel),
            &mut chosen.guesses,
        )?
        else {
            continue;
        };
        // Columns that are not part of the recording need not be understood.
        let is_optional = rank < Rank::Own && !needs.has(channel);
        let unit = match choice.unit(channel, column, &mut chosen.guesses) {
            Err(_) | Ok(None) if is_optional => continue,
            Ok(None) => choice.unmarked(channel, column, &mut assumed)?,
            Ok(Some(unit)) => unit,
            Err(error) => return Err(error),
        };
        let told = &table.columns[column];
        // Dates that the table marks as its times are no guess.
        if rank < Rank::Own && !(told.is_time && told.is_stamp) {
            let name = quoted(&told.name);
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
        let step = reading.rate.map(|rate| Clock {
            start: 0.0,
            step: 1.0 / rate,
        });
        chosen.clock = step.or(table.clock);
    }
    for channel in Channel::ALL
        .into_iter()
        .filter(|&channel| needs.has(channel))
    {
        let is_there = chosen.used.iter().any(|used| used.channel == channel)
            || (channel == Channel::Time && chosen.clock.is_some());
        if !is_there {
            return Err(choice.missing(channel, &candidates));
        }
    }
    chosen.controls = choice.controls(&chosen.used, &mut chosen.guesses)?;
    if !assumed.is_empty() {
        chosen.assumed = Some(format!(
            "no unit is given, so {} is assumed; give the unit, or put it into the name, such as force_kN",
            assumed.join(", ")
        ));
    }
    Ok(chosen)
}

/// Basis of a choice.
pub(super) struct Choice<'a> {
    pub file: &'a str,
    pub table: &'a Table,
    pub reading: &'a Reading,
    pub needs: &'a Needs,
}

impl Choice<'_> {
    /// The column of a channel, and the certainty of the choice.
    fn column(
        &self,
        channel: Channel,
        candidates: &[Vec<Candidate>],
        is_needed: bool,
        guesses: &mut Vec<String>,
    ) -> Result<Option<(usize, Rank)>, InputError> {
        if let Some(name) = said(&self.reading.channels, channel.name()) {
            return Ok(Some((self.named(name, channel.name())?, Rank::Said)));
        }
        let all = candidates
            .iter()
            .enumerate()
            .filter(|(column, _)| !self.is_spoken_for(*column));
        let of_channel = all.flat_map(|(column, list)| {
            let mine = list.iter().filter(|candidate| candidate.channel == channel);
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
            [(column, ..)] if best < Rank::Own => self.rivals(channel, column, best, candidates),
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
            .at(Place::Column(name(second).into()))),
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
    fn is_spoken_for(&self, column: usize) -> bool {
        let name = self.table.columns[column].name.as_str();
        self.reading.channels.iter().any(|(_, said)| said == name)
    }

    /// Columns that match a channel as well as the chosen one, though with less certainty.
    fn rivals(
        &self,
        channel: Channel,
        taken: usize,
        rank: Rank,
        candidates: &[Vec<Candidate>],
    ) -> Vec<usize> {
        let columns = &self.table.columns;
        if columns[taken].is_time || columns[taken].is_stamp {
            return Vec::new();
        }
        let is_sure = rank > Rank::Unit && taken::is_understood(&columns[taken], channel);
        let is_another =
            |candidate: &Candidate| candidate.channel != channel && candidate.rank >= Rank::Word;
        let is_rival = |&column: &usize| {
            column != taken
                && !self.is_spoken_for(column)
                && !candidates[column].iter().any(is_another)
                && taken::control_name(&columns[column]).is_none()
                && taken::could_be(&columns[column], channel, is_sure)
        };
        (0..columns.len()).filter(is_rival).collect()
    }

    /// The unit of a channel's column; `None` if nothing states it.
    fn unit(
        &self,
        channel: Channel,
        column: usize,
        guesses: &mut Vec<String>,
    ) -> Result<Option<Unit>, InputError> {
        let fail = |problem: String| self.no_unit(channel, column, problem, &[]);
        let told = &self.table.columns[column];
        let found = unit_found::unit_for(told, channel);
        if let Some(written) = said(&self.reading.units, channel.name()) {
            let unit = super::spelling::unit_of(channel, written)
                .ok_or_else(|| no_such_unit(channel, written))?;
            if !super::spelling::is_as_spelt(channel, unit, written) {
                guesses.push(format!(
                    "unit {} of {} is read as {}",
                    quoted(written),
                    channel.name(),
                    unit.symbol
                ));
            }
            match found {
                UnitFound::Known(other) if told.is_stamp && !other.is_same(unit) => {
                    let problem = format!(
                        "its dates or times of day are read as seconds, and --unit time={unit} says {unit}",
                        unit = unit.symbol
                    );
                    let place = Place::Column(told.name.clone());
                    return Err(InputError::new(self.file, problem, "leave the unit out").at(place));
                }
                UnitFound::Known(other) if !other.is_same(unit) => {
                    let (unit, other) = (unit.symbol, other.symbol);
                    if super::is_own(&told.name) {
                        let quantity = channel.name();
                        let problem = format!(
                            "its name says {other}, and --unit {quantity}={unit} says {unit}"
                        );
                        let remedy = "leave out --unit, or rename the column";
                        let place = Place::Column(told.name.clone());
                        return Err(InputError::new(self.file, problem, remedy).at(place));
                    }
                    guesses.push(format!(
                        "column {} is read in {unit}, as --unit says, not in {other}, as the column says",
                        quoted(&told.name)
                    ));
                }
                UnitFound::Unknown(other) | UnitFound::Unclear(other, _) => guesses.push(format!(
                    "column {} is read in {}, as --unit says; its own unit, {}, is not understood",
                    quoted(&told.name),
                    unit.symbol,
                    quoted(&other)
                )),
                UnitFound::Known(_) | UnitFound::None => {}
            }
            return Ok(Some(unit));
        }
        match found {
            UnitFound::Known(unit) => Ok(Some(unit)),
            UnitFound::Unknown(written) if has_factor(&written) => {
                Err(self.scaled_unit(channel, column, &written))
            }
            UnitFound::Unknown(written) if super::spelling::is_quantity(&written) => Err(fail(
                format!("{written} is no unit of a {}", channel.name()),
            )),
            UnitFound::Unknown(written) => {
                let either = longer(channel, &written);
                let problem = format!("unknown unit {}", quoted(&written));
                Err(self.no_unit(channel, column, problem, &either))
            }
            UnitFound::Unclear(written, either) => {
                let problem = format!("the unit is not clear: {written}");
                Err(self.no_unit(channel, column, problem, &either))
            }
            UnitFound::None => Ok(None),
        }
    }

    /// The unit of a channel's column without a stated unit. `assumed` records the assumption.
    fn unmarked(
        &self,
        channel: Channel,
        column: usize,
        assumed: &mut Vec<String>,
    ) -> Result<Unit, InputError> {
        match &self.needs.unmarked {
            Unmarked::Refused => {
                let problem = match unit_found::unknown_unit(&self.table.columns[column]) {
                    Some(written) if has_factor(&written) => {
                        return Err(self.scaled_unit(channel, column, &written));
                    }
                    Some(written) => format!("unknown unit {}", quoted(&written)),
                    None => "the name carries no unit".into(),
                };
                Err(self.no_unit(channel, column, problem, &[]))
            }
            Unmarked::Said(units) => Ok(channel.unit_in(units)),
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
                    format!("give one of these names: --channel {quantity}=NAME"),
                ))
            }
        }
    }
}

/// A unit in an option that the channel cannot have.
fn no_such_unit(channel: Channel, written: &str) -> InputError {
    let quantity = channel.name();
    let problem = if super::spelling::is_quantity(written) {
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

/// The user's setting for a quantity; the last one counts.
pub(super) fn said<'s>(said: &'s [(String, String)], quantity: &str) -> Option<&'s str> {
    let of_it = said.iter().rev().find(|(of, _)| of == quantity);
    of_it.map(|(_, what)| what.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Column;

    fn table(names: &[&str]) -> Table {
        let column = |name: &&str| Column {
            name: (*name).into(),
            is_numeric: true,
            ..Column::default()
        };
        Table {
            columns: names.iter().map(column).collect(),
            ..Table::default()
        }
    }

    fn chosen(names: &[&str], reading: &Reading) -> Result<Chosen, String> {
        let chosen = choose("a.csv", &[table(names)], reading, &Needs::default());
        chosen.map_err(|error| error.to_string())
    }

    fn pair(of: &str, what: &str) -> (String, String) {
        (of.into(), what.into())
    }

    #[test]
    fn equal_candidates_are_asked_for_and_lesser_ones_are_not() {
        let plain = Reading::default();
        let columns = |names: &[&str]| {
            let chosen = chosen(names, &plain).unwrap();
            chosen
                .used
                .iter()
                .map(|used| used.column)
                .collect::<Vec<_>>()
        };
        assert_eq!(
            columns(&["Time [s]", "x [mm]", "Disp [mm]", "Load [kN]"]),
            [0, 2, 3]
        );
        assert_eq!(
            columns(&[
                "Time [s]",
                "Disp [mm]",
                "Axial Displacement Command [mm]",
                "Load [kN]"
            ]),
            [0, 1, 3]
        );
        assert_eq!(
            columns(&[
                "Cycle time [s]",
                "Time [s]",
                "Disp [mm]",
                "Load [MPa]",
                "Force [kN]"
            ]),
            [1, 2, 4]
        );
        for (names, option) in [
            (
                &["Time [s]", "Disp [mm]", "Force 1 [kN]", "Force 2 [kN]"][..],
                "--channel force='Force 1 [kN]'",
            ),
            (
                &["Time [s]", "Stroke [mm]", "Disp [mm]", "Load [kN]"],
                "--channel displacement='Disp [mm]'",
            ),
            (
                &["Time [s]", "Disp [mm]", "Pull [kN]"],
                "--channel force='Pull [kN]'",
            ),
            (&["Time [s]", "Disp", "Load [kN]"], "--unit displacement=mm"),
            (&["Disp [mm]", "Load [kN]"], "--rate"),
        ] {
            let error = chosen(names, &plain).unwrap_err();
            assert!(error.contains(option), "{error}");
        }
    }

    #[test]
    fn what_the_user_says_counts_and_a_word_of_no_use_is_refused() {
        let said = Reading {
            channels: vec![pair("force", "force 2 [kN]"), pair("valve", "Ch 4")],
            units: vec![pair("valve", "V")],
            ..Reading::default()
        };
        let names = [
            "Time [s]",
            "Disp [mm]",
            "Force 1 [kN]",
            "Force 2 [kN]",
            "Ch 4",
        ];
        let found = chosen(&names, &said).unwrap();
        assert_eq!(found.used[2].column, 3);
        assert_eq!(found.controls[0].name, "valve_V");
        let wrong = Reading {
            units: vec![pair("froce", "N")],
            ..Reading::default()
        };
        let error = chosen(&names, &wrong).unwrap_err();
        assert!(
            error.contains("--unit froce=N") && error.contains("is not a channel"),
            "{error}"
        );
        let wrong = Reading {
            channels: vec![pair("force", "Kraft")],
            ..Reading::default()
        };
        let error = chosen(&names, &wrong).unwrap_err();
        assert!(error.contains("there is no column \"Kraft\""), "{error}");
        // The word would be a control input, which the force depends on.
        for (word, remedy) in [
            ("Kraft", "--channel force='Force 1 [kN]'"),
            ("load", "--channel force='Force 1 [kN]'"),
            ("weg", "--channel displacement='Force 1 [kN]'"),
        ] {
            let wrong = Reading {
                channels: vec![pair(word, "Force 1 [kN]")],
                ..Reading::default()
            };
            let error = chosen(&names, &wrong).unwrap_err();
            assert!(error.contains(remedy), "{error}");
        }
    }

    #[test]
    fn a_unit_that_is_not_understood_is_asked_for_and_said() {
        let plain = Reading::default();
        let error = |names: &[&str]| chosen(names, &plain).unwrap_err();
        // No option states a factor, so that none is offered.
        let scaled = error(&["Time [s]", "Weg [1/100 mm]", "Kraft [kN]"]);
        assert!(scaled.contains("has a factor"), "{scaled}");
        assert!(!scaled.contains("--unit"), "{scaled}");
        for (force, offered) in [
            ("KRAFT [MN]", "--unit force=MN or --unit force=mN"),
            ("Load (kg)", "--unit force=kgf;"),
            ("Load [mm]", "mm is no unit of a force"),
        ] {
            let error = error(&["Time [s]", "Disp [mm]", force]);
            assert!(error.contains(offered), "{error}");
        }
        let said = |force: &str, unit: &str| Reading {
            channels: vec![pair("force", force)],
            units: vec![pair("force", unit)],
            ..Reading::default()
        };
        let names = ["Time [s]", "Disp [mm]", "Load (kg)"];
        let read = chosen(&names, &said("Load (kg)", "kgf")).unwrap();
        let note = "its own unit, \"kg\", is not understood";
        assert!(read.guesses.join("\n").contains(note), "{:?}", read.guesses);
        // An option that is wrong is named, and not the column.
        let wrong = chosen(&names, &said("Load (kg)", "mm")).unwrap_err();
        assert!(
            wrong.starts_with("--unit force=mm: mm is no unit of a force"),
            "{wrong}"
        );
    }

    #[test]
    fn a_raw_signal_in_volts_is_no_second_force() {
        let plain = Reading::default();
        let read = chosen(
            &["time_s", "displacement_mm", "force_kN", "force_V"],
            &plain,
        );
        assert_eq!(read.unwrap().used[2].column, 2);
        let both = chosen(
            &["time_s", "displacement_mm", "force_kN", "force_N"],
            &plain,
        );
        assert!(both.unwrap_err().contains("is also a force"));
        let alone = chosen(&["time_s", "displacement_mm", "force_V"], &plain).unwrap_err();
        assert!(alone.contains("V is no unit of a force"), "{alone}");
    }

    #[test]
    fn a_rate_in_place_of_times_is_said() {
        let said = Reading {
            rate: Some(100.0),
            ..Reading::default()
        };
        let read = chosen(&["Zeit [s]", "Disp [mm]", "Force [kN]"], &said).unwrap();
        let note = "the times in column \"Zeit [s]\" are not used, because --rate replaces them";
        assert!(
            read.guesses.iter().any(|guess| guess == note),
            "{:?}",
            read.guesses
        );
        let said = Reading {
            table: Some("x".into()),
            ..Reading::default()
        };
        let error = chosen(&["Zeit [s]", "Disp [mm]", "Force [kN]"], &said).unwrap_err();
        assert!(error.contains("leave out --table"), "{error}");
    }

    #[test]
    fn a_unit_in_other_letters_is_said() {
        let names = ["Time [s]", "Disp", "Force [kN]"];
        let guesses = |unit: &str| {
            let said = Reading {
                units: vec![pair("displacement", unit)],
                ..Reading::default()
            };
            chosen(&names, &said).unwrap().guesses.join("\n")
        };
        let note = "unit \"M\" of displacement is read as m";
        assert!(guesses("M").contains(note), "{}", guesses("M"));
        for unit in ["m", "metre", "µm"] {
            assert!(!guesses(unit).contains("is read as"), "{}", guesses(unit));
        }
    }
}

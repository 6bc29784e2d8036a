//! Questions about the columns of a recording, with the options to type.

use mesh_damper_output::error::{InputError, Place, quoted};

use super::choose::Choice;
use super::listed::{MOST, listed, option};
use super::meaning::Meaning;
use super::taken::{self, Candidate, Rank};
use crate::channel::Channel;

/// Largest number of options in a message.
const OPTIONS: usize = 4;

impl Choice<'_> {
    /// Several columns match a channel equally well.
    pub(super) fn several(&self, channel: Channel, columns: &[&str]) -> InputError {
        let channel = channel.name();
        let options: Vec<String> = columns
            .iter()
            .take(MOST)
            .map(|name| option("channel", channel, name))
            .collect();
        InputError::new(
            self.file,
            format!(
                "{} columns could be the {channel}: {}",
                columns.len(),
                listed(columns)
            ),
            format!("say which: {}", options.join(" or ")),
        )
        .answered_by(format!("--channel {channel}=NAME"))
    }

    /// The unit of a channel's column is not known; it may be one of `either`.
    pub(super) fn no_unit(
        &self,
        channel: Channel,
        column: usize,
        problem: String,
        either: &[&str],
    ) -> InputError {
        let name = self.table.columns[column].name.as_str();
        let units: Vec<&str> = channel.units().iter().map(|unit| unit.symbol).collect();
        let quantity = channel.name();
        let offered = if either.is_empty() {
            &units[..2]
        } else {
            either
        };
        let options: Vec<String> = (offered.iter())
            .map(|unit| format!("--unit {quantity}={unit}"))
            .collect();
        let remedy = format!(
            "use one of {}, or give it: {}; units are {}",
            channel.column_names(),
            options.join(" or "),
            units.join(", ")
        );
        InputError::new(self.file, problem, remedy)
            .at(Place::Column(name.into()))
            .answered_by(unit_option(channel))
    }

    /// The unit of a channel's column has a factor, which no option states.
    pub(super) fn scaled_unit(&self, channel: Channel, column: usize, written: &str) -> InputError {
        let name = self.table.columns[column].name.as_str();
        let problem = format!("unit {} has a factor, which is not read", quoted(written));
        let remedy = format!("write the column in one of {}", channel.column_names());
        InputError::new(self.file, problem, remedy).at(Place::Column(name.into()))
    }

    /// No column matches a channel.
    pub(super) fn missing(&self, channel: Channel) -> InputError {
        let columns = &self.table.columns;
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        let name = channel.name();
        // Columns that could be it: those with a unit of it, else those without a unit, unless they are another channel.
        let could_be = |is_it: &dyn Fn(&Meaning) -> bool| -> Vec<String> {
            let each = columns.iter().enumerate().zip(self.meanings);
            let each = each.filter(|((index, column), meaning)| {
                let is_other = |candidate: &Candidate| {
                    candidate.channel != channel && candidate.rank >= Rank::Word
                };
                is_it(meaning)
                    && column.is_numeric
                    && !column.is_stamp
                    && (channel != Channel::Time || rises(&column.first))
                    && !meaning.is_surely_other
                    && !self.is_spoken_for(*index)
                    && !meaning.candidates.iter().any(is_other)
            });
            each.take(OPTIONS)
                .map(|((_, column), _)| option("channel", name, &column.name))
                .collect()
        };
        let is_time = channel == Channel::Time;
        let mut options = could_be(&|meaning| meaning.has_unit(channel));
        let only = |options: &[String]| match options {
            [only] => only.clone(),
            _ => format!("--channel {name}=NAME"),
        };
        let mut answer = only(&options);
        let mut unit = String::new();
        if options.is_empty() {
            options = could_be(&|meaning| meaning.has_no_unit(channel));
            if is_time && options.is_empty() {
                answer = "--rate HZ".into();
            } else if self.reading.units.iter().all(|(of, _)| of != name) {
                unit = format!(
                    ", with its unit unless its name carries one: {}",
                    unit_option(channel)
                );
                answer = format!("{} {}", only(&options), unit_option(channel));
            }
        }
        if options.is_empty() {
            options.push(format!("--channel {name}=NAME"));
        }
        let rate = if is_time {
            ", or give the sampling rate in Hz with --rate"
        } else {
            ""
        };
        let problem = if self.table.is_nameless {
            format!(
                "there is no header, the first row holds numbers; its columns are {}",
                listed(&names)
            )
        } else {
            let words = columns.iter().find_map(|column| {
                let cell = column.words.as_ref()?;
                let is_it = |each: &Candidate| each.channel == channel;
                let is_named = taken::candidates(column, true).iter().any(is_it);
                is_named.then(|| {
                    let name = quoted(&column.name);
                    format!("; column {name} holds words, such as {}", quoted(cell))
                })
            });
            let words = words.unwrap_or_default();
            format!("there is no {name} column; found {}{words}", listed(&names))
        };
        let error = InputError::new(
            self.file,
            problem,
            format!(
                "name one of them {}, or say which one it is: {}{unit}{rate}",
                channel.column_names(),
                options.join(" or ")
            ),
        )
        .answered_by(answer)
        .lacking(channel.name());
        match self.table.header_line {
            Some(line) => error.at(Place::Line(line)),
            None => error,
        }
    }
}

/// The option for the unit of a channel, which only the user knows.
fn unit_option(channel: Channel) -> String {
    format!("--unit {}=UNIT", channel.name())
}

/// Whether the first values of a column can be times: they rise, and none is below the one before.
fn rises(first: &[f64]) -> bool {
    let mut known = first.iter().filter(|value| value.is_finite());
    let Some(begin) = known.next() else {
        return true;
    };
    let end = known.try_fold(begin, |before, value| (value >= before).then_some(value));
    end.is_some_and(|end| end > begin || first.len() == 1)
}

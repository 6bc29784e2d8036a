//! The open questions about a file, and the command that answers them.

use std::path::Path;

use mesh_damper_output::error::InputError;
use mesh_damper_output::shell;
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::columns::{Meanings, which_table};
use mesh_damper_tables::files::{Needs, Reading, Table};

/// All open questions: the table, and the column and unit of each channel. `first` is the question that a trace would ask first.
pub fn asked(
    name: &str,
    tables: &[Table],
    meanings: &Meanings<'_>,
    said: &Reading,
    first: &InputError,
) -> Vec<InputError> {
    let mut questions: Vec<InputError> = Vec::new();
    if first.answer().is_none() {
        return vec![first.clone()];
    }
    let mut said = said.clone();
    let (most, alike) = most_like_one(tables, meanings);
    // Displacement and force at least; time may be given.
    if said.table.is_none() && most > 1 {
        let names: Vec<&str> = (alike.iter())
            .map(|&index| tables[index].name.as_str())
            .collect();
        let which = which_table(name, &names);
        if first.answer() == which.answer() {
            questions.push(first.clone());
        } else if names.len() > 1 {
            questions.push(which);
        }
        said.table = names.first().map(|name| (*name).to_owned());
    }
    for channel in Channel::ALL
        .into_iter()
        .filter(|channel| channel.is_required())
    {
        if let Err(question) = meanings.choose(name, &said, &Needs::of([channel]))
            && !questions.contains(&question)
        {
            questions.push(question);
        }
    }
    if questions.is_empty() {
        // The question is not about a channel.
        questions.push(first.clone());
    }
    questions
}

/// The largest number of columns in a table that could be channels, and the tables with that number.
pub fn most_like_one(tables: &[Table], meanings: &Meanings<'_>) -> (usize, Vec<usize>) {
    let like: Vec<usize> = (0..tables.len())
        .map(|index| meanings.described_of(index))
        .collect();
    let most = like.iter().copied().max().unwrap_or(0);
    let such = (0..tables.len()).filter(|&index| like[index] == most);
    (most, such.collect())
}

/// The command that traces the file, with the given options and those that answer the questions.
pub fn command(path: &Path, options: &[String], questions: &[InputError]) -> String {
    let answers = || questions.iter().filter_map(|question| question.answer());
    let answer = |own: &str| {
        // One column cannot be two channels, so only the user knows which is which.
        let column = of_channel(own).and_then(|channel| channel.split_once('='));
        match column {
            Some((what, column)) if answers().filter(|other| names(other, column)).count() > 1 => {
                own.replacen(&format!("{what}={column}"), &format!("{what}=NAME"), 1)
            }
            _ => own.to_owned(),
        }
    };
    let mut parts = vec!["hil trace".to_owned(), shell::file(path)];
    parts.extend(options.iter().cloned().chain(answers().map(answer)));
    parts.join(" ")
}

/// The first of some options, if it gives a column to a channel.
fn of_channel(options: &str) -> Option<&str> {
    let channel = options.split(" --unit ").next()?;
    channel.starts_with("--channel ").then_some(channel)
}

/// Whether options give a column to a channel.
fn names(options: &str, column: &str) -> bool {
    of_channel(options).is_some_and(|channel| channel.ends_with(&format!("={column}")))
}

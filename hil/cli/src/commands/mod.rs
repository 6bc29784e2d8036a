//! The command line: one file for each command. `full` contains the commands that a first look does not need.

mod controls;
mod demo;
mod document;
#[cfg(feature = "full")]
mod full;
mod inspect;
mod inspect_questions;
mod inspect_words;
mod known_rig;
mod predict;
mod progress;
mod reading;
mod respond;
mod respond_sweep;
mod seeking;
mod separating;
mod summary;
mod trace;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use mesh_damper_identify::trace::TraceError;
use mesh_damper_output::error::InputError;
use mesh_damper_output::terminal::{check_said, say, tell, visible};

const EXAMPLES: &str = "Examples:\n  hil demo --seed 4\n  hil inspect demo-out/recording.csv.gz\n  hil trace demo-out/recording.csv.gz";

/// Test metal mesh dampers on a rig, find what a force law lacks, and predict forces
///
/// Exit codes: 0: done. 1: the work is done, but a check failed, the rig tripped, some recordings could not be traced, or no density
/// was found. 2: bad usage or bad input, or a standard output that cannot be written. 130, 143: interrupted by Ctrl-C, ended by SIGTERM;
/// no file is half written, and what was finished stays.
#[derive(Debug, Parser)]
#[command(
    name = "hil",
    version,
    after_help = EXAMPLES
)]
pub struct Cli {
    /// Numbers that decide, as JSON, in the place of the default ones
    #[cfg(feature = "full")]
    #[arg(long, global = true, hide = true, value_name = "FILE")]
    policy: Option<std::path::PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::DemoCommand),
    Inspect(inspect::InspectCommand),
    Trace(Box<trace::TraceCommand>),
    Predict(predict::Predict),
    Respond(respond::RespondCommand),
    #[cfg(feature = "full")]
    #[command(flatten)]
    Full(Box<full::Command>),
}

impl Cli {
    /// The command of this program's arguments.
    ///
    /// # Errors
    /// A help, the version, or an error of usage, which repeats arguments only as a terminal may show them.
    pub fn of_arguments() -> Result<Self, clap::Error> {
        Self::try_parse().map_err(|error| {
            let arguments = std::env::args_os();
            let shown = arguments.map(|each| visible(&each.to_string_lossy()).into_owned());
            // The same arguments, escaped, have the same error.
            Self::try_parse_from(shown).err().unwrap_or(error)
        })
    }

    /// Runs the command.
    pub fn run(self) -> Result<(), Failure> {
        #[cfg(feature = "full")]
        if let Some(path) = &self.policy {
            full::policy::install(path)?;
        }
        match self.command {
            Command::Demo(command) => command.run(),
            Command::Inspect(command) => command.run(),
            Command::Trace(command) => command.run(),
            Command::Predict(command) => command.run(),
            Command::Respond(command) => command.run(),
            #[cfg(feature = "full")]
            Command::Full(command) => command.run(),
        }?;
        Ok(check_said()?)
    }
}

/// The reason why a command did not succeed.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The usage or the input was wrong.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The recordings could not be traced.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The work was done, but a check failed.
    #[error("{0}")]
    Check(String),
}

impl Failure {
    /// The exit code for the failure.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Check(_) => ExitCode::from(1),
            Self::Input(_) | Self::Trace(_) => ExitCode::from(2),
        }
    }
}

/// Whether no file of a command is standard output, so that results in words can go there.
#[cfg(feature = "full")]
fn is_free_for_text<'a>(files: impl IntoIterator<Item = &'a Option<std::path::PathBuf>>) -> bool {
    let dash = std::path::Path::new("-");
    files.into_iter().all(|file| file.as_deref() != Some(dash))
}

/// Prints a warning to standard error; the work continues.
fn warn(text: &str) {
    tell(&format!("warning: {text}"));
}

#[cfg(test)]
mod tests {
    use clap::{Command, CommandFactory as _, Parser as _};

    use super::Cli;

    /// An example of this many characters fits into one line of a narrow terminal and can be copied as it is.
    const WIDTH: usize = 79;

    /// `command` and all its subcommands, each with the words that call it.
    fn all_of(command: &Command, called: String) -> Vec<(String, Command)> {
        let below = command
            .get_subcommands()
            .filter(|one| one.get_name() != "help");
        let below: Vec<_> = below
            .flat_map(|one| all_of(one, format!("{called} {}", one.get_name())))
            .collect();
        [(called, command.clone())]
            .into_iter()
            .chain(below)
            .collect()
    }

    fn all() -> Vec<(String, Command)> {
        let mut whole = Cli::command();
        whole.build();
        all_of(&whole, "hil".into())
    }

    /// The examples at the end of a help text, one line each.
    fn examples(help: &str) -> Vec<String> {
        let (_, last) = help
            .rsplit_once("Examples:\n")
            .or_else(|| help.rsplit_once("Example:\n"))
            .unwrap_or_default();
        let joined = last.replace("\\\n", " ");
        let lines = joined
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty());
        lines.map(str::to_owned).collect()
    }

    /// The words of a shell line without its redirections; for a pipe, the words of the last command.
    fn words(line: &str) -> Vec<String> {
        let line = line.rsplit(" | ").next().unwrap_or(line);
        let line = line.split(" > ").next().unwrap_or(line);
        // Every second part is inside quotes, where blanks do not separate words.
        let quoted = line.split('\'').enumerate();
        let kept: String = quoted
            .map(|(index, part)| match index % 2 {
                0 => part.to_owned(),
                _ => part.replace(' ', "\0"),
            })
            .collect();
        let words = kept.split_whitespace();
        words.map(|word| word.replace('\0', " ")).collect()
    }

    #[test]
    fn every_help_ends_with_examples_that_parse() {
        for (called, mut command) in all() {
            let help = command.render_long_help().to_string();
            let examples = examples(&help);
            let own =
                |example: &String| *example == called || example.starts_with(&format!("{called} "));
            assert!(examples.iter().any(own), "{called} has no example: {help}");
            for example in &examples {
                let words = words(example);
                assert_eq!(words[0], "hil", "{called}: {example}");
                let parsed = Cli::try_parse_from(&words);
                assert!(parsed.is_ok(), "{called}: {example}: {parsed:?}");
            }
            let example_lines = help.rsplit("Example").next().unwrap_or_default().lines();
            for line in example_lines {
                assert!(line.chars().count() <= WIDTH, "{called}: {line}");
            }
        }
    }

    #[test]
    fn every_option_has_a_help() {
        for (called, command) in all() {
            for argument in command.get_arguments() {
                let help = argument.get_help().or(argument.get_long_help());
                assert!(help.is_some(), "{called}: {}", argument.get_id());
            }
        }
    }
}

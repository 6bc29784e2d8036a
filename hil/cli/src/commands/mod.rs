//! The command line: one file per command. What a first look does not need is in `full`.

mod demo;
mod document;
#[cfg(feature = "full")]
mod full;
mod progress;
mod reading;
mod seeking;
mod separating;
mod summary;
mod trace;

use std::io::Write as _;
use std::process::ExitCode;
use std::sync::OnceLock;

use clap::{Parser, Subcommand};
use mesh_damper_identify::trace::TraceError;
use mesh_damper_recording::error::InputError;

/// Rig tests, tracing and prediction of the elastic porous metal mesh damper.
///
/// Exit codes: 0 done, 1 the check asked for failed, 2 bad usage or bad input.
#[derive(Debug, Parser)]
#[command(name = "hil", version)]
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
    Trace(Box<trace::TraceCommand>),
    #[cfg(feature = "full")]
    #[command(flatten)]
    Full(Box<full::Command>),
}

impl Cli {
    /// Does what the command line asks for.
    pub fn run(self) -> Result<(), Failure> {
        #[cfg(feature = "full")]
        if let Some(path) = &self.policy {
            full::policy::install(path)?;
        }
        match self.command {
            Command::Demo(command) => command.run(),
            Command::Trace(command) => command.run(),
            #[cfg(feature = "full")]
            Command::Full(command) => command.run(),
        }?;
        match UNSAID.get() {
            Some(error) => {
                let name = std::path::Path::new("standard output");
                Err(InputError::io(name, "write", error).into())
            }
            None => Ok(()),
        }
    }
}

/// Why a command did not end well.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The usage or the input was bad.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The recordings could not be traced.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The work was done, and what it was to show does not hold.
    #[error("{0}")]
    Check(String),
}

impl Failure {
    /// The exit code that says so.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Check(_) => ExitCode::from(1),
            Self::Input(_) | Self::Trace(_) => ExitCode::from(2),
        }
    }
}

/// Why standard output did not take what was said, the first time.
static UNSAID: OnceLock<std::io::Error> = OnceLock::new();

/// Prints results to standard output; who reads no more has read enough. [`Cli::run`] fails for anything else that keeps it from being
/// written.
fn say(text: &str) {
    let mut output = std::io::stdout();
    match writeln!(output, "{text}").and_then(|()| output.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            // The first one counts.
            let _ = UNSAID.set(error);
        }
        _ => {}
    }
}

/// Whether none of the files that a command writes is standard output, which has room for the results in words then.
#[cfg(feature = "full")]
fn is_free_for_text<'a>(files: impl IntoIterator<Item = &'a Option<std::path::PathBuf>>) -> bool {
    let dash = std::path::Path::new("-");
    files.into_iter().all(|file| file.as_deref() != Some(dash))
}

#[cfg(feature = "full")]
/// Prints to standard error what the user should know though the work goes on.
fn warn(text: &str) {
    eprintln!("warning: {text}");
}

//! The `hil` command: rig tests, tracing and prediction of the metal mesh damper.
#![forbid(unsafe_code)]
// What a person reads goes through `mesh_damper_output::terminal`.
#![warn(clippy::print_stderr, clippy::print_stdout)]
#![cfg_attr(
    not(feature = "full"),
    allow(
        dead_code,
        reason = "some of what is shared is for the commands of `full` alone"
    )
)]

mod commands;
#[cfg(unix)]
mod signals;

use std::io::ErrorKind;
use std::process::ExitCode;

use mesh_damper_output::ending;
use mesh_damper_output::terminal::{tell, unwritten};

/// A search constantly allocates and frees columns as long as the recording. The system's allocator returns their pages to the
/// system each time, which costs an eighth of a trace.
#[cfg(feature = "full")]
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|fault| {
        let fault = fault.to_string().replace('\n', ": ");
        tell(&format!(
            "error: internal error in hil, please report it: {fault}"
        ));
    }));
    #[cfg(unix)]
    signals::listen();
    let code = match commands::Cli::of_arguments() {
        Ok(command) => done(command),
        Err(usage) => printed(&usage),
    };
    // If a signal has come, what it ends breaks off here too, and that is no result.
    drop(ending::whole());
    code
}

fn done(command: commands::Cli) -> ExitCode {
    match command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            tell(&format!("error: {failure}"));
            failure.exit_code()
        }
    }
}

/// Prints a help, the version, or an error of usage.
fn printed(usage: &clap::Error) -> ExitCode {
    match usage.print() {
        Err(error) if !usage.use_stderr() && error.kind() != ErrorKind::BrokenPipe => {
            tell(&format!("error: {}", unwritten(&error)));
            ExitCode::from(2)
        }
        _ if usage.use_stderr() => ExitCode::from(2),
        _ => ExitCode::SUCCESS,
    }
}

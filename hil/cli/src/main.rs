//! The `hil` command: rig tests, tracing and prediction of the metal mesh damper.
#![forbid(unsafe_code)]
#![cfg_attr(
    not(feature = "full"),
    allow(
        dead_code,
        reason = "some of what is shared is for the commands of `full` alone"
    )
)]

mod commands;

use std::process::ExitCode;

use clap::Parser as _;

/// A search constantly allocates and frees columns as long as the recording. The system's allocator returns their pages to the
/// system each time, which costs an eighth of a trace.
#[cfg(feature = "full")]
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|fault| {
        eprintln!(
            "error: internal error in hil, please report it: {}",
            fault.to_string().replace('\n', ": ")
        );
    }));
    match commands::Cli::parse().run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            failure.exit_code()
        }
    }
}

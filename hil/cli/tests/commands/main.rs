//! The real command.

mod bad_input;
mod command;
mod demo_command;
#[cfg(feature = "full")]
mod full;
mod inspect_command;
mod predict;
mod refusal;
mod respond_command;
#[cfg(target_os = "linux")]
mod signals;
#[cfg(target_os = "linux")]
mod terminal;
mod trace_command;

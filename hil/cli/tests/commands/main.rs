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
mod trace_command;

//! The commands of the feature `full`.

mod amplitude_free_command;
mod bad_arguments;
mod bad_input_of_studies;
mod batch_command;
mod bench_command;
mod board_command;
#[cfg(unix)]
mod book;
#[path = "../../../../live/tests/live/broker.rs"]
mod broker;
#[path = "../../../../live/tests/live/common.rs"]
mod common;
mod controlled;
#[path = "../../../../link/tests/emulated/mod.rs"]
mod emulated;
mod ended_by_signals;
mod export_command;
mod export_fmu;
mod hostile_names;
mod image_command;
mod interrupted_run;
mod junit_command;
mod live_command;
mod no_room;
mod outputs;
mod paper_command;
mod policy_option;
mod quotes;
mod read_limit;
mod readme;
mod reference;
mod run_command;
mod schema_command;
mod separating;
mod shells;
mod surfaces_command;
mod trace_memory;
mod validator;

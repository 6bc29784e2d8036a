//! The option of every command that reads files: how much of them.

use clap::Args;
use mesh_damper_recording::read_limit::ReadLimit;

/// How much of each file is read.
#[derive(Args, Clone, Copy, Debug)]
pub struct Reading {
    /// Most bytes read of each file, unpacked; of a line, of all comments or of a JSON file a 64th
    #[arg(long = "max-read", value_name = "SIZE", default_value_t)]
    pub limit: ReadLimit,
}

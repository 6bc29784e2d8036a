//! The results of a benchmark run, for display and as JSON.

use serde::Serialize;

use super::count::{Core, Count};
use super::judge::LargestError;
use super::limits::Verdict;

/// Everything that was counted, compared with limits and measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Results {
    /// The tools with which the counts were made.
    pub tools: Tools,
    /// Instruction counts.
    pub counts: Vec<Count>,
    /// Errors of results against f64.
    pub errors: Vec<LargestError>,
    /// Sizes, bytes.
    pub sizes: Vec<Size>,
    /// Rates by this machine's clock, which differ from run to run.
    pub rates: Vec<Rate>,
    /// The limits, and whether they are met.
    pub limits: Vec<Verdict>,
    /// Values that could not be measured, and how to measure them.
    pub left_out: Vec<String>,
}

/// The tools on which the counts depend in addition to the code.
#[derive(Clone, Debug, Default, PartialEq, Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Tools {
    /// The Rust compiler of the images.
    pub rustc: String,
    /// The C compiler of the peer, with its options; null if there is none.
    pub c: Option<String>,
    /// The emulator.
    pub emulator: String,
}

/// The size of an item in bytes.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Size {
    /// The item.
    pub name: String,
    /// The kind of memory.
    pub of: &'static str,
    /// Number of bytes.
    pub bytes: u64,
}

/// The rate of an operation.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rate {
    /// The operation.
    pub name: &'static str,
    /// Operations per second.
    pub per_second: f64,
    /// The rate over the 10,000 ticks per second of the rig.
    pub times_real_time: f64,
}

impl Results {
    /// The count on `core` under `name`, for the calls of one `moment`.
    pub fn count(&self, core: Core, name: &str, moment: &str) -> Option<&Count> {
        let mut counts = self.counts.iter();
        counts.find(|count| count.core == core && count.name == name && count.moment == moment)
    }

    /// The largest error of the result `of` of `name`.
    pub fn error(&self, name: &str, of: &str) -> Option<f64> {
        let mut errors = self.errors.iter();
        errors
            .find(|error| error.name == name && error.of == of)
            .map(|error| error.error)
    }

    /// The bytes of `name`.
    pub fn size(&self, name: &str, of: &str) -> Option<u64> {
        let mut sizes = self.sizes.iter();
        sizes
            .find(|size| size.name == name && size.of == of)
            .map(|size| size.bytes)
    }
}

//! What a run of the benchmark came to, as it is shown and as JSON.

use serde::Serialize;

use super::count::{Core, Count};
use super::judge::LargestError;
use super::limits::Verdict;

/// Everything that was counted, judged and measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Results {
    /// With what.
    pub tools: Tools,
    /// Instructions.
    pub counts: Vec<Count>,
    /// Errors against f64.
    pub errors: Vec<LargestError>,
    /// Bytes.
    pub sizes: Vec<Size>,
    /// On this machine's clock: no two runs give the same.
    pub rates: Vec<Rate>,
    /// What is asked for, and whether it holds.
    pub limits: Vec<Verdict>,
    /// What could not be measured, and how to have it measured.
    pub left_out: Vec<String>,
}

/// What the counts depend on beside the code.
#[derive(Clone, Debug, Default, PartialEq, Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Tools {
    /// The compiler of the images.
    pub rustc: String,
    /// That of the peer in C, with its options.
    pub c: Option<String>,
    /// The emulator.
    pub emulator: String,
}

/// Bytes that something takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Size {
    /// What takes them.
    pub name: String,
    /// Of which memory.
    pub of: &'static str,
    /// How many.
    pub bytes: u64,
}

/// How often something is done in a second.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rate {
    /// What.
    pub name: &'static str,
    /// How many in a second.
    pub per_second: f64,
    /// Over the 10,000 ticks a second of the rig.
    pub times_real_time: f64,
}

impl Results {
    /// What was counted on `core` under `name`, for the calls of one `moment`.
    pub fn count(&self, core: Core, name: &str, moment: &str) -> Option<&Count> {
        let mut counts = self.counts.iter();
        counts.find(|count| count.core == core && count.name == name && count.moment == moment)
    }

    /// The largest error of `name`'s results `of`.
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

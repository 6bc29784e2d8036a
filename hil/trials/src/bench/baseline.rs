//! The baseline of counts that a run is compared to.

use std::path::{Path, PathBuf};

use mesh_damper_output::error::InputError;
use mesh_damper_rig::check::{Check, failures};
use mesh_damper_sources::Sources;
use mesh_damper_tables::read_limit::{ReadLimit, read_json};
use serde::{Deserialize, Serialize};

use super::count::{Core, Count};
use super::results::{Results, Tools};

/// In the repository.
const PATH: &str = "hil/trials/bench-baseline.json";

/// A count may exceed the baseline's by this fraction.
const GATE: f64 = 0.05;

/// The results of an accepted run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    /// The format: `mesh-damper bench-baseline`.
    #[serde(default = "format")]
    format: String,
    /// The version of the format, 1.
    #[serde(default = "version")]
    version: u32,
    /// The tools with which the counts were made.
    pub tools: Tools,
    /// The crate's counts, without the counts of its peers.
    pub counts: Vec<Entry>,
}

/// The word that marks the file; a file from before this field counts as one too.
fn format() -> String {
    "mesh-damper bench-baseline".into()
}

fn version() -> u32 {
    1
}

/// One count of the baseline, in instructions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// The core.
    pub core: Core,
    /// The function that was called.
    pub name: String,
    /// The kind of call.
    pub moment: String,
    /// Mean of the calls, instructions.
    pub mean: f64,
    /// The longest call, instructions.
    pub most: u64,
}

/// Names of peers end like this.
const PEERS: [&str; 4] = ["/libm", "/micromath", "/naive", "/c"];

fn is_own(count: &Count) -> bool {
    !PEERS.iter().any(|peer| count.name.ends_with(peer))
}

impl Baseline {
    /// Its path among the sources.
    ///
    /// # Errors
    /// The sources cannot be unpacked.
    pub fn path() -> Result<PathBuf, InputError> {
        Ok(Sources::find()?.root().join(PATH))
    }

    /// Its path in the repository, where it may be written.
    ///
    /// # Errors
    /// An installed command has no repository.
    pub fn path_in_repository() -> Result<PathBuf, InputError> {
        let sources = Sources::find()?;
        if !sources.is_repository() {
            return Err(InputError::new(
                "--bless",
                "an installed hil has no repository whose baseline it could write",
                "run `cargo hil bench --bless` in the repository",
            ));
        }
        Ok(sources.root().join(PATH))
    }

    /// The baseline of `results`, for later runs.
    pub fn of(results: &Results) -> Self {
        let own = results.counts.iter().filter(|count| is_own(count));
        Self {
            format: format(),
            version: version(),
            tools: results.tools.clone(),
            counts: own
                .map(|count| Entry {
                    core: count.core,
                    name: count.name.clone(),
                    moment: count.moment.clone(),
                    // As many digits as distinguish them.
                    mean: (100.0 * count.mean).round() / 100.0,
                    most: count.most,
                })
                .collect(),
        }
    }

    /// # Errors
    /// The file cannot be read, is beyond the default [`ReadLimit`], or is no baseline.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::read_within(path, ReadLimit::default())
    }

    /// [`Baseline::read`] of a file within another limit.
    ///
    /// # Errors
    /// As [`Baseline::read`].
    pub fn read_within(path: &Path, limit: ReadLimit) -> Result<Self, InputError> {
        let bytes = read_json(path, limit)?;
        serde_json::from_slice(&bytes).map_err(|error| {
            let remedy = "replace it with --bless";
            InputError::new(path.display().to_string(), error.to_string(), remedy)
        })
    }

    /// The [`Baseline::checks`] that `results` fails, one per line.
    pub fn failures(&self, results: &Results) -> Vec<String> {
        failures(self.checks(results))
    }

    /// No count of `results` is more than 5 % above this, and both have the same counts.
    pub fn checks(&self, results: &Results) -> Vec<Check> {
        // If this machine has no compiler for a core, that core is left out completely, with a message.
        let is_counted =
            |entry: &&Entry| results.counts.iter().any(|count| count.core == entry.core);
        let known = self.counts.iter().filter(is_counted);
        let is_new = |count: &&Count| {
            is_own(count)
                && !self.counts.iter().any(|entry| {
                    (entry.core, &entry.name, &entry.moment)
                        == (count.core, &count.name, &count.moment)
                })
        };
        let new = results.counts.iter().filter(is_new).map(|count| {
            let name = name_of(&count.name, &count.moment, count.core);
            let failure = format!("{name} is not in the baseline: --bless it");
            Check::new(name, false, || failure)
        });
        known
            .flat_map(|entry| entry.checks(results))
            .chain(new)
            .collect()
    }
}

fn name_of(name: &str, moment: &str, core: Core) -> String {
    format!("{name} {moment} on a {}", core.name())
}

impl Entry {
    /// `results` still contains this count, and it is at most 5 % larger.
    fn checks(&self, results: &Results) -> Vec<Check> {
        let name = name_of(&self.name, &self.moment, self.core);
        let Some(now) = results.count(self.core, &self.name, &self.moment) else {
            let failure = format!("{name} is no longer counted: --bless it away");
            return vec![Check::new(name, false, || failure)];
        };
        let figures = [
            ("mean", self.mean, now.mean),
            ("most", self.most as f64, now.most as f64),
        ];
        let each = figures.map(|(what, was, is)| {
            let holds = is <= was * (1.0 + GATE);
            Check::new(format!("{name}, {what}"), holds, || {
                format!(
                    "{name}: {what} {is:.1} instructions, {:.1} % above the baseline's {was:.1}",
                    100.0 * (is / was - 1.0)
                )
            })
        });
        each.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn results(counts: &[(&str, f64, u64)]) -> Results {
        let counts = counts.iter().map(|&(name, mean, most)| Count {
            core: Core::CortexM4f,
            name: name.into(),
            moment: "call".into(),
            calls: 1,
            mean,
            least: 0,
            most,
            checksum: 0,
        });
        Results {
            counts: counts.collect(),
            ..Results::default()
        }
    }

    #[test]
    fn five_percent_pass_and_more_does_not() {
        let baseline = Baseline::of(&results(&[("a", 100.0, 200), ("b/libm", 10.0, 10)]));
        assert!(baseline.failures(&results(&[("a", 105.0, 210)])).is_empty());
        assert!(
            baseline
                .failures(&results(&[("a", 50.0, 60), ("c/libm", 1e9, 1)]))
                .is_empty()
        );
        for (mean, most) in [(105.1, 200), (100.0, 211)] {
            let failures = baseline.failures(&results(&[("a", mean, most)]));
            assert_eq!(failures.len(), 1, "{failures:?}");
        }
    }

    #[test]
    fn what_one_lacks_is_said() {
        let baseline = Baseline::of(&results(&[("a", 100.0, 200)]));
        let failures = baseline.failures(&results(&[("b", 1.0, 1)]));
        assert_eq!(failures.len(), 2, "{failures:?}");
    }
}

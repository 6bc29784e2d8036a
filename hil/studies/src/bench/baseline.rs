//! The counts as they were, which a run is held against.

use std::path::{Path, PathBuf};

use mesh_damper_recording::error::InputError;
use mesh_damper_recording::read_limit::{ReadLimit, read_json};
use serde::{Deserialize, Serialize};

use super::count::{Core, Count};
use super::results::{Results, Tools};

/// By how much of itself a count may exceed the baseline's.
const GATE: f64 = 0.05;

/// What a run came to that was good.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    /// With what it was counted.
    pub tools: Tools,
    /// The crate's counts; its peers' are none of its business.
    pub counts: Vec<Entry>,
}

/// One count of the baseline, in instructions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// On what.
    pub core: Core,
    /// What was called.
    pub name: String,
    /// Which of its calls.
    pub moment: String,
    /// Mean.
    pub mean: f64,
    /// Of the longest call.
    pub most: u64,
}

/// Names that end so are peers.
const PEERS: [&str; 4] = ["/libm", "/micromath", "/naive", "/c"];

fn is_own(count: &Count) -> bool {
    !PEERS.iter().any(|peer| count.name.ends_with(peer))
}

impl Baseline {
    /// Where it is kept in the repository.
    pub fn path() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("bench-baseline.json")
    }

    /// What `results` would be held against from now on.
    pub fn of(results: &Results) -> Self {
        let own = results.counts.iter().filter(|count| is_own(count));
        Self {
            tools: results.tools.clone(),
            counts: own
                .map(|count| Entry {
                    core: count.core,
                    name: count.name.clone(),
                    moment: count.moment.clone(),
                    // As many digits as tell them apart.
                    mean: (100.0 * count.mean).round() / 100.0,
                    most: count.most,
                })
                .collect(),
        }
    }

    /// # Errors
    /// A file that cannot be read, that is beyond the default [`ReadLimit`], or that is no baseline.
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
            let mend = "write it anew with --bless";
            InputError::new(path.display().to_string(), error.to_string(), mend)
        })
    }

    /// The counts of `results` that are more than 5 % above this, and those of either that the other lacks, a line each.
    pub fn failures(&self, results: &Results) -> Vec<String> {
        let mut failures = Vec::new();
        for entry in &self.counts {
            let Entry {
                core,
                name,
                moment,
                mean,
                most,
            } = entry;
            // A core that this machine has no compiler for is left out as a whole, and said so.
            if !results.counts.iter().any(|count| count.core == *core) {
                continue;
            }
            let Some(now) = results.count(*core, name, moment) else {
                failures.push(format!(
                    "{name} {moment} on a {} is no longer counted: --bless it away",
                    core.name()
                ));
                continue;
            };
            let figures = [
                ("mean", *mean, now.mean),
                ("most", *most as f64, now.most as f64),
            ];
            for (what, was, is) in figures {
                if is > was * (1.0 + GATE) {
                    failures.push(format!(
                        "{name} {moment} on a {}: {what} {is:.1} instructions, {:.1} % above the baseline's {was:.1}",
                        core.name(),
                        100.0 * (is / was - 1.0)
                    ));
                }
            }
        }
        let is_new = |count: &&Count| {
            is_own(count)
                && !self.counts.iter().any(|entry| {
                    (entry.core, &entry.name, &entry.moment)
                        == (count.core, &count.name, &count.moment)
                })
        };
        failures.extend(results.counts.iter().filter(is_new).map(|count| {
            let Count { name, moment, .. } = count;
            let core = count.core.name();
            format!("{name} {moment} on a {core} is not in the baseline: --bless it")
        }));
        failures
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

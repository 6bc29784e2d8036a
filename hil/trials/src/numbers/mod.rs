//! The importance of each tuned number: the blind trial with the number halved and doubled.
//!
//! The list of numbers comes from the policies themselves, so that none can be missing.

mod cost;
mod table;

use mesh_damper_identify::policy as identify;
use mesh_damper_recording::numbers::{AlreadyInUse, Field, Mark};
use mesh_damper_recording::policy as recording;
use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use cost::{Cost, Costs, Score};
pub use table::table;

/// All policy numbers, crate by crate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Policies {
    /// Numbers for reading a recording.
    pub recording: recording::Policy,
    /// Numbers for a fit and a trace.
    pub identify: identify::Policy,
}

impl Policies {
    /// Puts them into use for the whole process, before any work.
    ///
    /// # Errors
    /// A number was read before.
    pub fn install(self) -> Result<(), AlreadyInUse> {
        self.recording.install()?;
        self.identify.install()
    }
}

/// One number.
#[derive(Clone, Debug)]
pub struct Number {
    /// Its path, as in a file of [`Policies`]: `identify.select.beam`.
    pub path: String,
    /// Its meaning and its source.
    pub field: Field,
    /// Its default.
    pub default: Value,
}

/// All numbers in order.
pub fn numbers() -> Vec<Number> {
    let defaults = defaults();
    let crates = [
        ("recording", recording::Policy::PARTS),
        ("identify", identify::Policy::PARTS),
    ];
    let mut numbers = Vec::new();
    for (of, parts) in crates {
        for (part, fields) in parts {
            numbers.extend(fields.iter().map(|&field| Number {
                path: format!("{of}.{part}.{}", field.name),
                field,
                default: defaults[of][part][field.name].clone(),
            }));
        }
    }
    numbers
}

fn defaults() -> Value {
    serde_json::to_value(Policies::default()).unwrap_or_default()
}

impl Number {
    /// Whether the study varies it.
    pub fn is_tuned(&self) -> bool {
        self.field.mark == Mark::Tuned
    }

    /// The policies with this number, or each of several, multiplied by `factor`; `None` if that changes nothing. Counts are whole
    /// and at least 1; a value of at most 1 stays so, because it is a fraction or a probability.
    pub fn varied(&self, factor: f64) -> Option<Policies> {
        let varied = scaled(&self.default, factor)?;
        if varied == self.default {
            return None;
        }
        let mut policies = defaults();
        let pointer = format!("/{}", self.path.replace('.', "/"));
        *policies.pointer_mut(&pointer)? = varied;
        serde_json::from_value(policies).ok()
    }
}

fn scaled(value: &Value, factor: f64) -> Option<Value> {
    match value {
        Value::Array(values) => {
            let scaled: Option<Vec<Value>> = values.iter().map(|v| scaled(v, factor)).collect();
            scaled.map(Value::Array)
        }
        Value::Number(number) if number.is_f64() => {
            let value = number.as_f64()?;
            let most = if value <= 1.0 { 1.0 } else { f64::INFINITY };
            Some(Value::from((factor * value).min(most)))
        }
        Value::Number(number) => {
            let count = (factor * number.as_f64()?).round().max(1.0);
            Some(Value::from(count as u64))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::*;

    fn number(path: &str) -> Number {
        let mut all = numbers().into_iter();
        all.find(|number| number.path == path).unwrap()
    }

    #[test]
    fn every_number_of_a_policy_is_listed_with_its_default_and_a_reason() {
        let numbers = numbers();
        for number in &numbers {
            assert!(!number.default.is_null(), "{}", number.path);
            assert!(!number.field.about.is_empty() && !number.field.reason.is_empty());
        }
        let parts = |value: Value| value.as_object().unwrap().clone();
        let fields = parts(defaults())
            .into_values()
            .flat_map(|policy| parts(policy).into_values());
        let count: usize = fields.map(|part| parts(part).len()).sum();
        assert_eq!(numbers.len(), count);
    }

    /// A block of these crates that is in no list decides, and can be neither changed nor printed.
    #[test]
    fn every_block_of_numbers_is_listed() {
        fn blocks(folder: &Path) -> usize {
            let entries = std::fs::read_dir(folder)
                .unwrap()
                .map(|entry| entry.unwrap().path());
            let of = |path: PathBuf| match path.is_dir() {
                true => blocks(&path),
                false => {
                    let text = std::fs::read_to_string(path).unwrap();
                    text.lines()
                        .filter(|line| line.ends_with("::numbers! {") && !line.starts_with('/'))
                        .count()
                }
            };
            entries.map(of).sum()
        }
        let hil = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        assert_eq!(
            blocks(&hil.join("recording/src")),
            recording::Policy::PARTS.len()
        );
        assert_eq!(
            blocks(&hil.join("identify/src")),
            identify::Policy::PARTS.len()
        );
    }

    #[test]
    fn a_number_is_halved_and_doubled_within_what_it_can_be() {
        let beam = number("identify.select.beam");
        assert_eq!(beam.varied(0.5).unwrap().identify.select.beam, 2);
        assert_eq!(beam.varied(2.0).unwrap().identify.select.beam, 6);
        let better = number("identify.adopt.better");
        let halved = better.varied(0.5).unwrap().identify.adopt.better;
        let doubled = better.varied(2.0).unwrap().identify.adopt.better;
        assert_eq!([halved, doubled], [0.475, 1.0]);
        let around = number("recording.spikes.times_around");
        let around = around.varied(2.0).unwrap().recording.spikes.times_around;
        assert_eq!(around, [16.0, 6.0]);
        // Everything else stays unchanged.
        let mut policies = beam.varied(2.0).unwrap();
        policies.identify.select.beam = 3;
        assert_eq!(policies, Policies::default());
    }

    #[test]
    fn a_list_of_kinds_is_not_halved() {
        assert!(number("identify.memory.kinds").varied(0.5).is_none());
    }
}

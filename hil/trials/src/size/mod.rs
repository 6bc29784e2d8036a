//! The cost of a trace: processor time and memory over the number of rows.
//!
//! Recordings are simulated with any number of rows, with blocks of sines and with a random motion. A separate process traces each,
//! so that the system counts its time and memory.

mod process;
mod simulate;

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;

use mesh_damper_output::error::InputError;
use serde::{Deserialize, Serialize};

pub use process::{Usage, usage_of};
pub use simulate::{Motion, simulate};

/// Memory limit of a trace: bytes for each row, in addition to [`BYTES_BESIDE`]. Convention: a gigabyte of free memory is enough
/// for two million rows, and the rest is for the command itself.
pub const BYTES_PER_ROW: u64 = 400;
/// Memory limit of a trace independent of the rows, bytes.
pub const BYTES_BESIDE: u64 = 64 << 20;
/// Time limit of a trace, as a fraction of the recording's duration, on two free cores. Convention: a day's tests are traced within
/// the hour.
pub const PART_OF_DURATION: f64 = 0.05;
/// A trace of at most this duration is quick enough however short the recording is, s. Convention: the user does not turn away.
pub const QUICK: f64 = 2.0;

/// The cost of tracing one recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Measured {
    /// The motion of the specimen.
    pub motion: Motion,
    /// Rows of the recording.
    pub rows: usize,
    /// Duration of the test, s.
    pub duration: f64,
    /// Processor time on all cores, s.
    pub processor: f64,
    /// Elapsed time from start to end, s.
    pub elapsed: f64,
    /// Peak memory, bytes.
    pub memory: u64,
}

impl Measured {
    /// Its memory limit, bytes.
    pub fn memory_limit(&self) -> u64 {
        memory_limit(self.rows)
    }

    /// Its time limit from start to end on two free cores, s.
    pub fn time_limit(&self) -> f64 {
        (PART_OF_DURATION * self.duration).max(QUICK)
    }

    /// Whether it is within both limits.
    pub fn is_within_limits(&self) -> bool {
        self.memory <= self.memory_limit() && self.elapsed <= self.time_limit()
    }
}

/// The memory limit for a trace of `rows` rows, bytes.
pub fn memory_limit(rows: usize) -> u64 {
    BYTES_PER_ROW * rows as u64 + BYTES_BESIDE
}

/// Traces a simulated test of `motion` with `rows` rows with `hil`, the command itself, in `folder`. The recording stays there.
///
/// # Errors
/// The folder cannot be written to, the command cannot start or fails, or the system does not count memory.
pub fn measure(
    hil: impl AsRef<OsStr>,
    folder: &Path,
    motion: Motion,
    rows: usize,
) -> Result<Measured, InputError> {
    let path = folder.join(format!("{}-{rows}.csv", motion.name()));
    let recording = simulate(motion, rows);
    std::fs::write(&path, recording.to_file(&path)?)
        .map_err(|error| InputError::io(&path, "write", &error))?;
    let [first, .., last] = recording.time[..] else {
        return Err(InputError::new(
            recording.name,
            "holds no samples",
            "take more rows",
        ));
    };
    let rows = recording.len();
    drop(recording);
    let mut command = Command::new(hil);
    let out = folder.join(format!("{}-{rows}", motion.name()));
    command.arg("trace").arg(&path).arg("--out").arg(out);
    let Usage {
        processor,
        elapsed,
        memory,
    } = usage_of(&mut command)?;
    Ok(Measured {
        motion,
        rows,
        duration: last - first,
        processor,
        elapsed,
        memory,
    })
}

/// As a table in Markdown.
pub fn table(all: &[Measured]) -> String {
    let mut text = "| motion | rows | lasts, s | processor, s | elapsed, s | limit, s | memory, MiB | limit, MiB |\n\
                    |---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for one in all {
        text += &format!(
            "| {} | {} | {:.0} | {:.1} | {:.1} | {:.1} | {:.0} | {:.0} |\n",
            one.motion.in_words(),
            one.rows,
            one.duration,
            one.processor,
            one.elapsed,
            one.time_limit(),
            mebibytes(one.memory),
            mebibytes(one.memory_limit()),
        );
    }
    text
}

/// In MiB.
pub fn mebibytes(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_limit_counts() {
        let measured = |memory: u64, elapsed: f64, duration: f64| Measured {
            motion: Motion::Sines,
            rows: 1000,
            duration,
            processor: 0.0,
            elapsed,
            memory,
        };
        let most = 400_000 + (64 << 20);
        assert!(measured(most, 1.9, 1.0).is_within_limits());
        assert!(!measured(most + 1, 1.9, 1.0).is_within_limits());
        assert!(!measured(most, 2.1, 1.0).is_within_limits());
        assert!(measured(most, 4.9, 100.0).is_within_limits());
        assert!(!measured(most, 5.1, 100.0).is_within_limits());
    }
}

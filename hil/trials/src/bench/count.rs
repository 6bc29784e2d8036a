//! Runs a counting image, and reads its output.

use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use mesh_damper_link::image::Board;
use mesh_damper_output::error::InputError;
use mesh_damper_output::process::Process;
use serde::{Deserialize, Serialize};

/// Time limit for an image. Images take seconds; one that takes this long hangs.
const LONGEST: Duration = Duration::from_secs(180);

/// A core whose instructions are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Core {
    /// Cortex-M4F, with a single-precision floating-point unit.
    #[serde(rename = "cortex-m4f")]
    CortexM4f,
    /// Cortex-M0, without a floating-point unit.
    #[serde(rename = "cortex-m0")]
    CortexM0,
}

impl Core {
    /// The board that it is emulated on.
    pub fn board(self) -> Board {
        match self {
            Self::CortexM4f => Board::Mps2An386,
            Self::CortexM0 => Board::Microbit,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::CortexM4f => "Cortex-M4F",
            Self::CortexM0 => "Cortex-M0",
        }
    }
}

/// The counts of a group of calls, in instructions.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Count {
    /// The core.
    pub core: Core,
    /// The function that was called.
    pub name: String,
    /// The kind of call. Calls with different work are counted separately.
    pub moment: String,
    /// The number of calls.
    pub calls: u64,
    /// Mean of the calls, instructions.
    pub mean: f64,
    /// The shortest call, instructions.
    pub least: u64,
    /// The longest call, instructions.
    pub most: u64,
    /// Checksum of the results of the calls.
    #[serde(skip)]
    pub checksum: u32,
}

/// The output of an image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Said {
    /// Line by line.
    pub counts: Vec<Count>,
    /// Further results, each list under a name.
    pub results: Vec<(String, Vec<f32>)>,
}

/// Runs `elf` on the board of `core` to its end.
///
/// # Errors
/// There is no emulator, the image fails or does not end, or a line is invalid.
pub fn count(elf: &Path, core: Core) -> Result<Said, InputError> {
    run_to_end(elf, core)?
        .lines()
        .try_fold(Said::default(), |said, line| read_line(said, core, line))
        .map_err(|line| failed(elf, format!("said what is no count: {line}")))
}

fn failed(elf: &Path, problem: String) -> InputError {
    let remedy = "run it in the emulator by hand to see more";
    InputError::new(elf.display().to_string(), problem, remedy)
}

/// Runs `elf` on the board of `core` to its end, and returns its output.
///
/// # Errors
/// There is no emulator, or the image fails or does not end.
pub fn run_to_end(elf: &Path, core: Core) -> Result<String, InputError> {
    let failed = |problem: String| failed(elf, problem);
    let mut command = core.board().emulator(elf)?;
    command
        // An instruction takes 2^10 ns of the emulator's time; time passes only that way.
        .args(["-icount", "shift=10,sleep=off"])
        .args(["-chardev", "stdio,id=said"])
        .args([
            "-semihosting-config",
            "enable=on,target=native,chardev=said",
        ])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut emulator = Process::start(&mut command)
        .map_err(|error| failed(format!("the emulator does not start: {error}")))?;
    let mut readers = [
        emulator.stdout.take().map(reader),
        emulator.stderr.take().map(reader),
    ];
    let started = Instant::now();
    let status = loop {
        match emulator.try_wait() {
            Ok(Some(status)) => break Some(status),
            Ok(None) if started.elapsed() < LONGEST => {
                std::thread::sleep(Duration::from_millis(10));
            }
            Ok(None) | Err(_) => {
                emulator.end();
                break None;
            }
        }
    };
    let [said, complaint] = readers.each_mut().map(|reader| {
        reader
            .take()
            .and_then(|thread| thread.join().ok())
            .unwrap_or_default()
    });
    match status {
        Some(status) if status.success() => Ok(said),
        Some(_) => {
            let last = said.lines().chain(complaint.lines()).last();
            Err(failed(format!(
                "failed: {}",
                last.unwrap_or("without a word")
            )))
        }
        None => Err(failed(format!(
            "did not end within {} s",
            LONGEST.as_secs()
        ))),
    }
}

/// Reads everything, so that neither stream fills up while the other is read.
fn reader(mut stream: impl std::io::Read + Send + 'static) -> std::thread::JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // The output before an error is all there is.
        let _ = stream.read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// `name moment calls instructions least most checksum`, or `= name bits…` with results of f32.
fn read_line(mut said: Said, core: Core, line: &str) -> Result<Said, String> {
    let parsed = || {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["=", name, ref bits @ ..] => {
                let values = bits
                    .iter()
                    .map(|bits| Some(f32::from_bits(u32::from_str_radix(bits, 16).ok()?)));
                said.results
                    .push((name.to_owned(), values.collect::<Option<_>>()?));
            }
            [name, moment, calls, sum, least, most, checksum] => {
                let calls: u64 = calls.parse().ok()?;
                let sum: u64 = sum.parse().ok()?;
                said.counts.push(Count {
                    core,
                    name: name.to_owned(),
                    moment: moment.to_owned(),
                    calls,
                    mean: sum as f64 / calls.max(1) as f64,
                    least: least.parse().ok()?,
                    most: most.parse().ok()?,
                    checksum: u32::from_str_radix(checksum, 16).ok()?,
                });
            }
            _ => return None,
        }
        Some(said)
    };
    parsed().ok_or_else(|| line.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_counts_and_results_and_refuses_the_rest() {
        let said = ["a/b call 4 10 2 3 0000000f", "= c 3f800000 40000000"]
            .into_iter()
            .try_fold(Said::default(), |said, line| {
                read_line(said, Core::CortexM0, line)
            })
            .unwrap();
        let [count] = &said.counts[..] else { panic!() };
        assert_eq!((count.name.as_str(), count.mean), ("a/b", 2.5));
        assert_eq!((count.least, count.most, count.checksum), (2, 3, 15));
        assert_eq!(said.results, [("c".to_owned(), vec![1.0, 2.0])]);
        for bad in ["", "panicked at src/x.rs", "a call 4 10 2 3 xyz", "= c 1.0"] {
            assert!(
                read_line(Said::default(), Core::CortexM0, bad).is_err(),
                "{bad}"
            );
        }
    }
}

//! The time and memory of a process.

use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use mesh_damper_output::error::InputError;
use mesh_damper_output::process::Process;

/// The time and memory of a process.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Usage {
    /// Processor time on all cores, s.
    pub processor: f64,
    /// From start to end, s.
    pub elapsed: f64,
    /// Peak memory, bytes.
    pub memory: u64,
}

/// Interval of the checks of a process. Convention: a check misses only its last moments, a hundredth of a second at most.
const PAUSE: Duration = Duration::from_millis(5);
/// Ticks per second of Linux's processor time. Derived: the `USER_HZ` of all machines that Rust's standard library supports.
const TICKS: f64 = 100.0;

/// Runs a command to its end, and checks its time and memory. The system keeps the peak memory of a process, so only its last
/// moments can be missed.
///
/// # Errors
/// The command cannot start or fails, with its last line; or the system has no `/proc`, which is any except Linux.
pub fn usage_of(command: &mut Command) -> Result<Usage, InputError> {
    let program = PathBuf::from(command.get_program());
    let failed = |error: std::io::Error| InputError::io(&program, "run", &error);
    let start = Instant::now();
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let mut child = Process::start(command).map_err(failed)?;
    let mut usage = Usage::default();
    let status = loop {
        if let Some(status) = child.try_wait().map_err(failed)? {
            break status;
        }
        if let Some((processor, memory)) = so_far(child.id()) {
            usage = Usage {
                processor,
                memory,
                ..usage
            };
        }
        std::thread::sleep(PAUSE);
    };
    usage.elapsed = start.elapsed().as_secs_f64();
    let name = || program.display().to_string();
    if !status.success() {
        let words: Vec<_> = command
            .get_args()
            .map(|word| word.to_string_lossy())
            .collect();
        return Err(InputError::new(
            name(),
            format!("failed, {status}, with {}", words.join(" ")),
            "run it alone",
        ));
    }
    if usage.memory == 0 {
        return Err(InputError::new(
            name(),
            "was not seen at work in /proc",
            "measure on Linux, and something that takes longer",
        ));
    }
    Ok(usage)
}

/// Processor time in s and peak memory in bytes of a running process; `None` if it has ended.
fn so_far(process: u32) -> Option<(f64, u64)> {
    let read = |file: &str| std::fs::read_to_string(format!("/proc/{process}/{file}")).ok();
    let status = read("status")?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    let stat = read("stat")?;
    // The second field is the program's name in parentheses, with any characters; user and system time are the 14th and 15th.
    let (_, fields) = stat.rsplit_once(')')?;
    let mut fields = fields.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some(((ticks()? + ticks()?) / TICKS, 1024 * kibibytes))
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    fn shell(script: &str) -> Result<Usage, InputError> {
        usage_of(Command::new("sh").args(["-c", script]))
    }

    /// A shell that holds a text of 40 MB takes that much more than one without, and one that counts takes time.
    #[test]
    fn memory_and_time_are_those_of_the_process() {
        let hold = |bytes: u32| {
            let script = format!(
                "x=$(head -c {bytes} /dev/zero | tr '\\0' x); y=0; while [ $y -lt 300000 ]; do y=$((y+1)); done"
            );
            shell(&script).unwrap()
        };
        let (small, large) = (hold(1), hold(40_000_000));
        let more = large.memory - small.memory;
        assert!((38_000_000..300_000_000).contains(&more), "{more} bytes");
        assert!(small.processor > 0.02 && small.processor < 2.0 * small.elapsed);
    }

    #[test]
    fn a_command_that_fails_is_said() {
        let error = shell("exit 3").unwrap_err().to_string();
        assert!(
            error.contains("failed") && error.contains("exit 3"),
            "{error}"
        );
    }
}

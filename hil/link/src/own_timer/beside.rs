//! An emulated board on its own timer, with actuator, sensors and specimen simulated next to the emulator.
//!
//! The board's time follows the instructions that it executes, at 16 ns each. At each tick it asks for the sensors' codes, and its
//! time stands still until it has them. The codes are held back while the board is ahead of real time. A busy host thus makes the
//! board slow, but no tick late. `firmware/src/emulated/beside.rs` documents the bytes.

use std::io::{BufRead as _, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use mesh_damper_output::error::InputError;
use mesh_damper_output::process::Process;
use mesh_damper_rig::Plant;
use mesh_damper_rig::actuator::{adc_code, dac_volts};
use mesh_damper_rig::specimen::DamperForce;

use crate::image::{Board, OWN_TIMER, build};

/// An instruction takes 2^4 ns, as at 62.5 MHz.
const TIME: &str = "shift=4,sleep=off";
/// Counts of the board's clock per second, as in `firmware/src/emulated/clock.rs`.
const CLOCK: f64 = 25e6;
/// Time by which the board may be ahead, s: a sleep takes some 0.1 ms more than requested.
const AHEAD: f64 = 2e-3;

/// The board, which runs until this is dropped.
#[derive(Debug)]
pub struct EmulatedBoard {
    process: Process,
    port: PathBuf,
    specimen: Option<JoinHandle<()>>,
    seen: Arc<Seen>,
}

/// State of the board as the simulated side knows it.
#[derive(Debug, Default)]
struct Seen {
    ticks: AtomicU64,
    enabled: AtomicBool,
}

impl EmulatedBoard {
    /// Builds the image if it is not up to date, and starts it with `plant`, at `speed` times real time. `arguments` are for the
    /// emulator.
    ///
    /// # Errors
    /// A compiler's target or an emulator that is not installed, or the error of one of them.
    pub fn start<S: DamperForce + Clone + Send + 'static>(
        plant: Plant<S>,
        speed: f64,
        arguments: &[&str],
    ) -> Result<Self, InputError> {
        let board = Board::Mps2An386;
        board.check()?;
        let elf = build(&OWN_TIMER, board)?;
        Self::start_image(&elf, plant, speed, arguments)
    }

    fn start_image<S: DamperForce + Clone + Send + 'static>(
        elf: &Path,
        plant: Plant<S>,
        speed: f64,
        arguments: &[&str],
    ) -> Result<Self, InputError> {
        let failed = |problem: String| {
            let remedy = "check that qemu-system-arm runs by itself";
            InputError::new("the emulator", problem, remedy)
        };
        let mut command = Board::Mps2An386.emulator_with("pty", elf)?;
        command
            .args(["-icount", TIME])
            .args(["-semihosting-config", "enable=on,target=native"])
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut process = Process::start(&mut command)
            .map_err(|error| failed(format!("does not start: {error}")))?;
        let (Some(delivered), Some(driven)) = (process.stdin.take(), process.stdout.take()) else {
            unreachable!("both are piped");
        };
        let mut driven = BufReader::new(driven);
        // Its output is: char device redirected to /dev/pts/1 (label serial0).
        let mut said = String::new();
        let named = driven.read_line(&mut said);
        let port = said.split_whitespace().find(|word| word.starts_with('/'));
        let (Ok(_), Some(port)) = (named, port) else {
            return Err(failed(format!("names no pseudo-terminal: {}", said.trim())));
        };
        let port = PathBuf::from(port);
        let seen = Arc::new(Seen::default());
        let beside = Beside::new(plant, speed, seen.clone());
        let specimen = std::thread::spawn(move || beside.answer(driven, delivered));
        Ok(Self {
            process,
            port,
            specimen: Some(specimen),
            seen,
        })
    }

    /// The pseudo-terminal that serves as the board's serial port.
    pub fn port(&self) -> &Path {
        &self.port
    }

    /// Number of the board's ticks so far, those without a rig included. They continue without requests.
    pub fn ticks(&self) -> u64 {
        self.seen.ticks.load(Relaxed)
    }

    /// Level of the enable line at its last tick.
    pub fn is_enabled(&self) -> bool {
        self.seen.enabled.load(Relaxed)
    }

    /// The emulator's process number.
    pub fn id(&self) -> u32 {
        self.process.id()
    }

    /// Waits until the emulator ends.
    ///
    /// # Errors
    /// An error of the system.
    pub fn wait(&mut self) -> std::io::Result<()> {
        self.process.wait().map(|_| ())
    }
}

impl Drop for EmulatedBoard {
    fn drop(&mut self) {
        self.process.end();
        if let Some(specimen) = self.specimen.take() {
            // It ends when the emulator closes the pipes.
            let _ = specimen.join();
        }
    }
}

/// The simulated side.
struct Beside<S> {
    plant: Plant<S>,
    /// Sensor values until the enable line rises for the first time; nothing moves until then.
    first: Vec<u8>,
    begun: bool,
    counts: Counts,
    /// Steps by which the plant is behind the board's clock: one at each tick of a rig at the plant's own rate.
    behind: f64,
    pace: Pace,
    seen: Arc<Seen>,
}

/// Counts of the board's clock.
#[derive(Default)]
struct Counts {
    last: Option<u32>,
}

impl Counts {
    /// Counts from the last reading to `count`. A tick takes a second at most; a longer time means a board that has restarted and
    /// counts from 0 again.
    fn passed(&mut self, count: u32) -> u32 {
        let passed = count.wrapping_sub(self.last.replace(count).unwrap_or(count));
        if f64::from(passed) > CLOCK { 0 } else { passed }
    }
}

/// Slows the board down to real time.
struct Pace {
    /// Seconds of real time per count of the board's clock.
    per_count: f64,
    /// Real time at which the last reading of the board's clock was due.
    due: Instant,
}

impl Pace {
    /// Waits until `passed` counts of the board's clock may have elapsed.
    fn wait(&mut self, passed: u32) {
        self.due += Duration::from_secs_f64(f64::from(passed) * self.per_count);
        let now = Instant::now();
        match self.due.checked_duration_since(now) {
            Some(ahead) if ahead.as_secs_f64() > AHEAD => std::thread::sleep(ahead),
            Some(_) => {}
            // The delay of a busy host is not made up for.
            None => self.due = now,
        }
    }
}

impl<S: DamperForce + Clone> Beside<S> {
    fn new(mut plant: Plant<S>, speed: f64, seen: Arc<Seen>) -> Self {
        let first = delivered(&mut plant);
        Self {
            plant,
            first,
            begun: false,
            counts: Counts::default(),
            behind: 0.0,
            pace: Pace {
                per_count: 1.0 / (CLOCK * speed),
                due: Instant::now(),
            },
            seen,
        }
    }

    /// Sensor values at a tick, after the actuator has had `code` and this level of its enable line since the last tick. `passed`
    /// counts of the board's clock have elapsed since then.
    fn next(&mut self, code: u16, enabled: bool, passed: u32) -> Vec<u8> {
        if self.begun {
            self.behind += f64::from(passed) / (CLOCK * self.plant.step());
            while self.behind > 0.5 {
                self.behind -= 1.0;
                self.plant.drive(dac_volts(code), enabled);
            }
            return delivered(&mut self.plant);
        }
        // The line rises between two ticks, and has had no tick of its own yet.
        self.begun = enabled;
        self.first.clone()
    }

    /// Answers the image until the emulator ends.
    fn answer(mut self, mut driven: impl Read, mut delivered: impl Write) {
        let mut asked = [0; 8];
        while driven.read_exact(&mut asked).is_ok() {
            let [low, high, enabled, _, clock @ ..] = asked;
            let passed = self.counts.passed(u32::from_le_bytes(clock));
            self.pace.wait(passed);
            self.seen.enabled.store(enabled != 0, Relaxed);
            self.seen.ticks.fetch_add(1, Relaxed);
            let next = self.next(u16::from_le_bytes([low, high]), enabled != 0, passed);
            if delivered.write_all(&next).is_err() {
                return;
            }
        }
    }
}

fn delivered<S: DamperForce + Clone>(plant: &mut Plant<S>) -> Vec<u8> {
    let (displacement, force) = plant.sense();
    let mut bytes = Vec::new();
    for volts in [displacement, force] {
        bytes.extend(adc_code(volts).to_le_bytes());
    }
    bytes.extend(plant.shown_temperature().to_le_bytes());
    for control in plant.shown_controls() {
        bytes.extend(control.to_le_bytes());
    }
    bytes.push(plant.tripped.into());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_that_restarts_has_not_slept_through_the_clocks_wrap() {
        let mut counts = Counts::default();
        let passed = [7, 2507, 3_000_000_000, 3_000_002_500, 0, 2500].map(|at| counts.passed(at));
        assert_eq!(passed, [0, 2500, 0, 2500, 0, 2500]);
        // A wrap of the clock is no restart.
        let mut counts = Counts::default();
        assert_eq!([u32::MAX - 99, 2400].map(|at| counts.passed(at)), [0, 2500]);
    }
}

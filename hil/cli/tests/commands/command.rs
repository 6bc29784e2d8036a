//! The real command.

use std::fs;
use std::path::Path;
use std::process::Command;
#[cfg(unix)]
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

/// No step takes nearly this long.
const LONGEST: Duration = Duration::from_secs(120);

/// The arguments in a line.
pub fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

/// The output of the command with these arguments in `directory`; the command must succeed.
#[track_caller]
pub fn hil(directory: &Path, arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_hil"))
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

/// `script` in a `shell` of its own, in `directory`, with the command as `$HIL`.
#[cfg(unix)]
pub fn shell(shell: &str, directory: &Path, script: &str) -> Output {
    Command::new(shell)
        .args(["-c", script])
        .env("HIL", env!("CARGO_BIN_EXE_hil"))
        .current_dir(directory)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

/// Waits for `seen` to return a value, and returns it.
pub fn wait_for<T>(what: &str, mut seen: impl FnMut() -> Option<T>) -> T {
    let until = Instant::now() + LONGEST;
    loop {
        if let Some(seen) = seen() {
            return seen;
        }
        assert!(Instant::now() < until, "{what}");
        std::thread::yield_now();
    }
}

/// A recording of eq 13 with a constant force; it is different for each `number`.
pub fn record(path: &Path, number: usize) {
    let mut rows = String::from("time_s,displacement_mm,force_kN\n");
    let (mut phase, mut state) = (0.0_f64, 12_345 + number as u64);
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
    };
    for sample in 0..1500 {
        let frequency = [1.0, 4.0, 2.0][sample / 500] + 0.01 * number as f64;
        let omega = std::f64::consts::TAU * frequency;
        let amplitude = [0.1, 0.2, 0.15][sample / 500];
        phase += omega / 250.0;
        let (y, v) = (amplitude * phase.sin(), amplitude * omega * phase.cos());
        let law = y + 8.0 * y.powi(3) + 0.1 * v.abs().powf(0.3) * v.signum();
        let force = law + 0.08 + 1.4e-3 * noise();
        rows.push_str(&format!("{},{y},{force}\n", sample as f64 / 250.0));
    }
    fs::write(path, rows).unwrap();
}

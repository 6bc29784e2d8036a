//! Checks whether this machine can run images. Shared by the tests that do.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Once;

use mesh_damper_link::image::{Board, Image, build};
use mesh_damper_link::lockstep::{Emulator, LogDecoder};
use mesh_damper_output::error::InputError;
use serde_json::Value;

/// `image` built for `board`, or `None` with a message that says which test was left out and how to get the missing part. With `CI`
/// set to `true` nothing may be left out: the test fails.
#[allow(
    dead_code,
    reason = "not every test that shares this file runs an image"
)]
pub fn image(image: &Image, board: Board) -> Option<PathBuf> {
    match board.check() {
        Ok(()) => Some(build(image, board).unwrap()),
        Err(error) => {
            leave_out(&error);
            None
        }
    }
}

/// The firmware in `examples/NAME`, which runs on `board`; the result is that of [`image`]. It is built in the same place as by the
/// gate.
#[allow(
    dead_code,
    reason = "not every test that shares this file runs an example"
)]
pub fn example(name: &str, board: Board) -> Option<PathBuf> {
    if let Err(error) = board.check() {
        leave_out(&error);
        return None;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let directory = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    let output = Command::new(env!("CARGO"))
        // Cargo takes its configuration, and the linker the memory map, from this directory.
        .current_dir(root.join("examples").join(name))
        .args(["build", "--quiet", "--locked", "--release"])
        .args(["--message-format", "json-render-diagnostics"])
        .arg("--target-dir")
        .arg(root.join(directory))
        // These variables would replace the linker's script.
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("RUSTFLAGS")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "examples/{name}: {said}");
    output
        .stdout
        .split(|&byte| byte == b'\n')
        .filter_map(|line| serde_json::from_slice::<Value>(line).ok())
        .find_map(|message| Some(PathBuf::from(message.get("executable")?.as_str()?)))
}

fn leave_out(error: &InputError) {
    assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{error}");
    // Once for all tests, bypassing their harness, which hides the output of passing tests.
    static SAID: Once = Once::new();
    SAID.call_once(|| {
        let said = writeln!(std::io::stderr(), "left out, no image is run: {error}");
        said.unwrap();
    });
}

/// The emulator with `elf` on `board`, without its log.
#[allow(
    dead_code,
    reason = "not every test that shares this file runs the firmware"
)]
pub fn start(elf: &Path, board: Board) -> Emulator {
    let bytes = std::fs::read(elf).unwrap();
    let log = LogDecoder::new(&bytes, Box::new(|_| {})).unwrap();
    Emulator::start(elf, board, log).unwrap()
}

/// Whether a process with this number is running.
#[cfg(target_os = "linux")]
#[allow(
    dead_code,
    reason = "not every test that shares this file ends an emulator"
)]
pub fn lives(id: u32) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{id}/status"));
    status.is_ok_and(|status| !status.contains("State:\tZ"))
}

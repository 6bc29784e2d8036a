//! Whether this machine can run images. Shared by the tests that do.

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Once;

use mesh_damper_link::image::{Board, Image, build};
use mesh_damper_link::lockstep::{Emulator, LogDecoder};
use mesh_damper_recording::error::InputError;

/// `image` built for `board`, or `None` with a line that says what was left out and how to get it. Where `CI` is `true`
/// nothing may be left out: it fails.
pub fn image(image: &Image, board: Board) -> Option<PathBuf> {
    match board.check() {
        Ok(()) => Some(build(image, board).unwrap()),
        Err(error) => {
            leave_out(&error);
            None
        }
    }
}

fn leave_out(error: &InputError) {
    assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{error}");
    // Once for all tests, and past their harness, which keeps what passing tests print to itself.
    static SAID: Once = Once::new();
    SAID.call_once(|| {
        let said = writeln!(std::io::stderr(), "left out, no image is run: {error}");
        said.unwrap();
    });
}

/// The emulator with `elf` on `board`, its log thrown away.
#[allow(
    dead_code,
    reason = "not every test that shares this file runs the firmware"
)]
pub fn start(elf: &std::path::Path, board: Board) -> Emulator {
    let bytes = std::fs::read(elf).unwrap();
    let log = LogDecoder::new(&bytes, Box::new(|_| {})).unwrap();
    Emulator::start(elf, board, log).unwrap()
}

/// Whether there is a process with this number that has not ended.
#[cfg(target_os = "linux")]
#[allow(
    dead_code,
    reason = "not every test that shares this file ends an emulator"
)]
pub fn lives(id: u32) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{id}/status"));
    status.is_ok_and(|status| !status.contains("State:\tZ"))
}

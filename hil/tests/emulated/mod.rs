//! Whether this machine can run images. Shared by the tests that do.

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Once;

use hil::error::InputError;
use hil::image::{Board, Image, build};
use hil::link::image::{Emulator, LogDecoder};

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

//! The firmware's image in the emulator.

mod emulated;

use hil::image::{Board, Image, sections};

const FIRMWARE: Image = Image {
    binary: "firmware",
    features: &["firmware"],
};

/// What is certified: kiB of flash, and of RAM with the law's tables.
#[test]
fn the_image_is_small() {
    for board in [Board::Mps2An386, Board::NetduinoPlus2] {
        let Some(elf) = emulated::image(&FIRMWARE, board) else {
            return;
        };
        let sizes = sections(&elf).unwrap();
        assert!(sizes.flash > 0 && sizes.flash <= 24 * 1024, "{sizes:?}");
        assert!(sizes.ram <= 12 * 1024, "{sizes:?}");
    }
}

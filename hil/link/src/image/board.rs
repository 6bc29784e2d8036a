//! The emulator and the boards that it supports.

use std::path::{Path, PathBuf};
use std::process::Command;

use mesh_damper_output::error::InputError;

use super::build::check_target;

/// A board that QEMU emulates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Board {
    /// Arm MPS2+ with AN386, a Cortex-M4F.
    Mps2An386,
    /// Arm MPS2+ with AN500, a Cortex-M7; runs the image of [`Board::Mps2An386`].
    Mps2An500,
    /// Netduino Plus 2 with an STM32F405, a Cortex-M4F.
    NetduinoPlus2,
    /// BBC micro:bit with an nRF51822, a Cortex-M0.
    Microbit,
}

impl Board {
    /// Every board.
    pub const ALL: [Self; 4] = [
        Self::Mps2An386,
        Self::Mps2An500,
        Self::NetduinoPlus2,
        Self::Microbit,
    ];

    /// Whether its memory can be shared with the harness.
    pub fn shares_memory(self) -> bool {
        match self {
            Self::Mps2An386 | Self::Mps2An500 => true,
            Self::NetduinoPlus2 | Self::Microbit => false,
        }
    }

    /// Its name in QEMU.
    pub fn machine(self) -> &'static str {
        match self {
            Self::Mps2An386 => "mps2-an386",
            Self::Mps2An500 => "mps2-an500",
            Self::NetduinoPlus2 => "netduinoplus2",
            Self::Microbit => "microbit",
        }
    }

    /// The compiler's target.
    pub fn target(self) -> &'static str {
        match self {
            Self::Mps2An386 | Self::Mps2An500 | Self::NetduinoPlus2 => "thumbv7em-none-eabihf",
            Self::Microbit => "thumbv6m-none-eabi",
        }
    }

    /// Folder of its package in `firmware/`.
    pub fn folder(self) -> &'static str {
        match self {
            Self::Mps2An386 | Self::Mps2An500 => "mps2-an386",
            Self::NetduinoPlus2 => "stm32f405",
            Self::Microbit => "microbit",
        }
    }

    /// Whether an image can be built for it and run.
    ///
    /// # Errors
    /// The compiler's target or the emulator is not installed.
    pub fn check(self) -> Result<(), InputError> {
        check_target(self.target())?;
        find_emulator().map(|_| ())
    }

    /// The emulator with this board and `elf` in its flash: no display, no monitor, no serial line. Add the arguments that the
    /// image needs.
    ///
    /// # Errors
    /// No emulator.
    pub fn emulator(self, elf: &Path) -> Result<Command, InputError> {
        self.emulator_with("none", elf)
    }

    /// The same with a first serial line connected to the emulator's `serial`: `pty` is a pseudo-terminal, which it names on its
    /// standard output.
    ///
    /// # Errors
    /// No emulator.
    pub fn emulator_with(self, serial: &str, elf: &Path) -> Result<Command, InputError> {
        let mut command = Command::new(find_emulator()?);
        command.args(["-machine", self.machine()]);
        if self == Self::Microbit {
            // The larger variant of its processor: the emulator's default has 16 KiB.
            command.args(["-global", "nrf51-soc.sram-size=32768"]);
        }
        command
            .args(["-display", "none", "-monitor", "none", "-serial", serial])
            .args(["-nic", "none"])
            .arg("-kernel")
            .arg(elf);
        Ok(command)
    }
}

const EMULATOR: &str = "qemu-system-arm";

/// The emulator in the search path.
fn find_emulator() -> Result<PathBuf, InputError> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path)
        .map(|directory| directory.join(EMULATOR))
        .find(|candidate| candidate.is_file())
        .ok_or_else(|| {
            InputError::new(
                "the emulator",
                format!("{EMULATOR} is not installed"),
                format!("apt-get install {EMULATOR} (or your system's package of it)"),
            )
        })
}

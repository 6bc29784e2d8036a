//! Builds an image by cargo, from the repository or from the sources that an installed command contains.

use std::path::{Path, PathBuf};
use std::process::Command;

use mesh_damper_output::error::InputError;
use mesh_damper_output::process;
use mesh_damper_sources::Sources;
use serde_json::Value;

use super::Board;

/// An image: a binary of the boards' packages in `firmware/`.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// Name of the binary.
    pub binary: &'static str,
    /// Feature of the board's package that selects it.
    pub feature: &'static str,
    /// Flag that the compiler sets for conditional compilation.
    pub cfg: Option<&'static str>,
}

/// The rig controller.
pub const FIRMWARE: Image = Image {
    binary: "firmware",
    feature: "rig",
    cfg: None,
};

/// The rig controller whose link is the board's serial port.
pub const SERIAL: Image = Image {
    binary: "serial",
    ..FIRMWARE
};

/// The rig controller on the board's own timer, with a specimen simulated next to the emulator.
pub const OWN_TIMER: Image = Image {
    binary: "own-timer",
    feature: "own-timer",
    cfg: None,
};

/// Builds `image` for `board` with profile `firmware` and returns its ELF file. Does nothing if nothing has changed.
///
/// # Errors
/// A target that is not installed, sources that cannot be unpacked, or an error of the compiler.
pub fn build(image: &Image, board: Board) -> Result<PathBuf, InputError> {
    let target = board.target();
    check_target(target)?;
    let sources = Sources::find()?;
    let root = sources.root();
    let flags = image
        .cfg
        .map_or_else(String::new, |cfg| format!("--cfg {cfg}"));
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build
        .current_dir(root.join("firmware").join(board.folder()))
        .args(["build", "--quiet", "--profile", "firmware"])
        // Unpacked sources contain only a part of the repository's packages, while the lock file names all; cargo removes the
        // others from it.
        .args(sources.is_repository().then_some("--locked"))
        .args(["--bin", image.binary])
        .args(["--features", image.feature])
        .args([
            "--target",
            target,
            "--message-format",
            "json-render-diagnostics",
        ])
        // A separate directory for each board, because the binary has the same name for all.
        .arg("--target-dir")
        .arg(target_directory(root).join(board.folder()))
        // What the boards have in common is built once.
        .env(
            "CARGO_BUILD_BUILD_DIR",
            target_directory(root).join("images"),
        )
        // A target-cpu in these variables would change the images' rounding, and link arguments their layout.
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env("RUSTFLAGS", flags);
    let failed = |problem: String| {
        let remedy = if sources.is_repository() {
            "build it by hand, as docs/firmware.md says, to see more".to_owned()
        } else {
            format!(
                "check that cargo can reach its registry, or remove {} and try again",
                root.display()
            )
        };
        InputError::new(format!("the image {}", image.binary), problem, remedy)
    };
    let output = process::output(&mut build)
        .map_err(|error| failed(format!("cargo does not start: {error}")))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        return Err(failed(format!("cargo cannot build it: {}", text.trim())));
    }
    output
        .stdout
        .split(|&byte| byte == b'\n')
        .filter_map(|line| serde_json::from_slice::<Value>(line).ok())
        .find_map(|message| Some(PathBuf::from(message.get("executable")?.as_str()?)))
        .ok_or_else(|| failed("cargo names no file that it built".into()))
}

/// Cargo's target directory.
fn target_directory(root: &Path) -> PathBuf {
    let directory = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    root.join(directory)
}

/// Checks that the core library for `target` is installed.
pub(super) fn check_target(target: &str) -> Result<(), InputError> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let mut asked = Command::new(rustc);
    asked.args(["--target", target, "--print", "target-libdir"]);
    match process::output(&mut asked) {
        Ok(output) if Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir() => Ok(()),
        _ => Err(InputError::new(
            "the compiler",
            format!("the target {target} is not installed"),
            format!("rustup target add {target}"),
        )),
    }
}

//! Has cargo build an image from the workspace that this harness was built from.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use mesh_damper_recording::error::InputError;
use serde_json::Value;

use super::Board;

/// An image: a binary of the crate.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// Name of the binary.
    pub binary: &'static str,
    /// Features of the crate that it needs; the board's own is added.
    pub features: &'static [&'static str],
}

/// The rig controller.
pub const FIRMWARE: Image = Image {
    binary: "firmware",
    features: &["firmware"],
};

/// Builds `image` for `board` with profile `firmware` and gives its ELF file. Does nothing where nothing has changed.
///
/// # Errors
/// A target that is not installed, or what the compiler says.
pub fn build(image: &Image, board: Board) -> Result<PathBuf, InputError> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let target = board.target();
    check_target(target)?;
    let features: Vec<&str> = image
        .features
        .iter()
        .copied()
        .chain(board.feature())
        .collect();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .current_dir(&root)
        .args(["build", "--quiet", "--locked", "--profile", "firmware"])
        .args(["--package", "mesh-damper", "--bin", image.binary])
        .args(["--features", &features.join(",")])
        .args([
            "--target",
            target,
            "--message-format",
            "json-render-diagnostics",
        ])
        // Of its own for each memory map: the binary's name is the same for all, and one would take another's place.
        .arg("--target-dir")
        .arg(target_directory(&root, board))
        // A target-cpu in them would change the images' rounding, and link arguments their layout.
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .stdin(Stdio::null())
        .output();
    let failed = |problem: String| {
        let mend = "build it by hand, as docs/firmware.md says, to see more";
        InputError::new(format!("the image {}", image.binary), problem, mend)
    };
    let output = output.map_err(|error| failed(format!("cargo does not start: {error}")))?;
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

/// Where cargo puts what it builds for `board`.
fn target_directory(root: &Path, board: Board) -> PathBuf {
    let directory = match std::env::var_os("CARGO_TARGET_DIR") {
        Some(directory) => PathBuf::from(directory),
        None => root.join("target"),
    };
    match board.feature() {
        Some(feature) => directory.join(feature),
        None => directory,
    }
}

/// Whether the core library for `target` is there.
pub(super) fn check_target(target: &str) -> Result<(), InputError> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let libraries = Command::new(rustc)
        .args(["--target", target, "--print", "target-libdir"])
        .output();
    match libraries {
        Ok(output) if Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir() => Ok(()),
        _ => Err(InputError::new(
            "the compiler",
            format!("the target {target} is not installed"),
            format!("rustup target add {target}"),
        )),
    }
}

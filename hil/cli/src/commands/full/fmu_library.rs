//! The library inside an FMU, built from the sources that this program contains.

use std::path::PathBuf;
use std::process::Command;

use mesh_damper_export::fmu;
use mesh_damper_output::error::InputError;
use mesh_damper_output::process;
use mesh_damper_sources::Sources;

use super::image::say_where;
use crate::commands::progress::Progress;

/// The folders with the library for this platform. If the library is not next to this program, cargo builds it.
///
/// # Errors
/// Sources that cannot be unpacked, or the errors of cargo.
pub fn folders() -> Result<Vec<PathBuf>, InputError> {
    let beside = fmu::beside_this_program();
    let name = fmu::file_name();
    if beside.iter().any(|folder| folder.join(&name).is_file()) {
        return Ok(beside);
    }
    Ok(vec![built(&name)?])
}

fn built(name: &str) -> Result<PathBuf, InputError> {
    let sources = Sources::find()?;
    say_where(&sources, "the FMU's library", "target/release");
    let progress = Progress::of(1);
    progress.step("building the FMU's library");
    let failed = |problem: String| {
        InputError::new(
            name,
            problem,
            format!(
                "check that cargo can reach its registry; or build it in the repository with `cargo build --release -p mesh-damper-fmu`, \
                 and give --library target/release/{name}"
            ),
        )
    };
    let target = sources.root().join("target");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build
        .current_dir(sources.root())
        .args([
            "build",
            "--quiet",
            "--release",
            "--package",
            "mesh-damper-fmu",
            "--target-dir",
        ])
        .arg(&target)
        // As for the images: the lock file names more packages than the unpacked sources contain.
        .args(sources.is_repository().then_some("--locked"));
    let output = process::output(&mut build)
        .map_err(|error| failed(format!("cargo does not start: {error}")))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        return Err(failed(format!("cargo cannot build it: {}", text.trim())));
    }
    Ok(target.join("release"))
}

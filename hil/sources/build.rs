//! Packs the files that images and the FMU's library are built of: `sources.rs` lists them by name, with what they hold.
//!
//! They are those of the repository around this folder; in a package, which has no repository around it, those in `packed/`, whose names
//! end in `.packed` there, because a package leaves out every folder that has a manifest.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Files and folders of the repository.
const PACKED: [&str; 20] = [
    ".cargo/config.toml",
    "Cargo.lock",
    "Cargo.toml",
    "bindings/fmu/Cargo.toml",
    "bindings/fmu/src",
    "firmware",
    "hil/model/Cargo.toml",
    "hil/model/src",
    "hil/output/Cargo.toml",
    "hil/output/src",
    "hil/recording/Cargo.toml",
    "hil/recording/src",
    "hil/tables/Cargo.toml",
    "hil/tables/src",
    "hil/trials/bench",
    "hil/trials/bench-baseline.json",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "memory.x",
    "src",
];

/// Ends the names in `packed/`.
const MARK: &str = ".packed";

fn main() -> io::Result<()> {
    let variable = |name| PathBuf::from(std::env::var_os(name).unwrap_or_default());
    let here = variable("CARGO_MANIFEST_DIR");
    let packed = here.join("packed");
    let mut files = Vec::new();
    // A path that does not exist would make Cargo run this at every call.
    if packed.is_dir() {
        println!("cargo::rerun-if-changed={}", packed.display());
        collect(&packed, &packed, &mut files)?;
    } else {
        let root = here.join("../..").canonicalize()?;
        for name in PACKED {
            println!("cargo::rerun-if-changed={}", root.join(name).display());
            collect(&root, &root.join(name), &mut files)?;
        }
    }
    files.sort();
    let mut table = "/// Names from the repository's folder on, and contents.\npub(crate) const FILES: &[(&str, &[u8])] = &[\n".to_owned();
    // FNV-1a, of 64 bits: it tells versions apart, and guards against nothing.
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for (name, path) in files {
        for byte in name.bytes().chain(fs::read(&path)?) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        // Writing to a string does not fail.
        let _ = writeln!(
            table,
            "    ({name:?}, include_bytes!({:?})),",
            path.display().to_string()
        );
    }
    let _ = writeln!(
        table,
        "];\n/// Tells these files from those of another version.\npub(crate) const DIGEST: &str = \"{hash:016x}\";"
    );
    fs::write(variable("OUT_DIR").join("sources.rs"), table)
}

/// Adds the files at `path` by their names from `root` on, with slashes.
fn collect(root: &Path, path: &Path, files: &mut Vec<(String, PathBuf)>) -> io::Result<()> {
    // What cargo builds in a board's folder is no source.
    if path.file_name().is_some_and(|name| name == "target") {
        return Ok(());
    }
    if path.is_dir() {
        for entry in fs::read_dir(path)? {
            collect(root, &entry?.path(), files)?;
        }
    } else if let Ok(name) = path.strip_prefix(root) {
        let parts = name.iter().map(|part| part.to_string_lossy());
        let name = parts.collect::<Vec<_>>().join("/");
        files.push((name.trim_end_matches(MARK).to_owned(), path.to_owned()));
    }
    Ok(())
}

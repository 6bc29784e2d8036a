//! The sources that images and the FMU's library are built of.
//!
//! A command that lies in its repository builds of the repository. One that was installed holds the sources itself, and unpacks them into
//! the user's cache where something is to be built: it needs no repository, and no path of the machine that it was built on.
//!
//! ```no_run
//! let sources = mesh_damper_sources::Sources::find()?;
//! println!("images are built in {}", sources.root().join("firmware").display());
//! # Ok::<(), mesh_damper_output::error::InputError>(())
//! ```
#![forbid(unsafe_code)]

mod cache;
mod manifest;

use std::path::{Path, PathBuf};

use mesh_damper_output::error::InputError;

include!(concat!(env!("OUT_DIR"), "/sources.rs"));

/// Files that only a repository has side by side.
const MARKS: [&str; 2] = ["hil/cli/Cargo.toml", "firmware/mps2-an386/Cargo.toml"];

/// A folder with the sources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sources {
    root: PathBuf,
    is_repository: bool,
}

impl Sources {
    /// The repository that this program lies in, or that cargo runs it in; else the sources that it holds, which are unpacked where they
    /// are not yet.
    ///
    /// # Errors
    /// A cache that cannot be found or written to.
    pub fn find() -> Result<Self, InputError> {
        match repository() {
            Some(root) => Ok(Self {
                root,
                is_repository: true,
            }),
            None => Ok(Self {
                root: cache::unpacked(&cache::folder()?, FILES, DIGEST)?,
                is_repository: false,
            }),
        }
    }

    /// The folder, laid out as the repository is.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Whether it is the repository, which may be written to.
    pub fn is_repository(&self) -> bool {
        self.is_repository
    }
}

/// The repository that this program lies in, or that cargo runs it in.
fn repository() -> Option<PathBuf> {
    let program = std::env::current_exe().ok();
    // Of `cargo run` and `cargo test`, while they run: target folders may lie elsewhere.
    let package = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    [program, package]
        .into_iter()
        .flatten()
        .find_map(|path| repository_around(&path))
}

fn repository_around(path: &Path) -> Option<PathBuf> {
    let is_repository = |folder: &&Path| MARKS.iter().all(|mark| folder.join(mark).is_file());
    path.ancestors().find(is_repository).map(Path::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_finds_its_repository() {
        let sources = Sources::find().unwrap();
        assert!(sources.is_repository());
        assert!(sources.root().join("memory.x").is_file());
    }

    #[test]
    fn a_program_elsewhere_finds_none() {
        let root = tempfile::tempdir().unwrap();
        let program = root.path().join("bin/hil");
        assert_eq!(repository_around(&program), None);
        // A project of someone else, with a firmware of its own.
        std::fs::create_dir_all(root.path().join("firmware/mps2-an386")).unwrap();
        std::fs::write(root.path().join(MARKS[1]), "").unwrap();
        assert_eq!(repository_around(&program), None);
    }

    /// What an image is built of is among them, and nothing that was built.
    #[test]
    fn the_sources_are_whole() {
        for name in [
            "Cargo.toml",
            "Cargo.lock",
            ".cargo/config.toml",
            "memory.x",
            "src/lib.rs",
            "firmware/mps2-an386/src/firmware.rs",
            "firmware/microbit/Cargo.lock",
            "bindings/fmu/src/lib.rs",
            "hil/output/src/lib.rs",
            "hil/tables/src/lib.rs",
            "hil/trials/bench/peer.c",
        ] {
            assert!(FILES.iter().any(|(file, _)| *file == name), "{name}");
        }
        let mut names = FILES.iter().flat_map(|(file, _)| file.split('/'));
        assert!(names.all(|part| part != "target"));
    }
}

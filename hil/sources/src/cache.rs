//! Sources in the user's cache.

use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use mesh_damper_output::error::InputError;
use mesh_damper_output::scratch::Scratch;

use super::manifest::trimmed;

/// Where the sources of all versions are.
///
/// # Errors
/// No folder of the user's.
pub fn folder() -> Result<PathBuf, InputError> {
    folder_of(|name| std::env::var_os(name)).ok_or_else(|| {
        InputError::new(
            "the cache",
            "neither XDG_CACHE_HOME nor HOME names a folder",
            "set XDG_CACHE_HOME to a folder of yours",
        )
    })
}

/// By the variables of the environment: an absolute folder, as that of XDG has to be.
fn folder_of(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let set = |name| {
        let path = PathBuf::from(variable(name)?);
        path.is_absolute().then_some(path)
    };
    let cache = set("XDG_CACHE_HOME")
        .or_else(|| set("LOCALAPPDATA"))
        .or_else(|| Some(set("HOME")?.join(".cache")));
    Some(cache?.join("mesh-damper"))
}

/// The folder in `cache` with `files`, of a version that is known by `digest`; it takes its name only when it is whole.
///
/// # Errors
/// A folder that cannot be written to.
pub fn unpacked(
    cache: &Path,
    files: &[(&str, &[u8])],
    digest: &str,
) -> Result<PathBuf, InputError> {
    let folder = cache.join(format!("sources-{digest}"));
    if folder.is_dir() {
        return Ok(folder);
    }
    write(cache, files, &folder).map_err(|error| {
        let mut refused = InputError::io(&folder, "write", &error);
        refused.remedy += ", or set XDG_CACHE_HOME to another folder";
        refused
    })?;
    Ok(folder)
}

fn write(cache: &Path, files: &[(&str, &[u8])], folder: &Path) -> io::Result<()> {
    fs::create_dir_all(cache)?;
    let whole = Scratch::within(cache)?;
    for (name, bytes) in files {
        let path = whole.path().join(name);
        fs::create_dir_all(path.parent().unwrap_or(cache))?;
        if name.ends_with("Cargo.toml") {
            fs::write(&path, trimmed(&String::from_utf8_lossy(bytes)))?;
        } else {
            fs::write(&path, bytes)?;
        }
    }
    match fs::rename(whole.path(), folder) {
        Ok(()) => Ok(()),
        // Another command was faster.
        Err(_) if folder.is_dir() => Ok(()),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_environment_says_where() {
        let of = |set: &'static [(&str, &str)]| {
            folder_of(|name| {
                let (_, value) = set.iter().find(|(each, _)| *each == name)?;
                Some(value.into())
            })
        };
        let at = |path: &str| Some(PathBuf::from(path));
        assert_eq!(
            of(&[("XDG_CACHE_HOME", "/c"), ("HOME", "/h")]),
            at("/c/mesh-damper")
        );
        // No folder by the rule of XDG, and left out by it.
        assert_eq!(
            of(&[("XDG_CACHE_HOME", "c"), ("HOME", "/h")]),
            at("/h/.cache/mesh-damper")
        );
        assert_eq!(of(&[]), None);
    }

    #[test]
    fn files_are_written_once() {
        let cache = tempfile::tempdir().unwrap();
        let files: [(&str, &[u8]); 2] = [
            ("a/Cargo.toml", b"[package]\n[dev-dependencies]\nb = 1\n"),
            ("a/src/lib.rs", b"//! A.\n"),
        ];
        let folder = unpacked(cache.path(), &files, "0").unwrap();
        let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
        assert_eq!(read("a/Cargo.toml"), "[package]\n");
        assert_eq!(read("a/src/lib.rs"), "//! A.\n");
        fs::write(folder.join("a/src/lib.rs"), "").unwrap();
        assert_eq!(unpacked(cache.path(), &files, "0").unwrap(), folder);
        assert_eq!(read("a/src/lib.rs"), "");
        // Nothing half-written is left beside it.
        assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_cache_that_takes_nothing_is_named() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("file");
        fs::write(&file, "").unwrap();
        let error = unpacked(&file, &[], "0").unwrap_err().to_string();
        assert!(error.contains("sources-0"), "{error}");
        assert!(error.contains("XDG_CACHE_HOME"), "{error}");
    }
}

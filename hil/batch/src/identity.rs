//! The identity of a trace: from the contents of its recordings and its settings, independent of file names.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;
use mesh_damper_output::error::InputError;
use mesh_damper_tables::read_limit::ReadLimit;
use sha2::{Digest as _, Sha256};

use crate::list::Task;

/// First bytes of a gzipped file.
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// The SHA-256 of a recording's contents.
pub(crate) type Content = [u8; 32];

/// The contents of each recording of a task: the fitted ones, then the held-out ones.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn contents(task: &Task, limit: ReadLimit) -> Result<Vec<Content>, InputError> {
    task.paths().map(|path| content(path, limit)).collect()
}

/// The identity of a trace, in hexadecimal digits. It does not depend on the order of the recordings.
pub(crate) fn identity(task: &Task, contents: &[Content], decisive: &str) -> String {
    let (fitted, held_out) = contents.split_at(task.recordings.len().min(contents.len()));
    let mut hash = Sha256::new();
    hash.update(decisive);
    for (role, contents) in [("fit", fitted), ("held_out", held_out)] {
        let mut contents = contents.to_vec();
        contents.sort_unstable();
        for content in contents {
            hash.update(role);
            hash.update(content);
        }
    }
    // Enough digits to distinguish a million traces except once in 10²⁶.
    hex(&hash.finalize()[..16])
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The hash of a file; for a gzipped file, that of its contents. The part beyond the limit is not read: the reader refuses the
/// file.
fn content(path: &Path, limit: ReadLimit) -> Result<Content, InputError> {
    let failed = |error: io::Error| InputError::io(path, "read", &error);
    if path.is_dir() {
        return Err(InputError::new(
            path.display().to_string(),
            "is a directory",
            "name a file in it",
        ));
    }
    let open = || File::open(path).map(BufReader::new);
    let mut first = Vec::new();
    let mut file = open().map_err(failed)?;
    Read::by_ref(&mut file)
        .take(2)
        .read_to_end(&mut first)
        .map_err(failed)?;
    if first == GZIP {
        // A damaged file is identified by its bytes.
        if let Ok(content) = hashed(MultiGzDecoder::new(open().map_err(failed)?), limit) {
            return Ok(content);
        }
    }
    hashed(open().map_err(failed)?, limit).map_err(failed)
}

fn hashed(from: impl Read, limit: ReadLimit) -> io::Result<Content> {
    let mut from = from.take(limit.file().saturating_add(1));
    let mut hash = Sha256::new();
    let mut bytes = vec![0; 1 << 16];
    loop {
        match from.read(&mut bytes) {
            Ok(0) => return Ok(hash.finalize().into()),
            Ok(count) => hash.update(&bytes[..count]),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn identity_of(task: &Task, decisive: &str) -> String {
        let contents = contents(task, ReadLimit::default()).unwrap();
        identity(task, &contents, decisive)
    }

    #[test]
    fn it_is_of_the_contents_the_roles_and_the_settings() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(b"one").unwrap();
        for (name, bytes) in [
            ("one", &b"one"[..]),
            ("moved", b"one"),
            ("packed", &packed.finish().unwrap()),
            ("two", b"two"),
            ("damaged", b"\x1f\x8bone"),
        ] {
            std::fs::write(path(name), bytes).unwrap();
        }
        let task = |fitted: &[&str], held_out: &[&str]| Task {
            recordings: fitted.iter().map(|name| path(name)).collect(),
            held_out: held_out.iter().map(|name| path(name)).collect(),
            ..Task::default()
        };
        let one = identity_of(&task(&["one"], &[]), "a");
        assert_eq!(one.len(), 32);
        for same in ["moved", "packed"] {
            assert_eq!(identity_of(&task(&[same], &[]), "a"), one);
        }
        let both = identity_of(&task(&["one", "two"], &[]), "a");
        assert_eq!(identity_of(&task(&["two", "moved"], &[]), "a"), both);
        let others = [
            one,
            both,
            identity_of(&task(&["one"], &[]), "b"),
            identity_of(&task(&["two"], &[]), "a"),
            identity_of(&task(&["damaged"], &[]), "a"),
            identity_of(&task(&["one"], &["two"]), "a"),
            identity_of(&task(&["two"], &["one"]), "a"),
        ];
        for (place, each) in others.iter().enumerate() {
            assert!(!others[..place].contains(each), "{place}");
        }
    }
}

//! The record of finished traces: one line per trace, on the disk before the next trace begins.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead as _, BufReader, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use mesh_damper_output::ending;
use mesh_damper_output::error::{InputError, Place};
use serde::{Deserialize, Serialize};

use crate::outcome::Outcome;

/// The word that marks a journal, and its version.
const FORMAT: &str = "mesh-damper batch journal";
const VERSION: u64 = 1;

/// The first line.
#[derive(Serialize, Deserialize)]
struct Head {
    format: String,
    version: u64,
}

/// Any other line.
#[derive(Serialize, Deserialize)]
struct Entry {
    id: String,
    #[serde(flatten)]
    outcome: Outcome,
}

/// The outcomes of a batch by the identities of its traces, and the file that stores them.
///
/// A line is written at once and is on the disk when [`Journal::keep`] returns. If a batch is killed while it writes a line, the
/// line stays cut. It is removed when the journal is opened again, and its trace is made again.
#[derive(Debug)]
pub(crate) struct Journal {
    path: PathBuf,
    file: File,
    known: HashMap<String, Outcome>,
}

impl Journal {
    /// Opens the journal at `path`, or creates it.
    ///
    /// # Errors
    /// Errors of the file system; a file that is another journal, or no journal.
    pub fn open(path: &Path) -> Result<Self, InputError> {
        let failed = |error: io::Error| InputError::io(path, "read", &error);
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(failed)?;
        let mut known = HashMap::new();
        let mut whole = 0;
        let mut reader = BufReader::new(&file);
        let mut line = Vec::new();
        loop {
            line.clear();
            let length = reader.read_until(b'\n', &mut line).map_err(failed)?;
            if line.last() != Some(&b'\n') {
                if whole == 0 && !head()?.starts_with(&line) {
                    return Err(no_journal(path));
                }
                break;
            }
            if whole == 0 {
                check_head(path, &line)?;
            } else if let Ok(Entry { id, outcome }) = serde_json::from_slice(&line) {
                // A damaged line is made again.
                known.insert(id, outcome);
            }
            whole += length as u64;
        }
        let mut journal = Self {
            path: path.to_owned(),
            file: {
                file.set_len(whole).map_err(failed)?;
                file.seek(SeekFrom::Start(whole)).map_err(failed)?;
                file
            },
            known,
        };
        if whole == 0 {
            journal.write(head()?)?;
        }
        Ok(journal)
    }

    /// The outcome of the trace with this identity, if known.
    pub fn outcome(&self, id: &str) -> Option<&Outcome> {
        self.known.get(id)
    }

    /// Stores the outcome of a trace.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn keep(&mut self, id: &str, outcome: &Outcome) -> Result<(), InputError> {
        let entry = Entry {
            id: id.to_owned(),
            outcome: outcome.clone(),
        };
        self.write(line(&entry)?)?;
        self.known.insert(id.to_owned(), outcome.clone());
        Ok(())
    }

    fn write(&mut self, line: Vec<u8>) -> Result<(), InputError> {
        // An end by a signal leaves whole lines.
        let _whole = ending::whole();
        self.file
            .write_all(&line)
            .and_then(|()| self.file.sync_data())
            .map_err(|error| InputError::io(&self.path, "write", &error))
    }
}

fn line(value: &impl Serialize) -> Result<Vec<u8>, InputError> {
    let mut bytes = serde_json::to_vec(value).map_err(|error| {
        let problem = format!("not to be written as JSON: {error}");
        InputError::new("the batch's journal", problem, "report this")
    })?;
    bytes.push(b'\n');
    Ok(bytes)
}

fn head() -> Result<Vec<u8>, InputError> {
    line(&Head {
        format: FORMAT.to_owned(),
        version: VERSION,
    })
}

fn check_head(path: &Path, line: &[u8]) -> Result<(), InputError> {
    match serde_json::from_slice::<Head>(line) {
        Ok(head) if head.format == FORMAT && head.version == VERSION => Ok(()),
        Ok(head) if head.format == FORMAT => Err(InputError::new(
            path.display().to_string(),
            format!("has version {}, this program reads {VERSION}", head.version),
            "name another folder with --out",
        )),
        _ => Err(no_journal(path)),
    }
}

fn no_journal(path: &Path) -> InputError {
    InputError::new(
        path.display().to_string(),
        "is no journal of a batch",
        "name another folder with --out",
    )
    .at(Place::Line(1))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::outcome::Failure;

    fn failed(error: &str) -> Outcome {
        Outcome::Failed(Failure {
            error: error.to_owned(),
            read_limit: None,
        })
    }

    #[test]
    fn a_line_that_was_cut_is_taken_off_wherever_it_was_cut() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("journal.jsonl");
        let mut journal = Journal::open(&path).unwrap();
        let head = fs::read(&path).unwrap().len();
        journal.keep("1", &failed("one")).unwrap();
        let one = fs::read(&path).unwrap().len();
        journal.keep("2", &failed("two")).unwrap();
        let whole = fs::read(&path).unwrap();
        for length in 0..=whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            let mut journal = Journal::open(&path).unwrap();
            let has = |id| journal.outcome(id).is_some();
            assert_eq!((has("1"), has("2")), (length >= one, length >= whole.len()));
            // An outcome stored afterwards is read again, whatever the file contained.
            journal.keep("3", &failed("three")).unwrap();
            let journal = Journal::open(&path).unwrap();
            assert_eq!(journal.outcome("3"), Some(&failed("three")), "{length}");
            assert_eq!(journal.outcome("1").is_some(), length >= one);
        }
        assert!(head < one);
    }

    #[test]
    fn a_line_that_is_damaged_is_forgotten_and_what_is_no_journal_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("journal.jsonl");
        let mut journal = Journal::open(&path).unwrap();
        journal.keep("1", &failed("one")).unwrap();
        journal.keep("2", &failed("two")).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, text.replace("\"1\"", "\"1")).unwrap();
        let journal = Journal::open(&path).unwrap();
        assert_eq!(journal.outcome("1"), None);
        assert_eq!(journal.outcome("2"), Some(&failed("two")));
        for (text, said) in [
            ("time_s,force_kN\n", "is no journal of a batch"),
            ("without an end", "is no journal of a batch"),
            (
                "{\"format\":\"mesh-damper batch journal\",\"version\":2}\n",
                "has version 2",
            ),
        ] {
            fs::write(&path, text).unwrap();
            let error = Journal::open(&path).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
    }
}

//! Invalid input or usage, described in one line.

use std::fmt::Write as _;
use std::path::Path;

use crate::terminal::visible;

/// Input that was rejected: the file, the place in it, the problem and its correction.
///
/// Its text is always a single line, whatever the file's name or its cells contain.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.line())]
pub struct InputError {
    /// The file as the user named it, or the option if there is no file.
    pub source_name: String,
    /// Place in it.
    pub place: Place,
    /// The problem.
    pub problem: String,
    /// Its correction.
    pub remedy: String,
    /// The question that it asks, if it is one. Boxed, as every `Result` has room for it.
    question: Option<Box<Question>>,
}

/// A question about a file.
#[derive(Clone, Debug, Default, PartialEq)]
struct Question {
    /// Name of the channel that the file lacks.
    missing: Option<&'static str>,
    /// The options that answer it.
    answer: Option<String>,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// The file as a whole.
    Whole,
    /// A line, counted from 1, comments and blank lines included.
    Line(u64),
    /// A column of a table.
    Column(String),
    /// A line and a column.
    Cell {
        /// The line, counted from 1.
        line: u64,
        /// The column's name.
        column: String,
    },
    /// A sample of a file without lines or of a recording in memory, counted from 1, and the column's name if it is one value. Boxed, as
    /// every `Result` has room for it.
    Sample(Box<(u64, Option<String>)>),
    /// A field of a structured file, as a path such as `effects[0].parameters.force`.
    Field(String),
}

impl InputError {
    /// An error about a file as a whole.
    pub fn new(
        source_name: impl Into<String>,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            source_name: source_name.into(),
            place: Place::Whole,
            problem: problem.into(),
            remedy: remedy.into(),
            question: None,
        }
    }

    /// The same error with the options that answer it.
    #[must_use]
    pub fn answered_by(mut self, options: impl Into<String>) -> Self {
        self.question.get_or_insert_default().answer = Some(options.into());
        self
    }

    /// The options that answer it, if options do: `--unit force=UNIT`. A word in capitals stands for what only the user knows.
    pub fn answer(&self) -> Option<&str> {
        self.question.as_ref()?.answer.as_deref()
    }

    /// The same error about a channel that the file lacks, by its name.
    #[must_use]
    pub fn lacking(mut self, channel: &'static str) -> Self {
        self.question.get_or_insert_default().missing = Some(channel);
        self
    }

    /// The name of the channel that the file lacks, if that is the problem.
    pub fn missing(&self) -> Option<&'static str> {
        self.question.as_ref()?.missing
    }

    /// The same error at a place in the file.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        self.place = place;
        self
    }

    /// The same error, which concerns the table with this name, a sheet or a group of the file; no name, if the file has only one.
    #[must_use]
    pub fn in_table(mut self, name: Option<&str>) -> Self {
        if let Some(name) = name {
            self.problem = format!("table {}: {}", quoted(name), self.problem);
        }
        self
    }

    /// An operation of the file system that failed.
    pub fn io(path: &Path, doing: &str, error: &std::io::Error) -> Self {
        use std::io::ErrorKind;
        let (problem, remedy) = match error.kind() {
            ErrorKind::NotFound => ("does not exist", "check the path"),
            ErrorKind::PermissionDenied => (
                "permission denied",
                "check the permissions of the file and its directory",
            ),
            ErrorKind::IsADirectory => ("is a directory", "name a file in it"),
            ErrorKind::NotADirectory => ("a part of the path is not a directory", "check the path"),
            ErrorKind::StorageFull => ("no space left on the device", "make room"),
            ErrorKind::QuotaExceeded => ("the quota is used up", "make room"),
            ErrorKind::FileTooLarge => (
                "the file would exceed the largest size that the system allows",
                "raise the limit (ulimit -f), or name another directory",
            ),
            ErrorKind::ReadOnlyFilesystem => {
                ("the file system is read-only", "name another directory")
            }
            _ => {
                return Self::new(
                    path.display().to_string(),
                    format!("{doing} failed: {error}"),
                    "check the path",
                );
            }
        };
        Self::new(
            path.display().to_string(),
            format!("cannot {doing} it: {problem}"),
            remedy,
        )
    }

    fn line(&self) -> String {
        let mut text = single_line(&self.source_name);
        // Writing to a string does not fail.
        let _ = match &self.place {
            Place::Whole => Ok(()),
            Place::Line(line) => write!(text, ": line {line}"),
            Place::Column(column) => write!(text, ": column {}", single_line(column)),
            Place::Cell { line, column } => {
                write!(text, ": line {line}, column {}", single_line(column))
            }
            Place::Sample(place) => match &**place {
                (sample, None) => write!(text, ": sample {sample}"),
                (sample, Some(column)) => {
                    write!(text, ": sample {sample}, column {}", single_line(column))
                }
            },
            Place::Field(field) => write!(text, ": field {}", single_line(field)),
        };
        let _ = write!(
            text,
            ": {}; {}",
            single_line(&self.problem),
            single_line(&self.remedy)
        );
        text
    }
}

/// `text` as one [`visible`] line, shortened where a file made it long.
fn single_line(text: &str) -> String {
    /// More than any path or list that a message is made of.
    const LONGEST: usize = 5000;
    let cut = (text.chars().nth(LONGEST).is_some()).then_some('…');
    let text: String = text.chars().take(LONGEST).chain(cut).collect();
    visible(&text).into_owned()
}

/// A cell or a name quoted for a message, shortened where it is long.
pub fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    let shown: String = text.chars().take(LONGEST).collect();
    let is_longer = text.chars().nth(LONGEST).is_some();
    let cut = if is_longer { "…" } else { "" };
    format!("\"{shown}{cut}\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_one_line_whatever_the_names_contain() {
        let error = InputError::new("a\nb.csv", "bad \"x\ry\"", "mend\tit").at(Place::Cell {
            line: 7,
            column: "force\nkN".into(),
        });
        let line = error.to_string();
        assert_eq!(
            line,
            "a\\nb.csv: line 7, column force\\nkN: bad \"x\\ry\"; mend\\tit"
        );
    }
}

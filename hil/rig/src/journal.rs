//! File with the samples recorded so far in a run.
//!
//! However the run ends, even if it is killed, the file is a recording up to its last complete row. It is removed once the
//! recording itself has been written.

use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use mesh_damper_output::ending;
use mesh_damper_output::error::InputError;
use mesh_damper_recording::UNFINISHED;
use mesh_damper_tables::write::{comment_line, decimal, guarded};

use super::run::Samples;

/// A file that grows with a run, next to the future recording.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    comments: Vec<String>,
    /// Names of the specimen's control inputs, which are the first ones of the samples.
    controls: Vec<String>,
    /// There is no file before the first sample, so that a run that does not begin leaves nothing.
    file: Option<File>,
    written: usize,
}

impl Journal {
    /// `recording.partial.csv` in `directory`, which must exist, with these comments. Nothing is written yet.
    pub fn new(directory: &Path, comments: Vec<String>) -> Self {
        Self::at(Self::path_in(directory), comments)
    }

    /// The same at `path`.
    pub fn at(path: PathBuf, comments: Vec<String>) -> Self {
        Self {
            path,
            comments,
            controls: Vec::new(),
            file: None,
            written: 0,
        }
    }

    /// The same with a column for each of `controls`, the control inputs of the specimen.
    #[must_use]
    pub fn with_controls(self, controls: Vec<String>) -> Self {
        Self { controls, ..self }
    }

    /// Its path for a run that leaves its recording in `directory`.
    pub fn path_in(directory: &Path) -> PathBuf {
        directory.join("recording.partial.csv")
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the rows of `samples` that are not written yet.
    ///
    /// # Errors
    /// The file and why it cannot be written. Rows written before stay.
    pub fn write(&mut self, samples: &Samples) -> Result<(), InputError> {
        if samples.len() == self.written {
            return Ok(());
        }
        let mut text = String::new();
        if self.file.is_none() {
            // A new file, so that it neither replaces another nor follows a link.
            let made = File::create_new(&self.path);
            self.file = Some(made.map_err(|error| InputError::io(&self.path, "write", &error))?);
            for comment in &self.comments {
                text += &comment_line(comment);
            }
            text += &format!("# {UNFINISHED}: the run was under way\n");
            text += "time_s,displacement_mm,force_kN,temperature_degC";
            for control in &self.controls {
                text += &format!(",{}", guarded(control));
            }
            text.push('\n');
        }
        for index in self.written..samples.len() {
            let cells = [
                &samples.time,
                &samples.displacement,
                &samples.force,
                &samples.temperature,
            ];
            text += &cells.map(|channel| decimal(channel[index])).join(",");
            for place in 0..self.controls.len() {
                // The samples keep no values of an input until it differs from 0.
                let input = samples.control(place).get(index).copied();
                text += &format!(",{}", decimal(input.unwrap_or_default()));
            }
            text.push('\n');
        }
        // An end by a signal leaves whole rows.
        let _whole = ending::whole();
        if let Some(file) = &mut self.file {
            file.write_all(text.as_bytes())
                .map_err(|error| InputError::io(&self.path, "write", &error))?;
        }
        self.written = samples.len();
        Ok(())
    }

    /// Whether there is a file with content.
    pub fn has_begun(&self) -> bool {
        self.written > 0
    }

    /// Removes the file, because the recording exists.
    pub fn remove(self) {
        if self.file.is_some() {
            // If the file is gone already, that is the goal.
            let _ = fs::remove_file(&self.path);
        }
    }
}

//! The files that a command reads and writes, stated before it begins.

use std::path::{Path, PathBuf};

use super::Outputs;
use super::ending;
use super::folder::Folders;
use super::place::{FileIdentity, Place, Target};
use crate::error::InputError;

/// The inputs and outputs of one command, so that an output that would destroy something is rejected before any work.
///
/// ```no_run
/// # use mesh_damper_output::Plan;
/// # use std::path::Path;
/// let mut outputs = Plan::new()
///     .reads(["recording.csv"])
///     .fills(Path::new("trace-out"), ["trace.json"])
///     .begin()?;
/// // The work, and then
/// outputs.add("trace-out/trace.json", "{}");
/// outputs.write()?;
/// # Ok::<(), mesh_damper_output::error::InputError>(())
/// ```
#[derive(Debug, Default)]
pub struct Plan {
    inputs: Vec<PathBuf>,
    outputs: Vec<PathBuf>,
    folder: Option<PathBuf>,
    unfinished: Option<PathBuf>,
}

impl Plan {
    /// A plan without inputs and outputs.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds files to read. Missing files are rejected when they are read.
    #[must_use]
    pub fn reads<P: Into<PathBuf>>(mut self, inputs: impl IntoIterator<Item = P>) -> Self {
        self.inputs.extend(inputs.into_iter().map(Into::into));
        self
    }

    /// Adds files that may be written; `-` is standard output.
    #[must_use]
    pub fn writes<P: Into<PathBuf>>(mut self, outputs: impl IntoIterator<Item = P>) -> Self {
        self.outputs.extend(outputs.into_iter().map(Into::into));
        self
    }

    /// Adds files that may be written into `folder`, if there is one, which no other command may fill meanwhile.
    #[must_use]
    pub fn fills<'a, P: AsRef<Path>>(
        mut self,
        folder: impl Into<Option<&'a Path>>,
        names: impl IntoIterator<Item = P>,
    ) -> Self {
        if let Some(folder) = folder.into() {
            self.folder = Some(folder.to_owned());
            self.outputs
                .extend(names.into_iter().map(|name| folder.join(name)));
        }
        self
    }

    /// Adds the file in which a test stores its recording while it runs. An existing one is the remainder of an interrupted test,
    /// and must not be overwritten.
    #[must_use]
    pub fn keeps(mut self, unfinished: impl Into<PathBuf>) -> Self {
        self.unfinished = Some(unfinished.into());
        self
    }

    /// Locks the folder, which is created if missing, until the outputs are dropped.
    ///
    /// # Errors
    /// An output that is an input, another output, a link, a directory, or below a file; a folder that another command fills or
    /// that cannot be created; an existing unfinished recording. No error leaves a new directory.
    pub fn begin(self) -> Result<Outputs, InputError> {
        let inputs: Vec<(FileIdentity, &PathBuf)> = self
            .inputs
            .iter()
            .filter_map(|path| Some((FileIdentity::of(path)?, path)))
            .collect();
        let mut planned: Vec<Target> = Vec::new();
        for name in self.outputs.iter().chain(&self.unfinished) {
            let target = Target::of(name.clone())?;
            refuse_lost(&target, &inputs, &planned)?;
            planned.push(target);
        }
        let mut folders = Folders::default();
        if let Some(folder) = &self.folder {
            // No end comes between a new directory and its entry for the end.
            let _whole = ending::whole();
            folders.lock(folder)?;
        }
        // Not before the folder is locked, because a running test has such a file as well.
        match &self.unfinished {
            Some(left) if left.exists() => Err(InputError::new(
                left.display().to_string(),
                "left by an interrupted run",
                "move it or remove it, or name another folder",
            )),
            _ => Ok(Outputs::new(planned, folders, self.unfinished)),
        }
    }
}

/// Rejects an output that would overwrite something else.
fn refuse_lost(
    target: &Target,
    inputs: &[(FileIdentity, &PathBuf)],
    planned: &[Target],
) -> Result<(), InputError> {
    let refused = |problem: String, remedy: &str| {
        let name = match target.place {
            Place::StandardOutput => "standard output".to_owned(),
            _ => target.name.display().to_string(),
        };
        Err(InputError::new(name, problem, remedy))
    };
    let is_input = |(file, _): &&(FileIdentity, &PathBuf)| target.file.as_ref() == Some(file);
    if let Some((_, input)) = inputs.iter().find(is_input) {
        return refused(
            format!("would replace the input {}", input.display()),
            "name another file",
        );
    }
    if let Some(other) = planned.iter().find(|other| target.is_same_as(other)) {
        return refused(
            format!(
                "would be written twice; the other output is {}",
                other.name.display()
            ),
            "name another file for one of them",
        );
    }
    if target.is_link() {
        return refused(
            "is a symbolic link; hil does not replace its target".to_owned(),
            "remove the link or name another file",
        );
    }
    Ok(())
}

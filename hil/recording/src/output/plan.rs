//! What a command reads and writes, stated before it begins.

use std::path::{Path, PathBuf};

use super::Outputs;
use super::folder::Folders;
use super::place::{FileIdentity, Place, Target};
use crate::error::InputError;

/// The inputs and outputs of one command, so that an output that would destroy something is refused before any work.
///
/// ```no_run
/// # use mesh_damper_recording::output::Plan;
/// # use std::path::Path;
/// let mut outputs = Plan::new()
///     .reads(["recording.csv"])
///     .fills(Path::new("trace-out"), ["trace.json"])
///     .begin()?;
/// // The work, and then
/// outputs.add("trace-out/trace.json", "{}");
/// outputs.write()?;
/// # Ok::<(), mesh_damper_recording::error::InputError>(())
/// ```
#[derive(Debug, Default)]
pub struct Plan {
    inputs: Vec<PathBuf>,
    outputs: Vec<PathBuf>,
    folder: Option<PathBuf>,
    unfinished: Option<PathBuf>,
}

impl Plan {
    /// Neither inputs nor outputs.
    pub fn new() -> Self {
        Self::default()
    }

    /// Files that are read. Those that are not there are refused when they are read.
    #[must_use]
    pub fn reads<P: Into<PathBuf>>(mut self, inputs: impl IntoIterator<Item = P>) -> Self {
        self.inputs.extend(inputs.into_iter().map(Into::into));
        self
    }

    /// Files that may be written; `-` is standard output.
    #[must_use]
    pub fn writes<P: Into<PathBuf>>(mut self, outputs: impl IntoIterator<Item = P>) -> Self {
        self.outputs.extend(outputs.into_iter().map(Into::into));
        self
    }

    /// Files that may be written into `folder`, if there is one, which no other command may fill meanwhile.
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

    /// The file that a test keeps its recording in while it is under way. One that is there is all that a broken-off test
    /// left, and nothing may take its place.
    #[must_use]
    pub fn keeps(mut self, unfinished: impl Into<PathBuf>) -> Self {
        self.unfinished = Some(unfinished.into());
        self
    }

    /// Takes hold of the folder, which is made where it is missing, until the outputs are dropped.
    ///
    /// # Errors
    /// An output that is an input, another output, a link, a directory, or below a file; a folder that another command
    /// fills or that cannot be made; an unfinished recording that is there. None leaves a directory behind.
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
            folders.lock(folder)?;
        }
        // Not before the folder is locked: a test under way keeps one as well.
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

/// Refuses an output that would take the place of something else.
fn refuse_lost(
    target: &Target,
    inputs: &[(FileIdentity, &PathBuf)],
    planned: &[Target],
) -> Result<(), InputError> {
    let refused = |problem: String, mend: &str| {
        let name = match target.place {
            Place::StandardOutput => "standard output".to_owned(),
            _ => target.name.display().to_string(),
        };
        Err(InputError::new(name, problem, mend))
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

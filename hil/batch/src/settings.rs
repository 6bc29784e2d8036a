//! The settings of all traces of a batch.

use mesh_damper_identify::trace::Sought;
use mesh_damper_output::error::InputError;
use mesh_damper_tables::files::Reading;
use mesh_damper_tables::read_limit::ReadLimit;

use crate::identity::{contents, identity};
use crate::list::Task;

/// The settings of all traces of a batch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// The effects to look for, and the base law.
    pub sought: Sought,
    /// How the recordings are read.
    pub reading: Reading,
    /// Whether each trace gets a `report.html`.
    pub reports: bool,
}

impl Settings {
    /// The identity of the trace of `task` with these settings, as in its row. Its recordings are read, but not traced.
    ///
    /// # Errors
    /// A recording that cannot be read.
    pub fn identity_of(&self, task: &Task) -> Result<String, InputError> {
        let contents = contents(task, self.reading.limit)?;
        Ok(identity(task, &contents, &self.decisive()))
    }

    /// Everything that determines the result of a trace, as text: the program's version, the reading of files, the effects to look
    /// for, and the policy numbers. The read limit is no part of it: a file within one limit is the same within another.
    pub(crate) fn decisive(&self) -> String {
        let numbers = (
            mesh_damper_recording::policy::Policy::in_use(),
            mesh_damper_identify::policy::Policy::in_use(),
        );
        let reading = Reading {
            limit: ReadLimit::default(),
            ..self.reading.clone()
        };
        let version = env!("CARGO_PKG_VERSION");
        format!("{version} {reading:?} {:?} {numbers:?}", self.sought)
    }
}

//! What all traces of a batch are made with.

use mesh_damper_identify::trace::Sought;
use mesh_damper_recording::files::Reading;
use mesh_damper_recording::read_limit::ReadLimit;

/// What all traces of a batch are made with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Which effects are sought, and beside which law.
    pub sought: Sought,
    /// How the recordings are read.
    pub reading: Reading,
    /// Whether each trace has a `report.html`.
    pub reports: bool,
}

impl Settings {
    /// Everything that decides what a trace finds, as text: the program's version, how files are read, what is sought, and the numbers
    /// that decide. How much of a file may be read is no part of it: what passed one limit is the same within another.
    pub(crate) fn decisive(&self) -> String {
        let numbers = (
            mesh_damper_recording::policy::policy(),
            mesh_damper_identify::policy::policy(),
        );
        let reading = Reading {
            limit: ReadLimit::default(),
            ..self.reading.clone()
        };
        let version = env!("CARGO_PKG_VERSION");
        format!("{version} {reading:?} {:?} {numbers:?}", self.sought)
    }
}

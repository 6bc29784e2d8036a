//! What all traces of a batch are made with.

use mesh_damper_identify::trace::Sought;
use mesh_damper_recording::read_limit::ReadLimit;

/// What all traces of a batch are made with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Which effects are sought, and beside which law.
    pub sought: Sought,
    /// How much of a file is read.
    pub limit: ReadLimit,
    /// Whether each trace has a `report.html`.
    pub reports: bool,
}

impl Settings {
    /// Everything that decides what a trace finds, as text: the program's version, what is sought, and the numbers that decide.
    pub(crate) fn decisive(&self) -> String {
        let numbers = (
            mesh_damper_recording::policy::policy(),
            mesh_damper_identify::policy::policy(),
        );
        format!(
            "{} {:?} {numbers:?}",
            env!("CARGO_PKG_VERSION"),
            self.sought
        )
    }
}

//! A run that is watched: its progress, its recording and its viewers.

use mesh_damper::health::Event;
use mesh_damper::rig::{CycleReport, Telemetry};
use mesh_damper_live::State;
use mesh_damper_output::error::InputError;
use mesh_damper_rig::{Journal, RigRun, Samples, SetupError, Watch};

use super::super::live::Live;
use super::super::pace::Pace;
use super::trip::in_words;
use crate::commands::progress::Progress;

/// Shows the progress of a run, stores its recording, and passes the data to the viewers.
pub(in crate::commands::full) struct Watched {
    pub(in crate::commands::full) progress: Progress,
    pub(in crate::commands::full) journal: Journal,
    pub(in crate::commands::full) live: Live,
    /// Pace of a rig without its own clock.
    pub(in crate::commands::full) pace: Pace,
}

impl Watched {
    /// Ends the progress; returns the recording so far and the viewers.
    pub fn over(self) -> (Journal, Live) {
        (self.journal, self.live)
    }
}

impl Watch for &mut Watched {
    fn tick(&mut self, telemetry: &Telemetry, time: f64, temperature: f64) {
        self.pace.wait(time);
        self.live.tick(telemetry, time, temperature);
    }

    fn cycle(&mut self, report: &CycleReport, time: f64) {
        self.live.cycle(report, time);
    }

    fn event(&mut self, event: &Event, time: f64) {
        self.live.event(event, time);
    }

    fn see(&mut self, part: f64, samples: &Samples) -> Result<(), InputError> {
        self.progress.done((100.0 * part) as u64);
        self.journal.write(samples)
    }
}

/// The end of a run, for the viewers.
pub fn ended(run: Result<&RigRun, &InputError>) -> State {
    match run {
        Ok(run) => match run.faults.first() {
            Some(&(time, fault)) => State::Stopped {
                time,
                cause: in_words(fault).to_owned(),
            },
            None => State::Finished {
                time: run.samples.time.last().copied().unwrap_or_default(),
            },
        },
        Err(error) => State::BrokenOff {
            cause: error.to_string(),
        },
    }
}

/// The error for a part of the rig that rejects the setup.
pub fn refused(error: SetupError) -> InputError {
    match error {
        SetupError::Link(error) | SetupError::Watch(error) | SetupError::Drive(error) => error,
        error => {
            let remedy = "change the blocks, the tick rate, the model or --follow";
            InputError::new("the rig", error.to_string(), remedy)
        }
    }
}

pub fn broken_off(error: SetupError, journal: &Journal) -> InputError {
    with_journal(refused(error), journal)
}

/// Adds to `error` the path of the recording up to it.
pub fn with_journal(mut error: InputError, journal: &Journal) -> InputError {
    if journal.has_begun() && journal.path().exists() {
        let path = journal.path().display();
        error.remedy = format!(
            "{}; the samples recorded before are in {path}",
            error.remedy
        );
    }
    error
}

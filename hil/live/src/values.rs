//! What a test says of itself while it runs.

use serde::Serialize;
use serde_json::{Value, json};

/// What is run, said once.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct About {
    /// In a few words.
    pub title: String,
    /// The specimen, in words.
    pub specimen: String,
    /// The law beside it, in words.
    pub law: String,
    /// Samples per second that a listener is told of, Hz, above 0.
    #[serde(rename = "sample_rate_Hz")]
    pub sample_rate: f64,
    /// How long the test takes, s; none where that is not known.
    #[serde(rename = "duration_s")]
    pub duration: Option<f64>,
    /// Whether there are cycles to come. A motion of any shape has none.
    pub has_cycles: bool,
}

/// What was measured at one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// s since the start; rises from sample to sample.
    pub time: f64,
    /// Measured, mm.
    pub displacement: f32,
    /// Measured, kN.
    pub force: f32,
    /// Of the law, kN.
    pub law_force: f32,
}

/// The results of one cycle. The names that leave the process carry the units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CycleResult {
    /// When it ended, s since the start.
    #[serde(rename = "time_s")]
    pub time: f64,
    /// Block of the test, from 0.
    pub block: u32,
    /// Number of the cycle, from 0.
    pub cycle: u32,
    /// In a ramp: not a steady cycle.
    pub ramp: bool,
    /// Half of the displacement's range, mm.
    #[serde(rename = "amplitude_mm")]
    pub amplitude: f32,
    /// Hz
    #[serde(rename = "frequency_Hz")]
    pub frequency: f32,
    /// Dynamic stiffness, kN/mm.
    #[serde(rename = "stiffness_kN_per_mm")]
    pub stiffness: f32,
    /// Loss factor.
    pub loss_factor: f32,
    /// Dissipated energy, J.
    #[serde(rename = "energy_J")]
    pub energy: f32,
    /// Dynamic stiffness by the law, kN/mm.
    #[serde(rename = "law_stiffness_kN_per_mm")]
    pub law_stiffness: f32,
    /// Loss factor by the law.
    pub law_loss_factor: f32,
    /// RMS of the law's error over the RMS of the measured force.
    #[serde(rename = "law_error")]
    pub error: f32,
    /// Of the specimen, °C; not a number where nobody measures it, which JSON has as null.
    #[serde(rename = "temperature_degC")]
    pub temperature: f32,
}

/// Something that a monitor named.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Event {
    /// s since the start.
    #[serde(rename = "time_s")]
    pub time: f64,
    /// Cycles completed.
    pub cycle: u32,
    /// The name of the cause.
    pub cause: String,
    /// What it may be as well.
    pub or: Option<String>,
    /// Something is wrong. A run-in, for example, is not.
    pub fault: bool,
    /// In one sentence, with the evidence.
    pub text: String,
}

/// How the test is.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum State {
    /// It has not begun.
    #[default]
    Waiting,
    /// It goes on.
    Running,
    /// It ran to its end.
    Finished {
        /// s since the start.
        time: f64,
    },
    /// It was stopped by a limit or a fault.
    Stopped {
        /// s since the start.
        time: f64,
        /// Why, in words.
        cause: String,
    },
    /// It could not go on.
    BrokenOff {
        /// Why, in words.
        cause: String,
    },
}

impl State {
    /// Whether nothing more comes.
    pub fn is_over(&self) -> bool {
        !matches!(self, Self::Waiting | Self::Running)
    }

    /// As JSON: `state`, `time_s` and `cause`, the last two null where there are none.
    pub fn to_json(&self) -> Value {
        let (name, time, cause) = match self {
            Self::Waiting => ("waiting", None, None),
            Self::Running => ("running", None, None),
            Self::Finished { time } => ("finished", Some(*time), None),
            Self::Stopped { time, cause } => ("stopped", Some(*time), Some(cause)),
            Self::BrokenOff { cause } => ("broken_off", None, Some(cause)),
        };
        json!({"state": name, "time_s": time, "cause": cause})
    }
}

/// Who is told of a test while it runs. No method may wait.
pub trait Listener {
    /// Every tick, or every so many of them.
    fn sample(&mut self, sample: &Sample);
    /// A cycle has ended.
    fn cycle(&mut self, cycle: &CycleResult);
    /// A monitor named something.
    fn event(&mut self, event: &Event);
    /// The state has changed.
    fn state(&mut self, state: &State);
}

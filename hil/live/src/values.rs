//! The data that a test reports while it runs.

use serde::Serialize;
use serde_json::{Value, json};

/// A description of the test, given once.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct About {
    /// In a few words.
    pub title: String,
    /// The specimen, as text.
    pub specimen: String,
    /// The law for comparison, as text.
    pub law: String,
    /// Samples per second for a listener, Hz, above 0.
    #[serde(rename = "sample_rate_Hz")]
    pub sample_rate: f64,
    /// Duration of the test, s; none if unknown.
    #[serde(rename = "duration_s")]
    pub duration: Option<f64>,
    /// Whether cycles will follow. A motion of arbitrary shape has none.
    pub has_cycles: bool,
}

/// The measurements of one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// s since the start; rises from sample to sample.
    pub time: f64,
    /// Measured, mm.
    pub displacement: f32,
    /// Measured, kN.
    pub force: f32,
    /// Force of the law, kN.
    pub law_force: f32,
}

/// The results of one cycle. The exported names carry the units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CycleResult {
    /// End of the cycle, s since the start.
    #[serde(rename = "time_s")]
    pub time: f64,
    /// Block of the test, from 0.
    pub block: u32,
    /// Number of the cycle, from 0.
    pub cycle: u32,
    /// Whether it belongs to a ramp and is not a steady cycle.
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
    /// Temperature of the specimen, °C; NaN if it is not measured, null in JSON.
    #[serde(rename = "temperature_degC")]
    pub temperature: f32,
}

/// A cause that a monitor named.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Event {
    /// s since the start.
    #[serde(rename = "time_s")]
    pub time: f64,
    /// Cycles completed.
    pub cycle: u32,
    /// The name of the cause.
    pub cause: String,
    /// The alternative cause.
    pub or: Option<String>,
    /// Whether this is a fault. A run-in, for example, is not.
    pub fault: bool,
    /// One sentence with the evidence.
    pub text: String,
}

/// The state of the test.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum State {
    /// It has not begun.
    #[default]
    Waiting,
    /// It is running.
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
        /// The reason, as text.
        cause: String,
    },
    /// It could not continue.
    BrokenOff {
        /// The reason, as text.
        cause: String,
    },
}

impl State {
    /// Whether nothing more follows.
    pub fn is_over(&self) -> bool {
        !matches!(self, Self::Waiting | Self::Running)
    }

    /// As JSON: `state`, `time_s` and `cause`; the last two are null if absent.
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

/// Receives the data of a test while it runs. No method may wait.
pub trait Listener {
    /// Every tick, or every n-th tick.
    fn sample(&mut self, sample: &Sample);
    /// A cycle has ended.
    fn cycle(&mut self, cycle: &CycleResult);
    /// A monitor named a cause.
    fn event(&mut self, event: &Event);
    /// The state has changed.
    fn state(&mut self, state: &State);
}

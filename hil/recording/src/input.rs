//! One channel over time: the force or the motion that drives something, without other channels.

use std::path::Path;

use mesh_damper_output::error::{InputError, Place};
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::control::ControlChannel;
use mesh_damper_tables::files::{self, GivenColumn, Kept, Needs, Reading, Unmarked};

use super::Recording;
use super::noise::noise_beside_tones;
use crate::faults::kind::listed;

/// A channel at equal steps of time.
#[derive(Clone, Debug, PartialEq)]
pub struct InputSignal {
    /// The file's path as the user gave it.
    pub name: String,
    /// Time of the first sample, s.
    pub start: f64,
    /// Time between samples, s.
    pub tick: f64,
    /// In the code's unit of the channel: mm or kN.
    pub values: Vec<f64>,
    /// Temperature in °C, one per sample, if the file has it.
    pub temperature: Option<Vec<f64>>,
    /// Control inputs, if the file has them.
    pub controls: Vec<ControlChannel>,
    /// Uncertain choices of columns in the file, in words.
    pub guesses: Vec<String>,
    /// Assumed units, in words; `None` if all are stated.
    pub assumed: Option<String>,
    /// Faults of the file's times, in words; `None` without faults.
    pub warning: Option<String>,
}

impl InputSignal {
    /// Reads time and `channel` of a recording; no other column is needed. Jittering times are converted to equal steps and gaps
    /// are bridged as in [`Recording::uniform`].
    ///
    /// # Errors
    /// As [`Recording::read`], except that the channel may be constant.
    ///
    /// ```no_run
    /// use mesh_damper_tables::channel::Channel;
    /// use mesh_damper_recording::input::InputSignal;
    /// use mesh_damper_tables::files::Reading;
    ///
    /// let force = InputSignal::read("shaker.csv", Channel::Force, &Reading::default())?;
    /// # Ok::<(), mesh_damper_output::error::InputError>(())
    /// ```
    pub fn read(
        path: impl AsRef<Path>,
        channel: Channel,
        reading: &Reading,
    ) -> Result<Self, InputError> {
        let path = path.as_ref();
        let (_, file) = files::open(path, reading)?;
        let needs = Needs::of([Channel::Time, channel]);
        Self::of(
            Recording::of(path, file, reading, Kept::Channels, &needs)?,
            channel,
        )
    }

    /// The same for columns in memory, whose names are interpreted like those of a file. `unmarked` gives the unit of a channel
    /// without a stated one.
    ///
    /// # Errors
    /// As [`Recording::of_columns`], except that the channel may be constant.
    pub fn of_columns(
        name: impl Into<String>,
        columns: impl IntoIterator<Item = impl Into<GivenColumn>>,
        channel: Channel,
        reading: &Reading,
        unmarked: Unmarked,
    ) -> Result<Self, InputError> {
        let needs = Needs {
            unmarked,
            ..Needs::of([Channel::Time, channel])
        };
        let recording = Recording::gathered(name.into(), columns, reading, &needs)?;
        Self::of(recording, channel)
    }

    fn of(mut recording: Recording, channel: Channel) -> Result<Self, InputError> {
        let values = match channel {
            Channel::Force => &recording.force,
            Channel::Displacement => &recording.displacement,
            Channel::Velocity | Channel::Temperature | Channel::Time => {
                return Err(InputError::new(
                    recording.name,
                    format!("the channel {} cannot drive the mass", channel.name()),
                    "read force or displacement",
                )
                .at(Place::Column(channel.name().into())));
            }
        };
        // The clock judges by the displacement whether jittering times are true: here, by the channel itself.
        let values = values.clone();
        recording.displacement.clone_from(&values);
        recording.force = values;
        recording.velocity = None;
        recording.require_samples(super::FEWEST_SAMPLES)?;
        recording.check_time()?;
        let uniform = recording.uniform()?;
        let mut faults = recording.faults().to_vec();
        faults.extend(uniform.faults());
        Ok(Self {
            start: uniform.start,
            tick: uniform.period,
            values: uniform.displacement,
            temperature: uniform.temperature,
            controls: uniform.controls,
            warning: (!faults.is_empty()).then(|| listed(&faults)),
            guesses: recording.guesses,
            assumed: recording.assumed,
            name: recording.name,
        })
    }

    /// About which part of the channel's rate is noise, RMS divided by RMS: noise of a displacement becomes noise of a velocity,
    /// multiplied by the sampling rate.
    pub fn noise_of_rate(&self) -> f64 {
        let rate = (self.values.windows(2)).map(|pair| (pair[1] - pair[0]).powi(2));
        let size = (rate.sum::<f64>() / self.values.len() as f64).sqrt();
        // A difference of two samples has the noise of both.
        let noise = std::f64::consts::SQRT_2 * noise_beside_tones(&self.values);
        if noise > 0.0 { noise / size } else { 0.0 }
    }
}

//! A recording of a rig test: motion and force over time, with the file that it came from.
//!
//! Files are CSV or CSV.gz: `#` comment lines, a header whose names contain their unit, then samples. `time_s`, a displacement and
//! a force are required; `velocity_mm_s` (or `velocity_mm/s`) and `temperature_degC` are used if present. A column of another
//! quantity with a unit, such as `current_A`, is a [control input](ControlChannel); any other is kept and ignored. See [`units`](mesh_damper_tables::units)
//! for the known units. Every row ends with a line end. A last row without it may have been cut within its last number, and is left
//! out.
//!
//! | module | for |
//! |---|---|
//! | the root | [`Recording`]: its channels, read from a file and written to one; [`Uniform`]: the same at even times |
//! | [`faults`] | channel faults, and their repair |
//! | [`noise`], [`averaging`], [`spectrum`] | the noise of a channel, and its smoothing |
//! | [`motion`], [`cycles`], [`trajectory`] | velocity and acceleration, cycles and blocks, and all inputs of a law |
//! | [`dynamic_stiffness`] | storage and loss stiffness of a cycle |
//! | [`rig`] | facts about the rig that its user states |
//! | [`input`] | a single channel that drives something |
//! | [`notes`] | notes that many recordings share |
//! | [`mod@numbers`], [`mod@policy`] | the numbers that decide all this, each with its source, and the list of them |
//! | [`extremes`] | the smallest, the largest and the quantiles of some values |
//!
//! ```
//! use mesh_damper_recording::Recording;
//! use mesh_damper_recording::trajectory::Trajectory;
//!
//! let time: Vec<f64> = (0..2000).map(|i| 0.001 * f64::from(i)).collect();
//! let displacement: Vec<f64> = time.iter().map(|t| 0.1 * (31.416 * t).sin()).collect();
//! let force = displacement.iter().map(|y| 8.0 * y).collect();
//! let recording = Recording::new("a spring at 5 Hz", time, displacement, force)?;
//! let block = &Trajectory::of(&recording)?.blocks[0];
//! assert!((block.frequency - 5.0).abs() < 0.01);
//! # Ok::<(), mesh_damper_output::error::InputError>(())
//! ```

#![forbid(unsafe_code)]

pub mod averaging;
mod clock;
mod consistency;
pub mod cycles;
pub mod dynamic_stiffness;
pub mod extremes;
pub mod faults;
mod harmonic;
mod in_memory;
pub mod input;
mod kinks;
pub mod motion;
pub mod motion_error;
pub mod noise;
mod noise_floor;
pub mod notes;
pub mod numbers;
pub mod pink;
pub mod policy;
mod polynomial;
mod read;
mod repeats;
mod resample;
mod rest;
pub mod rig;
mod smoother;
pub mod spectrum;
mod stated_rate;
mod steady;
mod times;
pub mod trajectory;
mod words;
pub mod write;
pub mod zero;
pub mod zeros;

pub use consistency::{check_consistency, check_held_out};
pub use repeats::refuse_repeats;
pub use resample::Uniform;

use mesh_damper_output::error::{InputError, Place};
use mesh_damper_tables::control::ControlChannel;
use mesh_damper_tables::rows::{RowLines, TextRows};
use mesh_damper_tables::units::Units;

use faults::ChannelFault;
use words::{counted, plain};

/// The key of the comment that marks the recording of a run under way.
pub const UNFINISHED: &str = "unfinished";

/// The fewest samples of a recording: the number needed to estimate its motion.
pub const FEWEST_SAMPLES: usize = 8;

/// Motion and force over time, in the code's units, with the units and rows of the file from which it was read.
///
/// All channels have as many samples as `time`, which increases strictly; every number is finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The file's path as the user gave it, or a name of the test that made the recording.
    pub name: String,
    /// Time, s, strictly increasing.
    pub time: Vec<f64>,
    /// Displacement, mm
    pub displacement: Vec<f64>,
    /// Force, kN
    pub force: Vec<f64>,
    /// Velocity, mm/s, if it was measured.
    pub velocity: Option<Vec<f64>>,
    /// Temperature, °C, if it was measured.
    pub temperature: Option<Vec<f64>>,
    /// Control inputs of the specimen, in the order of the file's columns.
    pub controls: Vec<ControlChannel>,
    /// The comment lines without their `#` and the blanks around the text.
    pub comments: Vec<String>,
    /// The units of the file, read or to be written.
    pub units: Units,
    source: Option<Source>,
    lines: RowLines,
    /// The name of its table in a file with several, for errors.
    table: Option<String>,
    guesses: Vec<String>,
    assumed: Option<String>,
    faults: Vec<ChannelFault>,
}

/// The file from which a recording was read, cell by cell.
#[derive(Clone, Debug, PartialEq)]
struct Source {
    header: csv::StringRecord,
    rows: TextRows,
}

impl Recording {
    /// A recording made in memory: `time` in s, `displacement` in mm, `force` in kN.
    ///
    /// # Errors
    /// As for a file: different lengths, too few samples, a value that is not finite, time that does not increase, a displacement
    /// that does not change.
    pub fn new(
        name: impl Into<String>,
        time: Vec<f64>,
        displacement: Vec<f64>,
        force: Vec<f64>,
    ) -> Result<Self, InputError> {
        let recording = Self {
            name: name.into(),
            time,
            displacement,
            force,
            velocity: None,
            temperature: None,
            controls: Vec::new(),
            comments: Vec::new(),
            units: Units::default(),
            source: None,
            lines: RowLines::default(),
            table: None,
            guesses: Vec::new(),
            assumed: None,
            faults: Vec::new(),
        };
        recording.check()?;
        Ok(recording)
    }

    /// The recording with a measured velocity, mm/s.
    ///
    /// # Errors
    /// The length differs from that of `time`, or a value is not finite.
    pub fn with_velocity(mut self, velocity: Vec<f64>) -> Result<Self, InputError> {
        self.velocity = Some(velocity);
        self.check()?;
        Ok(self)
    }

    /// The recording with a measured temperature, °C.
    ///
    /// # Errors
    /// The length differs from that of `time`, or a value is not finite.
    pub fn with_temperature(mut self, temperature: Vec<f64>) -> Result<Self, InputError> {
        self.temperature = Some(temperature);
        self.check()?;
        Ok(self)
    }

    /// The recording with one more control input. `name` is the column's name with the unit, such as `current_A`.
    ///
    /// # Errors
    /// The length differs from that of `time`, or a value is not finite.
    pub fn with_control(
        mut self,
        name: impl Into<String>,
        values: Vec<f64>,
    ) -> Result<Self, InputError> {
        let name = name.into();
        self.controls.push(ControlChannel { name, values });
        self.check()?;
        Ok(self)
    }

    /// Keeps the control inputs of these names, in this order.
    ///
    /// # Errors
    /// The first name that the recording lacks; nothing is changed then.
    pub fn arrange_controls<'n>(
        &mut self,
        names: impl IntoIterator<Item = &'n str>,
    ) -> Result<(), InputError> {
        let named = |name: &str| {
            let known = self.controls.iter().find(|control| control.name == name);
            known.cloned().ok_or_else(|| {
                InputError::new(
                    &self.name,
                    format!("there is no column {name}, on which the force depends"),
                    format!("add a column {name}; one value in all rows will do"),
                )
            })
        };
        let arranged = names.into_iter().map(named);
        self.controls = arranged.collect::<Result<_, InputError>>()?;
        Ok(())
    }

    /// The recording with one more comment line, written after a `#`.
    #[must_use]
    pub fn with_comment(mut self, comment: impl Into<String>) -> Self {
        self.comments.push(comment.into());
        self
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there are no samples; never true for a constructed recording.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Text of the comment `key: text`, for keys such as `specimen` or `device`.
    pub fn declared(&self, key: &str) -> Option<&str> {
        let of_key = |comment| declaration(comment, key);
        self.comments.iter().map(String::as_str).find_map(of_key)
    }

    /// Rejects a recording with fewer than `samples` samples, for a computation that needs that many.
    ///
    /// # Errors
    /// The recording's name, its number of samples and the number needed.
    pub fn require_samples(&self, samples: usize) -> Result<(), InputError> {
        if self.len() >= samples {
            return Ok(());
        }
        Err(InputError::new(
            &self.name,
            format!("holds only {}", counted(self.len())),
            format!("record at least {samples}"),
        ))
    }

    /// The line of sample `index` in a text, its number in another file, or `index` + 1 without a file.
    fn line(&self, index: usize) -> u64 {
        self.lines.line(index).unwrap_or(index as u64 + 1)
    }

    /// The recording without what follows its first `samples`.
    #[must_use]
    pub fn first(mut self, samples: usize) -> Self {
        let is_kept: Vec<bool> = (0..self.len()).map(|index| index < samples).collect();
        self.keep(&is_kept);
        self
    }

    /// Keeps the samples that `is_kept`, with their rows of the file.
    fn keep(&mut self, is_kept: &[bool]) {
        let controls = self.controls.iter_mut().map(|control| &mut control.values);
        let channels = [&mut self.time, &mut self.displacement, &mut self.force];
        let optional = self.velocity.iter_mut().chain(&mut self.temperature);
        for values in channels.into_iter().chain(optional).chain(controls) {
            let mut is_kept = is_kept.iter();
            values.retain(|_| *is_kept.next().unwrap_or(&false));
        }
        self.lines.keep(is_kept);
        if let Some(source) = &mut self.source {
            source.rows.keep(source.header.len(), is_kept);
        }
    }

    /// Checks the invariants in the type's documentation.
    fn check(&self) -> Result<(), InputError> {
        if self.is_empty() {
            return Err(InputError::new(
                &self.name,
                "holds no samples",
                "write the samples below the header",
            ));
        }
        self.require_samples(FEWEST_SAMPLES)?;
        let channels = [
            ("time", Some(&self.time)),
            ("displacement", Some(&self.displacement)),
            ("force", Some(&self.force)),
            ("velocity", self.velocity.as_ref()),
            ("temperature", self.temperature.as_ref()),
        ];
        let channels = channels
            .into_iter()
            .filter_map(|(name, channel)| Some((name, channel?)));
        let controls = self.controls.iter();
        let controls = controls.map(|control| (control.name.as_str(), &control.values));
        for (name, channel) in channels.chain(controls) {
            if channel.len() != self.len() {
                return Err(InputError::new(
                    &self.name,
                    format!("{} samples for {} of time", channel.len(), self.len()),
                    "give every channel the same number of samples",
                )
                .at(Place::Column(name.into())));
            }
            if let Some(index) = channel.iter().position(|value| !value.is_finite()) {
                return Err(InputError::new(
                    &self.name,
                    "the value is not finite",
                    "remove the row or correct the value",
                )
                .at(self.lines.place(index, Some(name))));
            }
        }
        self.check_time()?;
        let first = self.displacement[0];
        if self.displacement.iter().all(|&value| value == first) {
            return Err(InputError::new(
                &self.name,
                "the displacement never changes, so that it says nothing about the force law",
                "record a motion, or check that the displacement sensor is connected",
            )
            .at(Place::Column("displacement".into())));
        }
        Ok(())
    }

    fn check_time(&self) -> Result<(), InputError> {
        let Some(index) = self.time.windows(2).position(|pair| pair[1] <= pair[0]) else {
            return Ok(());
        };
        let (before, after) = (self.time[index], self.time[index + 1]);
        let (how, remedy) = if after == before {
            (
                "stands still",
                "write time with more decimals, or give the sampling rate with --rate HZ, which counts every row",
            )
        } else {
            (
                "runs backwards",
                "write recordings of several tests into several files; if the clock was set here, correct the times, or give the sampling \
                 rate with --rate HZ, which takes the rows in their order",
            )
        };
        Err(InputError::new(
            &self.name,
            format!("time {how}: {} s after {} s", plain(after), plain(before)),
            remedy,
        )
        .at(self.lines.place(index + 1, None)))
    }
}

/// The text of the comment `key: text`; `None` for a comment with another key.
fn declaration<'c>(comment: &'c str, key: &str) -> Option<&'c str> {
    let (name, text) = comment.split_once(':')?;
    name.trim().eq_ignore_ascii_case(key).then(|| text.trim())
}

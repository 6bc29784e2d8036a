//! `hil run --drive`: a motion for the rig to follow, and the quality of the following.

use std::path::PathBuf;

use clap::Args;
use mesh_damper_output::error::{InputError, Place};
use mesh_damper_recording::Recording;
use mesh_damper_rig::drive::limits::{Demands, checked};
use mesh_damper_rig::drive::{Grid, Motion, RandomMotion, recorded};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{RigRun, RigSetup};
use schemars::JsonSchema;
use serde::Serialize;

use super::programme::LONGEST;
use super::run::refused;
use crate::commands::reading::{RecordingFiles, say_guesses};
use crate::commands::say;

/// The prefix of a random motion; any other text is a file.
const RANDOM: &str = "random:";

/// The motion that a rig follows instead of blocks.
#[derive(Args, Debug)]
pub struct DriveOptions {
    /// Follow this motion instead of blocks: a recording, or a random motion
    ///
    /// A recording needs times and displacements only. A random motion is written as
    /// random:rms=0.1mm,from=0.5Hz,to=20Hz,duration=30s,seed=1.
    #[arg(long, value_name = "REC|random:…", conflicts_with_all = ["blocks", "programme"])]
    drive: Option<String>,
    /// Multiply the motion of --drive by this factor, not 0
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, requires = "drive")]
    scale: f64,
    /// Add this to the recorded displacement before scaling, mm
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 0.0,
        requires = "drive",
        allow_negative_numbers = true
    )]
    shift: f64,
}

/// A motion and its source.
pub struct Driven {
    pub motion: Motion,
    source: String,
    scale: f64,
    shift: f64,
    /// RMS, mm
    left_out: f64,
}

/// How well a rig followed a motion. Units are in the names.
#[derive(JsonSchema, Serialize)]
pub struct Followed {
    /// The file, or the description of the random motion.
    source: String,
    /// The factor by which the recorded displacement was multiplied.
    scale: f64,
    /// Offset subtracted from the recorded displacement, mm.
    shift_mm: f64,
    /// Duration with the ramps, s.
    duration_s: f64,
    /// Duration of the ramp from rest to the beginning of the motion, s.
    ramp_in_s: f64,
    /// Duration of the ramp from the end of the motion to rest, s.
    ramp_out_s: f64,
    /// RMS of the displacement, without the ramps, mm.
    rms_mm: f64,
    /// RMS of the part of the recorded displacement that is treated as noise and not followed, mm.
    left_out_rms_mm: f64,
    /// The demands of the motion on the rig, as computed before the run.
    asked: Demands,
    /// RMS of the difference between measured and demanded displacement, mm.
    following_error_rms_mm: f64,
    /// RMS of the law's error over the RMS of the measured force, over the whole recording; null without a measured force.
    law_nrmse: Option<f64>,
}

impl Followed {
    /// The file, or the description of the random motion.
    pub fn source(&self) -> &str {
        &self.source
    }
}

impl DriveOptions {
    /// Whether a motion is given, so that the blocks do not count.
    pub fn is_given(&self) -> bool {
        self.drive.is_some()
    }

    /// The file from which the motion is read.
    pub fn file(&self) -> Option<PathBuf> {
        let drive = self.drive.as_ref()?;
        (!drive.starts_with(RANDOM)).then(|| PathBuf::from(drive))
    }

    /// The motion at `tick_rate` Hz, if one is given.
    ///
    /// # Errors
    /// A file that cannot be read, a random motion that is not possible, an invalid scale or shift, a motion that is too long.
    pub fn motion(
        &self,
        files: &RecordingFiles,
        tick_rate: f64,
    ) -> Result<Option<Driven>, InputError> {
        let Some(drive) = &self.drive else {
            return Ok(None);
        };
        let option = |field: &str, problem: String, remedy: &str| {
            InputError::new("--drive", problem, remedy).at(Place::Field(field.into()))
        };
        // The grid of knots supports only these rates.
        if !(1.0..=1e6).contains(&tick_rate) {
            let problem = format!("{tick_rate} Hz is outside 1 to 1000000 Hz");
            return Err(option("--tick-rate", problem, "change it"));
        }
        if self.scale == 0.0 || !self.scale.is_finite() {
            let problem = format!("{} gives no motion", self.scale);
            return Err(option("--scale", problem, "give a number such as 0.8"));
        }
        let grid = Grid::at(tick_rate);
        let (motion, left_out) = match drive.strip_prefix(RANDOM) {
            Some(_) if self.shift != 0.0 => {
                let problem = "a random motion has no shift".to_owned();
                return Err(option("--shift", problem, "leave it out"));
            }
            Some(text) => {
                let mut random = RandomMotion::parse(text)?;
                random.rms *= self.scale.abs();
                (random.motion(grid)?, 0.0)
            }
            None => {
                let recording = Recording::read_motion(drive, &files.stated())?;
                say_guesses(recording.named_guesses());
                let recorded = recorded(&recording, self.scale, self.shift, grid)?;
                (recorded.motion, recorded.left_out)
            }
        };
        if motion.duration() > LONGEST {
            let problem = format!("the motion lasts {:.0} s", motion.duration());
            let remedy = format!("keep it below {LONGEST} s, or cut it into parts");
            return Err(InputError::new("--drive", problem, remedy));
        }
        Ok(Some(Driven {
            motion,
            source: drive.clone(),
            scale: self.scale,
            shift: self.shift,
            left_out,
        }))
    }
}

impl Driven {
    /// Amplitude of a sine with the same RMS, mm, for which the coefficients of a law are taken.
    pub fn amplitude(&self) -> f64 {
        2f64.sqrt() * self.motion.rms()
    }

    /// The comment on the motion in the recording of the run.
    pub fn comment(&self) -> String {
        let [ramp_in, ramp_out] = self.motion.ramps();
        format!(
            "excitation: {} times {}, shifted by {} mm; ramps of {ramp_in} s before it and {ramp_out} s after it",
            self.source, self.scale, self.shift
        )
    }

    /// The demands of the motion on the rig of `setup`.
    ///
    /// # Errors
    /// The limit that the motion exceeds.
    pub fn checked<const B: usize, const N: usize>(
        &self,
        setup: &RigSetup<Specimen, B, N>,
    ) -> Result<Demands, InputError> {
        checked(setup, self.scale).map_err(|error| {
            let mut refused = refused(error);
            refused.source_name = format!("--drive {}", self.source);
            refused
        })
    }

    /// How well `run` followed the motion.
    pub fn followed(&self, run: &RigRun, asked: Demands) -> Followed {
        let samples = &run.samples;
        let rms = |values: &mut dyn Iterator<Item = f64>| {
            let (squares, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
            f64::sqrt(squares / f64::max(count, 1.0))
        };
        let moved = samples.time.iter().zip(&samples.displacement);
        let forces = samples.model_force.iter().zip(&samples.force);
        let force = rms(&mut samples.force.iter().copied());
        let [ramp_in_s, ramp_out_s] = self.motion.ramps();
        Followed {
            source: self.source.clone(),
            scale: self.scale,
            shift_mm: self.shift,
            duration_s: self.motion.duration(),
            ramp_in_s,
            ramp_out_s,
            rms_mm: self.motion.rms(),
            left_out_rms_mm: self.left_out,
            asked,
            following_error_rms_mm: rms(
                &mut moved.map(|(time, y)| y - self.motion.at(*time).displacement)
            ),
            law_nrmse: (force > 0.0).then(|| rms(&mut forces.map(|(law, f)| law - f)) / force),
        }
    }
}

impl Followed {
    /// Prints the results.
    pub fn print(&self) {
        say(&format!(
            "Motion: {:.4} mm RMS, at most {:.4} mm and {:.2} mm/s, over {:.2} s with ramps of {:.2} s before it and {:.2} s after",
            self.rms_mm,
            self.asked.displacement_mm,
            self.asked.velocity_mm_s,
            self.duration_s,
            self.ramp_in_s,
            self.ramp_out_s
        ));
        if self.left_out_rms_mm > 0.0 {
            say(&format!(
                "Noise of {:.6} mm RMS in the recorded displacement was removed and not followed",
                self.left_out_rms_mm
            ));
        }
        say(&format!(
            "Followed within {:.4} mm RMS, {:.1} % of the motion",
            self.following_error_rms_mm,
            100.0 * self.following_error_rms_mm / self.rms_mm
        ));
        if let Some(nrmse) = self.law_nrmse {
            say(&format!("Error of the law: {:.2} %", 100.0 * nrmse));
        }
    }
}

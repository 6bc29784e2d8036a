//! `hil run --drive`: a motion for the rig to follow, and how well it did.

use std::path::PathBuf;

use crate::commands::reading::{RecordingFiles, say_guesses};
use clap::Args;
use mesh_damper_recording::Recording;
use mesh_damper_recording::error::{InputError, Place};
use mesh_damper_rig::drive::limits::{Demands, checked};
use mesh_damper_rig::drive::{Grid, Motion, RandomMotion, recorded};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{RigRun, RigSetup};
use schemars::JsonSchema;
use serde::Serialize;

use super::programme::LONGEST;
use super::run::refused;
use crate::commands::say;

/// What a random motion begins with; anything else is a file.
const RANDOM: &str = "random:";

/// The motion that a rig is to follow in the place of blocks.
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

/// A motion, and where it came from.
pub struct Driven {
    pub motion: Motion,
    source: String,
    scale: f64,
    shift: f64,
    /// mm RMS
    left_out: f64,
}

/// How a rig followed a motion. Units are in the names.
#[derive(JsonSchema, Serialize)]
pub struct Followed {
    /// The file, or how the motion is drawn.
    source: String,
    /// What the recorded displacement was multiplied by, a factor.
    scale: f64,
    /// What was taken off it, mm.
    shift_mm: f64,
    /// With the ramps, s.
    duration_s: f64,
    /// From rest to its begin, s.
    ramp_in_s: f64,
    /// From its end to rest, s.
    ramp_out_s: f64,
    /// RMS of the displacement without the ramps, mm.
    rms_mm: f64,
    /// RMS of what was taken for noise in the recorded displacement and not followed, mm.
    left_out_rms_mm: f64,
    /// What it asked of the rig, as it was known before.
    asked: Demands,
    /// RMS of the measured displacement from the demanded one, mm.
    following_error_rms_mm: f64,
    /// RMS of the law's error over the RMS of the measured force, over all that was recorded; null without a force.
    law_nrmse: Option<f64>,
}

impl Followed {
    /// The file, or how the motion is drawn.
    pub fn source(&self) -> &str {
        &self.source
    }
}

impl DriveOptions {
    /// Whether there is a motion, and the blocks do not count.
    pub fn is_given(&self) -> bool {
        self.drive.is_some()
    }

    /// The file that it is read from.
    pub fn file(&self) -> Option<PathBuf> {
        let drive = self.drive.as_ref()?;
        (!drive.starts_with(RANDOM)).then(|| PathBuf::from(drive))
    }

    /// The motion at `tick_rate` Hz, where there is one.
    ///
    /// # Errors
    /// A file that cannot be read, a random motion that cannot be, a scale or shift that is none, a motion too long.
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
        // What a grid is not made for.
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
                let recording = Recording::read_motion(drive, &files.said())?;
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
    /// The amplitude of a sine of the same RMS, mm: that for which a law's coefficients are taken.
    pub fn amplitude(&self) -> f64 {
        2f64.sqrt() * self.motion.rms()
    }

    /// What is said of it in the run's recording.
    pub fn comment(&self) -> String {
        let [ramp_in, ramp_out] = self.motion.ramps();
        format!(
            "excitation: {} times {}, shifted by {} mm; ramps of {ramp_in} s before it and {ramp_out} s after it",
            self.source, self.scale, self.shift
        )
    }

    /// What it asks of the rig of `setup`.
    ///
    /// # Errors
    /// The limit that it exceeds.
    pub fn checked<const B: usize, const N: usize>(
        &self,
        setup: &RigSetup<Specimen, B, N>,
    ) -> Result<Demands, InputError> {
        checked(setup, self.scale).map_err(|error| InputError {
            source_name: format!("--drive {}", self.source),
            ..refused(error)
        })
    }

    /// How `run` followed it.
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
    /// Prints it.
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

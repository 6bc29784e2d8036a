//! `hil respond --sweep`: transmissibility over frequency and amplitude.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_model::extrapolation::Extrapolation;
use mesh_damper_model::file::{Elsewhere, FittedRange, ModelFile};
use mesh_damper_model::respond::{Settings, Sweep, SweepPoint, SweepRange, sweep};
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_report::transmissibility::picture;
use mesh_damper_tables::read_limit::ReadLimit;
use mesh_damper_tables::write::{WriteAs, table};
use serde::Serialize;

use super::controls::Controls;
use super::respond::{say_how_far_to_trust, warn_of_left_out, warn_of_range};
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::{Failure, say, warn};

/// The sines of a sweep.
#[derive(Args, Debug)]
pub struct SweepOptions {
    /// Amplitudes of the base in mm, 1e-9 to 10000
    #[arg(
        long,
        value_name = "MM,…",
        value_delimiter = ',',
        requires = "sweep",
        allow_negative_numbers = true
    )]
    amplitudes: Vec<f64>,
    /// First frequency in Hz, 0.001 to 100000
    #[arg(
        long,
        value_name = "HZ",
        requires = "sweep",
        allow_negative_numbers = true
    )]
    from: Option<f64>,
    /// Last frequency in Hz, above --from and at most 100000
    #[arg(
        long,
        value_name = "HZ",
        requires = "sweep",
        allow_negative_numbers = true
    )]
    to: Option<f64>,
    /// Number of frequencies, 2 to 10000, evenly spaced in octaves
    #[arg(long, value_name = "N", default_value_t = 60)]
    points: usize,
    /// File for the picture, SVG
    #[arg(long, value_name = "FILE", requires = "sweep")]
    picture: Option<PathBuf>,
}

/// The transmissibility of a damper with a mass over frequency and amplitude.
#[derive(Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
pub(in crate::commands) struct Summary<'a> {
    /// Path of the model.
    model: &'a Path,
    /// Mass on the damper, kg.
    mass: f64,
    /// Largest excess of a motion over the operating range, as a fraction of the range.
    beyond_fitted_range: f64,
    /// The fraction of the points outside the operating range, and their distance from it.
    outside_operating_range: Extrapolation,
    /// The error of the model's force on motions that were left out of its fit; null if the model file does not hold it.
    elsewhere: Option<Elsewhere>,
    #[serde(flatten)]
    sweep: &'a Sweep,
}

impl SweepOptions {
    /// Runs the sweep for the model in a file that is read within a limit, and adds CSV and JSON to `outputs`.
    pub fn run(
        &self,
        (model, limit): (&Path, ReadLimit),
        (settings, controls): (&Settings, &Controls),
        (out, json): (&Path, Option<&Path>),
    ) -> Result<(), Failure> {
        let mut outputs = Plan::new()
            .reads([model])
            .writes([out])
            .writes(json)
            .writes(&self.picture)
            .begin()?;
        WriteAs::of(out)?;
        let file = ModelFile::read_within(model, limit)?;
        let range = SweepRange {
            // The parser requires both.
            from: self.from.unwrap_or_default(),
            to: self.to.unwrap_or_default(),
            points: self.points,
        };
        let mut settings = *settings;
        let held = controls.of(&file.model(), (&model.display().to_string(), &[]), 1)?;
        for (place, control) in settings.controls.iter_mut().zip(held) {
            *place = control.values[0];
        }
        let progress = Progress::of((self.points * self.amplitudes.len()) as u64);
        let found = sweep(
            &file.model(),
            &settings,
            &self.amplitudes,
            range,
            &mut |done| progress.done(done as u64),
        )
        .map_err(|error| error.about(&model.display().to_string()))?;
        drop(progress);

        warn_of_left_out(model, &found.left_out);
        let unsteady = found.points.iter().filter(|point| !point.steady).count();
        if unsteady > 0 {
            warn(&format!(
                "{unsteady} of {} motions do not repeat from cycle to cycle: their transmissibility is that of the last cycle",
                found.points.len()
            ));
        }
        let motions = found.points.iter().map(|point| FittedRange {
            displacement: [-point.damper_amplitude, point.damper_amplitude],
            velocity: [-point.damper_speed, point.damper_speed],
        });
        let outside = Extrapolation::of_motions(&file.fitted_range(), motions);
        warn_of_range(model, &outside, "motions");
        outputs.add(out, to_file(out, &found.points)?);
        if let Some(path) = &self.picture {
            outputs.add(path, picture(&found.points));
        }
        if let Some(path) = json {
            let summary = Summary {
                model,
                mass: settings.mass,
                beyond_fitted_range: outside.most(),
                outside_operating_range: outside,
                elsewhere: file.elsewhere(),
                sweep: &found,
            };
            outputs.add_document(path, &summary)?;
        }
        outputs.write()?;
        if ![Some(out), json, self.picture.as_deref()].contains(&Some(Path::new("-"))) {
            print(&found.points);
            say_how_far_to_trust(file.elsewhere().as_ref());
        }
        Ok(())
    }
}

fn to_file(out: &Path, points: &[SweepPoint]) -> Result<Vec<u8>, InputError> {
    let of = |value: fn(&SweepPoint) -> f64| points.iter().map(value).collect();
    table(
        out,
        &[],
        &[
            ("base_amplitude_mm", of(|p| p.base_amplitude)),
            ("frequency_Hz", of(|p| p.frequency)),
            ("transmissibility", of(|p| p.transmissibility)),
            ("phase_deg", of(|p| p.phase)),
            ("peak_transmissibility", of(|p| p.peak)),
            ("damper_amplitude_mm", of(|p| p.damper_amplitude)),
            ("cycles", of(|p| p.cycles as f64)),
            ("steady", of(|p| f64::from(u8::from(p.steady)))),
            ("change_on_halving", of(|p| p.change)),
        ],
    )
}

/// Prints, for each amplitude, the largest transmissibility and the frequency above which the mass moves less than the base.
fn print(points: &[SweepPoint]) {
    say("base, mm   largest   at, Hz   below 1 from, Hz   steps' change");
    for curve in points.chunk_by(|a, b| a.base_amplitude == b.base_amplitude) {
        let largest = curve
            .iter()
            .max_by(|a, b| a.transmissibility.total_cmp(&b.transmissibility));
        let isolating = curve
            .iter()
            .rev()
            .take_while(|point| point.transmissibility < 1.0)
            .last();
        let change = curve.iter().fold(0.0, |most: f64, p| most.max(p.change));
        if let Some(largest) = largest {
            say(&format!(
                "{:8.4} {:9.3} {:8.2} {:>18} {:15.1e}",
                largest.base_amplitude,
                largest.transmissibility,
                largest.frequency,
                isolating.map_or("nowhere".into(), |point| format!("{:.2}", point.frequency)),
                change
            ));
        }
    }
}

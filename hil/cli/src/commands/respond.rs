//! `hil respond`: the motion of a mass on a damper.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_model::extrapolation::Extrapolation;
use mesh_damper_model::file::{Elsewhere, ModelFile};
use mesh_damper_model::respond::{
    EnergyBalance, Excitation, LeftOut, Moment, Response, Settings, respond,
};
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_recording::input::InputSignal;
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::write::{WriteAs, table};
use serde::Serialize;

use super::controls::Controls;
use super::respond_sweep::SweepOptions;
use crate::commands::document::AddDocument as _;
use crate::commands::reading::{RecordingFiles, say_guesses};
use crate::commands::{Failure, say, warn};

/// Largest fraction of noise in the velocity of a base without a warning to smooth it. The damper's friction would follow the
/// noise.
const NOISY: f64 = 0.1;

/// Compute the motion of a mass on a damper, under a force or on a moving base
///
/// Integrates M·x'' + F(x − base) = force, where F is the force of a model. Writes displacement, velocity and force of the damper, which
/// `hil trace` reads as a recording, and displacement, velocity and acceleration of the mass. With --sweep, the base moves by sines and
/// the command writes the transmissibility.
///
/// A model with the effect `inertia` has its own mass, which is added to --mass; --mass 0 uses that mass alone.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  hil demo --seed 4\n  \
    hil respond --model demo-out/model.json --mass 500 \\\n      \
    --base demo-out/recording.csv.gz --out response.csv\n  \
    hil respond --model demo-out/model.json --mass 500 --sweep \\\n      \
    --amplitudes 0.05,0.1 --from 5 --to 80 --points 20 \\\n      \
    --out sweep.csv --picture sweep.svg")]
pub struct RespondCommand {
    /// The model, a model.json of `hil trace`
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Mass on the damper, kg
    #[arg(long, value_name = "KG", allow_negative_numbers = true)]
    mass: f64,
    /// Force on the mass: a recording with time and force
    #[arg(long, value_name = "REC", required_unless_present_any = ["base", "sweep"], conflicts_with_all = ["base", "sweep"])]
    force: Option<PathBuf>,
    /// Motion of the base: a recording with time and displacement
    #[arg(long, value_name = "REC", conflicts_with = "sweep")]
    base: Option<PathBuf>,
    /// Compute the transmissibility: the base moves by sines, each until the motion is steady
    #[arg(long, requires_all = ["amplitudes", "from", "to"])]
    sweep: bool,
    #[command(flatten)]
    range: SweepOptions,
    /// Apply the model's constant force (`offset`) to the mass; by default a static load balances it
    #[arg(long)]
    with_offset: bool,
    /// Halve the time step until displacements change by less than this part of their RMS, 1e-12 to 1
    #[arg(long, value_name = "PART", default_value_t = Settings::TOLERANCE, allow_negative_numbers = true, conflicts_with = "sweep")]
    tolerance: f64,
    /// File for the motion or the sweep: .csv, .csv.gz, .parquet, .mat or .mcap; `-` is standard output, as CSV
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Write peaks, RMS values, energies and steps, or the sweep, as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    controls: Controls,
    #[command(flatten)]
    files: RecordingFiles,
}

/// The excitation of the mass.
#[derive(Clone, Copy, Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
enum Drive {
    /// A force on the mass.
    Force,
    /// The motion of the base.
    Base,
}

/// The motion of a mass on a damper.
#[derive(Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
pub(in crate::commands) struct Summary<'a> {
    /// Path of the model.
    model: &'a Path,
    /// Path of the recording with the force or the motion.
    excitation: &'a Path,
    /// The excitation of the mass.
    drive: Drive,
    /// Mass on the damper, kg.
    mass: f64,
    /// Mass of the model's effect `inertia`, kg.
    model_mass: f64,
    /// Number of samples of the motion.
    samples: usize,
    /// Duration from the first sample to the last, s.
    duration: f64,
    /// Time step of the integration, s.
    step: f64,
    /// RMS of the change of the displacements over their RMS, when the steps were halved last.
    change_on_halving: f64,
    /// Whether that change is smaller than `--tolerance`.
    settled: bool,
    /// Displacement of the mass, mm.
    displacement: Size,
    /// Velocity of the mass, mm/s.
    velocity: Size,
    /// Acceleration of the mass, mm/s².
    acceleration: Size,
    /// Displacement of the damper, mm.
    relative_displacement: Size,
    /// Force of the damper, kN.
    force: Size,
    /// Energy balance, J.
    energy: EnergyBalance,
    /// Excess of the motion over the operating range, as a fraction of the range.
    beyond_fitted_range: f64,
    /// The fraction of the samples outside the operating range, and their distance from it.
    outside_operating_range: Extrapolation,
    /// The error of the model's force on motions that were left out of its fit; null if the model file does not hold it.
    elsewhere: Option<Elsewhere>,
    /// Effects of the model that the integration leaves out or treats differently.
    left_out: &'a [LeftOut],
}

/// Size of a channel.
#[derive(Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
struct Size {
    /// Largest magnitude, in the unit of the channel.
    peak: f64,
    /// Root mean square, in the unit of the channel.
    rms: f64,
}

impl Size {
    fn of(moments: &[Moment], channel: impl Fn(&Moment) -> f64) -> Self {
        let squares: f64 = moments.iter().map(|m| channel(m).powi(2)).sum();
        Self {
            peak: moments
                .iter()
                .fold(0.0, |most, m| channel(m).abs().max(most)),
            rms: (squares / moments.len() as f64).sqrt(),
        }
    }
}

impl RespondCommand {
    pub fn run(self) -> Result<(), Failure> {
        let settings = Settings {
            offset: self.with_offset,
            tolerance: self.tolerance,
            ..Settings::new(self.mass)
        };
        let (path, drive) = match (&self.force, &self.base) {
            (Some(path), _) => (path, Drive::Force),
            (_, Some(path)) => (path, Drive::Base),
            _ => {
                return self.range.run(
                    (&self.model, self.files.reading.limit),
                    (&settings, &self.controls),
                    (&self.out, self.json.as_deref()),
                );
            }
        };
        let mut outputs = Plan::new()
            .reads([&self.model, path])
            .writes([&self.out])
            .writes(&self.json)
            .begin()?;
        WriteAs::of(&self.out)?;
        let file = ModelFile::read_within(&self.model, self.files.reading.limit)?;
        let channel = match drive {
            Drive::Force => Channel::Force,
            Drive::Base => Channel::Displacement,
        };
        let input = InputSignal::read(path, channel, &self.files.stated())?;
        say_guesses(
            input
                .guesses
                .iter()
                .map(|guess| format!("{}: {guess}", input.name)),
        );
        let excitation = match drive {
            Drive::Force => Excitation::force(input.tick, input.values.clone()),
            Drive::Base => Excitation::base(input.tick, input.values.clone()),
        }
        .with_temperature(input.temperature.clone());
        let model = file.model();
        let known = (input.name.as_str(), input.controls.as_slice());
        let controls = self.controls.of(&model, known, input.values.len())?;
        let excitation =
            excitation.with_controls(controls.into_iter().map(|each| each.values).collect());
        let response = respond(&model, &excitation, &settings)
            .map_err(|error| error.about(&self.model.display().to_string()))?;

        warn_of_input(&input, drive);
        if input.temperature.is_none() && model.depends_on_temperature() {
            warn(&format!(
                "{} depends on temperature, and {} has none: room temperature is assumed",
                self.model.display(),
                input.name
            ));
        }
        warn_of_left_out(&self.model, &response.left_out);
        if !response.settled {
            warn(&format!(
                "displacements still change by {:.2} % if the time step of {:.1e} s is halved: the motion may depend on the time step",
                100.0 * response.change,
                2.0 * response.step
            ));
        }
        let outside = response.extrapolation(&file.fitted_range());
        warn_of_range(&self.model, &outside, "samples");
        let moments = &response.moments;
        let summary = Summary {
            model: &self.model,
            excitation: path,
            drive,
            mass: self.mass,
            model_mass: response.model_mass,
            samples: moments.len(),
            duration: response.tick * (moments.len() - 1) as f64,
            step: response.step,
            change_on_halving: response.change,
            settled: response.settled,
            displacement: Size::of(moments, |m| m.displacement),
            velocity: Size::of(moments, |m| m.velocity),
            acceleration: Size::of(moments, |m| m.acceleration),
            relative_displacement: Size::of(moments, |m| m.relative_displacement),
            force: Size::of(moments, |m| m.force),
            energy: response.energy,
            beyond_fitted_range: outside.most(),
            outside_operating_range: outside,
            elsewhere: file.elsewhere(),
            left_out: &response.left_out,
        };
        outputs.add(&self.out, to_file(&self.out, &input, drive, &response)?);
        outputs.add_document_if(&self.json, &summary)?;
        outputs.write()?;
        if ![Some(&self.out), self.json.as_ref()].contains(&Some(&PathBuf::from("-"))) {
            print(&self.out, &summary);
        }
        Ok(())
    }
}

/// Writes the damper's motion and force in the columns of a recording, and the motion of the mass in further columns.
fn to_file(
    out: &Path,
    input: &InputSignal,
    drive: Drive,
    response: &Response,
) -> Result<Vec<u8>, InputError> {
    let of = |channel: fn(&Moment) -> f64| response.moments.iter().map(channel).collect();
    let driving = match drive {
        Drive::Force => "applied_force_kN",
        Drive::Base => "base_displacement_mm",
    };
    let time = (0..response.moments.len()).map(|index| input.start + index as f64 * input.tick);
    let comments =
        ["displacement, velocity and force of the damper, as its sensors would measure them"];
    table(
        out,
        &comments.map(String::from),
        &[
            ("time_s", time.collect()),
            ("displacement_mm", of(|m| m.relative_displacement)),
            ("velocity_mm_s", of(|m| m.relative_velocity)),
            ("force_kN", of(|m| m.force)),
            ("mass_displacement_mm", of(|m| m.displacement)),
            ("mass_velocity_mm_s", of(|m| m.velocity)),
            ("mass_acceleration_mm_s2", of(|m| m.acceleration)),
            (driving, input.values.clone()),
        ],
    )
}

fn print(out: &Path, summary: &Summary<'_>) {
    let energy = &summary.energy;
    say(&format!(
        "{}: {} samples, {:.3} s in steps of {:.2e} s",
        out.display(),
        summary.samples,
        summary.duration,
        summary.step
    ));
    say("                           peak          RMS");
    for (name, size, unit) in [
        ("mass", &summary.displacement, "mm"),
        ("mass, velocity", &summary.velocity, "mm/s"),
        ("mass, acceleration", &summary.acceleration, "mm/s²"),
        ("damper", &summary.relative_displacement, "mm"),
        ("damper, force", &summary.force, "kN"),
    ] {
        say(&format!(
            "{name:18} {:12.5} {:12.5} {unit}",
            size.peak, size.rms
        ));
    }
    say(&format!(
        "Energy, J: input {:.5} = kinetic {:.5} + springs {:.5} + dissipated {:.5} + error of the steps {:.1e}",
        energy.input, energy.kinetic, energy.elastic, energy.dissipated, energy.residual
    ));
    say_how_far_to_trust(summary.elsewhere.as_ref());
}

/// How large an error of the force is to be expected.
pub fn say_how_far_to_trust(elsewhere: Option<&Elsewhere>) {
    if let Some(Elsewhere { conditions, most }) = elsewhere {
        say(&format!(
            "Nine of ten errors of the model's force are expected within {:.2} % of its RMS, by {conditions} conditions left out of the fit",
            100.0 * most
        ));
    }
}

fn warn_of_input(input: &InputSignal, drive: Drive) {
    if let Some(warning) = &input.warning {
        warn(&format!("{}: {warning}", input.name));
    }
    let noise = input.noise_of_rate();
    if matches!(drive, Drive::Base) && noise > NOISY {
        warn(&format!(
            "{}: {:.0} % of the base's velocity looks like noise, and the friction of the damper responds to it: smooth the displacement first",
            input.name,
            100.0 * noise.min(1.0)
        ));
    }
}

pub fn warn_of_left_out(model: &Path, left_out: &[LeftOut]) {
    for LeftOut { family, reason } in left_out {
        warn(&format!("{}: {family}: {reason}", model.display()));
    }
}

/// Warns of `samples` beyond the operating range of the model in a file.
pub fn warn_of_range(model: &Path, outside: &Extrapolation, samples: &str) {
    if let Some(words) = outside.in_words(samples, &model.display().to_string()) {
        warn(&words);
    }
}

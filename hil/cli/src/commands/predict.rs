//! `hil predict`: the force of a model for the motion of a recording.

use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use mesh_damper_model::extrapolation::{Extrapolation, percent};
use mesh_damper_model::file::{Elsewhere, ModelFile, model_error};
use mesh_damper_model::predict::{band, nrmse, predict, predict_embedded, whole_band};
use mesh_damper_output::Plan;
use mesh_damper_recording::Recording;
use mesh_damper_recording::faults::ScalePolicy;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::write::Prediction;
use mesh_damper_tables::write::WriteAs;
use serde::{Serialize, Serializer};

use super::controls::Controls;
#[cfg(feature = "full")]
use super::full::predict_on::{Link, LogLevel};
use super::respond::warn_of_range;
use crate::commands::document::AddDocument as _;
use crate::commands::reading::{RecordingFiles, say_guesses};
use crate::commands::{Failure, say, warn};

/// Predict the force for a recording's motion with a model
///
/// Writes the rows of the recording and three more columns: predicted_force_UNIT and predicted_band_UNIT in the recording's unit, and
/// predicted_beyond. The band is half the width of the interval that holds the force in nine of ten cases, by the model's errors on motions
/// left out of its fit and by the noise of the displacement. The third column says how far the motion is beyond the range that the model
/// was fitted on, as a fraction of that range; there the band is not known.
/// The recording may lack a force: then no error is computed.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  hil demo --seed 4\n  \
    hil predict --model demo-out/model.json demo-out/recording.csv.gz \\\n      \
    --out prediction.csv")]
pub struct Predict {
    /// Recording that gives the motion
    #[arg(value_name = "REC")]
    recording: PathBuf,
    /// The model, a model.json of `hil trace`
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Where the law is evaluated
    ///
    /// `f64`: in double precision, as it was fitted. `f32`: the embedded law at the recording's rate. `image`: the same in the firmware
    /// image, in an emulator. `serial:PORT`: the same on a board. These two need a build with the feature `full`, as `cargo hil` has it.
    #[arg(long, value_name = "PLACE", default_value_t = On::F32)]
    on: On,
    /// Print log messages of the image from this level on
    #[cfg(feature = "full")]
    #[arg(long, value_enum, value_name = "LEVEL", default_value_t = LogLevel::Warn)]
    log: LogLevel,
    /// File for the prediction: .csv, .csv.gz, .parquet, .mat or .mcap; `-` is standard output, as CSV
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Write the error and its inputs as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the motion given to the law and its force as JSON, exact to the last bit; `-` is standard output
    #[arg(long, value_name = "FILE")]
    motion: Option<PathBuf>,
    #[command(flatten)]
    controls: Controls,
    #[command(flatten)]
    files: RecordingFiles,
}

#[derive(Clone, Debug, PartialEq)]
enum On {
    /// In double precision, as the law was fitted.
    F64,
    /// The embedded law at the rate of the recording.
    F32,
    /// The embedded law in the firmware's image, in an emulator or on a board.
    #[cfg(feature = "full")]
    Linked(Link),
}

impl FromStr for On {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "f64" => Ok(Self::F64),
            "f32" => Ok(Self::F32),
            #[cfg(feature = "full")]
            _ => text.parse().map(Self::Linked).map_err(|_| {
                "give f64, f32, image or serial:PORT, such as serial:/dev/ttyACM0".into()
            }),
            #[cfg(not(feature = "full"))]
            _ => Err(
                "give f64 or f32; an image and a board need a build with --features full".into(),
            ),
        }
    }
}

impl Display for On {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::F64 => f.write_str("f64"),
            Self::F32 => f.write_str("f32"),
            #[cfg(feature = "full")]
            Self::Linked(link) => link.fmt(f),
        }
    }
}

#[cfg(feature = "full")]
impl schemars::JsonSchema for On {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "On".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({"type": "string", "description": "Where the law was evaluated: `f64`, `f32`, `image` or `serial:PORT`."})
    }
}

impl Serialize for On {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The error of a model's force over a recording.
#[derive(Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
pub(in crate::commands) struct Summary<'a> {
    /// Path of the model.
    model: &'a Path,
    /// Path of the recording that gives the motion.
    recording: &'a Path,
    /// Where the law was evaluated.
    on: On,
    /// Number of samples in the recording.
    samples: usize,
    /// RMS of the error over the RMS of the measured force; null if no force was measured.
    nrmse: Option<f64>,
    /// RMS of the band's half width over the RMS of the measured force, or of the predicted force if no force was measured.
    band: f64,
    /// The part of the band that is due to displacement noise, in the same way.
    band_of_noise: f64,
    /// The error of the model on motions that were left out of its fit; null if the model file does not hold it.
    elsewhere: Option<Elsewhere>,
    /// Excess of the motion over the operating range, as a fraction of the range.
    beyond_fitted_range: f64,
    /// The fraction of the samples outside the operating range, and their distance from it, in displacement and velocity.
    outside_operating_range: Extrapolation,
}

/// The motion that the law was given at each sample of the uniform time base, and its force.
#[derive(Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
pub(in crate::commands) struct LawMotion<'a> {
    /// Where the law was evaluated.
    on: On,
    /// Time between two samples, s.
    tick: f64,
    /// Displacement of each sample, mm.
    displacement: &'a [f64],
    /// Velocity of each sample, mm/s.
    velocity: &'a [f64],
    /// Acceleration of each sample, mm/s².
    acceleration: &'a [f64],
    /// Amplitude of the cycle of each sample, mm.
    amplitude: &'a [f64],
    /// Number of cycles since the beginning of the recording.
    cycles: &'a [f64],
    /// Temperature of each sample, °C.
    temperature: Vec<f64>,
    /// Control inputs in the order of the model.
    controls: Vec<Input<'a>>,
    /// Force of the law, kN.
    force: &'a [f64],
}

/// A control input.
#[derive(Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
struct Input<'a> {
    /// Name of the input with its unit, for example `current_A`.
    name: &'a str,
    /// Value of each sample, in the unit of the name.
    values: &'a [f64],
}

impl Summary<'_> {
    /// How large an error is to be expected.
    fn trust(&self) -> String {
        let noise = 100.0 * self.band_of_noise;
        match &self.elsewhere {
            Some(Elsewhere { conditions, .. }) => format!(
                "nine of ten errors are expected within {:.2} %, by {conditions} conditions left out of the fit and by the displacement's \
                 noise, {noise:.2} %",
                100.0 * self.band
            ),
            None => format!(
                "the model's own error is unknown; displacement noise may cause up to {noise:.2} %"
            ),
        }
    }
}

impl<'a> LawMotion<'a> {
    fn new(on: On, trajectory: &'a Trajectory, force: &'a [f64]) -> Self {
        let motion = &trajectory.motion;
        let temperature = (0..trajectory.len()).map(|sample| trajectory.temperature_at(sample));
        let controls = trajectory.controls.iter().map(|channel| Input {
            name: &channel.name,
            values: &channel.values,
        });
        Self {
            on,
            tick: trajectory.tick,
            displacement: &motion.displacement,
            velocity: &motion.velocity,
            acceleration: &motion.acceleration,
            amplitude: &trajectory.amplitude,
            cycles: &trajectory.cycles,
            temperature: temperature.collect(),
            controls: controls.collect(),
            force,
        }
    }
}

impl Predict {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new()
            .reads([&self.model, &self.recording])
            .writes([&self.out])
            .writes(&self.json)
            .writes(&self.motion)
            .begin()?;
        WriteAs::of(&self.out)?;
        let file = ModelFile::read_within(&self.model, self.files.reading.limit)?;
        let (recording, no_force) =
            Recording::read_even_without_force(&self.recording, &self.files.stated())?;
        if let Some(error) = no_force {
            warn(&format!(
                "{}: predicted from the motion alone: {}",
                recording.name, error.problem
            ));
        }
        say_guesses(recording.named_guesses());
        // The same faults are repaired as in a trace, and the samples of held-out data there count.
        let mut repaired = recording.repaired();
        let model = file.model();
        let known = (recording.name.as_str(), repaired.controls.as_slice());
        let controls = self.controls.of(&model, known, repaired.len())?;
        if controls != repaired.controls {
            repaired.to_mut().controls = controls;
        }
        let uniform = repaired.uniform()?;
        let trajectory = Trajectory::of(&repaired)?;
        let wrong = |error| model_error(&self.model.display().to_string(), &error);
        let force = match &self.on {
            On::F64 => predict(&model, &trajectory).map_err(wrong)?,
            On::F32 => predict_embedded(&model, &trajectory).map_err(wrong)?,
            #[cfg(feature = "full")]
            On::Linked(link) => link.predict(self.log, &model, &trajectory, wrong)?,
        };
        let of_noise = band(&model, &trajectory).map_err(wrong)?;
        let elsewhere = file.elsewhere();
        let band: Vec<f64> = match &elsewhere {
            Some(elsewhere) => whole_band(&of_noise, elsewhere, &trajectory, &force),
            None => of_noise.clone(),
        };
        let motion = &trajectory.motion;
        let range = file.fitted_range();
        let samples = motion.displacement.iter().zip(&motion.velocity);
        let beyond: Vec<f64> = samples.map(|(&y, &v)| range.beyond(y, v)).collect();
        // A constant channel is no measured force.
        let is_measured = recording.force.iter().any(|f| *f != recording.force[0]);
        let error = is_measured.then(|| {
            nrmse(&force, &trajectory.force, |sample| {
                trajectory.measured[sample]
            })
        });
        if let Some(path) = &self.motion {
            outputs.add_document(path, &LawMotion::new(self.on.clone(), &trajectory, &force))?;
        }
        let [force, band, of_noise, beyond] =
            [force, band, of_noise, beyond].map(|values| uniform.at_samples_of(&repaired, &values));

        for fault in &trajectory.faults {
            warn(&format!("{}: {fault}", recording.name));
        }
        // As between the recordings of a trace.
        let apart = ScalePolicy::in_use().unit_apart;
        let ratio = rms(&repaired.force) / rms(&force);
        if error.is_some() && !(1.0 / apart..=apart).contains(&ratio) {
            warn(&format!(
                "{}: the measured force is {ratio:.1e} times the predicted one; check the units of its columns, and that displacement and \
                 force are not swapped",
                recording.name
            ));
        }
        let outside = Extrapolation::of(&range, &motion.displacement, &motion.velocity);
        warn_of_range(&self.model, &outside, "samples");
        if recording.temperature.is_none() && model.depends_on_temperature() {
            warn(&format!(
                "{} depends on temperature, and {} has none: {} °C is assumed",
                self.model.display(),
                recording.name,
                trajectory.temperature_at(0)
            ));
        }
        let shown = match error {
            Some(_) => rms(&repaired.force),
            None => rms(&force),
        };
        let part = |values: &[f64]| rms(values) / shown;
        let summary = Summary {
            model: &self.model,
            recording: &self.recording,
            on: self.on.clone(),
            samples: recording.len(),
            nrmse: error,
            band: part(&band),
            band_of_noise: part(&of_noise),
            elsewhere,
            beyond_fitted_range: outside.most(),
            outside_operating_range: outside,
        };
        outputs.add(
            &self.out,
            recording.to_file_with_prediction(
                &self.out,
                &Prediction {
                    force,
                    band,
                    beyond,
                },
            )?,
        );
        outputs.add_document_if(&self.json, &summary)?;
        outputs.write()?;
        let dash = Path::new("-");
        let is_free = |other: &Option<PathBuf>| other.as_deref() != Some(dash);
        if self.out != dash && is_free(&self.json) && is_free(&self.motion) {
            let error = match summary.nrmse {
                // Digits of a percentage would say nothing.
                Some(error) if error >= 10.0 => {
                    format!("error {error:.2e} times the measured force's RMS")
                }
                Some(error) => format!("error {:.2} % of the measured force's RMS", 100.0 * error),
                None => "no error, because no force was measured,".into(),
            };
            say(&format!(
                "{}: {error} over {} samples; {}",
                self.out.display(),
                summary.samples,
                summary.trust()
            ));
            say(&in_words(&summary.outside_operating_range));
        }
        Ok(())
    }
}

/// The fraction of the samples outside the operating range, and the largest distance from it.
fn in_words(outside: &Extrapolation) -> String {
    if outside.part > 0.0 {
        let most = outside.most();
        return format!(
            "outside the operating range: {} of the samples, by up to {most:.2} times the range",
            percent(outside.part)
        );
    }
    "outside the operating range: none of the samples".into()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

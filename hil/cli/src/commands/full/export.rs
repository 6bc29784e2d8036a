//! `hil export`: a model as firmware or a simulation takes it.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use mesh_damper::pack::NAME;
use mesh_damper_model::ModelError;
use mesh_damper_model::export::{Export, ExportError, ExportSettings, c_identifier, rust_module};
use mesh_damper_model::file::{ModelFile, model_error};
use mesh_damper_recording::error::{InputError, Place};
use mesh_damper_recording::output::Plan;
use serde::Serialize;

use super::export_fmu::{self, Unit};
use crate::commands::reading::Reading;
use crate::commands::{Failure, say, warn};

/// A model as others take it: a coefficient pack, a Rust module, a C header and source, or an FMU
///
/// All of them are the same law at one tick rate, and say for which tick rate and operating range it is, of which model, and which
/// revision. A law whose coefficients change with the amplitude is taken at the largest one that it was fitted at, or at --amplitude.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil export --model trace-out/model.json --format pack --tick-rate 10000 --out mount.mdcp\n  \
    hil export --model trace-out/model.json --format rust --tick-rate 10000 --out src/mount.rs\n  \
    hil export --model trace-out/model.json --format c --tick-rate 10000 --out mount.c\n  \
    hil export --model trace-out/model.json --format fmu --tick-rate 10000 --out mount.fmu"
)]
pub struct ExportCommand {
    /// The model, as `hil trace` writes it
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// What it becomes
    #[arg(long, value_enum)]
    format: Format,
    /// Ticks per second of the firmware, or evaluations of the law per second in an FMU, 1 to 1000000
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    tick_rate: f64,
    /// Where it goes, `-` for standard output; of C the name of header and source, with or without its ending
    #[arg(long, value_name = "PATH")]
    out: PathBuf,
    /// What the model is called, at most 32 bytes; the name of the file that is written without it
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Of this export: a firmware may refuse one that is not above that of before
    #[arg(long, value_name = "N", default_value_t = 0)]
    revision: u32,
    /// The amplitude at which the law is taken, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    amplitude: Option<f64>,
    /// Density of the specimen, g/cm³, to be said with the law
    #[arg(long, value_name = "G_PER_CM3", allow_negative_numbers = true)]
    density: Option<f64>,
    /// Exports a law that gives more energy than it takes as well: a firmware that loads it has to allow that too
    #[arg(long)]
    allow_active: bool,
    /// The library for an FMU, in the place of the one beside this program; again for each further platform
    #[arg(long, value_name = "FILE")]
    library: Vec<PathBuf>,
    /// Where what was written goes as JSON as well; `-` for standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
enum Format {
    /// A coefficient pack, for a rig that takes it while it runs
    Pack,
    /// A module of constants with the law composed statically
    Rust,
    /// A header and a source of C99 with the pack as an array
    C,
    /// A unit of FMI 2.0 for co-simulation
    Fmu,
}

#[derive(Serialize)]
struct Summary<'a> {
    format: Format,
    model: &'a Path,
    files: Vec<Written<'a>>,
    name: &'a str,
    identity: String,
    revision: u32,
    tick_rate: f32,
    /// mm and mm/s
    operating_range: Option<Range>,
    /// mm
    amplitude: Option<f32>,
    /// g/cm³
    density: Option<f32>,
    /// Whether the law gives no more energy than it takes, within the operating range
    passive: bool,
    /// Of an FMU
    #[serde(flatten)]
    fmu: Option<Unit>,
}

#[derive(Serialize)]
struct Written<'a> {
    path: &'a Path,
    bytes: usize,
}

#[derive(Serialize)]
struct Range {
    displacement: [f32; 2],
    velocity: [f32; 2],
}

impl ExportCommand {
    pub fn run(self) -> Result<(), Failure> {
        let paths = self.paths()?;
        if let (Some(library), false) = (self.library.first(), self.format == Format::Fmu) {
            return Err(InputError::new(
                format!("--library {}", library.display()),
                "only an FMU carries a library",
                "give --format fmu, or leave --library out",
            )
            .into());
        }
        let mut outputs = Plan::new()
            .reads([&self.model])
            .reads(&self.library)
            .writes(&paths)
            .writes(&self.json)
            .begin()?;
        let file = ModelFile::read_within(&self.model, self.reading.limit)?;
        let settings = ExportSettings {
            tick_rate: self.tick_rate,
            amplitude: self.amplitude,
            density: self.density,
            revision: self.revision,
            name: self.name()?,
            allow_active: self.allow_active,
        };
        let export = Export::new(&file, &settings).map_err(|error| self.refused(&error))?;
        let (texts, fmu) = self.texts(&file, &export)?;
        let info = export.info();
        let summary = Summary {
            format: self.format,
            model: &self.model,
            files: paths
                .iter()
                .zip(&texts)
                .map(|(path, text)| Written {
                    path,
                    bytes: text.len(),
                })
                .collect(),
            name: &info.name,
            identity: info.stamp.identity.to_string(),
            revision: info.stamp.revision,
            tick_rate: info.stamp.tick_rate,
            operating_range: info.operating_range.map(|range| Range {
                displacement: range.displacement(),
                velocity: range.velocity(),
            }),
            amplitude: info.amplitude,
            density: info.density,
            passive: export.active().is_none(),
            fmu,
        };
        if let Some(json) = &self.json {
            outputs.add_json(json, &summary)?;
        }
        let said = self.in_words(&summary);
        for (path, text) in paths.iter().zip(texts) {
            outputs.add(path, text);
        }
        outputs.write()?;
        if let (Some(amplitude), None, true) =
            (info.amplitude, self.amplitude, file.model().law.len() > 1)
        {
            warn(&format!(
                "the law changes with the amplitude, and is that of {amplitude} mm: --amplitude takes another"
            ));
        }
        if let Some(active) = export.active() {
            warn(&format!(
                "the law is active: {active}, and a load refuses it unless it allows that"
            ));
        }
        let dash = Path::new("-");
        if self.json.as_deref() != Some(dash) && paths.iter().all(|path| path != dash) {
            for line in said {
                say(&line);
            }
        }
        Ok(())
    }

    /// The files that are written: of C the header and the source.
    fn paths(&self) -> Result<Vec<PathBuf>, InputError> {
        if self.format != Format::C {
            return Ok(vec![self.out.clone()]);
        }
        let stem = self.stem();
        if self.out == Path::new("-") {
            return Err(InputError::new(
                "--out",
                "C is a header and a source, and standard output takes one of them",
                "give a file name",
            ));
        }
        // The source includes the header by its name.
        if stem.is_empty() || stem.contains(['"', '\\']) || stem.contains(char::is_control) {
            return Err(InputError::new(
                format!("--out {}", self.out.display()),
                "this is no name for a C header",
                "give a name of letters, digits and _",
            ));
        }
        let endings = ["h", "c"];
        Ok(endings
            .map(|ending| self.out.with_file_name(format!("{stem}.{ending}")))
            .to_vec())
    }

    /// The name of what is written, without the ending of its format.
    fn stem(&self) -> String {
        let path = match self.out == Path::new("-") {
            true => &self.model,
            false => &self.out,
        };
        let is_ending = |ending: &str| match self.format {
            Format::C => ["c", "h"].contains(&ending),
            Format::Pack | Format::Rust | Format::Fmu => true,
        };
        let ending = path.extension().and_then(|ending| ending.to_str());
        let name = match ending.is_some_and(is_ending) {
            true => path.file_stem(),
            false => path.file_name(),
        };
        name.unwrap_or_default().to_string_lossy().into_owned()
    }

    fn name(&self) -> Result<String, InputError> {
        let (name, place) = match &self.name {
            Some(name) => (name.clone(), "--name"),
            None => (self.stem(), "--out"),
        };
        let problem = if name.contains(char::is_control) {
            "holds a control character".to_owned()
        } else if name.len() > NAME {
            format!("has {} bytes, and a pack holds {NAME}", name.len())
        } else {
            return Ok(name);
        };
        Err(InputError::new(
            place,
            format!("the name {problem}"),
            format!("give --name with at most {NAME} bytes"),
        ))
    }

    /// What each of the files holds, and what else an FMU says of itself.
    fn texts(
        &self,
        file: &ModelFile,
        export: &Export,
    ) -> Result<(Vec<Vec<u8>>, Option<Unit>), InputError> {
        let refused = |error| self.refused(&error);
        let texts = match self.format {
            Format::Pack => vec![export.pack().map_err(refused)?],
            Format::Rust => vec![export.rust().map_err(refused)?.into_bytes()],
            Format::C => {
                let texts = export.c(&self.stem()).map_err(refused)?;
                texts.map(String::into_bytes).to_vec()
            }
            Format::Fmu => {
                let libraries = export_fmu::libraries(&self.library)?;
                let model = self.model.display().to_string();
                let (bytes, unit) =
                    export_fmu::packed(file, export, self.tick_rate, &libraries, &model)?;
                return Ok((vec![bytes], Some(unit)));
            }
        };
        Ok((texts, None))
    }

    /// What was written, what it is of, and how it is used.
    fn in_words(&self, summary: &Summary<'_>) -> Vec<String> {
        let files: Vec<String> = summary
            .files
            .iter()
            .map(|file| format!("{} ({} bytes)", file.path.display(), file.bytes))
            .collect();
        let mut said = format!(
            "{}: model {}, revision {}, for {} ticks a second",
            files.join(", "),
            summary.identity,
            summary.revision,
            summary.tick_rate
        );
        if let Some(amplitude) = summary.amplitude {
            said += &format!(", at an amplitude of {amplitude} mm");
        }
        if let Some(Range {
            displacement: [low, high],
            velocity: [slowest, fastest],
        }) = summary.operating_range
        {
            said += &format!(", within {low} to {high} mm and {slowest} to {fastest} mm/s");
        }
        if summary.passive {
            said += ", passive";
        }
        let used = match self.format {
            Format::Pack => format!(
                "Load it with pack::decode or Upload::finish and Expectation::at({:?})",
                summary.tick_rate
            ),
            Format::Rust => format!(
                "Use it beside the crate mesh-damper: `#[path = {:?}] mod {module};`, then `{module}::fill(&mut law)` with a \
                 `{module}::DamperLaw`",
                self.out.display().to_string(),
                module = rust_module(&self.stem())
            ),
            Format::Fmu => format!(
                "Import it for co-simulation on {}, with steps that are multiples of {} s",
                summary
                    .fmu
                    .as_ref()
                    .map_or(String::new(), |unit| unit.platforms.join(", ")),
                1.0 / self.tick_rate
            ),
            Format::C => {
                let name = c_identifier(summary.name);
                format!(
                    "Compile the source with your firmware and include the header: {name}_pack has {}_PACK_LENGTH bytes",
                    name.to_ascii_uppercase()
                )
            }
        };
        vec![said, used]
    }

    /// `error` with the option or the file that it is about.
    fn refused(&self, error: &ExportError) -> InputError {
        let model = self.model.display().to_string();
        match error {
            ExportError::Setting(setting) => {
                let said = setting.to_string();
                let field = said.split(' ').next().unwrap_or_default();
                InputError::new(
                    format!("--{}", field.replace('_', "-")),
                    said.clone(),
                    "give a value within that",
                )
            }
            ExportError::NoAmplitude => InputError::new(
                "--amplitude",
                format!("the law of {model} has the same coefficients at every amplitude"),
                "leave --amplitude out",
            ),
            ExportError::Model(error @ ModelError::Refused { .. }) => InputError {
                mend: format!(
                    "give another --tick-rate than {}, mend the field, or trace the recordings again",
                    self.tick_rate
                ),
                ..model_error(&model, error)
            },
            ExportError::Model(error) => model_error(&model, error),
            ExportError::Active(active) => InputError::new(
                model,
                format!("the law is active: {active}"),
                "see to its damping and to stiffnesses of friction below 0, or give --allow-active",
            )
            .at(Place::Field("law".into())),
            ExportError::ResidualTable => InputError::new(
                model,
                "a law that Rust composes statically carries no residual table",
                "export it with --format pack or c, whose law is read while it runs",
            )
            .at(Place::Field("correction".into())),
        }
    }
}

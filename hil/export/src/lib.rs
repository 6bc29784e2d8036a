//! Exports a model as files for firmware or a simulation: the work of `hil export`, without its options.
//!
//! | module | for |
//! |---|---|
//! | the root | [`Request`]: the requested export and its place; [`Exported`]: its files and their description |
//! | [`fmu`] | the archive of an FMU |
//!
//! ```
//! use mesh_damper_export::{Format, Request};
//! use mesh_damper_model::file::{FittedRange, ModelFile};
//! use mesh_damper_model::{LawNode, Model};
//!
//! let law = LawNode { amplitude: 0.0, k1: 8.0, k3: 30.0, c: 0.1, alpha: 0.3 };
//! let model = Model { law: vec![law], effects: Vec::new(), correction: None, controls: Vec::new() };
//! let range = FittedRange { displacement: [-0.2, 0.2], velocity: [-6.0, 6.0] };
//! let request = Request::new("model.json", Format::Pack, 10_000.0, "mount.mdcp");
//! let exported = request.export(&ModelFile::new(model, range))?;
//! assert_eq!(exported.summary.name, "mount");
//! # Ok::<(), mesh_damper_output::error::InputError>(())
//! ```
#![forbid(unsafe_code)]

pub mod fmu;
mod refusal;
mod words;

use std::path::{Path, PathBuf};

use mesh_damper::pack::NAME;
use mesh_damper_model::export::{Export, ExportSettings};
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::InputError;
use mesh_damper_output::terminal::visible;
use serde::Serialize;

use fmu::Unit;

/// The format of an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// A coefficient pack, which a rig can load while it runs
    Pack,
    /// A Rust module of constants, with the law as a static type
    Rust,
    /// A header and a source file in C99 that hold the pack as an array
    C,
    /// An FMU for co-simulation, FMI 2.0
    Fmu,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 4] = [Self::Pack, Self::Rust, Self::C, Self::Fmu];

    /// Its word in the command's option.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pack => "pack",
            Self::Rust => "rust",
            Self::C => "c",
            Self::Fmu => "fmu",
        }
    }
}

/// The requested export of a model, and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The model's file, or its name in errors.
    pub model: PathBuf,
    /// What it becomes.
    pub format: Format,
    /// Ticks per second of the firmware, or evaluations of the law per second in an FMU, Hz.
    pub tick_rate: f64,
    /// Output path; for C the name of header and source, with or without its ending; `-` for standard output.
    pub out: PathBuf,
    /// What the model is called, at most 32 bytes; the name of the file that is written without it.
    pub name: Option<String>,
    /// Of this export: a firmware may refuse one that is not above that of before.
    pub revision: u32,
    /// The amplitude at which the law is taken, mm; without it the largest one that it was fitted at.
    pub amplitude: Option<f64>,
    /// Density of the specimen, g/cm³, to be said with the law.
    pub density: Option<f64>,
    /// Whether to export a law that gives out more energy than it takes.
    pub allow_active: bool,
    /// Libraries for an FMU, one for each platform.
    pub libraries: Vec<PathBuf>,
    /// Folders to search for an FMU's library, in addition to these.
    pub folders: Vec<PathBuf>,
}

/// The files of an export, and their description.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// The files to write, in the order of [`Request::paths`].
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// What was written, for other programs.
    pub summary: Summary,
    /// The output, its contents and its use, in text for people.
    pub said: Vec<String>,
    /// Warnings for the user although the model was exported.
    pub warnings: Vec<String>,
}

/// The result of an export.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// The format of the export.
    pub format: Format,
    /// Path of the model file.
    pub model: PathBuf,
    /// The files that were written.
    pub files: Vec<Written>,
    /// Name of the model.
    pub name: String,
    /// Identity of the model, a hash of its contents.
    pub identity: String,
    /// Revision of this export.
    pub revision: u32,
    /// Tick rate of the law, Hz.
    pub tick_rate: f32,
    /// Operating range of the model; null if the model does not give it.
    pub operating_range: Option<Range>,
    /// Amplitude of the exported coefficients, mm; null if the coefficients are the same at all amplitudes.
    pub amplitude: Option<f32>,
    /// Density of the specimen, g/cm³; null if it was not given.
    pub density: Option<f32>,
    /// Whether the law is passive in the operating range: it never returns more energy than it has taken up.
    pub passive: bool,
    /// The FMU; absent for other formats.
    #[serde(flatten)]
    pub fmu: Option<Unit>,
}

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Written {
    /// Path of the file.
    pub path: PathBuf,
    /// Length of the file, bytes.
    pub bytes: usize,
}

/// The range of motion that a model was fitted on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Range {
    /// Smallest and largest displacement, mm.
    pub displacement: [f32; 2],
    /// Smallest and largest velocity, mm/s.
    pub velocity: [f32; 2],
}

impl Request {
    /// For the model in a file, for `tick_rate` Hz, to `out`; everything else has its default.
    pub fn new(
        model: impl Into<PathBuf>,
        format: Format,
        tick_rate: f64,
        out: impl Into<PathBuf>,
    ) -> Self {
        Self {
            model: model.into(),
            format,
            tick_rate,
            out: out.into(),
            name: None,
            revision: 0,
            amplitude: None,
            density: None,
            allow_active: false,
            libraries: Vec::new(),
            folders: Vec::new(),
        }
    }

    /// The files that will be written: for C the header and the source.
    ///
    /// # Errors
    /// A name that no C header can have, or a library together with a format other than FMU.
    pub fn paths(&self) -> Result<Vec<PathBuf>, InputError> {
        if let (Some(library), false) = (self.libraries.first(), self.format == Format::Fmu) {
            return Err(InputError::new(
                format!("--library {}", library.display()),
                "only an FMU carries a library",
                "give --format fmu, or leave --library out",
            ));
        }
        if self.format != Format::C {
            return Ok(vec![self.out.clone()]);
        }
        let stem = self.stem();
        if self.out == Path::new("-") {
            return Err(InputError::new(
                "--out",
                "C needs two files, a header and a source; standard output takes only one",
                "give a file name",
            ));
        }
        // The source includes the header by its name.
        if stem.is_empty() || stem.contains(['"', '\\']) || visible(&stem) != stem {
            return Err(InputError::new(
                format!("--out {}", self.out.display()),
                "this is not a valid name for a C header",
                "give a name of letters, digits and _",
            ));
        }
        let endings = ["h", "c"];
        Ok(endings
            .map(|ending| self.out.with_file_name(format!("{stem}.{ending}")))
            .to_vec())
    }

    /// The name of the output, without the ending of its format.
    pub(crate) fn stem(&self) -> String {
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
        let problem = if visible(&name) != name {
            "holds a character that a terminal obeys".to_owned()
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

    /// Exports the model of `file`.
    ///
    /// # Errors
    /// As [`Request::paths`]; also a setting out of range, by the name of its option; a model that cannot run at the tick rate or
    /// that the format cannot hold; a library for an FMU that is invalid or missing.
    pub fn export(&self, file: &ModelFile) -> Result<Exported, InputError> {
        let paths = self.paths()?;
        let settings = ExportSettings {
            tick_rate: self.tick_rate,
            amplitude: self.amplitude,
            density: self.density,
            revision: self.revision,
            name: self.name()?,
            allow_active: self.allow_active,
        };
        let export = Export::new(file, &settings).map_err(|error| self.refused(&error))?;
        let (texts, fmu) = self.texts(file, &export)?;
        let info = export.info();
        let summary = Summary {
            format: self.format,
            model: self.model.clone(),
            files: paths
                .iter()
                .zip(&texts)
                .map(|(path, text)| Written {
                    path: path.clone(),
                    bytes: text.len(),
                })
                .collect(),
            name: info.name.to_string(),
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
        let mut warnings = Vec::new();
        if let (Some(amplitude), None, true) =
            (info.amplitude, self.amplitude, file.model().law.len() > 1)
        {
            warnings.push(format!(
                "the coefficients depend on the amplitude; the export uses those of {amplitude} mm; --amplitude selects others"
            ));
        }
        if let Some(active) = export.active() {
            warnings.push(format!(
                "the law is active: {active}; a firmware refuses it unless it allows active laws"
            ));
        }
        Ok(Exported {
            files: paths.into_iter().zip(texts).collect(),
            said: self.in_words(&summary),
            summary,
            warnings,
        })
    }

    /// The contents of each file, and the additional data of an FMU.
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
                let libraries = fmu::libraries(&self.libraries, &self.folders)?;
                let model = self.model.display().to_string();
                let (bytes, unit) = fmu::packed(file, export, self.tick_rate, &libraries, &model)?;
                return Ok((vec![bytes], Some(unit)));
            }
        };
        Ok((texts, None))
    }
}

//! `hil export`: a model as firmware or a simulation takes it.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_export::{Exported, Format, Request, fmu};
use mesh_damper_model::file::ModelFile;
use mesh_damper_recording::output::Plan;

use super::fmu_library;
use crate::commands::document::AddDocument as _;
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

impl ExportCommand {
    pub fn run(self) -> Result<(), Failure> {
        let folders = match (self.format, self.library.first()) {
            (Format::Fmu, None) => fmu_library::folders()?,
            _ => fmu::beside_this_program(),
        };
        let request = Request {
            name: self.name,
            revision: self.revision,
            amplitude: self.amplitude,
            density: self.density,
            allow_active: self.allow_active,
            libraries: self.library,
            folders,
            ..Request::new(self.model, self.format, self.tick_rate, self.out)
        };
        let paths = request.paths()?;
        let mut outputs = Plan::new()
            .reads([&request.model])
            .reads(&request.libraries)
            .writes(&paths)
            .writes(&self.json)
            .begin()?;
        let file = ModelFile::read_within(&request.model, self.reading.limit)?;
        let Exported {
            files,
            summary,
            said,
            warnings,
        } = request.export(&file)?;
        if let Some(json) = &self.json {
            outputs.add_document(json, &summary)?;
        }
        for (path, bytes) in files {
            outputs.add(path, bytes);
        }
        outputs.write()?;
        for warning in &warnings {
            warn(warning);
        }
        let dash = Path::new("-");
        if self.json.as_deref() != Some(dash) && paths.iter().all(|path| path != dash) {
            for line in said {
                say(&line);
            }
        }
        Ok(())
    }
}

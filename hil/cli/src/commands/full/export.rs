//! `hil export`: exports a model for firmware or a simulation.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_export::{Exported, Format, Request, fmu};
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::Plan;

use super::fmu_library;
use crate::commands::document::AddDocument as _;
use crate::commands::reading::Reading;
use crate::commands::{Failure, say, warn};

/// Export a model for firmware or simulation: a coefficient pack, a Rust module, C sources, or an FMU
///
/// Every format holds the same law at one tick rate. It states that tick rate, the operating range, the identity of the model, and the
/// revision. If the coefficients depend on the amplitude, the export uses those at the largest fitted amplitude, or at --amplitude.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  hil demo --seed 4\n  \
    hil export --model demo-out/model.json --format pack --tick-rate 10000 \\\n      \
    --out mount.mdcp\n  \
    hil export --model demo-out/model.json --format c --tick-rate 10000 \\\n      \
    --out mount.c")]
pub struct ExportCommand {
    /// The model, a model.json of `hil trace`
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Format of the export
    #[arg(long, value_enum)]
    format: Format,
    /// Tick rate of the firmware, or evaluation rate of the law in an FMU, in Hz, 1 to 1000000
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    tick_rate: f64,
    /// File to write; `-` is standard output
    ///
    /// For C this names both header and source; you may leave out the ending.
    #[arg(long, value_name = "PATH")]
    out: PathBuf,
    /// Name of the model, at most 32 bytes; the default is the name of the written file
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Revision of this export; a firmware may refuse a revision that is not above its last one
    #[arg(long, value_name = "N", default_value_t = 0)]
    revision: u32,
    /// Amplitude whose coefficients are used, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    amplitude: Option<f64>,
    /// Density of the specimen in g/cm³, stated in the export
    #[arg(long, value_name = "G_PER_CM3", allow_negative_numbers = true)]
    density: Option<f64>,
    /// Export a law even if it can deliver energy; the firmware must allow that too
    #[arg(long)]
    allow_active: bool,
    /// Library for an FMU instead of the one next to this program; repeat it for each platform
    #[arg(long, value_name = "FILE")]
    library: Vec<PathBuf>,
    /// Write the result as JSON to this file; `-` is standard output
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
        outputs.add_document_if(&self.json, &summary)?;
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

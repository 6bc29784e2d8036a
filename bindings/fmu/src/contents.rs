//! The contents of an FMU for one model: the resources that its library reads, and the GUID made from them.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use mesh_damper_model::export::Export;
use mesh_damper_model::file::ModelFile;
use mesh_damper_recording::trajectory::TrajectoryPolicy;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use crate::MARK;
use crate::refusal::{Refusal, finite};

/// The model among the resources.
pub const MODEL: &str = "model.json";
/// The settings of the model, next to it.
pub const SETTINGS: &str = "fmu.json";
/// Longest resource that is read, bytes. A model with a residual table has some tens of kilobytes.
const LONGEST: u64 = 16 << 20;
/// Slowest and fastest tick rate, Hz: those of an export.
const TICK_RATES: [f64; 2] = mesh_damper_model::export::TICK_RATES;

/// The settings of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// A name for people.
    pub name: String,
    /// Ticks per second, Hz.
    pub tick_rate: f64,
    /// Initial amplitude of the law, mm; `None` if the law does not depend on it.
    pub amplitude: Option<f64>,
    /// Temperature at the start, °C.
    pub temperature: f64,
    /// Density of the specimen, g/cm³, if known.
    pub density: Option<f64>,
    /// Revision of this export.
    pub revision: u32,
}

/// A model, its settings, and the GUID of both.
#[derive(Clone, Debug, PartialEq)]
pub struct Contents {
    /// The model.
    pub file: ModelFile,
    /// Its settings.
    pub settings: Settings,
    /// GUID from this library's version, model and settings, in braces.
    pub guid: String,
}

impl Contents {
    /// From an export at `tick_rate` Hz, and the bytes of [`MODEL`] and of [`SETTINGS`].
    ///
    /// # Panics
    /// Never: numbers and names are valid JSON.
    pub fn of_export(file: &ModelFile, export: &Export, tick_rate: f64) -> (Self, [Vec<u8>; 2]) {
        let info = export.info();
        let settings = Settings {
            name: info.name.to_string(),
            tick_rate,
            amplitude: export.amplitude(),
            temperature: TrajectoryPolicy::in_use().room,
            density: info.density.map(f64::from),
            revision: info.stamp.revision,
        };
        let json = |bytes: serde_json::Result<Vec<u8>>| bytes.expect("numbers and names are JSON");
        let resources = [
            json(serde_json::to_vec_pretty(file)),
            json(serde_json::to_vec_pretty(&settings)),
        ];
        let contents = Self {
            file: file.clone(),
            settings,
            guid: guid(&resources),
        };
        (contents, resources)
    }

    /// From the resources in `folder`, which must match the `guid`.
    ///
    /// # Errors
    /// A resource is missing, too long, damaged, or from another FMU.
    pub fn read(folder: &Path, guid: &str) -> Result<Self, Refusal> {
        let resources = [read(&folder.join(MODEL))?, read(&folder.join(SETTINGS))?];
        let contents = Self::of(&folder.join(MODEL).display().to_string(), &resources)?;
        if !contents.guid.eq_ignore_ascii_case(guid) {
            return Err(Refusal::new(
                "fmuGUID",
                guid,
                format_args!("the resources and the library are {}", contents.guid),
                "take the GUID from the modelDescription.xml beside them, or export the model again",
            ));
        }
        Ok(contents)
    }

    fn of(name: &str, resources: &[Vec<u8>; 2]) -> Result<Self, Refusal> {
        let again = "export the model again";
        let file = ModelFile::from_bytes(name, &resources[0]).map_err(|error| {
            let problem = format!("{:?}: {}", error.place, error.problem);
            Refusal::new(MODEL, name, problem, again)
        })?;
        let settings: Settings = serde_json::from_slice(&resources[1])
            .map_err(|error| Refusal::new(SETTINGS, name, error, again))?;
        let [slowest, fastest] = TICK_RATES;
        if !(slowest..=fastest).contains(&settings.tick_rate) {
            return Err(Refusal::new(
                "tick_rate",
                settings.tick_rate,
                format_args!("outside {slowest} to {fastest} Hz"),
                again,
            ));
        }
        for (field, value) in [
            ("amplitude", settings.amplitude.unwrap_or_default()),
            ("temperature", settings.temperature),
        ] {
            finite(field, value)?;
        }
        if file.model().law.len() > 1 && settings.amplitude.is_none() {
            return Err(Refusal::new(
                "amplitude",
                "null",
                "the law changes with it",
                again,
            ));
        }
        Ok(Self {
            guid: guid(resources),
            file,
            settings,
        })
    }
}

fn read(path: &Path) -> Result<Vec<u8>, Refusal> {
    let refused = |problem: String| {
        Refusal::new(
            "resource",
            path.display(),
            problem,
            "unpack the whole FMU, or export the model again",
        )
    };
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(LONGEST + 1).read_to_end(&mut bytes))
        .map_err(|error| refused(error.to_string()))?;
    if bytes.len() as u64 > LONGEST {
        return Err(refused(format!("longer than {LONGEST} bytes")));
    }
    Ok(bytes)
}

/// GUID from the library's version and the resources.
fn guid(resources: &[Vec<u8>; 2]) -> String {
    let mut hash = Sha256::new();
    hash.update(MARK);
    for resource in resources {
        hash.update((resource.len() as u64).to_le_bytes());
        hash.update(resource);
    }
    let mut guid = String::from("{");
    for (place, byte) in hash.finalize().iter().take(16).enumerate() {
        if [4, 6, 8, 10].contains(&place) {
            guid.push('-');
        }
        let _ = write!(guid, "{byte:02x}");
    }
    guid + "}"
}

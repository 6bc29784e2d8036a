//! A model of a specimen at a time, with what its trace says of it.

use std::path::Path;

use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_model::file::ModelFile;
use mesh_damper_recording::error::{InputError, Place};
use mesh_damper_recording::read_limit::{ReadLimit, read_json};

use super::Compared;
use crate::one::{MODEL, TRACE};

/// A model of a specimen at a time.
#[derive(Clone, Debug)]
pub struct Moment {
    /// What messages call it.
    pub name: String,
    /// When; in any unit, as long as all have it.
    pub time: f64,
    /// The model.
    pub model: ModelFile,
    /// What its trace found, with the intervals of its parameters; `None` where that is not known.
    pub trace: Option<TraceResult>,
}

impl Moment {
    /// Reads `path`: the folder that `hil trace` wrote, or the model in it, beside which its trace is looked for.
    ///
    /// # Errors
    /// A model that cannot be read; a trace that is there and cannot be read.
    pub fn read(path: &Path, time: f64, limit: ReadLimit) -> Result<Self, InputError> {
        let model = match path.is_dir() {
            true => path.join(MODEL),
            false => path.to_owned(),
        };
        let trace = model.with_file_name(TRACE);
        Ok(Self {
            name: path.display().to_string(),
            time,
            trace: trace
                .exists()
                .then(|| read_trace(&trace, limit))
                .transpose()?,
            model: ModelFile::read_within(&model, limit)?,
        })
    }

    /// Families of its effects, each once, by name.
    pub(super) fn families(&self) -> Vec<String> {
        let effects = self.model.model().effects;
        let mut families: Vec<String> = effects
            .iter()
            .map(|effect| effect.family.name().to_owned())
            .collect();
        families.sort();
        families.dedup();
        families
    }

    pub(super) fn compared(&self) -> Compared {
        let held_out = self
            .trace
            .as_ref()
            .map(|trace| trace.augmented.nrmse_held_out);
        Compared {
            name: self.name.clone(),
            time: self.time,
            effects: self.families(),
            nrmse_held_out: held_out.filter(|error| error.is_finite()),
            has_intervals: self.trace.is_some(),
        }
    }
}

fn read_trace(path: &Path, limit: ReadLimit) -> Result<TraceResult, InputError> {
    serde_json::from_slice(&read_json(path, limit)?).map_err(|error| {
        let name = path.display().to_string();
        InputError::new(
            name,
            format!("is no trace.json: {error}"),
            "trace the recordings again",
        )
        .at(Place::Line(error.line() as u64))
    })
}

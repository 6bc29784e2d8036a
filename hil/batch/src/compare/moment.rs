//! A model of a specimen at a time, with the data of its trace.

use std::path::{Path, PathBuf};

use mesh_damper_identify::trace::result::{OperatingConditions, TraceResult};
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::{InputError, Place};
use mesh_damper_tables::read_limit::{ReadLimit, read_json};

use super::Compared;
use crate::one::{MODEL, TRACE};

/// A model of a specimen at a time.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Its name in messages.
    pub name: String,
    /// The time, in any unit that is the same for all.
    pub time: f64,
    /// The model.
    pub model: ModelFile,
    /// The result of its trace, with the intervals of its parameters; `None` if not known.
    pub trace: Option<TraceResult>,
}

impl Moment {
    /// Reads `path`: the folder that `hil trace` wrote, or the model in it. The trace is expected next to the model.
    ///
    /// # Errors
    /// A model that cannot be read, or an existing trace that cannot be read.
    pub fn read(path: &Path, time: f64, limit: ReadLimit) -> Result<Self, InputError> {
        let [model, trace] = Self::files(path);
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

    /// The files that [`Self::read`] reads: the model and the trace, which may be missing.
    pub fn files(path: &Path) -> [PathBuf; 2] {
        let model = match path.is_dir() {
            true => path.join(MODEL),
            false => path.to_owned(),
        };
        let trace = model.with_file_name(TRACE);
        [model, trace]
    }

    /// The conditions of its recordings; `None` if not known.
    pub(super) fn conditions(&self) -> Option<&OperatingConditions> {
        self.trace.as_ref()?.operating_conditions.as_ref()
    }

    /// The zero of its law's displacement in mm of the recorded displacement: the middle if the recordings differ.
    pub(super) fn zero(&self) -> f64 {
        let [low, high] = self.model.displacement_zero();
        0.5 * (low + high)
    }

    /// Whether the trace stores a subtracted zero. Older traces mention it only in a warning.
    pub(super) fn knows_zero(&self) -> bool {
        let warnings = self.trace.iter().flat_map(|trace| &trace.warnings);
        let mut of_zero =
            warnings.filter(|warning| warning.contains("the displacement's zero lies"));
        self.conditions().is_some() || of_zero.next().is_none()
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

//! A model as it leaves the host: a coefficient pack, a Rust module, or a C header and source, all of the same law.
//!
//! ```no_run
//! use mesh_damper_model::export::{Export, ExportSettings};
//! use mesh_damper_model::file::ModelFile;
//!
//! let file = ModelFile::read("trace-out/model.json")?;
//! let export = Export::new(&file, &ExportSettings::at(10_000.0, "mount"))?;
//! std::fs::write("mount.mdcp", export.pack()?)?;
//! std::fs::write("mount.rs", export.rust()?)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod c;
mod identifier;
mod rust;

pub use identifier::{c_identifier, rust_module};

use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::FastLaw;
use mesh_damper::pack::{self, LARGEST, PackInfo, Stamp};
use mesh_damper::passivity::{Active, Passivity};
use mesh_damper::real::Real as _;

use crate::file::ModelFile;
use crate::{MAX_EFFECTS, Model, ModelError};

/// Slowest and fastest tick that a model is exported for, Hz: those of the crate's rig and generator.
pub const TICK_RATES: [f64; 2] = [1.0, 1e6];

/// What an export is to be.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportSettings {
    /// Ticks per second of the firmware, Hz, within [`TICK_RATES`].
    pub tick_rate: f64,
    /// Amplitude at which the law is taken, mm; `None` for the largest one that it was fitted at, where its forces are largest.
    pub amplitude: Option<f64>,
    /// Density of the specimen, g/cm³, where it is known.
    pub density: Option<f64>,
    /// Of this export.
    pub revision: u32,
    /// For people, at most [`pack::NAME`] bytes.
    pub name: String,
    /// Exports a law that gives more energy than it takes as well.
    pub allow_active: bool,
}

impl ExportSettings {
    /// For `tick_rate` Hz, called `name`, and nothing else said.
    pub fn at(tick_rate: f64, name: impl Into<String>) -> Self {
        Self {
            tick_rate,
            amplitude: None,
            density: None,
            revision: 0,
            name: name.into(),
            allow_active: false,
        }
    }
}

/// Why a model is not exported.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// A setting that is not finite or out of range, by its name in [`ExportSettings`].
    #[error("{0}")]
    Setting(ConfigError),
    /// The law of the model is the same at every amplitude, and one was given.
    #[error("amplitude: the law has the same coefficients at every amplitude")]
    NoAmplitude,
    /// What the model is made of cannot run at the tick rate.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A law whose type names its effects carries no residual table.
    #[error("correction: a law that is composed statically carries no residual table")]
    ResidualTable,
    /// The law gives more energy than it takes, and [`ExportSettings::allow_active`] is not set.
    #[error("law: {0}")]
    Active(Active),
}

/// A model at one tick rate and one amplitude.
#[derive(Clone, Debug)]
pub struct Export {
    model: Model,
    tick: f64,
    amplitude: Option<f64>,
    law: FastLaw<MAX_EFFECTS>,
    info: PackInfo,
    passivity: Result<(), Active>,
}

impl Export {
    /// The model of `file` as `settings` ask for it.
    ///
    /// # Errors
    /// A setting that is out of range, a model that cannot run at the tick rate, or a law that is active and not allowed to be.
    pub fn new(file: &ModelFile, settings: &ExportSettings) -> Result<Self, ExportError> {
        let [slowest, fastest] = TICK_RATES;
        let tick_rate = within("tick_rate", settings.tick_rate, slowest, fastest)?;
        if let Some(density) = settings.density {
            within("density", density, f64::MIN_POSITIVE, pack::DENSITY_MOST)?;
        }
        let model = file.model();
        let amplitude = amplitude(&model, settings.amplitude)?;
        let tick = 1.0 / tick_rate;
        let law = FastLaw::new(model.augmented(amplitude.unwrap_or_default(), tick)?);
        let range = file.fitted_range().operating_range();
        let info = PackInfo {
            operating_range: Some(range.map_err(|error| ModelError::Refused {
                place: "fitted_range".into(),
                error,
            })?),
            density: settings.density.map(f32::from_f64),
            amplitude: amplitude.map(f32::from_f64),
            stamp: Stamp {
                tick_rate: tick_rate as f32,
                revision: settings.revision,
                identity: file.identity(),
            },
            ..PackInfo::at(tick_rate as f32)
                .named(&settings.name)
                .map_err(ExportError::Setting)?
        };
        let passivity =
            Passivity::new(info.operating_range.as_ref(), info.stamp.tick_rate).check(&law);
        if let (Err(active), false) = (passivity, settings.allow_active) {
            return Err(ExportError::Active(active));
        }
        Ok(Self {
            model,
            tick,
            amplitude,
            law,
            info,
            passivity,
        })
    }

    /// The motion within the fitted range in which the law gives more energy than it takes; `None` of a passive one.
    pub fn active(&self) -> Option<Active> {
        self.passivity.err()
    }

    /// The amplitude that the law is taken at, mm; `None` where it does not change with it. [`PackInfo`] has it rounded to f32.
    pub fn amplitude(&self) -> Option<f64> {
        self.amplitude
    }

    /// What the export says of itself, whatever its format.
    pub fn info(&self) -> &PackInfo {
        &self.info
    }

    /// As a coefficient pack.
    ///
    /// # Errors
    /// [`ModelError::Pack`] where it is longer than a pack may be.
    pub fn pack(&self) -> Result<Vec<u8>, ExportError> {
        let mut buffer = [0; LARGEST];
        let pack = pack::encode(&self.law, &self.info, &mut buffer).map_err(ModelError::Pack)?;
        Ok(pack.to_vec())
    }

    /// As a Rust module, whose only dependency is `mesh-damper`. What it composes gives the force of [`Export::pack`] bit for bit.
    ///
    /// # Errors
    /// [`ExportError::ResidualTable`]
    pub fn rust(&self) -> Result<String, ExportError> {
        rust::module(self)
    }

    /// As a C header and source: [`Export::pack`] as an array, and what it says of itself as constants. `stem` is the name of the
    /// header without its `.h`, by which the source includes it.
    ///
    /// # Errors
    /// As [`Export::pack`].
    pub fn c(&self, stem: &str) -> Result<[String; 2], ExportError> {
        Ok(c::files(
            &self.info,
            &self.model.controls,
            &self.pack()?,
            stem,
        ))
    }
}

/// The amplitude at which the law is taken, mm; `None` where it does not change with it.
fn amplitude(model: &Model, asked: Option<f64>) -> Result<Option<f64>, ExportError> {
    let amplitudes = || model.law.iter().map(|node| node.amplitude);
    let low = amplitudes().fold(f64::INFINITY, f64::min);
    let high = amplitudes().fold(0.0, f64::max);
    match asked {
        Some(_) if high == 0.0 => Err(ExportError::NoAmplitude),
        Some(asked) => within("amplitude", asked, low, high).map(Some),
        None => Ok((high > 0.0).then_some(high)),
    }
}

fn within(field: &'static str, value: f64, low: f64, high: f64) -> Result<f64, ExportError> {
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    Err(ExportError::Setting(if value.is_finite() {
        ConfigError::OutOfRange {
            field,
            value,
            low,
            high,
        }
    } else {
        ConfigError::NonFinite(field)
    }))
}

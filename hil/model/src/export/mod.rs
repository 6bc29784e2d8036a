//! The exported forms of a model: a coefficient pack, a Rust module, or a C header and source. All have the same law.
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
use mesh_damper::passivity::{self, Active};
use mesh_damper::real::Real as _;

use crate::file::ModelFile;
use crate::{MAX_EFFECTS, Model, ModelError};

/// Slowest and fastest tick rate of an export, Hz: the limits of the crate's rig and generator.
pub const TICK_RATES: [f64; 2] = [1.0, 1e6];

/// The settings of an export.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportSettings {
    /// Ticks per second of the firmware, Hz, within [`TICK_RATES`].
    pub tick_rate: f64,
    /// Amplitude at which to take the law, mm; `None` for the largest fitted one, where its forces are largest.
    pub amplitude: Option<f64>,
    /// Density of the specimen, g/cm³, if known.
    pub density: Option<f64>,
    /// Revision of this export.
    pub revision: u32,
    /// A name for people, at most [`pack::NAME`] bytes.
    pub name: String,
    /// Also exports a law that can give out more energy than it takes.
    pub allow_active: bool,
}

impl ExportSettings {
    /// Settings for `tick_rate` Hz and `name`; the rest has its default.
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

/// The reason why a model is not exported.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// A setting, by its name in [`ExportSettings`], is not finite or out of range.
    #[error("{0}")]
    Setting(ConfigError),
    /// An amplitude was given, but the law of the model is the same at every amplitude.
    #[error("amplitude: the law has the same coefficients at every amplitude")]
    NoAmplitude,
    /// A part of the model cannot run at the tick rate.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A law of a static type, with its effects in the type, cannot carry a residual table.
    #[error("correction: a law that is composed statically carries no residual table")]
    ResidualTable,
    /// The law can give out more energy than it takes, and [`ExportSettings::allow_active`] is not set.
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
    /// Exports the model of `file` with `settings`.
    ///
    /// # Errors
    /// A setting is out of range, the model cannot run at the tick rate, or the law is active and that is not allowed.
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
        let passivity = passivity::check(law.augmented());
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

    /// The part of the law with which it can give out more energy than it takes; `None` for a passive law.
    pub fn active(&self) -> Option<Active> {
        self.passivity.err()
    }

    /// The amplitude at which the law was taken, mm; `None` if the law does not depend on it. [`PackInfo`] has it rounded to f32.
    pub fn amplitude(&self) -> Option<f64> {
        self.amplitude
    }

    /// The description of the export, the same in all formats.
    pub fn info(&self) -> &PackInfo {
        &self.info
    }

    /// As a coefficient pack.
    ///
    /// # Errors
    /// [`ModelError::Pack`] if the pack would be too long.
    pub fn pack(&self) -> Result<Vec<u8>, ExportError> {
        let mut buffer = [0; LARGEST];
        let pack = pack::encode(&self.law, &self.info, &mut buffer).map_err(ModelError::Pack)?;
        Ok(pack.to_vec())
    }

    /// As a Rust module whose only dependency is `mesh-damper`. Its law gives the force of [`Export::pack`] bit for bit.
    ///
    /// # Errors
    /// [`ExportError::ResidualTable`]
    pub fn rust(&self) -> Result<String, ExportError> {
        rust::module(self)
    }

    /// As a C header and source: [`Export::pack`] as an array, and its description as constants. `stem` is the name of the header
    /// without its `.h`; the source includes the header by it.
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

/// The amplitude at which to take the law, mm; `None` if the law does not depend on it.
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

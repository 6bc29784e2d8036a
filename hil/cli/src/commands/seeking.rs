//! The options of the commands that trace: the families to look for, and the baseline law.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_identify::base_law::BaseLaw;
use mesh_damper_identify::trace::Sought;
use mesh_damper_model::Family;
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::InputError;
use mesh_damper_recording::rig::DisplacementZero;
use mesh_damper_tables::read_limit::ReadLimit;

use super::known_rig::{KnownRig, zero};

/// The families to look for in a trace.
#[derive(Args, Clone, Debug)]
pub struct Seeking {
    /// Look for these families of effects only, such as `stick_slip,yielding`; the default is all
    #[arg(long, value_name = "FAMILIES", value_delimiter = ',', value_parser = family, long_help = families_help())]
    families: Vec<Family>,
    /// Do not look for these families: effects that the specimen cannot have
    #[arg(long, value_name = "FAMILIES", value_delimiter = ',', value_parser = family)]
    exclude: Vec<Family>,
    /// The law without effects
    ///
    /// `mixed` is the mixed damping law k1·y + k3·y³ + c·|v|^α·sgn v (eq 13). `linear` is a spring and a dashpot. `none` has effects only.
    #[arg(long, value_name = "LAW", default_value = BaseLaw::default().word(), value_parser = base_law)]
    baseline: BaseLaw,
    /// A model whose effects are known; the trace looks for more
    ///
    /// The known effects stay in the law. The trace fits their parameters again, together with those of the law, and starts from the values
    /// of the model.
    #[arg(long, value_name = "MODEL")]
    law: Option<PathBuf>,
    #[command(flatten)]
    rig: KnownRig,
    /// Where the displacement of the specimen is 0: mean, start or none; the default is what the recording shows
    ///
    /// `mean` is the mean of the recorded displacement, `start` the displacement at rest with which the recording starts, `none` the
    /// recorded zero.
    #[arg(long, value_name = "WHERE", value_parser = zero)]
    zero: Option<DisplacementZero>,
}

impl Seeking {
    /// The model with known effects.
    pub fn law(&self) -> Option<&Path> {
        self.law.as_deref()
    }

    /// The settings of these options.
    ///
    /// # Errors
    /// A model of known effects that cannot be read, or with an effect that the fit does not know; a mass beyond the crate's range.
    pub fn sought(&self, limit: ReadLimit) -> Result<Sought, InputError> {
        let known = match &self.law {
            Some(path) => {
                let model = ModelFile::read_within(path, limit)?;
                Sought::beside(&model, &path.display().to_string())?
            }
            None => Sought::default(),
        };
        let sought = Sought {
            families: self.families.clone(),
            exclude: self.exclude.clone(),
            law: self.baseline,
            ..known
        };
        sought.on_rig(self.rig.facts(self.zero))
    }
}

fn family(name: &str) -> Result<Family, String> {
    Family::named(name)
        .ok_or_else(|| format!("no effect has that name; give one of {}", all_families()))
}

fn families_help() -> String {
    format!(
        "Look for these families of effects only, such as `stick_slip,yielding`; the default is all\n\nFamilies: {}",
        all_families()
    )
}

fn all_families() -> String {
    let all: Vec<&str> = Family::all().map(Family::name).collect();
    all.join(", ")
}

fn base_law(word: &str) -> Result<BaseLaw, String> {
    let mut all = BaseLaw::ALL.into_iter();
    all.find(|law| law.word() == word).ok_or_else(|| {
        let words = BaseLaw::ALL.map(BaseLaw::word);
        format!("no law has that name; give one of {}", words.join(", "))
    })
}

//! A simulated specimen, as the command line describes it.

use clap::Args;
use mesh_damper_output::error::InputError;
use mesh_damper_rig::specimen::{DamperForce as _, Specimen, draw};

use super::effect;

/// Amplitude of the paper's table row that gives a specimen of a given density its coefficients, mm.
pub const SPECIMEN_AMPLITUDE: f64 = 0.1;

/// The simulated specimen.
#[derive(Args, Debug)]
pub struct SpecimenOptions {
    /// Density of the simulated specimen in g/cm³, 2 to 4
    #[arg(long, value_name = "G_PER_CM3", default_value_t = 3.0)]
    density: f64,
    /// Draw a specimen with a hidden effect by --seed, as `hil demo` does
    #[arg(long, conflicts_with_all = ["density", "effect"])]
    drawn: bool,
    /// Give the specimen this effect, as family:name=value,name=value; repeat it for more effects
    #[arg(long, value_name = "EFFECT")]
    effect: Vec<String>,
    /// Seed, a whole number: it draws the sensor noise, and the specimen of --drawn
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

impl SpecimenOptions {
    /// The specimen, its density in g/cm³, and its description in the recording.
    pub fn specimen(&self) -> Result<(Specimen, f64, String), InputError> {
        if self.drawn {
            let (specimen, drawn) = draw(self.seed);
            let described = format!(
                "simulated MMD, density_g_cm3 = {}, undeclared effect of seed {}",
                drawn.density, self.seed
            );
            return Ok((specimen, drawn.density, described));
        }
        let (low, high) = (2.0, 4.0);
        if !(low..=high).contains(&self.density) {
            return Err(InputError::new(
                "--density",
                format!("{} g/cm³ is outside the paper's tables", self.density),
                format!("give {low} to {high}"),
            ));
        }
        let mut described = format!("simulated MMD, density_g_cm3 = {}", self.density);
        let mut specimen = Specimen::of_density(self.density, SPECIMEN_AMPLITUDE);
        for text in &self.effect {
            let effect = effect::parse(text)?;
            if specimen.control().is_some() && effect.control_at(0.0).is_some() {
                return Err(InputError::new(
                    "--effect",
                    "gives the specimen a second control input",
                    "give one: a simulated specimen has one control input",
                ));
            }
            specimen = specimen.with(effect);
            described = format!("{described}, {text}");
        }
        Ok((specimen, self.density, described))
    }
}

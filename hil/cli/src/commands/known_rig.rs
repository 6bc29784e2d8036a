//! The options for what a laboratory knows about its rig.

use clap::Args;
use mesh_damper_recording::rig::{DisplacementZero, RigFacts};

/// What lies between the specimen and the recorded force.
#[derive(Args, Clone, Copy, Debug)]
pub struct KnownRig {
    /// Mass in kg that moves between the specimen and the load cell
    ///
    /// Its force is part of what the load cell measures. A load cell that is compensated for too large a mass has a negative one.
    #[arg(long, value_name = "KG", allow_hyphen_values = true, value_parser = finite)]
    fixture_mass: Option<f64>,
    /// Time in s by which the recorded force is late; negative if it is early
    ///
    /// A filter of the load cell makes the force late. A filter of the displacement sensor makes the displacement late, and so the force
    /// early. The force is moved back by this time.
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = finite)]
    force_delay: Option<f64>,
}

impl KnownRig {
    /// The facts, with the zero of the displacement.
    pub fn facts(&self, zero: Option<DisplacementZero>) -> RigFacts {
        RigFacts {
            fixture_mass: self.fixture_mass,
            force_delay: self.force_delay,
            zero,
        }
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|value| value.is_finite())
        .ok_or_else(|| "write a finite number".to_owned())
}

/// The zero with this word.
pub fn zero(word: &str) -> Result<DisplacementZero, String> {
    let mut all = DisplacementZero::ALL.into_iter();
    all.find(|zero| zero.word() == word).ok_or_else(|| {
        let words = DisplacementZero::ALL.map(DisplacementZero::word);
        format!("write one of {}", words.join(", "))
    })
}

//! A trial: two recordings of a specimen, and what it hides.

use mesh_damper_recording::Recording;
use mesh_damper_reference::protocol::MotionSample;
use mesh_damper_rig::specimen::HiddenEffect;
use serde::Serialize;

use super::described::DescribedEffect;
use super::path::Kind;
use super::programme::Programme;
use super::sensors::MotionSensors;

/// The correct answer of the tracer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// Nothing is hidden.
    None,
    /// One listed effect.
    Listed,
    /// Two listed effects.
    Pair,
    /// One unlisted effect.
    Unlisted,
}

/// The hidden effect of a specimen.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Hidden {
    /// The hidden effect uses separate physics.
    Specimen(HiddenEffect),
    /// The hidden effect uses the crate's physics.
    Described(DescribedEffect),
}

impl Hidden {
    /// Its family, or the kind of an unlisted one.
    pub fn family(&self) -> &'static str {
        match self {
            Self::Specimen(effect) => effect.family(),
            Self::Described(effect) => effect.family,
        }
    }

    /// Its parameters as (name, value, unit).
    pub fn parameters(&self) -> Vec<(&'static str, f64, &'static str)> {
        match self {
            Self::Specimen(effect) => effect.parameters(),
            Self::Described(effect) => effect.parameters(),
        }
    }
}

/// An effect and its size.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sized {
    /// The effect.
    pub effect: Hidden,
    /// RMS of the effect's force in the training test over the RMS of the noise.
    pub size: f64,
    /// RMS of the residual of eq 13, fitted separately at each amplitude, over the RMS of the noise.
    pub visible: f64,
}

/// Tests with blocks of sines.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Blocks {
    /// The tests.
    pub programme: Programme,
    /// RMS of the force's noise over the RMS of the force.
    pub noise: f64,
    /// Whether the chamber warms although nothing depends on it.
    pub warms: bool,
    /// Whether a current is set although nothing depends on it.
    pub is_set: bool,
}

/// Tests over any motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnyMotion {
    /// Motion of both tests.
    pub kind: Kind,
    /// Sensors of both tests.
    pub sensors: MotionSensors,
    /// Residual of eq 13 with all hidden effects over the error of the true law, in the training test.
    pub visible: f64,
}

/// The tests of a specimen.
#[derive(Clone, Debug, PartialEq)]
pub enum Test {
    /// Blocks of sines.
    Blocks(Blocks),
    /// Any motion.
    Motion(AnyMotion),
}

/// The hidden truth of a trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Secret {
    /// The seed.
    pub seed: u64,
    /// The correct answer of the tracer.
    pub class: Class,
    /// Density, g/cm³.
    pub density: f64,
    /// The hidden effects.
    pub effects: Vec<Sized>,
    /// Sampling rate, Hz.
    pub rate: f64,
    /// The tests.
    #[cfg_attr(feature = "schema", schemars(with = "Blocks"))]
    #[serde(flatten, serialize_with = "blocks")]
    pub test: Test,
}

/// The JSON of trials over any motion has another form: see [`MotionOutcome`](super::MotionOutcome).
fn blocks<S: serde::Serializer>(test: &Test, serializer: S) -> Result<S::Ok, S::Error> {
    match test {
        Test::Blocks(blocks) => Some(blocks),
        Test::Motion(_) => None,
    }
    .serialize(serializer)
}

impl Secret {
    /// The families, or kinds of the unlisted.
    pub fn families(&self) -> Vec<&'static str> {
        self.effects.iter().map(|e| e.effect.family()).collect()
    }

    /// The visibility of the least visible effect of blocks, or of all effects over any motion; infinite if there is none.
    pub fn visible(&self) -> f64 {
        match &self.test {
            _ if self.effects.is_empty() => f64::INFINITY,
            Test::Motion(motion) => motion.visible,
            Test::Blocks(_) => self
                .effects
                .iter()
                .fold(f64::INFINITY, |least, e| least.min(e.visible)),
        }
    }
}

/// Two recordings and their hidden truth.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The truth, which the tracer must not see.
    pub secret: Secret,
    /// To be fitted.
    pub training: Recording,
    /// To be predicted.
    pub held_out: Recording,
    /// RMS of the error that the true law leaves on the held-out force over the RMS of that force: for blocks its noise, over any
    /// motion the error along the motion as it is estimated.
    pub held_out_noise: f64,
    /// The true motion of the training test; empty for blocks.
    pub motion: Vec<MotionSample>,
}

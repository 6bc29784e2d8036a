//! Truth physics of a simulated metal mesh specimen: eq 13 with the table's coefficients, and effects that the law does
//! not know of. Shares no code with the crate's effects, so that tracing them is a test and not an echo.

mod draw;
mod hidden;
mod protocol;

pub use draw::{DrawnEffect, LARGEST_SHARE, SMALLEST_SHARE, draw, force_share};
pub use hidden::{HiddenEffect, SlipShape};
pub use protocol::{Block, Motion, PROTOCOL, motion};

use hidden::Hidden;

use crate::reference::law::Coefficients;
use crate::reference::tables;

/// What resists the actuator.
pub trait DamperForce {
    /// Force in kN that it takes to hold the specimen at `displacement` mm, moving at `velocity` mm/s and
    /// `acceleration` mm/s², `time` s after the test began and `dt` s after the previous call.
    ///
    /// Call it in order of time: what the specimen remembers moves on with each call.
    fn force(
        &mut self,
        time: f64,
        displacement: f64,
        velocity: f64,
        acceleration: f64,
        dt: f64,
    ) -> f64;

    /// Temperature, °C, after the last call.
    fn temperature(&self) -> f64;
}

/// Temperature at which the coefficients hold, and of a specimen that nothing warms, °C.
pub const REFERENCE_TEMPERATURE: f64 = 20.0;

/// A metal mesh damper on a simulated rig.
#[derive(Debug)]
pub struct Specimen {
    coefficients: Coefficients,
    hidden: Vec<Hidden>,
    temperature: f64,
}

impl Clone for Specimen {
    fn clone(&self) -> Self {
        Self {
            coefficients: self.coefficients,
            hidden: self.hidden.clone(),
            temperature: self.temperature,
        }
    }

    /// Into the room that is there.
    #[inline]
    fn clone_from(&mut self, source: &Self) {
        self.coefficients = source.coefficients;
        self.hidden.clone_from(&source.hidden);
        self.temperature = source.temperature;
    }
}

impl Specimen {
    /// A specimen that follows eq 13 with these coefficients, whatever the amplitude.
    pub fn new(coefficients: Coefficients) -> Self {
        Self {
            coefficients,
            hidden: Vec::new(),
            temperature: REFERENCE_TEMPERATURE,
        }
    }

    /// A specimen with the paper's coefficients at `density` g/cm³, those identified at `amplitude` mm.
    pub fn of_density(density: f64, amplitude: f64) -> Self {
        Self::new(tables::interpolate(density, amplitude))
    }

    /// The same with one more effect in it.
    ///
    /// # Panics
    /// When the effect is not [admissible](HiddenEffect::is_admissible).
    pub fn with(mut self, effect: HiddenEffect) -> Self {
        assert!(effect.is_admissible(), "no specimen can have {effect:?}");
        self.hidden.push(Hidden::at_rest(effect));
        self
    }

    /// The coefficients of its eq 13.
    pub fn coefficients(&self) -> Coefficients {
        self.coefficients
    }

    /// The effects in it, in the order in which they were added.
    pub fn effects(&self) -> impl Iterator<Item = HiddenEffect> + '_ {
        self.hidden.iter().map(Hidden::effect)
    }

    /// The same specimen as new: nothing remembered, at the reference temperature.
    pub fn at_rest(&self) -> Self {
        self.effects()
            .fold(Self::new(self.coefficients), Self::with)
    }
}

impl DamperForce for Specimen {
    fn force(
        &mut self,
        time: f64,
        displacement: f64,
        velocity: f64,
        acceleration: f64,
        dt: f64,
    ) -> f64 {
        let law = self.coefficients.force(displacement, velocity);
        let step = hidden::Step {
            time,
            displacement,
            velocity,
            acceleration,
            dt,
            law,
        };
        let mut total = law;
        for hidden in &mut self.hidden {
            total += hidden.force(&step);
            if let Some(temperature) = hidden.temperature() {
                self.temperature = temperature;
            }
        }
        total
    }

    fn temperature(&self) -> f64 {
        self.temperature
    }
}

//! Shared by the tests of this program: ticks, scales and laws.

use mesh_damper::converter::Scale;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::law::Law;
use mesh_damper::rig::Wiring;

/// A timer that loses no tick and counts the ticks.
#[derive(Default)]
pub struct Ticks(u32);

impl Ticks {
    /// The counter at the next tick.
    pub fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(1);
        self.0
    }
}

/// A full scale of 1 mm or 1 kN, without an offset.
pub fn unit() -> Scale {
    Scale::new(1.0, 0.0).unwrap()
}

/// A force channel that is inverted and reads 0.25 kN at rest.
pub fn kilonewtons() -> Scale {
    Scale::new(-5.0, 0.25).unwrap()
}

/// [`unit`] for every channel.
pub fn units() -> Wiring {
    Wiring {
        displacement: unit(),
        force: unit(),
        command: unit(),
    }
}

/// A spring of 1 kN/mm.
pub fn elastic() -> AugmentedLaw<f32, 1> {
    AugmentedLaw::new(Law::new(1.0, 0.0, 0.0, 0.0).unwrap())
}

//! Kinds of devices.

use rand::Rng;
use serde::Serialize;

use super::draw::Drawn;
use super::{Device, Scale};

/// A kind of device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// A linear spring with a viscous damper: nothing beyond the law.
    Linear,
    /// The mixed damping law itself: nothing beyond it.
    MixedDamping,
    /// Metal mesh with the hysteresis of Bouc and Wen.
    BoucWen,
    /// A joint whose loops are pinched and lose strength.
    Pinching,
    /// Wire rope with an asymmetric envelope.
    WireRope,
    /// Sliders with distributed limits.
    Masing,
    /// Sliders with other limits in each direction.
    AsymmetricSliders,
    /// One to three Maxwell branches beside a spring.
    Maxwell,
    /// A spring-pot beside a spring.
    Fractional,
    /// Filled rubber with Berg's friction.
    FilledRubber,
    /// Rubber that softens while it moves.
    Payne,
    /// A shock absorber with valves and a gas volume.
    ShockAbsorber,
    /// An orifice in series with a stiffness.
    SeriesOrifice,
    /// A magnetorheological damper with the hysteresis of Bouc and Wen.
    MrBoucWen,
    /// A magnetorheological damper with a yield force over velocity.
    MrTanh,
    /// Friction with bristles and the Stribeck curve.
    Stribeck,
    /// A friction damper whose clamping a voltage sets.
    Clamped,
    /// An air spring with a leak, whose pressure is set.
    AirSpring,
    /// A superelastic brace.
    Superelastic,
    /// Stops behind a gap.
    Gap,
    /// A rocking connection with yielding bars.
    Rocking,
    /// Damping that does not depend on the rate.
    Structural,
    /// An inerter.
    Inerter,
    /// Friction that depends on the normal load.
    LoadedFriction,
    /// Friction over a wavy surface.
    WavyFriction,
    /// A hydraulic mount with an inertia track.
    HydraulicMount,
    /// A damper that warms.
    Warming,
    /// Two of the others in parallel.
    Pair,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 28] = [
        Self::Linear,
        Self::MixedDamping,
        Self::BoucWen,
        Self::Pinching,
        Self::WireRope,
        Self::Masing,
        Self::AsymmetricSliders,
        Self::Maxwell,
        Self::Fractional,
        Self::FilledRubber,
        Self::Payne,
        Self::ShockAbsorber,
        Self::SeriesOrifice,
        Self::MrBoucWen,
        Self::MrTanh,
        Self::Stribeck,
        Self::Clamped,
        Self::AirSpring,
        Self::Superelastic,
        Self::Gap,
        Self::Rocking,
        Self::Structural,
        Self::Inerter,
        Self::LoadedFriction,
        Self::WavyFriction,
        Self::HydraulicMount,
        Self::Warming,
        Self::Pair,
    ];
    /// Those whose force a control input sets.
    pub const CONTROLLED: [Self; 4] = [
        Self::MrBoucWen,
        Self::MrTanh,
        Self::Clamped,
        Self::AirSpring,
    ];
    /// Those with nothing beyond the law.
    pub const PLAIN: [Self; 2] = [Self::Linear, Self::MixedDamping];

    /// The single ones with something beyond the law.
    pub fn beyond() -> &'static [Self] {
        &Self::ALL[Self::PLAIN.len()..Self::ALL.len() - 1]
    }

    /// The name of its control input, with the unit, and the range of its largest values in that unit.
    pub fn control(self) -> (&'static str, [f64; 2]) {
        match self {
            Self::AirSpring => ("supply_pressure_bar", [2.0, 10.0]),
            Self::Clamped => ("piezo_V", [50.0, 1000.0]),
            _ => ("current_A", [0.3, 5.0]),
        }
    }

    /// A device of this kind.
    pub fn device(self, scale: Scale, rng: &mut impl Rng) -> Device {
        let parts = Drawn::parts(self, rng);
        Device { scale, parts }
    }
}

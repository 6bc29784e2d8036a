//! Damping that differs between the directions: valves with different openings, wires with a drawing direction.

use super::description::{Cost, Dependence, Description, EffectKind, Energy, Growth, Parameter};
use super::{ClampedMotion, Equations, LawForce, Packed};
use crate::error::ConfigError;
use crate::real::{Real, in_range};

/// F = d·c·|v|^α: adds the part d of the law's own damping where the displacement rises, and subtracts it where it falls.
///
/// It has no state. With |d| ≤ 1 the law's damping and this force together are (1 + d·sgn v)·c·|v|^α·sgn v, which never drives the
/// motion. It dissipates nothing in a cycle that is symmetric in velocity: it shifts the loop by d times the damping, and a rig may
/// take that for a preload.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional<R> {
    difference: R,
}

impl<R: Real> Directional<R> {
    /// * `difference`: d, relative increase of the damping where the displacement rises, −1…1
    ///
    /// # Errors
    /// `difference` not finite or out of range.
    pub fn new(difference: R) -> Result<Self, ConfigError> {
        let new = Self { difference };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for Directional<R> {
    const DESCRIPTION: Description = Description {
        name: "directional",
        family: "directional",
        number: 20,
        kind: EffectKind::Modulator,
        cost: Cost::Rare,
        parameters: &[Parameter::new("difference", "1", -1.0, 1.0)],
        most: 1,
        typical: &[0.3],
        depends_on: &[Dependence::Velocity],
        outside: Growth::OfDamping,
        energy: Energy::ScalesDamping,
        scales_law: true,
        sentence: "Damping that is stronger one way than the other.",
    };
    const NONE: Self = Self {
        difference: R::ZERO,
    };

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [difference] = super::exactly(parameters)?;
        Self::new(R::from_f64(difference))
    }

    fn check(&self) -> Result<(), ConfigError> {
        in_range("difference", self.difference, -1.0, 1.0).map(|_| ())
    }

    fn least_damping(&self) -> (&'static str, R, R) {
        ("difference", self.difference, -self.difference.abs())
    }

    /// At rest the law has no damping, and so this force is 0.
    #[inline(always)]
    fn force_of_law(&self, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
        let rising = self.difference * law.damping;
        if motion.velocity() < R::ZERO {
            -rising
        } else {
            rising
        }
    }
}

impl Packed for Directional<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        put(self.difference);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let &[difference] = words else { return None };
        Some(Self { difference })
    }
}

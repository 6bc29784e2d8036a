//! Inputs of the effects on a tick: the motion clamped to the limits, and the mixed damping law's force.

use crate::law::Law;
use crate::limits;
use crate::real::Real;

/// Most control inputs of a damper: the current of a coil, the pressure of a gas.
pub const CONTROLS: usize = 4;

/// One tick of motion, as input of the effects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Motion<R> {
    /// Displacement, mm.
    pub displacement: R,
    /// Velocity, mm/s.
    pub velocity: R,
    /// Acceleration, mm/s².
    pub acceleration: R,
    /// Cycles since the test began, the current one's fraction included.
    pub cycles: R,
    /// Temperature, °C. A constant where it is not measured.
    pub temperature: R,
    /// Control inputs of the damper, in the units of the effects that depend on them; 0 for an input that does not exist.
    pub controls: [R; CONTROLS],
}

impl<R: Real> Motion<R> {
    /// A displacement in mm and a velocity in mm/s; everything else is 0.
    pub const fn at(displacement: R, velocity: R) -> Self {
        Self {
            displacement,
            velocity,
            acceleration: R::ZERO,
            cycles: R::ZERO,
            temperature: R::ZERO,
            controls: [R::ZERO; CONTROLS],
        }
    }

    /// Clamps the motion to [`limits`], once per tick rather than in every effect. NaN becomes 0.
    #[inline(always)]
    pub fn clamped(&self) -> ClampedMotion<R> {
        ClampedMotion(Self {
            displacement: self.displacement.clamped(R::from_f64(limits::DISPLACEMENT)),
            velocity: self.velocity.clamped(R::from_f64(limits::VELOCITY)),
            acceleration: self.acceleration.clamped(R::from_f64(limits::ACCELERATION)),
            cycles: self.cycles.abs(),
            temperature: self.temperature.clamped(R::from_f64(limits::TEMPERATURE)),
            controls: self.controls,
        })
    }
}

/// A [`Motion`] clamped to [`limits`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClampedMotion<R>(pub(super) Motion<R>);

impl<R: Real> ClampedMotion<R> {
    /// Displacement, mm.
    #[inline(always)]
    pub fn displacement(&self) -> R {
        self.0.displacement
    }
    /// Velocity, mm/s.
    #[inline(always)]
    pub fn velocity(&self) -> R {
        self.0.velocity
    }
    /// Acceleration, mm/s².
    #[inline(always)]
    pub fn acceleration(&self) -> R {
        self.0.acceleration
    }
    /// Cycles since the test began, at least 0. Not clamped: their users accept any number of them, and NaN.
    #[inline(always)]
    pub fn cycles(&self) -> R {
        self.0.cycles
    }
    /// Temperature, °C.
    #[inline(always)]
    pub fn temperature(&self) -> R {
        self.0.temperature
    }
    /// Control input at index `place`, −1e6…1e6; 0 for NaN and beyond the last index. Clamped here, because most laws read none.
    #[inline(always)]
    pub fn control(&self, place: usize) -> R {
        let control = self.0.controls.get(place).copied().unwrap_or(R::ZERO);
        control.clamped(R::from_f64(limits::CONTROL))
    }
}

/// Force of eq 13 on a tick, kN.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LawForce<R> {
    /// c·|v|^α·sgn v
    pub damping: R,
    /// Sum of the damping force and the elastic force.
    pub total: R,
}

impl<R: Real> LawForce<R> {
    /// An elastic force of 1 without damping, and a damping force of 1 without elastic force.
    pub(crate) fn units() -> [Self; 2] {
        [R::ZERO, R::ONE].map(|damping| Self {
            damping,
            total: R::ONE,
        })
    }

    /// Force of `law` at `motion`, with its damping force from `damping`.
    #[inline(always)]
    pub(crate) fn of(law: &Law<R>, motion: &ClampedMotion<R>, damping: impl Fn(R) -> R) -> Self {
        let damping = damping(motion.velocity());
        Self {
            damping,
            total: law.elastic_force_within(motion.displacement()) + damping,
        }
    }
}

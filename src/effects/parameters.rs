//! An effect by its parameters: as a file or a pack carries it.

use super::{
    Asymmetry, Drift, Effect, Hardening, Inertia, MAX_STICK_SLIP_ELEMENTS, Offset, Relaxation,
    StickSlip, Temperature, Viscous,
};
use crate::error::ConfigError;
use crate::real::Real;

/// An effect as its constructor takes it, with the units and ranges of that constructor.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EffectParameters<R> {
    /// Of [`Offset::new`].
    Offset {
        /// kN
        force: R,
    },
    /// Of [`Asymmetry::new`].
    Asymmetry {
        /// kN/mm²
        k2: R,
    },
    /// Of [`Hardening::new`].
    Hardening {
        /// kN/mm⁵
        k5: R,
    },
    /// Of [`StickSlip::new`]: stiffness in kN/mm and slip limit in mm of each element.
    StickSlip(heapless::Vec<(R, R), MAX_STICK_SLIP_ELEMENTS>),
    /// Of [`Viscous::new`].
    Viscous {
        /// kN·s/mm
        c1: R,
    },
    /// Of [`Relaxation::new`].
    Relaxation {
        /// kN/mm
        stiffness: R,
        /// s
        time: R,
        /// s
        tick: R,
    },
    /// Of [`Inertia::new`].
    Inertia {
        /// kg
        mass: R,
    },
    /// Of [`Drift::new`].
    Drift {
        /// kN/mm
        stiffness: R,
        /// Cycles until 63 % of the change is done.
        cycles: R,
    },
    /// Of [`Temperature::new`].
    Temperature {
        /// 1/°C
        beta: R,
        /// °C
        reference: R,
    },
}

impl<R: Real> EffectParameters<R> {
    /// The effect.
    ///
    /// # Errors
    /// The parameter that its constructor refuses.
    pub fn effect(&self) -> Result<Effect<R>, ConfigError> {
        match self {
            Self::Offset { force } => Offset::new(*force).map(Effect::Offset),
            Self::Asymmetry { k2 } => Asymmetry::new(*k2).map(Effect::Asymmetry),
            Self::Hardening { k5 } => Hardening::new(*k5).map(Effect::Hardening),
            Self::StickSlip(elements) => StickSlip::new(elements).map(Effect::StickSlip),
            Self::Viscous { c1 } => Viscous::new(*c1).map(Effect::Viscous),
            Self::Relaxation {
                stiffness,
                time,
                tick,
            } => Relaxation::new(*stiffness, *time, *tick).map(Effect::Relaxation),
            Self::Inertia { mass } => Inertia::new(*mass).map(Effect::Inertia),
            Self::Drift { stiffness, cycles } => Drift::new(*stiffness, *cycles).map(Effect::Drift),
            Self::Temperature { beta, reference } => {
                Temperature::new(*beta, *reference).map(Effect::Temperature)
            }
        }
    }
}

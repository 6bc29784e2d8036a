//! An effect by its parameters: as a file or a pack carries it.

use super::{
    Asymmetry, BoucWen, Compliance, Delay, Drift, Effect, Gap, Hardening, Inertia, LoadFriction,
    MAX_BRANCHES, MAX_CONTACTS, MAX_STICK_SLIP_ELEMENTS, MAX_TONES, Offset, Periodic, Relaxation,
    StickSlip, Stop, Temperature, Viscous,
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
        /// Stiffness in kN/mm and time in s of each branch.
        branches: heapless::Vec<(R, R), MAX_BRANCHES>,
        /// s
        tick: R,
    },
    /// Of [`Inertia::new`].
    Inertia {
        /// kg
        mass: R,
    },
    /// Of [`LoadFriction::new`].
    LoadFriction {
        /// 1/mm
        load: R,
    },
    /// Of [`Drift::new`] and [`Drift::with_forces`].
    Drift {
        /// kN/mm
        stiffness: R,
        /// Cycles until 63 % of the change is done.
        cycles: R,
        /// Change of eq 13's elastic force, as a part of it.
        elastic_change: R,
        /// The same of its damping force.
        damping_change: R,
    },
    /// Of [`Temperature::new`] and [`Temperature::with_damping`].
    Temperature {
        /// 1/°C
        beta: R,
        /// 1/°C
        beta_damping: R,
        /// °C
        reference: R,
    },
    /// Of [`Stop::new`]: stiffness in kN/mm and gap in mm of each contact.
    Stop(heapless::Vec<(R, R), MAX_CONTACTS>),
    /// Of [`Gap::new`].
    Gap {
        /// mm
        half_width: R,
        /// Whether velocity and acceleration are felt within the play.
        damps_inside: bool,
    },
    /// Of [`BoucWen::new`].
    BoucWen {
        /// kN/mm
        stiffness: R,
        /// mm
        slip_limit: R,
        /// Exponent of the transition.
        sharpness: R,
    },
    /// Of [`Periodic::new`].
    Periodic {
        /// Amplitude in kN, frequency in Hz and phase in rad of each tone.
        tones: heapless::Vec<(R, f64, f64), MAX_TONES>,
        /// s
        tick: f64,
    },
    /// Of [`Compliance::new`].
    Compliance {
        /// kN/mm
        stiffness: R,
        /// s
        tick: R,
    },
    /// Of [`Delay::new`].
    Delay {
        /// s
        time: R,
        /// s
        tick: R,
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
            Self::Relaxation { branches, tick } => {
                Relaxation::new(branches, *tick).map(Effect::Relaxation)
            }
            Self::Inertia { mass } => Inertia::new(*mass).map(Effect::Inertia),
            Self::LoadFriction { load } => LoadFriction::new(*load).map(Effect::LoadFriction),
            Self::Drift {
                stiffness,
                cycles,
                elastic_change,
                damping_change,
            } => Drift::new(*stiffness, *cycles)
                .and_then(|stiffness| stiffness.with_forces(*elastic_change, *damping_change))
                .map(Effect::Drift),
            Self::Temperature {
                beta,
                beta_damping,
                reference,
            } => Temperature::new(*beta, *reference)
                .and_then(|both| both.with_damping(*beta_damping))
                .map(Effect::Temperature),
            Self::Stop(contacts) => Stop::new(contacts).map(Effect::Stop),
            Self::Gap {
                half_width,
                damps_inside,
            } => Gap::new(*half_width, *damps_inside).map(Effect::Gap),
            Self::BoucWen {
                stiffness,
                slip_limit,
                sharpness,
            } => BoucWen::new(*stiffness, *slip_limit, *sharpness).map(Effect::BoucWen),
            Self::Periodic { tones, tick } => Periodic::new(tones, *tick).map(Effect::Periodic),
            Self::Compliance { stiffness, tick } => {
                Compliance::new(*stiffness, *tick).map(Effect::Compliance)
            }
            Self::Delay { time, tick } => Delay::new(*time, *tick).map(Effect::Delay),
        }
    }
}

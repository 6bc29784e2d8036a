//! Physical effects that eq 13 lacks, one per file, and the law that carries a set of them.
//!
//! Every effect has a configuration (validated, shared, swappable at a cycle boundary) and a state (what it remembers),
//! and adds a force. All are generic over the float: identification runs them in `f64`, the firmware in `f32`.

mod asymmetry;
mod drift;
mod hardening;
mod inertia;
mod offset;
mod parameters;
mod relaxation;
mod stick_slip;
mod temperature;
mod viscous;

pub use asymmetry::Asymmetry;
pub use drift::Drift;
pub use hardening::Hardening;
pub use inertia::Inertia;
pub use offset::Offset;
pub use parameters::EffectParameters;
pub use relaxation::Relaxation;
pub use stick_slip::{MAX_ELEMENTS as MAX_STICK_SLIP_ELEMENTS, StickSlip};
pub use temperature::Temperature;
pub use viscous::Viscous;

use crate::error::ConfigError;
use crate::law::Law;
use crate::real::Real;

/// One tick of motion as the effects see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion<R> {
    /// Displacement, mm.
    pub displacement: R,
    /// Velocity, mm/s.
    pub velocity: R,
    /// Acceleration, mm/s².
    pub acceleration: R,
    /// Cycles since the test began, the current one's fraction included.
    pub cycles: R,
    /// Temperature, °C. A constant where nothing measures it.
    pub temperature: R,
}

/// A force beside the law's.
pub trait EffectForce<R: Real> {
    /// What the effect remembers from tick to tick; its default is the effect at rest.
    type State: Copy + Default;

    /// The force in kN that the effect adds on this tick to eq 13's, `law_force` kN. Called once per tick, in order.
    fn force(&self, state: &mut Self::State, motion: &Motion<R>, law_force: R) -> R;
}

macro_rules! effects {
    ($($(#[$doc:meta])* $name:ident),+ $(,)?) => {
        /// Any one effect's configuration.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Effect<R> {
            $($(#[$doc])* $name($name<R>)),+
        }

        /// The state of any one effect.
        #[derive(Clone, Copy, Debug)]
        #[non_exhaustive]
        pub enum EffectState<R: Real> {
            $($(#[$doc])* $name(<$name<R> as EffectForce<R>>::State)),+
        }

        impl<R: Real> Effect<R> {
            /// The state of this effect at rest.
            pub fn at_rest(&self) -> EffectState<R> {
                match self {
                    $(Self::$name(_) => EffectState::$name(Default::default())),+
                }
            }

            /// The force in kN that the effect adds on this tick. A state of another effect is first replaced by this
            /// effect's own at rest.
            #[inline]
            pub fn force(&self, state: &mut EffectState<R>, motion: &Motion<R>, law_force: R) -> R {
                match self {
                    $(Self::$name(effect) => {
                        let mut own = match *state {
                            EffectState::$name(own) => own,
                            _ => Default::default(),
                        };
                        let force = effect.force(&mut own, motion, law_force);
                        *state = EffectState::$name(own);
                        force
                    })+
                }
            }
        }
    };
}

effects! {
    /// A constant force.
    Offset,
    /// Even stiffness.
    Asymmetry,
    /// Odd stiffness above the cubic.
    Hardening,
    /// Rate-independent friction with elastic pre-sliding.
    StickSlip,
    /// A linear dashpot.
    Viscous,
    /// A spring and a dashpot in series.
    Relaxation,
    /// A moving mass.
    Inertia,
    /// A stiffness that settles with the cycles.
    Drift,
    /// A force that scales with temperature.
    Temperature,
}

/// Eq 13 and up to `N` added effects.
#[derive(Clone, Debug, PartialEq)]
pub struct AugmentedLaw<R, const N: usize> {
    law: Law<R>,
    effects: heapless::Vec<Effect<R>, N>,
}

/// What the effects of an [`AugmentedLaw`] remember.
#[derive(Clone, Debug)]
pub struct AugmentedState<R: Real, const N: usize> {
    effects: [EffectState<R>; N],
}

impl<R: Real, const N: usize> AugmentedState<R, N> {
    /// Whatever the effects are: a state of another effect counts as the effect's own at rest. All bits are 0.
    pub(crate) const AT_REST: Self = Self {
        effects: [EffectState::Offset(()); N],
    };
}

impl<R: Real, const N: usize> AugmentedLaw<R, N> {
    /// The law alone.
    pub const fn new(law: Law<R>) -> Self {
        Self {
            law,
            effects: heapless::Vec::new(),
        }
    }

    /// The law with one more effect.
    ///
    /// # Errors
    /// [`ConfigError::Full`] when `N` effects are in it already.
    pub fn with(mut self, effect: Effect<R>) -> Result<Self, ConfigError> {
        self.effects.push(effect).map_err(|_| ConfigError::Full {
            field: "effects",
            capacity: N,
        })?;
        Ok(self)
    }

    /// The same effects beside another eq 13: when the amplitude changes and its coefficients are tabulated over it.
    pub fn set_law(&mut self, law: Law<R>) {
        self.law = law;
    }

    /// Eq 13 alone.
    pub fn law(&self) -> &Law<R> {
        &self.law
    }

    /// The added effects, in order.
    pub fn effects(&self) -> &[Effect<R>] {
        &self.effects
    }

    /// All effects at rest.
    pub fn at_rest(&self) -> AugmentedState<R, N> {
        AugmentedState::AT_REST
    }

    /// Force in kN on this tick: the law's and every effect's. Call it once per tick.
    #[inline]
    pub fn force(&self, state: &mut AugmentedState<R, N>, motion: &Motion<R>) -> R {
        let law_force = self.law.force(motion.displacement, motion.velocity);
        self.with_effects(state, motion, law_force)
    }

    /// `law_force`, which is eq 13's on this tick in kN whoever computed it, and every effect's force.
    #[inline]
    pub(crate) fn with_effects(
        &self,
        state: &mut AugmentedState<R, N>,
        motion: &Motion<R>,
        law_force: R,
    ) -> R {
        let mut total = law_force;
        for (effect, state) in self.effects.iter().zip(&mut state.effects) {
            total += effect.force(state, motion, law_force);
        }
        total
    }
}

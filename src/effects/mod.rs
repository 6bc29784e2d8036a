//! Physical effects that eq 13 lacks, one per file, and the law that carries a set of them.
//!
//! Every effect has a configuration (validated, shared, swappable at a cycle boundary) and a state (what it remembers),
//! and adds a force. All are generic over the float: identification runs them in `f64`, the firmware in `f32`.

mod offset;

pub use offset::Offset;

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
    /// Cycles completed since the test began.
    pub cycle: u32,
    /// Temperature, °C. A constant where nothing measures it.
    pub temperature: R,
}

/// A force beside the law's.
pub trait EffectForce<R: Real> {
    /// What the effect remembers from tick to tick; its default is the effect at rest.
    type State: Copy + Default;

    /// The force in kN that the effect adds on this tick. Called once per tick, in order.
    fn force(&self, state: &mut Self::State, motion: &Motion<R>) -> R;
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
            pub fn force(&self, state: &mut EffectState<R>, motion: &Motion<R>) -> R {
                match (self, &mut *state) {
                    $((Self::$name(effect), EffectState::$name(state)) => effect.force(state, motion),)+
                    #[allow(unreachable_patterns, reason = "unreachable only while there is one effect")]
                    _ => {
                        *state = self.at_rest();
                        self.force(state, motion)
                    }
                }
            }
        }
    };
}

effects! {
    /// A constant force.
    Offset,
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
    effects: heapless::Vec<EffectState<R>, N>,
}

impl<R: Real, const N: usize> AugmentedLaw<R, N> {
    /// The law alone.
    pub fn new(law: Law<R>) -> Self {
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
        AugmentedState {
            effects: self.effects.iter().map(Effect::at_rest).collect(),
        }
    }

    /// Force in kN on this tick: the law's and every effect's. Call it once per tick.
    #[inline]
    pub fn force(&self, state: &mut AugmentedState<R, N>, motion: &Motion<R>) -> R {
        let mut total = self.law.force(motion.displacement, motion.velocity);
        for (effect, state) in self.effects.iter().zip(&mut state.effects) {
            total += effect.force(state, motion);
        }
        total
    }
}

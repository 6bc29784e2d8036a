//! Physical effects that eq 13 lacks, one per file, and the law that carries a set of them.
//!
//! Every effect has a configuration (validated, shared, swappable at a cycle boundary) and a state (what it remembers).
//! All are generic over the float: identification runs them in `f64`, the firmware in `f32`.
//!
//! Most add a force to eq 13's. Three lie between the specimen and what is measured, and are stages that a tick passes
//! through:
//!
//! ```text
//! motion ─▶ part of a tick ─▶ gap ─▶ compliance ─▶ eq 13 and every effect that adds a force ─▶ whole ticks ─▶ force
//! ```

mod asymmetry;
mod bouc_wen;
mod compliance;
pub mod correction;
mod delay;
mod drift;
mod gap;
mod hardening;
mod inertia;
mod load_friction;
mod offset;
mod packed;
mod parameters;
mod periodic;
mod relaxation;
mod stick_slip;
mod stop;
mod temperature;
mod viscous;

pub use asymmetry::Asymmetry;
pub use bouc_wen::BoucWen;
pub use compliance::Compliance;
pub use correction::Correction;
pub use delay::{Delay, MAX_DELAY};
pub use drift::Drift;
pub use gap::Gap;
pub use hardening::Hardening;
pub use inertia::Inertia;
pub use load_friction::LoadFriction;
pub use offset::Offset;
pub use parameters::EffectParameters;
pub use periodic::{MAX_TONES, Periodic};
pub use relaxation::{MAX_BRANCHES, Relaxation};
pub use stick_slip::{MAX_ELEMENTS as MAX_STICK_SLIP_ELEMENTS, StickSlip};
pub use stop::{MAX_CONTACTS, Stop};
pub use temperature::Temperature;
pub use viscous::Viscous;

use crate::error::ConfigError;
use crate::law::Law;
use crate::limits;
use crate::real::Real;
use compliance::ComplianceState;
use correction::CorrectionState;
use delay::DelayState;

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

impl<R: Real> Motion<R> {
    /// Within [`limits`], once per tick rather than in every effect. NaN becomes 0.
    #[inline(always)]
    pub fn confined(&self) -> ConfinedMotion<R> {
        ConfinedMotion(Self {
            displacement: self
                .displacement
                .confined(R::from_f64(limits::DISPLACEMENT)),
            velocity: self.velocity.confined(R::from_f64(limits::VELOCITY)),
            acceleration: self
                .acceleration
                .confined(R::from_f64(limits::ACCELERATION)),
            cycles: self.cycles.abs(),
            temperature: self.temperature.confined(R::from_f64(limits::TEMPERATURE)),
        })
    }
}

/// A [`Motion`] within [`limits`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfinedMotion<R>(Motion<R>);

impl<R: Real> ConfinedMotion<R> {
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
    /// Cycles since the test began, at least 0. Not confined: what reads it takes any number of them, and NaN.
    #[inline(always)]
    pub fn cycles(&self) -> R {
        self.0.cycles
    }
    /// Temperature, °C.
    #[inline(always)]
    pub fn temperature(&self) -> R {
        self.0.temperature
    }
}

/// What eq 13 comes to on a tick, kN.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LawForce<R> {
    /// c·|v|^α·sgn v
    pub damping: R,
    /// With the elastic force.
    pub total: R,
}

impl<R: Real> LawForce<R> {
    /// `law` at `motion`, its damping by `damping`.
    #[inline(always)]
    fn of(law: &Law<R>, motion: &ConfinedMotion<R>, damping: impl Fn(R) -> R) -> Self {
        let damping = damping(motion.velocity());
        Self {
            damping,
            total: law.elastic_force_within(motion.displacement()) + damping,
        }
    }
}

/// A force beside the law's.
pub trait EffectForce<R: Real> {
    /// What the effect remembers from tick to tick; `()` for most.
    type State: Copy + Default;

    /// Whether what it is made of is finite and within what its constructor can give: for one that was not constructed, but
    /// read.
    ///
    /// # Errors
    /// The field that is not.
    fn check(&self) -> Result<(), ConfigError>;

    /// The state at rest at `motion`, that of the first tick.
    #[inline(always)]
    fn begin(&self, _motion: &ConfinedMotion<R>) -> Self::State {
        Default::default()
    }

    /// The force of this tick, where the state is none before the first.
    #[inline(always)]
    fn next(
        &self,
        state: &mut Option<Self::State>,
        motion: &ConfinedMotion<R>,
        law: LawForce<R>,
    ) -> R {
        let state = state.get_or_insert_with(|| self.begin(motion));
        self.force(state, motion, law)
    }

    /// The force in kN that the effect adds on this tick to eq 13's, `law`. Called once per tick, in order.
    fn force(&self, state: &mut Self::State, motion: &ConfinedMotion<R>, law: LawForce<R>) -> R;
}

/// The first `used` of what an effect has room for, at least one.
///
/// # Errors
/// None, or more than there is room for.
#[inline(never)]
fn some<'t, T>(field: &'static str, all: &'t [T], used: usize) -> Result<&'t [T], ConfigError> {
    match all.get(..used) {
        Some([]) => Err(ConfigError::Empty(field)),
        Some(used) => Ok(used),
        None => Err(ConfigError::Full {
            field,
            capacity: all.len(),
        }),
    }
}

macro_rules! effects {
    (
        plain: $($(#[$doc:meta])* $field:ident: $name:ident),+;
        costly: $($(#[$costly_doc:meta])* $costly_field:ident: $costly:ident),+;
        with_memory: $($(#[$memory_doc:meta])* $memory_field:ident: $memory:ident),+;
        rare: $($(#[$rare_doc:meta])* $rare_field:ident: $rare:ident),+;
        stages: $($(#[$stage_doc:meta])* $stage_field:ident: $stage:ident),+;
    ) => {
        /// Any one effect's configuration.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Effect<R> {
            $($(#[$doc])* $name($name<R>),)+
            $($(#[$costly_doc])* $costly($costly<R>),)+
            $($(#[$memory_doc])* $memory($memory<R>),)+
            $($(#[$rare_doc])* $rare($rare<R>),)+
            $($(#[$stage_doc])* $stage($stage<R>)),+
        }

        impl<R: Real> Effect<R> {
            /// [`EffectForce::check`].
            #[inline(never)]
            pub(crate) fn check(&self) -> Result<(), ConfigError> {
                match self {
                    $(Self::$name(effect) => effect.check(),)+
                    $(Self::$costly(effect) => effect.check(),)+
                    $(Self::$memory(effect) => effect.check(),)+
                    $(Self::$rare(effect) => effect.check(),)+
                    $(Self::$stage(effect) => effect.check()),+
                }
            }

            /// Its bit, and the field that holds it.
            fn kind(&self) -> (u32, &'static str) {
                match self {
                    $(Self::$name(_) => (Kind::$name.bit(), stringify!($field)),)+
                    $(Self::$costly(_) => (Kind::$costly.bit(), stringify!($costly_field)),)+
                    $(Self::$memory(_) => (Kind::$memory.bit(), stringify!($memory_field)),)+
                    $(Self::$rare(_) => (Kind::$rare.bit(), stringify!($rare_field)),)+
                    $(Self::$stage(_) => (Kind::$stage.bit(), stringify!($stage_field))),+
                }
            }
        }

        /// Kinds of effects, by the number of their bit.
        #[derive(Clone, Copy)]
        enum Kind {
            $($name,)+
            $($costly,)+
            $($memory,)+
            $($rare,)+
            $($stage,)+
            /// No [`Effect`]: it counts among them as none.
            Correction,
        }

        impl Kind {
            const PLAIN: u32 = $(Self::$name.bit())|+;
            const RARE: u32 = $(Self::$rare.bit())|+;
            const CORRECTION: u32 = Self::Correction.bit();
            const STAGES: u32 = $(Self::$stage.bit())|+;

            const fn bit(self) -> u32 {
                1 << self as u32
            }
        }

        /// Up to one effect of each kind. The plain ones are a multiplication or two and are all taken where one is there; one
        /// test stands for all rare ones and the correction.
        #[derive(Clone, Debug, PartialEq)]
        struct Effects<R> {
            /// The bits of those that are there, and of the correction.
            present: u32,
            $($field: $name<R>,)+
            $($costly_field: $costly<R>,)+
            $($memory_field: $memory<R>,)+
            $($rare_field: $rare<R>,)+
            $($stage_field: $stage<R>),+
        }

        /// What the effects of an [`AugmentedLaw`] remember: nothing before the first tick.
        #[derive(Clone, Debug)]
        // The longest comes first: the others are within reach of a load's offset from what follows.
        #[repr(C)]
        pub struct AugmentedState<R: Real> {
            delay: DelayState<R>,
            $($memory_field: Option<<$memory<R> as EffectForce<R>>::State>,)+
            $($rare_field: Option<<$rare<R> as EffectForce<R>>::State>,)+
            compliance: Option<ComplianceState<R>>,
            correction: CorrectionState,
        }

        impl<R: Real> AugmentedState<R> {
            /// Before the first tick, whatever the effects are. All bits are 0.
            pub(crate) const AT_REST: Self = Self {
                $($memory_field: None,)+
                $($rare_field: None,)+
                compliance: None,
                delay: DelayState::EMPTY,
                correction: CorrectionState::NEW,
            };
        }

        impl<R: Real> Effects<R> {
            /// All bits are 0.
            const NONE: Self = Self {
                present: 0,
                $($field: $name::NONE,)+
                $($costly_field: $costly::NONE,)+
                $($memory_field: $memory::NONE,)+
                $($rare_field: $rare::NONE,)+
                $($stage_field: $stage::NONE),+
            };

            fn add(&mut self, effect: Effect<R>) -> Result<(), ConfigError> {
                let (bit, field) = effect.kind();
                if self.present & bit != 0 {
                    return Err(ConfigError::Full { field, capacity: 1 });
                }
                self.present |= bit;
                match effect {
                    $(Effect::$name(effect) => self.$field = effect,)+
                    $(Effect::$costly(effect) => self.$costly_field = effect,)+
                    $(Effect::$memory(effect) => self.$memory_field = effect,)+
                    $(Effect::$rare(effect) => self.$rare_field = effect,)+
                    $(Effect::$stage(effect) => self.$stage_field = effect),+
                }
                Ok(())
            }

            /// The bits of the effects.
            fn kinds(&self) -> u32 {
                self.present & !Kind::CORRECTION
            }

            #[inline(always)]
            fn has(&self, kind: Kind) -> bool {
                self.present & kind.bit() != 0
            }

            fn iter(&self) -> impl Iterator<Item = Effect<R>> {
                [
                    $(self.has(Kind::$name).then_some(Effect::$name(self.$field)),)+
                    $(self.has(Kind::$costly).then_some(Effect::$costly(self.$costly_field)),)+
                    $(self.has(Kind::$memory).then_some(Effect::$memory(self.$memory_field)),)+
                    $(self.has(Kind::$rare).then_some(Effect::$rare(self.$rare_field)),)+
                    $(self.has(Kind::$stage).then_some(Effect::$stage(self.$stage_field))),+
                ]
                .into_iter()
                .flatten()
            }

            /// `law` and every effect's force but those of the rare ones and of the stages, kN.
            #[inline(always)]
            fn add_force(
                &self,
                state: &mut AugmentedState<R>,
                motion: &ConfinedMotion<R>,
                law: LawForce<R>,
            ) -> R {
                let mut total = law.total;
                if self.present & Kind::PLAIN != 0 {
                    $(total += self.$field.force(&mut (), motion, law);)+
                }
                $(if self.has(Kind::$costly) {
                    total += self.$costly_field.force(&mut (), motion, law);
                })+
                $(if self.has(Kind::$memory) {
                    let state = &mut state.$memory_field;
                    total += self.$memory_field.next(state, motion, law);
                })+
                total
            }

            /// The sum of `force` and the rare effects' forces, kN.
            #[inline(always)]
            fn add_rare_force(
                &self,
                state: &mut AugmentedState<R>,
                motion: &ConfinedMotion<R>,
                law: LawForce<R>,
                force: R,
            ) -> R {
                let mut total = force;
                if self.present & Kind::RARE != 0 {
                    $(if self.has(Kind::$rare) {
                        let state = &mut state.$rare_field;
                        total += self.$rare_field.next(state, motion, law);
                    })+
                }
                total
            }
        }
    };
}

effects! {
    plain:
    /// A constant force.
    offset: Offset,
    /// Even stiffness.
    asymmetry: Asymmetry,
    /// Odd stiffness above the cubic.
    hardening: Hardening,
    /// A linear dashpot.
    viscous: Viscous,
    /// A moving mass.
    inertia: Inertia,
    /// Friction that grows with the displacement.
    load_friction: LoadFriction,
    /// A force that scales with temperature.
    temperature: Temperature;
    costly:
    /// A force that settles with the cycles.
    drift: Drift;
    with_memory:
    /// Rate-independent friction with elastic pre-sliding.
    stick_slip: StickSlip,
    /// Springs and dashpots in series.
    relaxation: Relaxation;
    rare:
    /// One-sided contact.
    stop: Stop,
    /// Rate-independent friction with a smooth transition.
    bouc_wen: BoucWen,
    /// Tones.
    periodic: Periodic;
    stages:
    /// Free play of the mounting.
    gap: Gap,
    /// A spring in series with the specimen.
    compliance: Compliance,
    /// A force channel that is late.
    delay: Delay;
}

/// Eq 13 and up to `N` added effects, one of each kind.
#[derive(Clone, Debug, PartialEq)]
pub struct AugmentedLaw<R, const N: usize> {
    law: Law<R>,
    effects: Effects<R>,
    correction: Correction<R>,
}

impl<R: Real, const N: usize> AugmentedLaw<R, N> {
    /// The law alone.
    pub const fn new(law: Law<R>) -> Self {
        Self {
            law,
            effects: Effects::NONE,
            correction: Correction::NONE,
        }
    }

    /// The law with one more effect.
    ///
    /// # Errors
    /// [`ConfigError::Full`] when `N` effects are in it already, or, naming the kind, one of this kind.
    pub fn with(mut self, effect: Effect<R>) -> Result<Self, ConfigError> {
        self.push(effect)?;
        Ok(self)
    }

    /// The law with a correction in the place of the one that it has, or has not. It counts among the `N` as none.
    ///
    /// # Errors
    /// [`ConfigError::Full`] where `N` is 0: such a law has no place for what is remembered.
    pub fn with_correction(mut self, correction: Correction<R>) -> Result<Self, ConfigError> {
        if N == 0 {
            return Err(ConfigError::Full {
                field: "correction",
                capacity: 0,
            });
        }
        self.correct_with(|slot| {
            *slot = correction;
            Ok(())
        })?;
        Ok(self)
    }

    /// The correction, where there is one.
    pub fn correction(&self) -> Option<&Correction<R>> {
        Some(&self.correction).filter(|_| self.effects.has(Kind::Correction))
    }

    /// [`AugmentedLaw::with_correction`] with the one that `write` writes in place.
    ///
    /// # Errors
    /// That of `write`; the law has no correction then.
    pub(crate) fn correct_with<E>(
        &mut self,
        write: impl FnOnce(&mut Correction<R>) -> Result<(), E>,
    ) -> Result<(), E> {
        self.effects.present &= !Kind::CORRECTION;
        let written = write(&mut self.correction);
        if written.is_ok() && self.correction.is_there() {
            self.effects.present |= Kind::CORRECTION;
        } else {
            // What it would remember is no matter of the law's.
            self.correction = Correction::NONE;
        }
        written
    }

    /// Takes all effects out, and the correction.
    pub(crate) fn clear(&mut self) {
        self.effects = Effects::NONE;
        self.correction = Correction::NONE;
    }

    /// [`AugmentedLaw::with`] in place.
    pub(crate) fn push(&mut self, effect: Effect<R>) -> Result<(), ConfigError> {
        if self.effects.kinds().count_ones() as usize >= N {
            return Err(ConfigError::Full {
                field: "effects",
                capacity: N,
            });
        }
        self.effects.add(effect)
    }

    /// The same effects beside another eq 13: when the amplitude changes and its coefficients are tabulated over it.
    pub fn set_law(&mut self, law: Law<R>) {
        self.law = law;
    }

    /// Eq 13 alone.
    pub fn law(&self) -> &Law<R> {
        &self.law
    }

    /// The added effects, in the order of [`Effect`].
    pub fn effects(&self) -> impl Iterator<Item = Effect<R>> {
        self.effects.iter()
    }

    /// Whether `other` has the same kinds of effects.
    pub(crate) fn has_kinds_of(&self, other: &Self) -> bool {
        N == 0
            || (self.effects.kinds() == other.effects.kinds()
                && self.correction.remembers_as(&other.correction))
    }

    /// All effects at rest.
    pub fn at_rest(&self) -> AugmentedState<R> {
        AugmentedState::AT_REST
    }

    /// Force in kN on this tick: the law's and every effect's. Call it once per tick.
    #[inline]
    pub fn force(&self, state: &mut AugmentedState<R>, motion: &Motion<R>) -> R {
        let motion = motion.confined();
        let damping = |v| self.law.damping_force(v);
        if self.has_stages() {
            return self.force_through_stages(state, &motion, &self.law, damping);
        }
        let law = LawForce::of(&self.law, &motion, damping);
        self.with_effects(state, &motion, law)
    }

    /// A gap, a compliance or a delay is among the effects.
    #[inline(always)]
    pub(crate) fn has_stages(&self) -> bool {
        N > 0 && self.effects.present & Kind::STAGES != 0
    }

    /// Force in kN on this tick whatever the effects are, with `law` for eq 13. `damping` gives its damping force at a velocity
    /// within the limit.
    #[inline(always)]
    pub(crate) fn force_through_stages(
        &self,
        state: &mut AugmentedState<R>,
        motion: &ConfinedMotion<R>,
        law: &Law<R>,
        damping: impl Fn(R) -> R,
    ) -> R {
        let effects = &self.effects;
        let measured = motion;
        let mut motion = *motion;
        if effects.has(Kind::Delay) {
            motion = effects.delay.felt(&motion);
        }
        if effects.has(Kind::Gap) {
            motion = effects.gap.felt(&motion);
        }
        let spring = effects.has(Kind::Compliance).then_some(&effects.compliance);
        let viscous = effects.viscous.c1;
        let law = match spring {
            Some(compliance) => {
                let before = &mut state.compliance;
                let (seen, law) = compliance.deflect(before, &motion, law, viscous, damping);
                motion = seen;
                law
            }
            None => LawForce::of(law, &motion, damping),
        };
        let force = effects.add_force(state, &motion, law);
        let force = effects.add_rare_force(state, &motion, law, force);
        if let Some(compliance) = spring {
            compliance.remember(&mut state.compliance, force - law.total, viscous);
        }
        let force = if effects.has(Kind::Delay) {
            effects.delay.delayed(&mut state.delay, force)
        } else {
            force
        };
        // It was fitted to what is measured: no stage stands before it.
        self.corrected(state, measured, force)
    }

    /// What the effects that scale eq 13's force make of an elastic force of 1 and of a damping force of 1.
    pub(crate) fn scales(&self, motion: &ConfinedMotion<R>) -> [R; 2] {
        let effects = &self.effects;
        if effects.present & (Kind::PLAIN | Kind::Drift.bit()) == 0 {
            return [R::ONE; 2];
        }
        [R::ZERO, R::ONE].map(|damping| {
            let total = R::ONE;
            let law = LawForce { damping, total };
            total
                + effects.load_friction.force(&mut (), motion, law)
                + effects.temperature.force(&mut (), motion, law)
                + if effects.has(Kind::Drift) {
                    effects.drift.force_of_law(motion, law)
                } else {
                    R::ZERO
                }
        })
    }

    /// The sum of `force` and the correction's, kN.
    #[inline(always)]
    fn corrected(&self, state: &mut AugmentedState<R>, motion: &ConfinedMotion<R>, force: R) -> R {
        if self.effects.has(Kind::Correction) {
            force + self.correction.force(&mut state.correction, motion)
        } else {
            force
        }
    }

    /// `law`, whoever computed it, and every effect's force but the stages', kN.
    #[inline(always)]
    pub(crate) fn with_effects(
        &self,
        state: &mut AugmentedState<R>,
        motion: &ConfinedMotion<R>,
        law: LawForce<R>,
    ) -> R {
        if N == 0 {
            return law.total;
        }
        let force = self.effects.add_force(state, motion, law);
        if self.effects.present & (Kind::RARE | Kind::CORRECTION) == 0 {
            return force;
        }
        if self.effects.present & Kind::RARE == 0 {
            return force + self.correction.force(&mut state.correction, motion);
        }
        let force = self.effects.add_rare_force(state, motion, law, force);
        self.corrected(state, motion, force)
    }
}

//! Physical effects in addition to the mixed damping law (eq 13), one per file, and the law that holds a set of them.
//!
//! Every effect has a configuration (validated, shared, swappable at a cycle boundary) and a state. All are generic over the float:
//! identification runs them in `f64`, the firmware in `f32`.
//!
//! Most add a force to that of the law. Four are stages between the specimen and the measurement, through which a tick passes:
//!
//! ```text
//! motion ─▶ part of a tick ─▶ gap ─▶ compliance ─▶ law and every effect that adds a force ─▶ whole ticks ─▶ low-pass ─▶ force
//! ```

pub mod description;
pub mod residual_table;
#[macro_use]
mod list;
#[macro_use]
mod numbers;
mod motion;
mod named;
pub mod stretch;

pub use delay::MAX_DELAY;
pub use motion::{CONTROLS, ClampedMotion, LawForce, Motion};
pub use named::EffectSet;
pub use periodic::MAX_TONES;
pub use relaxation::MAX_BRANCHES;
pub use residual_table::ResidualTable;
pub use stick_slip::MAX_ELEMENTS as MAX_STICK_SLIP_ELEMENTS;
pub use stop::MAX_CONTACTS;

use crate::error::ConfigError;
use crate::frame::Writer;
use crate::law::Law;
use crate::passivity::Active;
use crate::real::{Real, compare};
use description::{Cost, Description, EffectKind, Energy};
use residual_table::ResidualTableState;

/// The equations of an effect. Its file holds its configuration, which implements this trait, its state, and its description.
///
/// Methods that an effect does not need have a default without cost: a force and a modulator have a force, a stage has none.
pub trait Equations<R: Real>: Copy {
    /// Its description.
    const DESCRIPTION: Description;
    /// An effect that does nothing. All bits are 0.
    const NONE: Self;

    /// Its state from tick to tick; `()` for most.
    type State: Clone;
    /// State before the first tick, for any configuration. All bits are 0.
    const AT_REST: Self::State;

    /// The effect from `parameters` in the order of the description, element by element, for a tick of `tick` s.
    ///
    /// # Errors
    /// Too few or too many parameters, or the one that is not finite or out of range.
    fn from_parameters(parameters: &[f64], tick: f64) -> Result<Self, ConfigError>;

    /// Checks the numbers of an effect, as its constructor does: whether they are finite, within the range that the constructor can
    /// give, and agree with each other where one follows from others.
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    fn check(&self) -> Result<(), ConfigError>;

    /// Checks the numbers that follow from the tick, for one of `tick` s.
    ///
    /// # Errors
    /// The field that is of another tick.
    fn check_tick(&self, _tick: R) -> Result<(), ConfigError> {
        Ok(())
    }

    /// The parameter with which it can give out more energy than it absorbs in a closed cycle, and its value; `None` if it cannot
    /// with its parameters, and for an effect that does so by its nature. The description's
    /// [`energy`](description::Description::energy) says which parameters these are.
    fn supplies(&self) -> Option<(&'static str, R)> {
        None
    }

    /// For an effect of [`Energy::ScalesDamping`](description::Energy): the parameter that changes the law's damping, its value,
    /// and the change as a part of the damping, at the motion and the temperature at which the least of it remains.
    fn least_damping(&self) -> (&'static str, R, R) {
        ("", R::ZERO, R::ZERO)
    }

    /// The force in kN that it adds on this tick to that of the mixed damping law, `law`. Called once per tick, in order.
    #[inline(always)]
    fn force(&self, _: &mut Self::State, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
        self.force_of_law(motion, law)
    }

    /// The part of it that is proportional to the law's forces, kN: the whole of a modulator.
    #[inline(always)]
    fn force_of_law(&self, _: &ClampedMotion<R>, _: LawForce<R>) -> R {
        R::ZERO
    }

    /// The part of its force, kN, that acts on the sensors' side of a spring in series.
    #[inline(always)]
    fn outside(&self, _: &ClampedMotion<R>) -> R {
        R::ZERO
    }

    /// Coefficient in kN·s/mm of a dashpot parallel to the law, which a stage that solves for the velocity includes.
    #[inline(always)]
    fn viscous(&self) -> R {
        R::ZERO
    }

    /// For a stage: the motion of the specimen behind the stage, where the motion before the stage is `motion`.
    #[inline(always)]
    fn felt(&self, motion: &ClampedMotion<R>) -> ClampedMotion<R> {
        *motion
    }

    /// For a stage whose motion depends on the force behind it: that motion, and the law's force at it. `damping` gives the law's
    /// damping force at a velocity within the limit; `viscous` is [`Equations::viscous`] of the parallel effects.
    #[inline(always)]
    fn solved(
        &self,
        _: &mut Self::State,
        _motion: &ClampedMotion<R>,
        _law: &Law<R>,
        _viscous: R,
        _damping: &impl Fn(R) -> R,
    ) -> Option<(ClampedMotion<R>, LawForce<R>)> {
        None
    }

    /// For a stage: takes the force that the effects behind it added to the law's on this tick, kN.
    #[inline(always)]
    fn added(&self, _: &mut Self::State, _force: R, _viscous: R) {}

    /// For a stage: the measured force for `force` kN.
    #[inline(always)]
    fn shown(&self, _: &mut Self::State, force: R) -> R {
        force
    }
}

/// An effect as words in a pack.
pub(crate) trait Packed: Sized {
    /// Passes the words to `put`, at most [`MOST_WORDS`].
    fn pack(&self, put: &mut impl FnMut(f32));

    /// The effect from the words that [`Packed::pack`] gave; `None` if they cannot be an effect. They are not checked yet.
    fn unpack(words: &[f32]) -> Option<Self>;
}

/// Error for a pack or a caller with the number of an effect of another version.
pub(crate) fn unknown(number: u8) -> ConfigError {
    ConfigError::OutOfRange {
        field: "effect",
        value: number.into(),
        low: 0.0,
        high: HIGHEST.into(),
    }
}

/// The highest number of an effect.
const HIGHEST: u8 = {
    let (mut highest, mut index) = (0, 0);
    while index < DESCRIPTIONS.len() {
        if DESCRIPTIONS[index].number > highest {
            highest = DESCRIPTIONS[index].number;
        }
        index += 1;
    }
    highest
};

/// Most words of an effect in a pack.
pub(crate) const MOST_WORDS: usize = 5 * MAX_TONES;

/// Checks a number that follows from the tick. Derived: a tick and a rate in f32 are each rounded, within 1.2e-7 together.
///
/// # Errors
/// It is not `expected`, within a millionth.
fn is_of_tick<R: Real>(field: &'static str, value: R, expected: R) -> Result<(), ConfigError> {
    let [low, high] = [1.0 - 1e-6, 1.0 + 1e-6].map(|part| expected * R::from_f64(part));
    compare(field, value, low, high).map(|_| ())
}

/// The parameter `name` and its `value` if that is below 0.
fn below_0<R: Real>(name: &'static str, value: R) -> Option<(&'static str, R)> {
    (value < R::ZERO).then_some((name, value))
}

const fn is_cost(description: &Description, cost: Cost) -> bool {
    description.cost as u8 == cost as u8
}

const fn is_kind(description: &Description, kind: EffectKind) -> bool {
    description.kind as u8 == kind as u8
}

effects! {
    offset: Offset,
    asymmetry: Asymmetry,
    hardening: Hardening,
    viscous: Viscous,
    inertia: Inertia,
    load_friction: LoadFriction,
    directional: Directional,
    temperature: Temperature,
    drift: Drift,
    stick_slip: StickSlip,
    relaxation: Relaxation,
    stop: Stop,
    bouc_wen: BoucWen,
    hardening_friction: HardeningFriction,
    yielding: Yielding,
    control_input: ControlInput,
    backlash: Backlash,
    degradation: Degradation,
    weakening: Weakening,
    periodic: Periodic,
    delay: Delay,
    force_filter: ForceFilter,
    gap: Gap,
    compliance: Compliance,
}

/// The mixed damping law and up to `N` added effects, one of each kind.
#[derive(Clone, Debug, PartialEq)]
pub struct AugmentedLaw<R, const N: usize> {
    law: Law<R>,
    effects: Effects<R>,
    correction: ResidualTable<R>,
}

impl<const N: usize> AugmentedLaw<f32, N> {
    /// `law` without effects; [`AugmentedLaw::is_unfinished`] is true until [`AugmentedLaw::finish`].
    pub(crate) fn begin(&mut self, law: Law<f32>) {
        self.law = law;
        self.effects = Effects::NONE;
        self.effects.present = UNFINISHED;
    }

    /// Removes the residual table. A separate method, because the table is as long as all effects together.
    pub(crate) fn begin_table(&mut self) {
        self.correction = ResidualTable::NONE;
    }

    /// Checks the numbers of the effect with this number, for a tick of `tick` s if that is known, after it was read.
    ///
    /// # Errors
    /// The field that is not in its range, or does not agree with others.
    pub(crate) fn check_effect(&self, number: u8, tick: Option<f32>) -> Result<(), ConfigError> {
        self.effects.check(number, tick)
    }

    /// Whether it is still being written by this upload; no running law is.
    pub(crate) fn is_unfinished(&self) -> bool {
        self.effects.has(UNFINISHED)
    }

    /// Marks the law as completely written.
    pub(crate) fn finish(&mut self) {
        self.effects.present &= !UNFINISHED;
    }

    /// Reads cells of the residual table whose head was read, from index `from` to before index `to`. Returns whether these were
    /// the last. `None` if they are not all there.
    pub(crate) fn read_cells(
        &mut self,
        reader: &mut crate::frame::Reader<'_>,
        from: usize,
        to: usize,
    ) -> Option<bool> {
        let is_last = self.correction.unpack_cells(reader, from, to)?;
        // A table without force must leave no memory in the law.
        if is_last && self.effects.present & CORRECTION == 0 {
            self.correction = ResidualTable::NONE;
        }
        Some(is_last)
    }
}

impl<R: Real, const N: usize> AugmentedLaw<R, N> {
    /// The law alone.
    pub const fn new(law: Law<R>) -> Self {
        Self {
            law,
            effects: Effects::NONE,
            correction: ResidualTable::NONE,
        }
    }

    /// Adds one more effect.
    ///
    /// # Errors
    /// [`ConfigError::Full`] if the law has `N` effects already, or, naming the kind, one of this kind.
    pub fn with(mut self, effect: Effect<R>) -> Result<Self, ConfigError> {
        self.push(effect)?;
        Ok(self)
    }

    /// Sets the residual table, and replaces one that the law has. It does not count among the `N` effects.
    ///
    /// # Errors
    /// [`ConfigError::Full`] if `N` is 0: such a law has no place for the state.
    pub fn with_residual_table(mut self, table: ResidualTable<R>) -> Result<Self, ConfigError> {
        if N == 0 {
            return Err(ConfigError::Full {
                field: "correction",
                capacity: 0,
            });
        }
        self.correct_with(|slot| {
            *slot = table;
            Ok(())
        })?;
        Ok(self)
    }

    /// The residual table, if there is one.
    pub fn residual_table(&self) -> Option<&ResidualTable<R>> {
        Some(&self.correction).filter(|_| self.effects.has(CORRECTION))
    }

    /// [`AugmentedLaw::with_residual_table`] with a table that `write` writes in place.
    ///
    /// # Errors
    /// The error of `write`; the law has no residual table then.
    pub(crate) fn correct_with<E>(
        &mut self,
        write: impl FnOnce(&mut ResidualTable<R>) -> Result<(), E>,
    ) -> Result<(), E> {
        self.effects.present &= !CORRECTION;
        let written = write(&mut self.correction);
        if written.is_ok() && self.correction.is_there() {
            self.effects.present |= CORRECTION;
        } else {
            // An absent table must leave no memory in the law.
            self.correction = ResidualTable::NONE;
        }
        written
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

    /// Replaces the mixed damping law and keeps the effects, for coefficients that are tabulated over the amplitude when the
    /// amplitude changes.
    pub fn set_law(&mut self, law: Law<R>) {
        self.law = law;
    }

    /// The mixed damping law alone.
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

    /// The state with all effects at rest.
    pub fn at_rest(&self) -> AugmentedState<R> {
        AugmentedState::AT_REST
    }

    /// Force in kN on this tick: that of the law and of every effect. Call it once per tick.
    #[inline]
    pub fn force(&self, state: &mut AugmentedState<R>, motion: &Motion<R>) -> R {
        let motion = motion.clamped();
        let damping = |v| self.law.damping_force(v);
        if self.has_stages() {
            return self.force_through_stages(state, &motion, &self.law, damping);
        }
        let law = LawForce::of(&self.law, &motion, damping);
        self.with_effects(state, &motion, law)
    }

    /// The first effect that can give out more energy than it absorbs with its parameters, for the check of [`crate::passivity`].
    pub(crate) fn supplies(&self) -> Option<Active> {
        let is_there = |bit: Bit| self.effects.has(bit.mask());
        // A law that is softer than the spring jumps from one displacement to another. With k3 below 0 it is, from some displacement on.
        if is_there(Bit::Compliance) {
            let stiffness = self.effects.compliance.stiffness();
            if self.law.k3() < R::ZERO || self.law.k1() + stiffness <= R::ZERO {
                return Some(Active {
                    effect: Compliance::<R>::DESCRIPTION.name,
                    field: "stiffness",
                    value: stiffness.to_f64(),
                });
            }
        }
        self.effects.supplies()
    }

    /// The least part of the law's damping that remains with the effects that scale it, and a parameter that takes of it.
    pub(crate) fn least_damping(&self) -> (R, Active) {
        self.effects.least_damping()
    }

    /// Whether a stage is among the effects.
    #[inline(always)]
    pub(crate) fn has_stages(&self) -> bool {
        N > 0 && self.effects.present & STAGES != 0
    }

    /// Force in kN on this tick for any effects, with `law` as the mixed damping law. `damping` gives its damping force at a
    /// velocity within the limit.
    #[inline(always)]
    pub(crate) fn force_through_stages(
        &self,
        state: &mut AugmentedState<R>,
        motion: &ClampedMotion<R>,
        law: &Law<R>,
        damping: impl Fn(R) -> R,
    ) -> R {
        let force = self
            .effects
            .force_through_stages(state, motion, law, damping);
        // The residual table was fitted to the measured motion, so no stage applies to it.
        self.corrected(state, motion, force)
    }

    /// Factors by which the effects that scale the law's forces change an elastic force and a damping force.
    pub(crate) fn scales(&self, motion: &ClampedMotion<R>) -> [R; 2] {
        if self.effects.present & SCALING == 0 {
            return [R::ONE; 2];
        }
        LawForce::units().map(|law| self.effects.scaled(motion, law))
    }

    /// Sum of `force` and of the residual table's force, kN.
    #[inline(always)]
    fn corrected(&self, state: &mut AugmentedState<R>, motion: &ClampedMotion<R>, force: R) -> R {
        if self.effects.has(CORRECTION) {
            force + self.correction.force(&mut state.correction, motion)
        } else {
            force
        }
    }

    /// Sum of `law` and of every effect's force except those of stages, kN. The caller computes `law`.
    #[inline(always)]
    pub(crate) fn with_effects(
        &self,
        state: &mut AugmentedState<R>,
        motion: &ClampedMotion<R>,
        law: LawForce<R>,
    ) -> R {
        if N == 0 {
            return law.total;
        }
        let force = self.effects.add_force(state, motion, law);
        if self.effects.present & (RARE | CORRECTION) == 0 {
            return force;
        }
        if self.effects.present & RARE == 0 {
            return force + self.correction.force(&mut state.correction, motion);
        }
        let force = self.effects.add_rare_force(state, motion, law, force);
        self.corrected(state, motion, force)
    }
}

//! A set of effects named by a type: a tuple of them.

use super::description::EffectKind;
use super::{ClampedMotion, DESCRIPTIONS, Equations, LawForce};
use crate::law::Law;
use crate::real::Real;

/// A tuple of up to eight effects, in the order of [`DESCRIPTIONS`]; a tuple in any other order does not compile where it is used.
///
/// ```compile_fail
/// use mesh_damper::effects::{StickSlip, Viscous};
/// use mesh_damper::static_law::StaticLaw;
///
/// // A dashpot comes before stick-slip.
/// static mut LAW: StaticLaw<(StickSlip<f32>, Viscous<f32>)> = StaticLaw::empty();
/// ```
pub trait EffectSet<R: Real>: Copy {
    /// State of its effects.
    type State: Clone;
    /// A set in which no effect does anything. All bits are 0.
    const NONE: Self;
    /// State before the first tick. All bits are 0.
    const AT_REST: Self::State;
    /// Whether one of them is a stage.
    const HAS_STAGES: bool;

    /// The force in kN, with `law` as that of the mixed damping law.
    fn force(&self, state: &mut Self::State, motion: &ClampedMotion<R>, law: LawForce<R>) -> R;

    /// The forces of `law` alone, as the effects scale them, kN.
    fn scaled(&self, motion: &ClampedMotion<R>, law: LawForce<R>) -> R;

    /// The force in kN through the stages, with `law` as the mixed damping law. `damping` gives its damping force at a velocity
    /// within the limit.
    fn force_through_stages(
        &self,
        state: &mut Self::State,
        motion: &ClampedMotion<R>,
        law: &Law<R>,
        damping: impl Fn(R) -> R,
    ) -> R;
}

/// Index of an effect in [`DESCRIPTIONS`].
const fn place(number: u8) -> usize {
    let mut place = 0;
    while place < DESCRIPTIONS.len() && DESCRIPTIONS[place].number != number {
        place += 1;
    }
    place
}

/// Whether these numbers are in the order of [`DESCRIPTIONS`].
const fn is_ordered(numbers: &[u8]) -> bool {
    let mut index = 1;
    while index < numbers.len() {
        if place(numbers[index - 1]) >= place(numbers[index]) {
            return false;
        }
        index += 1;
    }
    true
}

/// Whether one of these is a stage.
const fn has_stage(numbers: &[u8]) -> bool {
    let mut index = 0;
    while index < numbers.len() {
        if DESCRIPTIONS[place(numbers[index])].kind as u8 == EffectKind::Stage as u8 {
            return true;
        }
        index += 1;
    }
    false
}

macro_rules! sets {
    ($(($($name:ident $index:tt),*);)+) => {
        $(
            #[allow(clippy::unused_unit, reason = "of no effects")]
            impl<R: Real, $($name: Equations<R>),*> EffectSet<R> for ($($name,)*) {
                type State = ($($name::State,)*);
                const NONE: Self = {
                    assert!(
                        is_ordered(&[$($name::DESCRIPTION.number),*]),
                        "the effects of a law are named in the order of effects::DESCRIPTIONS, each once"
                    );
                    ($($name::NONE,)*)
                };
                const AT_REST: Self::State = ($($name::AT_REST,)*);
                const HAS_STAGES: bool = has_stage(&[$($name::DESCRIPTION.number),*]);

                #[inline(always)]
                #[allow(unused_variables, reason = "of no effects")]
                fn force(
                    &self,
                    state: &mut Self::State,
                    motion: &ClampedMotion<R>,
                    law: LawForce<R>,
                ) -> R {
                    #[allow(unused_mut, reason = "of no effects")]
                    let mut total = law.total;
                    $(if $name::DESCRIPTION.kind as u8 != EffectKind::Stage as u8 {
                        total += self.$index.force(&mut state.$index, motion, law);
                    })*
                    total
                }

                #[allow(unused_variables, reason = "of no effects")]
                fn scaled(&self, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
                    #[allow(unused_mut, reason = "of no effects")]
                    let mut total = law.total;
                    $(total += self.$index.force_of_law(motion, law);)*
                    total
                }

                #[inline(always)]
                #[allow(unused_mut, unused_variables, reason = "of no effects")]
                fn force_through_stages(
                    &self,
                    state: &mut Self::State,
                    motion: &ClampedMotion<R>,
                    law: &Law<R>,
                    damping: impl Fn(R) -> R,
                ) -> R {
                    let mut motion = *motion;
                    $(motion = self.$index.felt(&motion);)*
                    let mut viscous = R::ZERO;
                    $(viscous += self.$index.viscous();)*
                    let mut solved = None;
                    $(if let Some((seen, force)) =
                        self.$index.solved(&mut state.$index, &motion, law, viscous, &damping)
                    {
                        motion = seen;
                        solved = Some(force);
                    })*
                    let law = match solved {
                        Some(law) => law,
                        None => LawForce::of(law, &motion, damping),
                    };
                    let force = EffectSet::force(self, state, &motion, law);
                    #[allow(unused_mut, reason = "of no effects")]
                    let mut added = force - law.total;
                    $(added -= self.$index.outside(&motion);)*
                    let mut shown = force;
                    $(
                        self.$index.added(&mut state.$index, added, viscous);
                        shown = self.$index.shown(&mut state.$index, shown);
                    )*
                    shown
                }
            }
        )+
    };
}

sets! {
    ();
    (A 0);
    (A 0, B 1);
    (A 0, B 1, C 2);
    (A 0, B 1, C 2, D 3);
    (A 0, B 1, C 2, D 3, E 4);
    (A 0, B 1, C 2, D 3, E 4, F 5);
    (A 0, B 1, C 2, D 3, E 4, F 5, G 6);
    (A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7);
}

//! The fast law, as it runs on the target: the mixed damping law (eq 13) with its damping from a table, added effects, and a swap
//! at a cycle's end.
//!
//! A swap switches between two sets of coefficients. The single table of 4 KiB is then refilled over the following ticks, one row
//! per tick, so that no tick bears the whole cost. A tick fills the row that it needs, or the next row in turn if the tick before
//! needed the same one. Every force is therefore that of the new law from the first tick on.

use crate::effects::{AugmentedLaw, AugmentedState, ClampedMotion, LawForce, Motion};
use crate::law::Law;
use crate::power::{PowerSeed, PowerTable, ROWS};
use crate::real::Real;
use crate::tick_law::TickLaw;

/// The mixed damping law, up to `N` added effects, and the seed of the damping table.
#[derive(Clone, Debug, PartialEq)]
pub struct FastLaw<const N: usize> {
    pub(crate) augmented: AugmentedLaw<f32, N>,
    pub(crate) damping: PowerSeed,
}

impl<const N: usize> FastLaw<N> {
    /// A law without force.
    pub const EMPTY: Self = Self {
        augmented: AugmentedLaw::new(Law::from_valid(0.0, 0.0, 0.0, 0.0)),
        damping: PowerSeed::EMPTY,
    };

    /// Computes 64 powers in f64: not for the hot path.
    pub fn new(augmented: AugmentedLaw<f32, N>) -> Self {
        Self {
            damping: seed(augmented.law()),
            augmented,
        }
    }

    /// Replaces the mixed damping law and keeps the effects, for coefficients that are tabulated over the amplitude when the
    /// amplitude changes. Computes 64 powers in f64.
    pub fn set_law(&mut self, law: Law<f32>) {
        self.damping = seed(&law);
        self.augmented.set_law(law);
    }

    /// The mixed damping law and the effects.
    pub fn augmented(&self) -> &AugmentedLaw<f32, N> {
        &self.augmented
    }

    /// The seed from which the damping table is filled.
    pub fn damping(&self) -> &PowerSeed {
        &self.damping
    }
}

fn seed(law: &Law<f32>) -> PowerSeed {
    PowerSeed::from_valid(law.c().to_f64(), law.alpha().to_f64())
}

/// A law that waits for the end of the cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Waiting {
    No,
    /// A law with the same kinds of effects: their state is kept.
    SameEffects,
    OtherEffects,
}

/// Relative difference of each coefficient between the running law and the law as given: a slow change of the specimen to which
/// the rig has adapted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Adaptation {
    /// Relative change of k1.
    pub k1: f32,
    /// Relative change of k3.
    pub k3: f32,
    /// Relative change of c.
    pub c: f32,
}

impl Adaptation {
    /// Clamps each part to −1…1.
    pub(crate) fn clamped(self) -> Self {
        Self {
            k1: self.k1.clamped(1.0),
            k3: self.k3.clamped(1.0),
            c: self.c.clamped(1.0),
        }
    }

    /// The law that differs from `given` by this adaptation.
    pub(crate) fn of(self, given: &Law<f32>) -> Law<f32> {
        let part = |of: f32| 1.0 + of;
        Law::from_valid(
            part(self.k1) * given.k1(),
            part(self.k3) * given.k3(),
            part(self.c) * given.c(),
            given.alpha(),
        )
    }
}

/// [`TickLaw::parts`] of a law as `given`, whose effects change an elastic and a damping force of 1 to `elastic` and `damping`.
#[inline(always)]
pub(crate) fn parts(
    given: &Law<f32>,
    motion: &ClampedMotion<f32>,
    [elastic, damping]: [f32; 2],
    damping_force: f32,
) -> [f32; 3] {
    let y = motion.displacement();
    [
        elastic * (given.k1() * y),
        elastic * (given.k3() * (y * y) * y),
        damping * damping_force,
    ]
}

/// A running [`FastLaw`], and optionally a second one that waits for the end of the cycle.
#[derive(Clone, Debug)]
// Long fields come first: this keeps the table within the offset of one load, and the other fields near to each other.
#[repr(C)]
pub struct RunningLaw<const N: usize> {
    table: PowerTable,
    /// The mixed damping law with the adaptation applied, and the factor on the tabulated damping.
    in_force: Law<f32>,
    damping_part: f32,
    followed: Adaptation,
    state: AugmentedState<f32>,
    laws: [FastLaw<N>; 2],
    /// The second law runs.
    second: bool,
    waiting: Waiting,
    /// Number of rows filled for the running law, and one further row, which the last velocity needed.
    filled: usize,
    needed: usize,
    /// The table is filled, and the law has no stages.
    settled: bool,
}

impl<const N: usize> RunningLaw<N> {
    /// Runs `law`, with its effects at rest.
    pub fn new(law: FastLaw<N>) -> Self {
        let mut new = Self {
            laws: [law, FastLaw::EMPTY],
            needed: ROWS,
            ..Self::empty()
        };
        new.follow_nothing();
        new
    }

    /// A law without force, until another is swapped in. All bits are 0, so that it takes no flash in a static.
    pub const fn empty() -> Self {
        Self {
            laws: [const { FastLaw::EMPTY }; 2],
            in_force: Law::from_valid(0.0, 0.0, 0.0, 0.0),
            damping_part: 0.0,
            followed: Adaptation {
                k1: 0.0,
                k3: 0.0,
                c: 0.0,
            },
            second: false,
            waiting: Waiting::No,
            table: PowerTable::empty(),
            filled: 0,
            needed: 0,
            settled: false,
            state: AugmentedState::AT_REST,
        }
    }

    /// The running law, as given.
    pub fn law(&self) -> &FastLaw<N> {
        let [first, second] = &self.laws;
        if self.second { second } else { first }
    }

    /// From now on k1, k3 and c differ from the law as given by these parts, clamped to −1…1. The adaptation ends when another law
    /// takes over.
    #[inline(never)]
    pub fn follow(&mut self, followed: Adaptation) {
        let followed = followed.clamped();
        self.in_force = followed.of(self.law().augmented.law());
        self.damping_part = 1.0 + followed.c;
        self.followed = followed;
    }

    /// Ends the adaptation: the running law is the law as given.
    #[inline]
    pub(crate) fn follow_nothing(&mut self) {
        self.in_force = *self.law().augmented.law();
        self.damping_part = 1.0;
        self.followed = Adaptation::default();
    }

    /// Relative difference between the running law and the law as given.
    pub fn followed(&self) -> Adaptation {
        self.followed
    }

    /// k1·y, k3·y³ and c·|v|^α·sgn v of the law as given, kN, each as its effects change it. The running law adds the
    /// corresponding part of [`Adaptation`] of each. 0 where a stage lies between the specimen and the measurement. Not for every
    /// tick.
    #[inline]
    pub(crate) fn parts(&self, motion: &Motion<f32>) -> [f32; 3] {
        let law = self.law();
        if law.augmented.has_stages() {
            return [0.0; 3];
        }
        let motion = motion.clamped();
        let v = motion.velocity();
        let scales = law.augmented.scales(&motion);
        let damping_force = if self.settled {
            self.table.damping_force(v)
        } else {
            law.damping.damping_force(v)
        };
        parts(law.augmented.law(), &motion, scales, damping_force)
    }

    /// Sets the law that takes over at the next [`RunningLaw::boundary`]. It replaces one that was waiting.
    pub fn swap(&mut self, law: FastLaw<N>) {
        let written: Result<(), core::convert::Infallible> = self.swap_with(|slot| {
            *slot = law;
            Ok(())
        });
        let Ok(()) = written;
    }

    /// [`RunningLaw::swap`] with a law that `write` writes in place, so that it need not pass through the stack. If `write` fails,
    /// no law waits.
    ///
    /// # Errors
    /// The error of `write`.
    pub fn swap_with<E>(
        &mut self,
        write: impl FnOnce(&mut FastLaw<N>) -> Result<(), E>,
    ) -> Result<(), E> {
        self.swap_in_slices(|slot| write(slot).map(Some))
            .map(|_| ())
    }

    /// [`RunningLaw::swap_with`] for a law that is written slice by slice, between ticks that continue with the running law.
    /// `write` is called with the same slot each time until it returns something; then the law waits.
    ///
    /// # Errors
    /// The error of `write`; no law waits then.
    pub fn swap_in_slices<T, E>(
        &mut self,
        write: impl FnOnce(&mut FastLaw<N>) -> Result<Option<T>, E>,
    ) -> Result<Option<T>, E> {
        self.waiting = Waiting::No;
        let [first, second] = &mut self.laws;
        let (law, slot) = if self.second {
            (second, first)
        } else {
            (first, second)
        };
        let written = write(slot)?;
        if written.is_none() {
            return Ok(None);
        }
        self.waiting = if slot.augmented.has_kinds_of(&law.augmented) {
            Waiting::SameEffects
        } else {
            Waiting::OtherEffects
        };
        Ok(written)
    }

    /// Marks the end of a cycle: a waiting law takes over. Returns whether one did. The effects keep their state if the new law has
    /// the same kinds of effects; otherwise they start at rest.
    #[inline]
    pub fn boundary(&mut self) -> bool {
        if self.waiting == Waiting::No {
            return false;
        }
        if self.waiting == Waiting::OtherEffects {
            self.rest();
        }
        self.waiting = Waiting::No;
        self.second = !self.second;
        self.filled = 0;
        self.needed = ROWS;
        self.settled = false;
        self.follow_nothing();
        true
    }

    /// Whether a law waits for the end of a cycle.
    pub fn is_waiting(&self) -> bool {
        self.waiting != Waiting::No
    }

    /// Puts all effects at rest.
    pub fn rest(&mut self) {
        self.state = self.law().augmented.at_rest();
    }

    /// Force in kN on this tick: that of the mixed damping law and of every effect. Call it once per tick.
    #[inline]
    pub fn force(&mut self, motion: &Motion<f32>) -> f32 {
        if !self.settled {
            if self.law().augmented.has_stages() {
                return self.force_through_stages(motion);
            }
            self.settle(motion);
        }
        let motion = motion.clamped();
        let [first, second] = &self.laws;
        let law = if self.second { second } else { first };
        let elastic = self.in_force.elastic_force_within(motion.displacement());
        let damping = self.damping_part * self.table.damping_force(motion.velocity());
        let law_force = LawForce {
            damping,
            total: elastic + damping,
        };
        law.augmented
            .with_effects(&mut self.state, &motion, law_force)
    }

    /// [`RunningLaw::fill`] for the rare ticks that need it. Not inlined, so that other ticks do not save its registers.
    #[cold]
    #[inline(never)]
    fn settle(&mut self, motion: &Motion<f32>) {
        self.fill(motion.clamped().velocity());
        self.settled = !self.is_filling();
    }

    /// Not inlined, so that other ticks do not save its registers.
    #[inline(never)]
    fn force_through_stages(&mut self, motion: &Motion<f32>) -> f32 {
        let motion = motion.clamped();
        let filling = self.is_filling();
        if filling {
            self.fill(motion.velocity());
        }
        let [first, second] = &self.laws;
        let law = if self.second { second } else { first };
        let damping = |v| {
            self.damping_part
                * if filling {
                    // A stage may ask for another row than the one filled.
                    law.damping.damping_force(v)
                } else {
                    self.table.damping_force(v)
                }
        };
        law.augmented
            .force_through_stages(&mut self.state, &motion, &self.in_force, damping)
    }

    /// Damping force of the law as given, in kN, at `v` mm/s within ±[`crate::limits::VELOCITY`], independent of the rows filled.
    /// Not for every tick.
    pub(crate) fn damping_force(&self, v: f32) -> f32 {
        self.law().damping.damping_force(v)
    }

    /// A law has taken over, and the table is not completely filled for it yet.
    #[inline(always)]
    pub(crate) fn is_filling(&self) -> bool {
        self.filled < ROWS
    }

    /// Sum of `elastic` kN and the damping force of the law as given at `v` mm/s, within ±[`crate::limits::VELOCITY`]. The table
    /// must be filled for it.
    #[inline(always)]
    pub(crate) fn add_damping_force(&self, elastic: f32, v: f32) -> f32 {
        self.table.add_damping_force(elastic, v)
    }

    /// Fills the row for `v` mm/s, or the next row in turn if the tick before needed the same one.
    #[inline(always)]
    pub(crate) fn fill(&mut self, v: f32) {
        let [first, second] = &self.laws;
        let law = if self.second { second } else { first };
        let needed = PowerTable::row_of(v);
        let row = if needed == self.needed {
            self.filled += 1;
            self.filled - 1
        } else {
            self.needed = needed;
            needed
        };
        self.table.fill_row(&law.damping, row);
    }
}

impl<const N: usize> TickLaw for RunningLaw<N> {
    #[inline(always)]
    fn force(&mut self, motion: &Motion<f32>) -> f32 {
        Self::force(self, motion)
    }
    fn rest(&mut self) {
        Self::rest(self);
    }
    #[inline(always)]
    fn boundary(&mut self) -> bool {
        Self::boundary(self)
    }
    fn follow(&mut self, followed: Adaptation) {
        Self::follow(self, followed);
    }
    fn followed(&self) -> Adaptation {
        Self::followed(self)
    }
    #[inline(always)]
    fn parts(&self, motion: &Motion<f32>) -> [f32; 3] {
        Self::parts(self, motion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Drift, Effect, LoadFriction, Temperature, Viscous};

    /// k1·y, k3·y³ and c·|v|^α·sgn v. Load friction multiplies the last by 1 + λ·|y|, temperature subtracts β·ΔT, or β_damping·ΔT
    /// from the last, and a drift adds a and b as far as it has progressed. A dashpot and a drift's stiffness are in none. The
    /// force changes by the adaptation's part of each.
    #[test]
    fn the_adaptation_is_the_sum_of_its_parts() {
        let followed = Adaptation {
            k1: 0.1,
            k3: -0.2,
            c: 0.3,
        };
        let beside = [
            Effect::Viscous(Viscous::new(0.01).unwrap()),
            Effect::LoadFriction(LoadFriction::new(2.0).unwrap()),
            Effect::Temperature(
                Temperature::new(0.01, 20.0)
                    .and_then(|both| both.with_damping(-0.02))
                    .unwrap(),
            ),
            Effect::Drift(
                Drift::new(0.7, 12.0)
                    .and_then(|drift| drift.with_forces(-0.3, 0.8))
                    .unwrap(),
            ),
        ];
        let done = 1.0 - libm::expf(-30.0 / 12.0);
        for (count, load, cooled, done) in [
            (0, 0.0, 0.0, 0.0),
            (1, 0.0, 0.0, 0.0),
            (2, 2.0, 0.0, 0.0),
            (3, 2.0, 0.25, 0.0),
            (4, 2.0, 0.25, done),
        ] {
            let law = AugmentedLaw::<f32, 4>::new(Law::new(1.0, 10.0, 0.1, 0.4).unwrap());
            let mut effects = beside.iter().take(count);
            let law = effects.try_fold(law, |law, effect| law.with(*effect));
            let mut given = RunningLaw::new(FastLaw::new(law.unwrap()));
            let mut following = given.clone();
            following.follow(followed);
            for (y, v) in [(0.2f32, 3.0f32), (-0.1, 0.7), (0.15, -2.0)] {
                let motion = Motion {
                    temperature: 45.0,
                    cycles: 30.0,
                    ..Motion::at(y, v)
                };
                let damping = 0.1 * libm::powf(v.abs(), 0.4).copysign(v);
                let elastic = 1.0 - cooled - 0.3 * done;
                let expected = [
                    elastic * y,
                    elastic * 10.0 * y * y * y,
                    (1.0 + load * y.abs() + 2.0 * cooled + 0.8 * done) * damping,
                ];
                let parts = given.parts(&motion);
                for (part, expected) in parts.iter().zip(expected) {
                    assert!(
                        (part - expected).abs() < 1e-6,
                        "{count}: {part}, {expected}"
                    );
                }
                let [k1, k3, c] = parts;
                let sum = followed.k1 * k1 + followed.k3 * k3 + followed.c * c;
                let beyond = following.force(&motion) - given.force(&motion);
                assert!(
                    (beyond - sum).abs() < 1e-6,
                    "{count}: {beyond} is not {sum}"
                );
            }
        }
    }
}

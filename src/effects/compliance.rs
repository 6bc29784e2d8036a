//! A spring in series with the specimen: the fixture gives way, and the specimen moves less than is measured.

use super::{AugmentedState, ConfinedMotion, Motion};
use crate::error::ConfigError;
use crate::law::Law;
use crate::limits;
use crate::real::{Real, in_range};

/// The specimen's displacement x and velocity ẋ, where that of specimen and spring together is y, solve
///
/// K·(y − x) = F(x, ẋ) + c1·ẋ + E,
///
/// F eq 13, c1 that of [`super::Viscous`], E the other effects' force of the tick before: a step of at most K and what damps
/// per tick is fed back with a delay of one tick, so that stiffness which has memory has to be below that. All effects see x
/// and ẋ; the acceleration stays y's.
///
/// # Step
/// The spring's deflection d = y − x follows from its last two by the second backward difference, which damps a stiff spring
/// (BDF2): ẋ = ẏ − (3d − 4d₋₁ + d₋₂)/2Δt, that is d = D − h·ẋ with h = 2Δt/3 and D = (4d₋₁ − d₋₂)/3 + h·ẏ. What is small is kept, so
/// that the limit of a stiff spring is the law and no difference of displacements.
///
/// Now ẋ alone is sought. It has the sign of what pulls where the specimen stays, and a magnitude below both those that the
/// spring alone, and c·|v|^α alone, would allow. From the lesser of these Newton's steps come close in a few, and where friction
/// holds and a velocity has no meaning the force is that of the balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compliance<R> {
    pub(super) stiffness: R,
    /// h
    pub(super) step: R,
}

/// What a [`Compliance`] remembers.
#[derive(Clone, Copy, Debug)]
pub(super) struct ComplianceState<R> {
    /// d₋₁ and d₋₂, mm.
    deflections: [R; 2],
    /// E, kN.
    others: R,
    /// ẋ, mm/s.
    velocity: R,
}

/// Newton's steps.
const STEPS: usize = 4;
/// Squarings that stand for an exponent above 1, and the exponent that they come to.
const SQUARINGS: usize = 6;
const POWER: f64 = (1 << SQUARINGS) as f64;
/// Smallest magnitude of a velocity, mm/s: no quotient overflows at it.
const SLOWEST: f64 = 1e-20;

impl<R: Real> Compliance<R> {
    /// * `stiffness`: K, kN/mm, 1e-3…1e9
    /// * `tick`: Δt, s, 1e-7…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(stiffness: R, tick: R) -> Result<Self, ConfigError> {
        let tick = in_range("tick", tick, 1e-7, 1e3)?;
        let new = Self {
            stiffness,
            step: tick * R::from_f64(2.0 / 3.0),
        };
        new.check()?;
        Ok(new)
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        in_range("stiffness", self.stiffness, 1e-3, limits::COEFFICIENT)?;
        in_range("step", self.step, 6e-8, 700.0).map(|_| ())
    }

    /// At the first tick the spring is stretched as if `motion` had not changed lately.
    #[cold]
    #[inline(never)]
    fn begin(&self, motion: &ConfinedMotion<R>, law: &Law<R>, damping: R) -> ComplianceState<R> {
        let k1 = law.k1();
        let k1 = if k1 > R::ZERO { k1 } else { R::ZERO };
        let force = law.elastic_force_within(motion.displacement()) + damping;
        let deflection =
            (force / (self.stiffness + k1)).confined(R::from_f64(limits::DISPLACEMENT));
        ComplianceState {
            deflections: [deflection; 2],
            others: R::ZERO,
            velocity: motion.velocity(),
        }
    }

    /// The specimen's motion, and eq 13's force in kN at it. `damping` gives eq 13's damping force at a velocity within the
    /// limit, `viscous` is c1 in kN·s/mm.
    #[inline(always)]
    pub(super) fn deflect(
        &self,
        state: &mut Option<ComplianceState<R>>,
        motion: &ConfinedMotion<R>,
        law: &Law<R>,
        viscous: R,
        damping: impl Fn(R) -> R,
    ) -> (ConfinedMotion<R>, R) {
        let before = match *state {
            Some(before) => before,
            None => self.begin(motion, law, damping(motion.velocity())),
        };
        let [last, last_but_one] = before.deflections;
        let unmoved =
            last + (last - last_but_one) * R::from_f64(1.0 / 3.0) + self.step * motion.velocity();
        let position = |v: R| {
            let x = motion.displacement() - (unmoved - self.step * v);
            x.confined(R::from_f64(limits::DISPLACEMENT))
        };
        // All but the damping's force, against the spring's.
        let balance = |x: R, v: R| {
            let deflection = unmoved - self.step * v;
            law.elastic_force_within(x) + viscous * v + before.others - self.stiffness * deflection
        };
        // kN·s/mm: what a velocity adds to that.
        let quarter = R::from_f64(0.25) * self.step * self.stiffness;
        let rate = |x: R| {
            let tangent = law.k1() + R::from_f64(3.0) * law.k3() * (x * x);
            let rate = self.step * (self.stiffness + tangent) + viscous;
            // A law that gives way faster than the spring has no solution.
            if rate > quarter { rate } else { quarter }
        };

        let start = position(R::ZERO);
        let pull = balance(start, R::ZERO);
        let forward = pull < R::ZERO;
        let signed = |value: R| if forward { value } else { -value };
        let pull = pull.abs();
        // (pull/c)^(1/α), α at least 1/64.
        let alpha = law.alpha();
        let least = R::from_f64(1.0 / POWER);
        let exponent = if alpha > least { least / alpha } else { R::ONE };
        let mut held = (pull / law.c()).abs_pow(exponent);
        for _ in 0..SQUARINGS {
            held = held * held;
        }
        let free = pull / rate(start);
        let mut speed = if held < free { held } else { free };

        let (slowest, fastest) = (R::from_f64(SLOWEST), R::from_f64(limits::VELOCITY));
        let within = |speed: R| {
            if speed > fastest {
                fastest
            } else if speed > slowest {
                speed
            } else {
                slowest
            }
        };
        speed = within(speed);
        for _ in 0..STEPS {
            let v = signed(speed);
            let x = position(v);
            let force = damping(speed);
            let excess = force + signed(balance(x, v));
            let next = speed - excess * speed / (alpha * force + rate(x) * speed);
            // Friction next to Coulomb's bends so much that a step may lead beyond 0.
            let lowest = speed * R::from_f64(1.0 / 16.0);
            speed = within(if next > lowest { next } else { lowest });
        }
        let v = signed(speed);
        let x = position(v);
        let force = damping(speed);
        let excess = force + signed(balance(x, v));
        // Where it holds the balance's force, where it slides the law's: they differ by what the steps have left.
        let force = force - excess * force / (force + self.step * self.stiffness * speed);
        let deflection =
            (unmoved - self.step * v).confined(R::from_f64(2.0 * limits::DISPLACEMENT));
        *state = Some(ComplianceState {
            deflections: [deflection, last],
            others: before.others,
            velocity: v,
        });
        let seen = ConfinedMotion(Motion {
            displacement: x,
            velocity: v,
            ..motion.0
        });
        (seen, law.elastic_force_within(x) + signed(force))
    }

    /// What the effects added to eq 13's force on this tick, kN.
    #[inline(always)]
    pub(super) fn remember(&self, state: &mut Option<ComplianceState<R>>, added: R, viscous: R) {
        if let Some(state) = state {
            state.others = added - viscous * state.velocity;
        }
    }
}

impl<R: Real> AugmentedState<R> {
    /// After a tick with a [`Compliance`]: by how much its spring gives way, mm, and the velocity of the specimen behind it,
    /// mm/s.
    pub fn behind_spring(&self) -> Option<(R, R)> {
        let state = self.compliance.as_ref()?;
        Some((state.deflections[0], state.velocity))
    }
}

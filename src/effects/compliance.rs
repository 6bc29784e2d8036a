//! A spring in series with the specimen: the fixture yields, so the specimen moves less than the measured displacement.

use super::description::{Dependence, Description, EffectKind, Growth};
use super::{AugmentedState, ClampedMotion, Equations, LawForce, Motion};
use crate::error::ConfigError;
use crate::law::Law;
use crate::limits;
use crate::real::{Real, in_range};

/// Let y be the displacement of specimen and spring together. The specimen's displacement x and velocity ẋ solve
///
/// K·(y − x) = F(x, ẋ) + c1·ẋ + E,
///
/// F is the mixed damping law (eq 13), c1 that of [`super::Viscous`], and E the force of the other effects but a mass
/// ([`super::Inertia`]), which is on the sensors' side of the spring and has the acceleration of y. The others see x and ẋ. E is taken
/// from the tick before, and is 0 at the first tick. The force therefore oscillates from tick to tick where the other effects together
/// are stiffer than spring and law, and undamped. It also does where [`super::LoadFriction`] and [`super::Directional`] add more than
/// 100 % to the law's damping.
///
/// # Step
/// The spring's deflection d = y − x follows from its last two values by the second backward difference, which damps a stiff spring
/// (BDF2): ẋ = ẏ − (3d − 4d₋₁ + d₋₂)/2Δt. This is d = D − h·ẋ with h = 2Δt/3 and D = (4d₋₁ − d₋₂)/3 + h·ẏ. The state is the small
/// deflection. The limit of a stiff spring is thus the law itself, without a difference of displacements.
///
/// Now only ẋ is unknown. It has the sign of the force that would act on the specimen at rest. Its magnitude is below both the
/// value that the spring alone would allow and the value that c·|v|^α alone would allow. Newton's method starts from the smaller of
/// these and converges in a few steps. Where friction holds the specimen, and the velocity has no meaning, the force is that of the
/// balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compliance<R> {
    stiffness: R,
    /// h
    step: R,
}

/// State of a [`Compliance`].
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ComplianceState<R> {
    /// d₋₁ and d₋₂, mm.
    deflections: [R; 2],
    /// E, kN.
    others: R,
    /// ẋ, mm/s.
    velocity: R,
}

/// h of a tick, s.
fn step_of<R: Real>(tick: R) -> R {
    tick * R::from_f64(2.0 / 3.0)
}

/// Range of the stiffness, kN/mm.
const STIFFNESS: [f64; 2] = [1e-3, limits::COEFFICIENT];
/// Number of Newton steps.
const STEPS: usize = 4;
/// Number of squarings that approximate an exponent above 1.
const SQUARINGS: usize = 6;
const POWER: f64 = (1 << SQUARINGS) as f64;
/// Smallest magnitude of a velocity, mm/s, at which no quotient overflows.
const SLOWEST: f64 = 1e-20;

numbers! {
    Compliance { stiffness, step } of {
        stiffness: "kN/mm" in STIFFNESS,
    }
}

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
            step: step_of(tick),
        };
        new.check()?;
        Ok(new)
    }

    /// K, kN/mm.
    pub(super) fn stiffness(&self) -> R {
        self.stiffness
    }

    /// At the first tick the spring is stretched as if `motion` had been constant for some time.
    #[cold]
    #[inline(never)]
    fn begin(&self, motion: &ClampedMotion<R>, law: &Law<R>, damping: R) -> ComplianceState<R> {
        let k1 = law.k1();
        let k1 = if k1 > R::ZERO { k1 } else { R::ZERO };
        let force = law.elastic_force_within(motion.displacement()) + damping;
        let deflection = (force / (self.stiffness + k1)).clamped(R::from_f64(limits::DISPLACEMENT));
        ComplianceState {
            deflections: [deflection; 2],
            others: R::ZERO,
            velocity: motion.velocity(),
        }
    }
}

impl<R: Real> Equations<R> for Compliance<R> {
    const DESCRIPTION: Description = Description {
        name: "compliance",
        family: "compliance",
        number: 13,
        kind: EffectKind::Stage,
        parameters: Self::PARAMETERS,
        typical: &[20.0],
        depends_on: &[
            Dependence::Displacement,
            Dependence::Velocity,
            Dependence::Amplitude,
        ],
        outside: Growth::AtMostLinear,
        sentence: "A spring in series with the specimen: the fixture gives way.",
        ..Description::PLAIN
    };
    const NONE: Self = Self::ABSENT;

    type State = Option<ComplianceState<R>>;
    const AT_REST: Self::State = None;

    fn from_parameters(parameters: &[f64], tick: f64) -> Result<Self, ConfigError> {
        let [stiffness] = super::numbers::exactly(parameters)?;
        Self::new(R::from_f64(stiffness), R::from_f64(tick))
    }

    fn check(&self) -> Result<(), ConfigError> {
        in_range("stiffness", self.stiffness, STIFFNESS[0], STIFFNESS[1])?;
        in_range("step", self.step, 6e-8, 700.0).map(|_| ())
    }

    fn check_tick(&self, tick: R) -> Result<(), ConfigError> {
        super::is_of_tick("step", self.step, step_of(tick))
    }

    #[inline(always)]
    fn solved(
        &self,
        state: &mut Self::State,
        motion: &ClampedMotion<R>,
        law: &Law<R>,
        viscous: R,
        damping: &impl Fn(R) -> R,
    ) -> Option<(ClampedMotion<R>, LawForce<R>)> {
        let before = match *state {
            Some(before) => before,
            None => self.begin(motion, law, damping(motion.velocity())),
        };
        let [last, last_but_one] = before.deflections;
        let unmoved =
            last + (last - last_but_one) * R::from_f64(1.0 / 3.0) + self.step * motion.velocity();
        let mut trial = Trial {
            compliance: self,
            law,
            viscous,
            damping,
            displacement: motion.displacement(),
            unmoved,
            others: before.others,
            forward: true,
        };
        let start = trial.at(R::ZERO);
        trial.forward = start.excess < R::ZERO;
        let pull = start.excess.abs();
        // (pull/c)^(1/α), α at least 1/64.
        let alpha = law.alpha();
        let least = R::from_f64(1.0 / POWER);
        let exponent = if alpha > least { least / alpha } else { R::ONE };
        let mut held = (pull / law.c()).abs_pow(exponent);
        for _ in 0..SQUARINGS {
            held = held * held;
        }
        let free = pull / start.rate;
        let mut speed = within(if held < free { held } else { free });
        let mut at = trial.at(speed);
        for _ in 0..STEPS {
            let next = speed - at.excess * speed / (alpha * at.damping + at.rate * speed);
            // Friction close to Coulomb's is so strongly curved that a step may pass 0.
            let lowest = speed * R::from_f64(1.0 / 16.0);
            speed = within(if next > lowest { next } else { lowest });
            at = trial.at(speed);
        }
        let v = trial.signed(speed);
        // Where the specimen sticks, the force of the balance, where it slides, that of the law. They differ by the remaining error
        // of the Newton steps.
        let held = at.damping / (at.damping.abs() + self.step * self.stiffness * speed);
        let force = trial.signed(at.damping - at.excess * held);
        let deflection = (unmoved - self.step * v).clamped(R::from_f64(2.0 * limits::DISPLACEMENT));
        *state = Some(ComplianceState {
            deflections: [deflection, last],
            others: before.others,
            velocity: v,
        });
        let seen = ClampedMotion(Motion {
            displacement: at.displacement,
            velocity: v,
            ..motion.0
        });
        let law = LawForce {
            damping: force,
            total: at.elastic + force,
        };
        Some((seen, law))
    }

    #[inline(always)]
    fn added(&self, state: &mut Self::State, added: R, viscous: R) {
        if let Some(state) = state {
            // An infinite sum must not stay in the state: a difference of infinities would be NaN for good.
            state.others = (added - viscous * state.velocity).clamped(R::from_f64(limits::FORCE));
        }
    }
}

impl<R: Real> AugmentedState<R> {
    /// After a tick with a [`Compliance`]: the deflection of its spring, mm, and the velocity of the specimen behind it, mm/s.
    pub fn behind_spring(&self) -> Option<(R, R)> {
        let state = self.compliance.as_ref()?;
        Some((state.deflections[0], state.velocity))
    }
}

/// The equation of one tick, with its known terms.
struct Trial<'a, R, D> {
    compliance: &'a Compliance<R>,
    law: &'a Law<R>,
    viscous: R,
    /// Eq 13's damping force as a function of velocity.
    damping: D,
    /// y, mm.
    displacement: R,
    /// D, mm.
    unmoved: R,
    /// E, kN.
    others: R,
    /// The velocity is positive.
    forward: bool,
}

/// The equation evaluated at a speed.
#[derive(Clone, Copy)]
struct Tried<R> {
    /// x, mm.
    displacement: R,
    /// Eq 13's elastic force, kN.
    elastic: R,
    /// Magnitude of eq 13's damping force, kN, at this speed.
    damping: R,
    /// All forces minus the spring's, kN, in the direction of the velocity.
    excess: R,
    /// Derivative of these forces with respect to velocity, without eq 13's damping, kN·s/mm.
    rate: R,
}

impl<R: Real, D: Fn(R) -> R> Trial<'_, R, D> {
    #[inline(always)]
    fn signed(&self, value: R) -> R {
        if self.forward { value } else { -value }
    }

    // Not inlined, because a tick calls it six times.
    #[inline(never)]
    fn at(&self, speed: R) -> Tried<R> {
        let Compliance { stiffness, step } = *self.compliance;
        let v = self.signed(speed);
        let deflection = self.unmoved - step * v;
        let x = (self.displacement - deflection).clamped(R::from_f64(limits::DISPLACEMENT));
        let elastic = self.law.elastic_force_within(x);
        let damping = (self.damping)(speed);
        let balance = elastic + self.viscous * v + self.others - stiffness * deflection;
        let tangent = self.law.k1() + R::from_f64(3.0) * self.law.k3() * (x * x);
        let rate = step * (stiffness + tangent) + self.viscous;
        // A law with a negative stiffness beyond the spring's has no solution.
        let least = R::from_f64(0.25) * step * stiffness;
        Tried {
            displacement: x,
            elastic,
            damping,
            excess: damping + self.signed(balance),
            rate: if rate > least { rate } else { least },
        }
    }
}

/// Clamps the magnitude of a velocity so that nothing overflows.
#[inline(always)]
fn within<R: Real>(speed: R) -> R {
    let (slowest, fastest) = (R::from_f64(SLOWEST), R::from_f64(limits::VELOCITY));
    if speed > fastest {
        fastest
    } else if speed > slowest {
        speed
    } else {
        slowest
    }
}

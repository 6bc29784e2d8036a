//! A force that settles with the cycles: run-in, friction wear, or wires that break one after another.

use super::description::{Absent, Cost, Dependence, Description, Energy, Growth};
use super::numbers::COEFFICIENTS;
use super::{ClampedMotion, Equations, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient, compare, in_range};

/// Range of N.
const CYCLES: [f64; 2] = [0.1, limits::CYCLES];

/// F = (1 − e^(−n/N))·(k·y + a·F_elastic + b·F_damping), n the cycles since the test began. In the end the stiffness has changed by
/// k, the elastic force of the mixed damping law (eq 13) by the fraction a of itself, and its damping force by b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift<R> {
    stiffness: R,
    /// a
    elastic: R,
    /// b − a
    beyond: R,
    /// −log₂ e/N
    rate: R,
}

numbers! {
    Drift { stiffness, elastic, beyond, rate } of {
        cycles: "1" in CYCLES,
        stiffness: "kN/mm" in COEFFICIENTS => Absent::Is(0.0),
        elastic_change: "1" in [-1.0, limits::CHANGE] => Absent::Is(0.0),
        damping_change: "1" in [-1.0, limits::CHANGE] => Absent::Is(0.0),
    }
}

impl<R: Real> Drift<R> {
    /// * `stiffness`: final change of the stiffness, kN/mm, −1e9…1e9
    /// * `cycles`: N, after which 63 % of the change is complete, 0.1…1e9
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(stiffness: R, cycles: R) -> Result<Self, ConfigError> {
        let cycles = in_range("cycles", cycles, CYCLES[0], CYCLES[1])?;
        let new = Self {
            stiffness,
            elastic: R::ZERO,
            beyond: R::ZERO,
            rate: R::from_f64(-core::f64::consts::LOG2_E) / cycles,
        };
        new.check()?;
        Ok(new)
    }

    /// The same with a change of eq 13's forces.
    ///
    /// * `elastic_change`: a, −1…1e3. Below −1 the force would reverse. The upper end is high, because the final value of a slow
    ///   change may be far beyond the change within a test
    /// * `damping_change`: b, −1…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn with_forces(self, elastic_change: R, damping_change: R) -> Result<Self, ConfigError> {
        let elastic = in_range("elastic_change", elastic_change, -1.0, limits::CHANGE)?;
        let damping = in_range("damping_change", damping_change, -1.0, limits::CHANGE)?;
        let new = Self {
            elastic,
            beyond: damping - elastic,
            ..self
        };
        new.check()?;
        Ok(new)
    }

    /// Final change of the forces of `law`.
    #[inline(always)]
    fn change_of_law(&self, law: LawForce<R>) -> R {
        self.elastic * law.total + self.beyond * law.damping
    }

    /// The completed part of a change.
    #[inline(always)]
    fn done(&self, change: R, motion: &ClampedMotion<R>) -> R {
        change - change * (motion.cycles() * self.rate).exp2_of_negative()
    }
}

impl<R: Real> Equations<R> for Drift<R> {
    const DESCRIPTION: Description = Description {
        name: "drift",
        family: "drift",
        number: 5,
        cost: Cost::Common,
        parameters: Self::PARAMETERS,
        typical: &[30.0, 0.2, 0.1, -0.3],
        depends_on: &[Dependence::Displacement, Dependence::Cycle],
        outside: Growth::OfLaw,
        energy: Energy::ScalesDamping,
        scales_law: true,
        sentence: "A force that settles with the cycles: run-in, friction that wears, or wires that break one after another.",
        ..Description::PLAIN
    };
    const NONE: Self = Self::ABSENT;

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [cycles, stiffness, elastic, damping] =
            super::numbers::exactly(parameters)?.map(R::from_f64);
        Self::new(stiffness, cycles)?.with_forces(elastic, damping)
    }

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("stiffness", self.stiffness)?;
        in_range("elastic_change", self.elastic, -1.0, limits::CHANGE)?;
        // Beyond the range only by the rounding of the two in f32: `least_damping` takes it for the end of the range.
        let rounding = R::from_f64(2.4e-7) * (R::ONE + self.elastic.abs());
        let damping = self.elastic + self.beyond;
        let most = R::from_f64(limits::CHANGE);
        compare(
            "damping_change",
            damping,
            -R::ONE - rounding,
            most + rounding,
        )?;
        // A little beyond the range, because it is computed from a rounded number.
        let rate = CYCLES.map(|cycles| -core::f64::consts::LOG2_E / cycles);
        in_range("rate", self.rate, 1.001 * rate[0], 0.999 * rate[1]).map(|_| ())
    }

    /// Before the first cycle there is no change yet.
    fn least_damping(&self) -> (&'static str, R, R) {
        let change = self.elastic + self.beyond;
        let least = if change < R::ZERO { change } else { R::ZERO };
        ("damping_change", change, least.clamped(R::ONE))
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
        let change = self.stiffness * motion.displacement() + self.change_of_law(law);
        self.done(change, motion)
    }

    /// All of the force but that of the stiffness.
    #[inline(always)]
    fn force_of_law(&self, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
        self.done(self.change_of_law(law), motion)
    }
}

//! Rate-independent friction in the general form of Bouc (1967) and Wen (1976), bounded: the third form of stick-slip.

use super::description::{Dependence, Description, Energy, Growth};
use super::numbers::{COEFFICIENTS, SLIP_LIMITS};
use super::stretch::{SHARPNESS, Stretch, power};
use super::{ClampedMotion, Equations, LawForce, below_0};
use crate::real::Real;

numbers! {
    /// F = k·z with |z| ≤ x: away from 0 dz = dy·(1 + h·(|z|/x)ⁿ), towards 0 dz = dy·(1 + (h + l)·(|z|/x)ⁿ).
    ///
    /// Bouc and Wen's dz = A·dy − β·(γ·|dy|·|z|ⁿ⁻¹·z + δ·dy·|z|ⁿ) is this with k = A, h = −(γ + δ)·β·(A·x)ⁿ/A and l = 2γ·β·(A·x)ⁿ/A.
    /// With h = −1 and l = 1 it is the softening form of [`BoucWen`](super::BoucWen). With h > 0 each branch becomes steeper, and only
    /// x ends it.
    ///
    /// The equation is passive: ∫ k·z dz/(1 + h·(|z|/x)ⁿ) is the stored energy. On the way away from 0 all work is stored, and on the
    /// way back, with l ≥ 0, no more than that is returned.
    ///
    /// # Step
    /// A step towards 0 and one away from 0 replace (|z|/x)ⁿ by the line through 0 that meets it in the middle of the step,
    /// dz = dy·(1 + c·z). The step is of second order, and exact for n = 1. A step that takes more than half of a z loses too much of it
    /// rather than too little. z never passes its bound, whatever the step.
    pub struct HardeningFriction {
        /// k, kN/mm, −1e9…1e9
        stiffness: "kN/mm" in COEFFICIENTS,
        /// x, mm, 1e-9…1e4
        stretch_limit: "mm" in SLIP_LIMITS,
        /// n, 0.5…8
        sharpness: "1" in SHARPNESS,
        /// h, −1…100
        hardening: "1" in [-1.0, 100.0],
        /// l, 0…200
        loss: "1" in [0.0, 200.0],
    }
}

impl<R: Real> HardeningFriction<R> {
    /// c of the line 1 + c·z that meets 1 + rise·(z/x)ⁿ at z = `stretch` ≥ 0. Not inlined, because it is called four times.
    #[inline(never)]
    fn bend(&self, stretch: R, rise: R) -> R {
        // Next to 0 it is a quotient of rounding errors, of a force that is almost straight there.
        let least = R::from_f64(1e-4) * self.stretch_limit;
        let stretch = if stretch > least { stretch } else { least };
        rise * power(stretch / self.stretch_limit, self.sharpness) / stretch
    }

    /// z ≥ 0 after `way` mm away from 0. Not inlined, because it is called from two places.
    #[inline(never)]
    fn away(&self, stretch: R, way: R) -> R {
        let slope = R::ONE + self.bend(stretch, self.hardening) * stretch;
        let middle = (stretch + R::from_f64(0.5) * way * slope).clipped(self.stretch_limit);
        let bend = self.bend(middle, self.hardening);
        let moved = stretch + (R::ONE + bend * stretch) * way * mean_growth(bend * way);
        if moved > stretch {
            moved.clipped(self.stretch_limit)
        } else {
            stretch
        }
    }

    /// z after `way` mm from −`stretch` ≤ 0 on, towards 0 and beyond.
    fn back(&self, stretch: R, way: R) -> R {
        let rise = self.hardening + self.loss;
        let half = R::from_f64(0.5);
        // Where a step falls steeply, the line of its middle would be almost flat: use at least half of the initial z.
        let middle = fallen(stretch, self.bend(stretch, rise), half * way);
        let least = half * stretch;
        let middle = if middle > least { middle } else { least };
        let bend = self.bend(middle, rise);
        // Where it falls by less than its displacement, the line may be below 0 at the other end, and z would grow there.
        let flat = -R::ONE / stretch;
        let bend = if bend > flat { bend } else { flat };
        let left = fallen(stretch, bend, way);
        if left >= R::ZERO {
            return -left;
        }
        let rest = way - stretch * mean_logarithm(bend * stretch);
        if rest > R::ZERO {
            self.away(R::ZERO, rest)
        } else {
            R::ZERO
        }
    }
}

/// z after `way` of dz = −(1 + bend·z)·dy from `stretch` on, below 0 where it passes that.
#[inline(never)]
fn fallen<R: Real>(stretch: R, bend: R, way: R) -> R {
    stretch - (R::ONE + bend * stretch) * way * mean_growth(-bend * way)
}

/// ln(1 + u)/u for a u of at least −1. With s the eighth root of 1 + u and x = (s − 1)/(s + 1), ln s is 2·artanh x; two of its
/// terms are within x⁴/5, and at −1 the result is finite.
#[inline(never)]
fn mean_logarithm<R: Real>(u: R) -> R {
    if u.abs() < R::from_f64(0.02) {
        // The next term is u³/4.
        return R::ONE - u * (R::from_f64(0.5) - u * R::from_f64(1.0 / 3.0));
    }
    let root = (R::ONE + u).abs_pow(R::from_f64(0.125));
    let x = (root - R::ONE) / (root + R::ONE);
    R::from_f64(16.0) * x * (R::ONE + x * x * R::from_f64(1.0 / 3.0)) / u
}

/// (eᵃ − 1)/a, the mean of eᵗ from 0 to a.
#[inline(never)]
fn mean_growth<R: Real>(a: R) -> R {
    let (small, most) = (R::from_f64(0.05), R::from_f64(30.0));
    let size = a.abs();
    if size < small {
        // The next term is a³/24.
        return R::ONE + a * (R::from_f64(0.5) + a * R::from_f64(1.0 / 6.0));
    }
    let size = if size < most { size } else { most };
    let fallen = (-size * R::from_f64(core::f64::consts::LOG2_E)).exp2_of_negative();
    let mean = (R::ONE - fallen) / size;
    if a > R::ZERO { mean / fallen } else { mean }
}

impl<R: Real> Equations<R> for HardeningFriction<R> {
    const DESCRIPTION: Description = Description {
        name: "hardening_friction",
        family: "stick_slip",
        number: 16,
        parameters: Self::PARAMETERS,
        typical: &[0.9, 0.4, 1.0, 2.0, 10.0],
        depends_on: &[Dependence::Displacement, Dependence::History],
        outside: Growth::Saturates,
        energy: Energy::Below0(&["stiffness"]),
        sentence: "Rate-independent friction whose branches grow steeper, and fall off faster than they rose.",
        ..Description::PLAIN
    };
    listed!();

    type State = Option<Stretch<R>>;
    const AT_REST: Self::State = None;

    fn supplies(&self) -> Option<(&'static str, R)> {
        below_0("stiffness", self.stiffness)
    }

    // Not inlined on a target, so that a tick without this effect does not save its registers.
    #[cfg_attr(not(feature = "std"), inline(never))]
    fn force(&self, state: &mut Self::State, motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let stretch = Stretch::after(state, motion, |stretch, way| {
            if stretch < R::ZERO {
                self.back(-stretch, way)
            } else {
                self.away(stretch, way)
            }
        });
        self.stiffness * stretch
    }
}

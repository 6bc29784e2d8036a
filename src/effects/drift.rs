//! A stiffness that settles with the cycles: run-in, or wires that break one after another.

use super::{EffectForce, Motion};
use crate::error::{ConfigError, in_range};
use crate::law::{COEFFICIENT_LIMIT, DISPLACEMENT_LIMIT};
use crate::real::Real;

/// Cycle counts are taken as within 0…this many.
const CYCLES_LIMIT: f64 = 1e9;

/// F = k·(1 − e^(−n/N))·y, n the cycles since the test began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift<R> {
    stiffness: R,
    /// 1/N
    rate: R,
}

impl<R: Real> Drift<R> {
    /// * `stiffness`: what the stiffness has changed by in the end, kN/mm, −1e9…1e9
    /// * `cycles`: N, after which 63 % of the change is done, 0.1…1e9
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(stiffness: R, cycles: R) -> Result<Self, ConfigError> {
        Ok(Self {
            stiffness: in_range(
                "stiffness",
                stiffness,
                -COEFFICIENT_LIMIT,
                COEFFICIENT_LIMIT,
            )?,
            rate: R::ONE / in_range("cycles", cycles, 0.1, CYCLES_LIMIT)?,
        })
    }
}

impl<R: Real> EffectForce<R> for Drift<R> {
    type State = ();

    #[inline]
    fn force(&self, _: &mut (), motion: &Motion<R>, _: R) -> R {
        let done =
            R::ONE - (-(motion.cycles.confined(R::from_f64(CYCLES_LIMIT)).abs() * self.rate)).exp();
        let y = motion
            .displacement
            .confined(R::from_f64(DISPLACEMENT_LIMIT));
        self.stiffness * done * y
    }
}

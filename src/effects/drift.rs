//! A stiffness that settles with the cycles: run-in, or wires that break one after another.

use super::{EffectForce, Motion};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

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
                -limits::COEFFICIENT,
                limits::COEFFICIENT,
            )?,
            rate: R::ONE / in_range("cycles", cycles, 0.1, limits::CYCLES)?,
        })
    }
}

impl<R: Real> EffectForce<R> for Drift<R> {
    type State = ();

    #[inline]
    fn force(&self, _: &mut (), motion: &Motion<R>, _: R) -> R {
        let done = R::ONE
            - (-(motion.cycles.confined(R::from_f64(limits::CYCLES)).abs() * self.rate)).exp();
        let y = motion
            .displacement
            .confined(R::from_f64(limits::DISPLACEMENT));
        self.stiffness * done * y
    }
}

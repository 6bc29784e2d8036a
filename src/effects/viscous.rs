//! A linear dashpot beside the |v|^α damping: a fluid, or the film between wires.

use super::{EffectForce, Motion};
use crate::error::{ConfigError, in_range};
use crate::law::{COEFFICIENT_LIMIT, VELOCITY_LIMIT};
use crate::real::Real;

/// F = c1·v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous<R> {
    c1: R,
}

impl<R: Real> Viscous<R> {
    /// * `c1`: kN·s/mm, −1e9…1e9. A negative one is allowed: it may take back what |v|^α gives too much of.
    ///
    /// # Errors
    /// `c1` not finite or out of range.
    pub fn new(c1: R) -> Result<Self, ConfigError> {
        Ok(Self {
            c1: in_range("c1", c1, -COEFFICIENT_LIMIT, COEFFICIENT_LIMIT)?,
        })
    }
}

impl<R: Real> EffectForce<R> for Viscous<R> {
    type State = ();

    #[inline]
    fn force(&self, _: &mut (), motion: &Motion<R>, _: R) -> R {
        self.c1 * motion.velocity.confined(R::from_f64(VELOCITY_LIMIT))
    }
}

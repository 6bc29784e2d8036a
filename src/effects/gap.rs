//! Free play of the mounting: the specimen does not feel the first part of a displacement to either side.

use super::{ConfinedMotion, Motion};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// The specimen is moved by sgn y·max(|y| − w, 0) instead of y. Velocity and acceleration are y's beyond ±w, and within it 0,
/// or y's as well where what damps lies beside the play.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap<R> {
    pub(super) half_width: R,
    /// What part of velocity and acceleration is felt within ±w: 0 or 1.
    pub(super) inside: R,
}

impl<R: Real> Gap<R> {
    pub(super) const NONE: Self = Self {
        half_width: R::ZERO,
        inside: R::ZERO,
    };

    /// * `half_width`: w, mm, 0…1e4
    /// * `damps_inside`: velocity and acceleration stay within ±w
    ///
    /// # Errors
    /// `half_width` not finite or out of range.
    pub fn new(half_width: R, damps_inside: bool) -> Result<Self, ConfigError> {
        let new = Self {
            half_width,
            inside: if damps_inside { R::ONE } else { R::ZERO },
        };
        new.check()?;
        Ok(new)
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        in_range("half_width", self.half_width, 0.0, limits::DISPLACEMENT)?;
        in_range("inside", self.inside, 0.0, 1.0).map(|_| ())
    }

    /// The motion that the specimen feels where the mounting's is `motion`. Cycles and temperature stay.
    #[inline]
    pub fn transform(&self, motion: &Motion<R>) -> Motion<R> {
        let y = motion.displacement;
        let mut felt = *motion;
        if y > self.half_width {
            felt.displacement = y - self.half_width;
        } else if y < -self.half_width {
            felt.displacement = y + self.half_width;
        } else {
            felt.displacement = R::ZERO;
            felt.velocity = self.inside * motion.velocity;
            felt.acceleration = self.inside * motion.acceleration;
        }
        felt
    }

    /// The same; what is within the limits stays within.
    #[inline(always)]
    pub(super) fn felt(&self, motion: &ConfinedMotion<R>) -> ConfinedMotion<R> {
        ConfinedMotion(self.transform(&motion.0))
    }
}

//! Free play of the mounting: the specimen does not feel the first part of a displacement in either direction.

use super::description::{Dependence, Description, EffectKind, Growth};
use super::{ClampedMotion, Equations, Motion};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// The specimen moves by sgn y·max(|y| − w, 0) instead of y. Beyond ±w its velocity is that of y. Within ±w it is
/// 0, or also that of y where the damping parts lie parallel to the play. A mass is on the sensors' side of the play: the acceleration
/// is that of y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap<R> {
    half_width: R,
    /// The part of the velocity that acts within ±w: 0 or 1.
    inside: R,
}

numbers! {
    Gap { half_width, inside } of {
        half_width: "mm" in [0.0, limits::DISPLACEMENT],
        damps_inside: "1" in [0.0, 1.0],
    }
}

impl<R: Real> Gap<R> {
    /// * `half_width`: w, mm, 0…1e4
    /// * `damps_inside`: whether the velocity is that of y within ±w too
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

    /// The motion of the specimen for the mounting's `motion`. Cycles and temperature stay.
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
        }
        felt
    }
}

impl<R: Real> Equations<R> for Gap<R> {
    const DESCRIPTION: Description = Description {
        name: "gap",
        family: "gap",
        number: 10,
        kind: EffectKind::Stage,
        parameters: Self::PARAMETERS,
        typical: &[0.01, 0.0],
        depends_on: &[Dependence::Displacement],
        outside: Growth::OfForceBehind,
        sentence: "Free play of the mounting: the first part of a displacement is not felt.",
        ..Description::PLAIN
    };
    const NONE: Self = Self::ABSENT;

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let [half_width, damps_inside] = super::numbers::exactly(parameters)?;
        in_range("damps_inside", damps_inside, 0.0, 1.0)?;
        Self::new(R::from_f64(half_width), damps_inside != 0.0)
    }

    fn check(&self) -> Result<(), ConfigError> {
        in_range("half_width", self.half_width, 0.0, limits::DISPLACEMENT)?;
        if self.inside == R::ZERO {
            return Ok(());
        }
        in_range("inside", self.inside, 1.0, 1.0).map(|_| ())
    }

    /// A motion within the limits stays within them.
    #[inline(always)]
    fn felt(&self, motion: &ClampedMotion<R>) -> ClampedMotion<R> {
        ClampedMotion(self.transform(&motion.0))
    }
}

//! State of a branch with a spring, and functions of friction that begins to slip by degrees.

use super::ClampedMotion;
use crate::real::Real;

/// Range of the exponent.
pub(super) const SHARPNESS: [f64; 2] = [0.5, 8.0];

/// The stretch of a spring, and the displacement that belongs to it.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stretch<R> {
    /// z, mm.
    stretch: R,
    /// Displacement of the tick before, mm.
    previous: R,
}

impl<R: Real> Stretch<R> {
    /// That of a spring at a displacement in mm.
    pub(super) fn of_spring(displacement: R) -> Self {
        Self {
            stretch: displacement,
            previous: displacement,
        }
    }

    /// z after a tick with this motion. `moved` gives it for a z and a displacement of at least 0, which both point upwards.
    #[inline(always)]
    pub(super) fn after(
        state: &mut Option<Self>,
        motion: &ClampedMotion<R>,
        moved: impl FnOnce(R, R) -> R,
    ) -> R {
        let y = motion.displacement();
        let state = state.get_or_insert(Self {
            stretch: R::ZERO,
            previous: y,
        });
        let step = y - state.previous;
        state.previous = y;
        let forward = step > R::ZERO;
        let (way, stretch) = if forward {
            (step, state.stretch)
        } else {
            (-step, -state.stretch)
        };
        let moved = moved(stretch, way);
        state.stretch = if forward { moved } else { -moved };
        state.stretch
    }
}

/// |part|^sharpness for a sharpness within [`SHARPNESS`], computed with an exponent of at most 1.
#[inline(always)]
pub(super) fn power<R: Real>(part: R, sharpness: R) -> R {
    let root = part.abs_pow(sharpness * R::from_f64(1.0 / SHARPNESS[1]));
    let square = root * root;
    let fourth = square * square;
    fourth * fourth
}

/// 1 − e⁻ᵃ for an a of at least 0: within a⁴/24 of e⁻ᵃ, and below 1.
#[inline(always)]
pub(super) fn taken<R: Real>(a: R) -> R {
    // Beyond this the cube would overflow, and the result is 1 already.
    let most = R::from_f64(1e3);
    let a = if a < most { a } else { most };
    let grown = a * (R::ONE + a * (R::from_f64(0.5) + a * R::from_f64(1.0 / 6.0)));
    grown / (R::ONE + grown)
}

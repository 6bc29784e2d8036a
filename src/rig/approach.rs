//! The approach: the way from the piston's position at the start of a rig to the start of its motion.
//!
//! A servo moves as fast as it can to a command that is far from its position. The command therefore begins at the piston's
//! position, and goes linearly to the start, in as many ticks as the return of a stopping rig.

use super::blend::Blend;

/// The remaining way, in mm; −∞ if the position has not been read since the start.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Approach(Blend);

impl Approach {
    /// The way is not known yet.
    pub(super) const DUE: Self = Self(Blend::of(f32::NEG_INFINITY, 0.0));

    /// Sets the way from `displacement` mm, where the piston is; a piston within `tolerance` of 0 is at the start already. The way
    /// takes `ticks`.
    pub(super) fn begin(&mut self, displacement: f32, tolerance: f32, ticks: f32) {
        // NaN and infinity are no way; the limits stop the rig.
        let is_away = displacement.is_finite() && displacement.abs() > tolerance;
        self.0 = Blend::of(if is_away { displacement } else { 0.0 }, 1.0 / ticks);
    }

    /// Whether the way is not known yet.
    pub(super) fn is_due(&self) -> bool {
        self.left() == f32::NEG_INFINITY
    }

    /// Whether a part of the way remains, or it is not known yet.
    #[inline(always)]
    pub(super) fn is_under_way(&self) -> bool {
        self.left() != 0.0
    }

    /// The remaining way, mm.
    #[inline(always)]
    pub(super) fn left(&self) -> f32 {
        self.0.left()
    }

    /// Advances by one tick; returns the remaining way, mm.
    pub(super) fn tick(&mut self) -> f32 {
        self.0.tick()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_a_straight_line_to_the_start() {
        let mut approach = Approach::DUE;
        assert!(approach.is_due());
        approach.begin(-0.2, 0.01, 4.0);
        assert!(approach.is_under_way() && !approach.is_due());
        for left in [-0.15f32, -0.1, -0.05, 0.0] {
            assert!((approach.tick() - left).abs() < 1e-7);
        }
        // The rest is a rounding error.
        assert_eq!(approach.tick(), 0.0);
        assert!(!approach.is_under_way());
    }

    #[test]
    fn who_is_there_need_not_go() {
        for displacement in [0.0, 0.01, -0.01, f32::NAN, f32::INFINITY] {
            let mut approach = Approach::DUE;
            approach.begin(displacement, 0.01, 4.0);
            assert!(!approach.is_under_way());
        }
    }
}

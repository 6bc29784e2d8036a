//! The way from where the piston is, as a rig starts, to where its motion begins.
//!
//! A servo that finds itself at another place than its command goes there as fast as it can. So the command begins where the piston is,
//! and goes to the start in a straight line in as many ticks as the way back of a rig that stops.

use super::blend::Blend;

/// The way that is left, in mm; −∞ where nobody has looked since the start.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Approach(Blend);

impl Approach {
    /// It is not yet known how far it is.
    pub(super) const DUE: Self = Self(Blend::of(f32::NEG_INFINITY, 0.0));

    /// The piston is at `displacement` mm; within `tolerance` of 0 it is there. The way takes `ticks`.
    pub(super) fn begin(&mut self, displacement: f32, tolerance: f32, ticks: f32) {
        // A number that is none is no way; the limits stop it.
        let is_away = displacement.is_finite() && displacement.abs() > tolerance;
        self.0 = Blend::of(if is_away { displacement } else { 0.0 }, 1.0 / ticks);
    }

    /// It is not known yet how far it is.
    pub(super) fn is_due(&self) -> bool {
        self.left() == f32::NEG_INFINITY
    }

    /// There is a way left, or that is not known.
    #[inline(always)]
    pub(super) fn is_under_way(&self) -> bool {
        self.left() != 0.0
    }

    /// mm.
    #[inline(always)]
    pub(super) fn left(&self) -> f32 {
        self.0.left()
    }

    /// A tick more; what is left after it, mm.
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
        // What rounding leaves.
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

//! A quantity that decreases linearly to 0.

/// The remaining quantity, in a unit of the caller.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Blend {
    left: f32,
    fall: f32,
}

impl Blend {
    /// `left` decreases by `part` of it per tick.
    pub(super) const fn of(left: f32, part: f32) -> Self {
        Self {
            left,
            fall: left.abs() * part,
        }
    }

    /// Adds a step of `step` from the new value to the old one. Together with the remaining quantity it decreases by `part` per
    /// tick.
    pub(super) fn begin(&mut self, step: f32, part: f32) {
        *self = Self::of(self.left + step, part);
    }

    #[inline(always)]
    pub(super) fn left(&self) -> f32 {
        self.left
    }

    /// Advances by one tick; returns the remaining quantity.
    #[inline(always)]
    pub(super) fn tick(&mut self) -> f32 {
        let left = self.left.abs() - self.fall;
        self.left = if left > 0.0 {
            left.copysign(self.left)
        } else {
            0.0
        };
        self.left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_away_in_a_straight_line() {
        let mut blend = Blend::default();
        assert_eq!(blend.tick(), 0.0);
        blend.begin(-1.0, 0.25);
        for left in [-0.75, -0.5, -0.25, 0.0, 0.0] {
            assert_eq!(blend.tick(), left);
        }
        // The remaining quantity is a part of the next one.
        blend.begin(1.0, 0.5);
        assert_eq!(blend.tick(), 0.5);
        blend.begin(-0.25, 0.5);
        assert_eq!(blend.tick(), 0.125);
    }
}

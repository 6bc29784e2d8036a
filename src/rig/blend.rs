//! What goes away in a straight line.

/// What is left of it, in a unit of its own.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Blend {
    left: f32,
    fall: f32,
}

impl Blend {
    /// `left` goes away in ticks of `part` of it each.
    pub(super) const fn of(left: f32, part: f32) -> Self {
        Self {
            left,
            fall: left.abs() * part,
        }
    }

    /// Another step, of `step` from what is now to what was: with what was left it goes away in ticks of `part` each.
    pub(super) fn begin(&mut self, step: f32, part: f32) {
        *self = Self::of(self.left + step, part);
    }

    #[inline(always)]
    pub(super) fn left(&self) -> f32 {
        self.left
    }

    /// A tick more; what is left after it.
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
        // What was left is a part of the next one.
        blend.begin(1.0, 0.5);
        assert_eq!(blend.tick(), 0.5);
        blend.begin(-0.25, 0.5);
        assert_eq!(blend.tick(), 0.125);
    }
}

//! Checks that the displacement moves at all, in any demanded motion.
//!
//! The statistic is the variance of the measured displacement divided by that of the demand, over windows in which the demand moved
//! enough. With a lagging servo it is near 1. With a frozen channel whose last bits toggle, or a dead actuator, it is almost 0.

/// Variance of the displacement divided by the demand's below which the displacement stands still: a tenth of the amplitude, which
/// is no response to the rig's correction either.
pub(super) const STILL: f32 = 0.01;
/// Number of successive windows that must be below it.
const LOW: u8 = 2;
/// Fewest samples in a window.
const LEAST_SAMPLES: f32 = 16.0;
/// Looks after which a window with hardly any motion is discarded, because f32 would lose digits in longer sums.
const MOST_SAMPLES: f32 = 4096.0;

/// Sums over a window, relative to its first sample.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    from: [f32; 2],
    samples: f32,
    sums: [f32; 2],
    squares: [f32; 2],
}

impl Sums {
    fn add(&mut self, values: [f32; 2]) {
        if self.samples == 0.0 {
            self.from = values;
        }
        self.samples += 1.0;
        for (at, value) in values.into_iter().enumerate() {
            let beyond = value - self.from[at];
            self.sums[at] += beyond;
            self.squares[at] += beyond * beyond;
        }
    }

    fn variances(&self) -> [f32; 2] {
        core::array::from_fn(|at| {
            let mean = self.sums[at] / self.samples;
            self.squares[at] / self.samples - mean * mean
        })
    }
}

/// Displacement and demand in the current window.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MovingWatch {
    now: Sums,
    low: u8,
}

impl MovingWatch {
    /// Adds a sample that demands `d` mm and shows `y` mm. Returns the variance of y divided by that of d, if y stood still in the
    /// last windows and d moved by more than `least` mm in each.
    #[inline]
    pub(super) fn update(&mut self, d: f32, y: f32, least: f32) -> Option<f32> {
        self.now.add([d, y]);
        if self.now.samples < LEAST_SAMPLES {
            return None;
        }
        let [demanded, moved] = self.now.variances();
        if demanded < 0.5 * least * least {
            if self.now.samples >= MOST_SAMPLES {
                self.now = Sums::default();
            }
            return None;
        }
        self.now = Sums::default();
        let part = moved / demanded;
        self.low = if part < STILL {
            self.low.saturating_add(1)
        } else {
            0
        };
        (self.low >= LOW).then_some(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::TAU;

    /// Looks until a displacement that stands still from look 1000 on is detected, with a demand about `offset`.
    fn seen(offset: f32, shown: impl Fn(u16, f32) -> f32) -> Option<u16> {
        let mut watch = MovingWatch::default();
        (0..4000).find(|look| {
            let d = 0.2 * libm::sinf(TAU * f32::from(*look) / 300.0);
            let y = shown(*look, d);
            watch.update(offset + d, offset + y, 0.05).is_some()
        })
    }

    #[test]
    fn a_standstill_is_detected_within_a_cycle_and_a_lag_never() {
        for offset in [0.0, 0.3, -5.0] {
            let frozen = |look, d| {
                if look < 1000 {
                    d
                } else {
                    1e-4 * f32::from(look % 3)
                }
            };
            let look = seen(offset, frozen).unwrap();
            assert!((1000..1300).contains(&look), "{look}");
            assert_eq!(seen(offset, |_, d| d), None);
            assert_eq!(seen(offset, |_, d| 0.15 * d), None);
            // A quarter of a cycle late.
            let late = |look: u16, _| -0.2 * libm::cosf(TAU * f32::from(look) / 300.0);
            assert_eq!(seen(offset, late), None);
        }
    }

    #[test]
    fn where_nothing_is_demanded_nothing_need_move() {
        let mut watch = MovingWatch::default();
        for look in 0..20_000u16 {
            let d = 0.3 + 1e-6 * f32::from(look % 2);
            assert_eq!(watch.update(d, 0.0, 0.05), None);
        }
    }
}

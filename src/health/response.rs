//! The actuator's response to the demanded motion, over half a cycle and anew every quarter.
//!
//! With d and v the demanded displacement and velocity and y the measured displacement, sums over half a cycle, in which d
//! and v are orthogonal wherever it begins:
//!
//! - Y = a + j·b, a = Σy·d/Σd², b = Σy·v/√(Σv²·Σd²), 1 + 0j of a perfect actuator
//! - what of y² d and v do not explain: 1 − (a² + b²)·Σd²/Σy²
//!
//! Two quarters after Y has left its place by [`LIMIT`], half a cycle of nothing but the fault tells what it is: one that
//! hardly moves is dead, one that moves in the shape demanded lags, and one that moves in another is saturated.

use super::cause::Cause;
use crate::real::square_root;

/// Distance of Y from where it was.
pub(super) const LIMIT: f32 = 0.03;
/// Variance over the demanded one, below which an actuator stands still.
const DEAD: f32 = 0.02;
/// Unexplained part of y², from which the shape is another. A triangle, the motion at one speed, has 0.0145.
const OTHER_SHAPE: f32 = 0.005;
/// Part by which the response that is normal follows, each quarter.
const FOLLOW: f32 = 1.0 / 16.0;
/// Quarters after the trigger until it is judged.
const QUARTERS: u8 = 2;
/// Quarters at the beginning that are left out, while the rig's correction learns: three cycles.
const SETTLING: u8 = 12;

/// Of half a cycle.
const LEAST_SAMPLES: f32 = 8.0;

/// Sums over a quarter.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    samples: f32,
    y: f32,
    yy: f32,
    d: f32,
    yd: f32,
    yv: f32,
    dd: f32,
    vv: f32,
}

impl Sums {
    fn plus(&self, other: &Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            y: self.y + other.y,
            yy: self.yy + other.yy,
            d: self.d + other.d,
            yd: self.yd + other.yd,
            yv: self.yv + other.yv,
            dd: self.dd + other.dd,
            vv: self.vv + other.vv,
        }
    }

    /// Variance of y and of d, times the number of samples.
    fn spreads(&self) -> (f32, f32) {
        let spread = |square: f32, sum: f32| square - sum * sum / self.samples;
        (spread(self.yy, self.y), spread(self.dd, self.d))
    }

    /// Whether y hardly moves.
    fn is_dead(&self) -> bool {
        let (spread, demanded) = self.spreads();
        spread < DEAD * demanded
    }
}

/// What the actuator did in the last half cycle, and what is normal.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ResponseWatch {
    now: Sums,
    before: Sums,
    quarter: u32,
    /// Whole quarters seen, up to [`SETTLING`].
    quarters: u8,
    normal: Option<(f32, f32)>,
    /// Quarters until a trigger is judged; 0 without one.
    waiting: u8,
}

impl ResponseWatch {
    /// Begins anew, as in a ramp.
    pub(super) fn restart(&mut self) {
        if self.now.samples > 0.0 {
            *self = Self::default();
        }
    }

    /// One sample at `phase`; at the end of a quarter what is wrong, and how far the response is from where it was.
    #[inline]
    pub(super) fn update(&mut self, y: f32, d: f32, v: f32, phase: u32) -> Option<(Cause, f32)> {
        let quarter = phase >> 30;
        let found = if quarter == self.quarter {
            None
        } else {
            self.quarter = quarter;
            self.turn()
        };
        let sums = &mut self.now;
        sums.samples += 1.0;
        sums.y += y;
        sums.yy += y * y;
        sums.d += d;
        sums.yd += y * d;
        sums.yv += y * v;
        sums.dd += d * d;
        sums.vv += v * v;
        found
    }

    /// Whether the actuator stands still, as far as this quarter tells, or the one before where this one is too young.
    pub(super) fn is_dead(&self) -> bool {
        if 2.0 * self.now.samples > self.before.samples {
            self.now.is_dead()
        } else {
            self.now.plus(&self.before).is_dead()
        }
    }

    /// A quarter has ended.
    #[inline(never)]
    fn turn(&mut self) -> Option<(Cause, f32)> {
        let half = self.now.plus(&self.before);
        self.before = core::mem::take(&mut self.now);
        if self.quarters < SETTLING || half.samples < LEAST_SAMPLES {
            self.quarters = self.quarters.saturating_add(1);
            return None;
        }
        let a = half.yd / half.dd;
        let b = half.yv / square_root(half.dd * half.vv);
        let (normal_a, normal_b) = *self.normal.get_or_insert((a, b));
        let (da, db) = (a - normal_a, b - normal_b);
        let distance = square_root(da * da + db * db);
        if self.waiting > 0 {
            self.waiting -= 1;
            if self.waiting > 0 {
                return None;
            }
            let unexplained = 1.0 - (a * a + b * b) * half.dd / half.yy;
            let cause = if half.is_dead() {
                Cause::ActuatorDead
            } else if unexplained > OTHER_SHAPE {
                Cause::ActuatorSaturated
            } else {
                Cause::ActuatorLagging
            };
            return (distance > LIMIT).then_some((cause, distance));
        }
        if distance > LIMIT {
            self.waiting = QUARTERS;
        } else {
            self.normal = Some((normal_a + FOLLOW * da, normal_b + FOLLOW * db));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_stands_still_is_dead() {
        for (gain, dead) in [(1.0, false), (0.9, false), (0.0, true)] {
            let mut watch = ResponseWatch::default();
            for look in 0..64u32 {
                let phase = core::f32::consts::TAU * look as f32 / 64.0;
                let (d, v) = (libm::sinf(phase), libm::cosf(phase));
                watch.update(gain * d, d, v, look << 26);
            }
            assert_eq!(watch.is_dead(), dead, "{gain}");
        }
    }
}

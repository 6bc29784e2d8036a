//! The actuator's response to the demanded motion, over half a cycle, updated every eighth.
//!
//! Let d and v be the demanded displacement and velocity, and y the measured displacement, minus the mean of y − d over the last
//! whole cycle. By least squares over half a cycle:
//!
//! - y ≈ a·d + b·v, with the response Y = a + j·ω·b, ω² = Σv²/Σd², which is 1 + 0j for a perfect actuator. The b of a delay is the
//!   same at all frequencies
//! - the part of Σy² that this does not explain
//!
//! Half a cycle after Y has moved by [`LIMIT`] from its normal value, the window contains only the fault. The fault is then
//! classified: an actuator that hardly moves is dead, one that moves in the demanded shape lags, and one that moves in another
//! shape is saturated. Another shape may be detected an eighth earlier.

use super::cause::{Channel, HealthCause};
use crate::real::square_root;

/// Largest normal distance of Y from its learned value.
pub(super) const LIMIT: f32 = 0.03;
/// Variance divided by the demanded one below which an actuator stands still.
const DEAD: f32 = 0.02;
/// Unexplained part of y² above which the shape differs. A triangle, a motion at constant speed, has 0.0145, and noise of 1 % of
/// the amplitude 0.0002.
const OTHER_SHAPE: f32 = 0.003;
/// Square of the correlation above which the displacement is reversed: within 30° of the opposite.
const REVERSED: f32 = 0.75;
/// Part by which the normal response is updated each eighth.
const FOLLOW: f32 = 1.0 / 32.0;
/// Eighths of half a cycle.
const EIGHTHS: usize = 4;
/// Eighths at the beginning that are left out, while the rig's correction learns: three cycles.
const SETTLING: u8 = 24;

/// Fewest samples of half a cycle.
const LEAST_SAMPLES: f32 = 8.0;

/// Sums over an eighth.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    samples: f32,
    y: f32,
    yy: f32,
    d: f32,
    v: f32,
    yd: f32,
    yv: f32,
    dd: f32,
    dv: f32,
    vv: f32,
}

impl Sums {
    fn plus(&self, other: &Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            y: self.y + other.y,
            yy: self.yy + other.yy,
            d: self.d + other.d,
            v: self.v + other.v,
            yd: self.yd + other.yd,
            yv: self.yv + other.yv,
            dd: self.dd + other.dd,
            dv: self.dv + other.dv,
            vv: self.vv + other.vv,
        }
    }

    /// Variances of y and of d, times the number of samples.
    fn spreads(&self) -> (f32, f32) {
        let spread = |square: f32, sum: f32| square - sum * sum / self.samples;
        (spread(self.yy, self.y), spread(self.dd, self.d))
    }

    /// a, b in s, and the part of y minus its `mean` that they do not explain.
    #[inline(never)]
    fn response(&self, mean: f32) -> (f32, f32, f32) {
        let (yd, yv) = (self.yd - mean * self.d, self.yv - mean * self.v);
        let yy = self.yy - mean * (2.0 * self.y - mean * self.samples);
        let determinant = self.dd * self.vv - self.dv * self.dv;
        let of_d = (yd * self.vv - yv * self.dv) / determinant;
        let of_v = (yv * self.dd - yd * self.dv) / determinant;
        let unexplained = 1.0 - (of_d * yd + of_v * yv) / yy;
        (of_d, of_v, unexplained)
    }

    /// Whether y hardly moves.
    fn is_dead(&self) -> bool {
        let (spread, demanded) = self.spreads();
        spread < DEAD * demanded
    }
}

/// Response of the last half cycle, and the normal response.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ResponseWatch {
    now: Sums,
    before: [Sums; EIGHTHS - 1],
    eighth: u32,
    /// Σ(y − d) and number of samples of the current cycle, −∞ after a bad sample, and its mean over the last whole cycle.
    sum: (f32, f32),
    mean: f32,
    /// Whole eighths seen, up to [`SETTLING`].
    eighths: u8,
    normal: Option<(f32, f32)>,
    /// Eighths until a trigger is classified at the latest; 0 without a trigger.
    waiting: u8,
}

/// A wrong response: the cause, an alternative cause, and the distance of the response from the learned one.
pub(super) type Off = (HealthCause, Option<HealthCause>, f32);

/// Eighths begin half an eighth after a cycle's end, where there is enough work already.
fn eighth(phase: u32) -> u32 {
    phase.wrapping_add(1 << 28) >> 29
}

impl ResponseWatch {
    /// Starts again, as in a ramp.
    pub(super) fn restart(&mut self) {
        if self.now.samples > 0.0 {
            *self = Self::default();
        }
    }

    /// The last sample was bad: the response is evaluated again when its eighth has left the half cycle, and its cycle gives no
    /// mean.
    pub(super) fn skip_last(&mut self) {
        self.eighths = self.eighths.min(SETTLING - EIGHTHS as u8);
        self.sum.1 = f32::NEG_INFINITY;
    }

    /// Whether a sample at `phase` is the first of an eighth.
    #[inline]
    pub(super) fn turns(&self, phase: u32) -> bool {
        eighth(phase) != self.eighth
    }

    /// Takes one sample at `phase`. At the end of an eighth returns the fault, and the distance of the response from the learned
    /// one.
    #[inline]
    pub(super) fn update(&mut self, y: f32, d: f32, v: f32, phase: u32) -> Option<Off> {
        let found = if self.turns(phase) {
            self.eighth = eighth(phase);
            self.turn()
        } else {
            None
        };
        let sums = &mut self.now;
        sums.samples += 1.0;
        sums.y += y;
        sums.yy += y * y;
        sums.d += d;
        sums.v += v;
        sums.yd += y * d;
        sums.yv += y * v;
        sums.dd += d * d;
        sums.dv += d * v;
        sums.vv += v * v;
        found
    }

    /// Whether the displacement is the opposite of the demand, according to this eighth and the one before.
    pub(super) fn is_reversed(&self) -> bool {
        let [.., before] = &self.before;
        let half = self.now.plus(before);
        let opposite = half.yd * half.yd > REVERSED * half.yy * half.dd;
        half.yd < 0.0 && opposite && !half.is_dead()
    }

    /// Whether the actuator stands still, according to this eighth and the one before.
    pub(super) fn is_dead(&self) -> bool {
        let [.., before] = &self.before;
        self.now.plus(before).is_dead()
    }

    /// An eighth has ended.
    #[inline(never)]
    fn turn(&mut self) -> Option<Off> {
        let error = self.sum.0 + self.now.y - self.now.d;
        let samples = self.sum.1 + self.now.samples;
        self.sum = if self.eighth == 0 {
            // A fault moves the mean of the cycle in which it begins.
            if self.waiting == 0 && samples > 0.0 {
                self.mean = error / samples;
            }
            (0.0, 0.0)
        } else {
            (error, samples)
        };
        let [first, second, third] = &mut self.before;
        let latest = second.plus(third).plus(&self.now);
        let half = first.plus(&latest);
        *first = *second;
        *second = *third;
        *third = core::mem::take(&mut self.now);
        if self.eighths < SETTLING || half.samples < LEAST_SAMPLES {
            self.eighths = self.eighths.saturating_add(1);
            return None;
        }
        let (a, b, unexplained) = half.response(self.mean);
        let (normal_a, normal_b) = *self.normal.get_or_insert((a, b));
        let (da, db) = (a - normal_a, b - normal_b);
        let square = da * da + db * db * half.vv / half.dd;
        if self.waiting == 0 {
            if square > LIMIT * LIMIT {
                self.waiting = EIGHTHS as u8;
            } else {
                self.normal = Some((normal_a + FOLLOW * da, normal_b + FOLLOW * db));
            }
            return None;
        }
        self.waiting -= 1;
        let cause = match self.waiting {
            0 if half.is_dead() => HealthCause::ActuatorDead,
            0 if unexplained > OTHER_SHAPE => HealthCause::ActuatorSaturated,
            0 => HealthCause::ActuatorLagging,
            1 if !latest.is_dead() && latest.response(self.mean).2 > OTHER_SHAPE => {
                self.waiting = 0;
                HealthCause::ActuatorSaturated
            }
            _ => return None,
        };
        // A smaller or larger motion that is not late may also come from a channel with another gain.
        let lags = db * db * half.vv > da * da * half.dd;
        let or = (cause == HealthCause::ActuatorLagging && !lags)
            .then_some(HealthCause::SensorGain(Channel::Displacement));
        (square > LIMIT * LIMIT).then(|| (cause, or, square_root(square)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, TAU};

    /// The fault found for a sine of amplitude 1, where `motion` gives y for its phase in cycles, and the cycle in which it is
    /// found.
    fn found(cycles: u32, motion: impl Fn(f32) -> f32) -> Option<(HealthCause, f32)> {
        let mut watch = ResponseWatch::default();
        for look in 0..32 * cycles {
            let (cycle, part) = (look / 32, look % 32);
            // Like the looks of the monitor: late by a quarter and three quarters of a part in turn.
            let phase = (4 * part + 1 + 2 * (cycle % 2)) << 25;
            let turns = cycle as f32 + phase as f32 / (1u64 << 32) as f32;
            let (d, v) = (libm::sinf(TAU * turns), libm::cosf(TAU * turns));
            if let Some((cause, or, distance)) = watch.update(motion(turns), d, v, phase) {
                assert!(distance > LIMIT);
                let gain = HealthCause::SensorGain(Channel::Displacement);
                assert!(or.is_none_or(|or| or == gain));
                return Some((cause, turns));
            }
        }
        None
    }

    fn sine(turns: f32) -> f32 {
        libm::sinf(TAU * turns)
    }

    /// y = 0.8·d + 0.01·v about a mean of 0.3, for a motion of 0.1.
    #[test]
    fn a_response_is_found_about_any_mean() {
        let (a, b, mean) = (0.8f32, 0.01f32, 0.3f32);
        let mut sums = Sums::default();
        for look in 0..48u8 {
            let turns = f32::from(look) / 32.0;
            let (d, v) = (0.1 * libm::sinf(TAU * turns), libm::cosf(TAU * turns));
            let y = mean + a * d + b * v;
            let one = Sums {
                samples: 1.0,
                y,
                d,
                v,
                yy: y * y,
                yd: y * d,
                yv: y * v,
                dd: d * d,
                dv: d * v,
                vv: v * v,
            };
            sums = sums.plus(&one);
        }
        let (of_d, of_v, unexplained) = sums.response(mean);
        assert!(
            (of_d - a).abs() < 1e-4 && (of_v - b).abs() < 1e-5,
            "{of_d}, {of_v}"
        );
        assert!(unexplained.abs() < 1e-3, "{unexplained}");
    }

    /// Of 0.05 mm. A displacement that is a quarter of a cycle late is not reversed, nor is one that stands still or follows the
    /// demand.
    #[test]
    fn the_opposite_is_detected() {
        let is_reversed = |motion: fn(f32) -> f32| {
            let mut watch = ResponseWatch::default();
            for look in 0..24u32 {
                let turns = look as f32 / 32.0;
                let (d, v) = (0.05 * sine(turns), 0.05 * TAU * sine(turns + 0.25));
                watch.update(0.05 * motion(turns), d, v, look << 27);
            }
            watch.is_reversed()
        };
        assert!(is_reversed(|turns| -sine(turns)));
        assert!(is_reversed(|turns| -0.5 * sine(turns)));
        assert!(!is_reversed(sine));
        assert!(!is_reversed(|turns| sine(turns - 0.25)));
        assert!(!is_reversed(|turns| -1e-3 * sine(turns)));
    }

    #[test]
    fn a_constant_response_is_normal() {
        for (gain, lag, mean) in [(1.0, 0.0, 0.0), (0.8, 0.1, 0.0), (1.1, -0.05, 0.1)] {
            assert_eq!(found(20, |turns| mean + gain * sine(turns - lag)), None);
        }
        // By 1 % of the amplitude in 20 cycles.
        assert_eq!(found(40, |turns| (1.0 - 5e-4 * turns) * sine(turns)), None);
    }

    #[test]
    fn how_it_begins_is_no_matter() {
        let correcting = |turns| if turns < 2.0 { 1.2 } else { 1.0 };
        assert_eq!(found(20, |turns| correcting(turns) * sine(turns)), None);
    }

    /// For every time at which it begins.
    #[test]
    fn every_fault_has_its_name_within_a_cycle() {
        for moment in 0..16u8 {
            let begins = 8.0 + f32::from(moment) / 16.0;
            let stands = sine(begins);
            let kinds: [(HealthCause, &dyn Fn(f32) -> f32); 4] = [
                (HealthCause::ActuatorDead, &|_| stands),
                (HealthCause::ActuatorLagging, &|turns| sine(turns - 0.05)),
                (HealthCause::ActuatorLagging, &|turns| 0.9 * sine(turns)),
                // A triangle.
                (HealthCause::ActuatorSaturated, &|turns| {
                    0.8 * libm::asinf(sine(turns)) / FRAC_PI_2
                }),
            ];
            for (cause, fault) in kinds {
                let motion = |turns| {
                    if turns < begins {
                        sine(turns)
                    } else {
                        fault(turns)
                    }
                };
                let (name, turns) = found(12, motion).unwrap();
                assert_eq!(name, cause, "from {begins} on");
                assert!(turns - begins < 1.0, "{cause:?} from {begins} to {turns}");
            }
        }
    }

    #[test]
    fn only_a_standstill_is_dead() {
        for (gain, dead) in [(1.0, false), (0.9, false), (0.0, true)] {
            let mut watch = ResponseWatch::default();
            for look in 0..32u32 {
                let (d, v) = (sine(look as f32 / 32.0), sine(look as f32 / 32.0 + 0.25));
                watch.update(gain * d, d, v, look << 27);
            }
            assert_eq!(watch.is_dead(), dead, "{gain}");
        }
    }

    /// For every position; a lag that begins with it is found all the same.
    #[test]
    fn a_bad_sample_that_is_skipped_is_no_fault() {
        for bad in 32 * 8..32 * 10u32 {
            for lag in [0.0, 0.05] {
                let mut watch = ResponseWatch::default();
                let mut name = None;
                for look in 0..32 * 14 {
                    let turns = look as f32 / 32.0;
                    let (d, v) = (sine(turns), sine(turns + 0.25));
                    let y = if look < bad { d } else { sine(turns - lag) };
                    let spike = if look == bad { 2.0 } else { 0.0 };
                    let found = watch.update(y + spike, d, v, look << 27);
                    name = name.or(found.map(|(cause, ..)| cause));
                    if look == bad {
                        watch.skip_last();
                    }
                }
                let expected = (lag > 0.0).then_some(HealthCause::ActuatorLagging);
                assert_eq!(name, expected, "{bad}");
            }
        }
    }

    /// As in a ramp, after which another response may be normal.
    #[test]
    fn the_normal_response_is_learned_again_after_a_restart() {
        let mut watch = ResponseWatch::default();
        for look in 0..32 * 16u32 {
            let turns = look as f32 / 32.0;
            let (d, v) = (sine(turns), sine(turns + 0.25));
            if look == 32 * 8 {
                watch.restart();
            }
            let gain = if look < 32 * 8 { 1.0 } else { 0.8 };
            assert_eq!(watch.update(gain * d, d, v, look << 27), None);
        }
    }
}

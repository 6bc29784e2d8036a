//! Checks that the force follows the motion at all.
//!
//! The statistic is the part of the force's variance that a·y + b·v + const explains by least squares, with y the measured
//! displacement and v the demanded velocity. The window is a cycle, advanced every quarter, or in any other motion the time in
//! which it moves enough. For a specimen's force the part is large, whatever its law: for pure friction under a sine it is 8/π² =
//! 0.81. For a wire that picks up noise, or a frozen channel whose last bit toggles, it is 2 divided by the number of samples.
//!
//! In addition half a cycle may be enough: if a force varied in every half of the last cycle, and hardly varies now.

/// Explained part below which the force does not belong to the motion. Noise twice as large as the force leaves 0.2 of its variance
/// explained.
pub(super) const LEAST_EXPLAINED: f32 = 0.2;
/// Explained part above which a window shows a specimen's force.
const EXPLAINED: f32 = 0.5;
/// Variance of a half cycle, relative to the least in the cycle before, below which the force has stopped: a quarter of its
/// amplitude.
const STOPPED: f32 = 1.0 / 16.0;
/// Least motion relative to that half for this test.
const AS_LARGE: f32 = 0.7;
/// Variance relative to the mean square below which a force is constant: f32 resolves 1e-7 of the square.
const CONSTANT: f32 = 1e-6;
/// Windows after which the least variances cover whole cycles.
const SOUND: u8 = 16;
/// Number of successive windows that must be below the limit, if the force followed the motion before. A sudden change, for example
/// of the mean, is in all four windows that contain it.
const LOW: u8 = 5;
/// The same for any motion, whose windows do not overlap.
const LOW_OF_ANY: u8 = 2;
/// Fewest samples in a window: an eighth of the variance is explained by chance.
const LEAST_SAMPLES: f32 = 16.0;

/// Sums over a quarter.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    samples: f32,
    y: f32,
    v: f32,
    f: f32,
    yy: f32,
    vv: f32,
    yv: f32,
    ff: f32,
    fy: f32,
    fv: f32,
}

impl Sums {
    fn add(&mut self, y: f32, v: f32, f: f32) {
        self.samples += 1.0;
        self.y += y;
        self.v += v;
        self.f += f;
        self.yy += y * y;
        self.vv += v * v;
        self.yv += y * v;
        self.ff += f * f;
        self.fy += f * y;
        self.fv += f * v;
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            y: self.y + other.y,
            v: self.v + other.v,
            f: self.f + other.f,
            yy: self.yy + other.yy,
            vv: self.vv + other.vv,
            yv: self.yv + other.yv,
            ff: self.ff + other.ff,
            fy: self.fy + other.fy,
            fv: self.fv + other.fv,
        }
    }

    /// Variances of y and of f.
    fn variances(&self) -> [f32; 2] {
        let of = |square: f32, sum: f32| (square - sum * sum / self.samples) / self.samples;
        [of(self.yy, self.y), of(self.ff, self.f)]
    }

    /// Part of the variance of f that the motion explains, 0 for a constant.
    #[inline(never)]
    fn explained(&self) -> f32 {
        let moment = |product: f32, a: f32, b: f32| product - a * b / self.samples;
        let (yy, vv, yv) = (
            moment(self.yy, self.y, self.y),
            moment(self.vv, self.v, self.v),
            moment(self.yv, self.y, self.v),
        );
        let (fy, fv) = (
            moment(self.fy, self.f, self.y),
            moment(self.fv, self.f, self.v),
        );
        let ff = moment(self.ff, self.f, self.f);
        let determinant = yy * vv - yv * yv;
        if !(determinant > 0.0 && ff > CONSTANT * self.ff) {
            return 0.0;
        }
        (fy * (fy * vv - fv * yv) + fv * (fv * yy - fy * yv)) / (determinant * ff)
    }
}

/// Quarters begin a 32nd of a cycle after the cycle's end, where there is enough work already.
fn quarter(phase: u32) -> u32 {
    phase.wrapping_add(7 << 27) >> 30
}

/// Force and motion in the last four quarters.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ForceWatch {
    now: Sums,
    before: [Sums; 3],
    quarter: u32,
    /// Least variances of y and f over the half cycles of this cycle, of the last one, and of the one before.
    least: [[f32; 2]; 3],
    /// Windows that followed the motion since the start, up to [`SOUND`]; and successive windows so far that did not, or varied too
    /// little.
    sound: u8,
    low: u8,
}

impl ForceWatch {
    /// Whether the force has followed the motion since the start.
    pub(super) fn has_followed(&self) -> bool {
        self.sound > 0
    }

    /// Whether the force varies in the last quarter and in the current one as it did before.
    pub(super) fn varies(&self) -> bool {
        let [.., last] = &self.before;
        let [_, varied] = last.plus(&self.now).variances();
        let [.., [_, usual]] = self.least;
        self.sound == SOUND && varied > STOPPED * usual
    }

    /// Evaluates a window of which the motion explains `explained`. Returns whether the force is lost, which takes `needed` windows
    /// once the force has followed the motion.
    fn judge(&mut self, explained: f32, needed: u8) -> bool {
        if explained > EXPLAINED {
            self.sound = self.sound.saturating_add(1).min(SOUND);
        }
        self.low = if explained < LEAST_EXPLAINED {
            self.low.saturating_add(1)
        } else {
            0
        };
        let needed = if self.sound > 0 { needed } else { 1 };
        self.low >= needed
    }

    /// Whether a sample at `phase`, 2³² per cycle, is the first of a quarter: [`ForceWatch::turn`] is due before it is added.
    #[inline]
    pub(super) fn turns(&self, phase: u32) -> bool {
        quarter(phase) != self.quarter
    }

    /// Adds one sample.
    #[inline]
    pub(super) fn add(&mut self, y: f32, v: f32, f: f32) {
        self.now.add(y, v, f);
    }

    /// Adds one sample of any motion: a window ends when y has moved enough.
    #[inline]
    pub(super) fn update_any(&mut self, y: f32, v: f32, f: f32, least: f32) -> Option<f32> {
        self.now.add(y, v, f);
        let [moved, _] = self.now.variances();
        if self.now.samples < LEAST_SAMPLES || moved < 0.5 * least * least {
            return None;
        }
        let explained = core::mem::take(&mut self.now).explained();
        self.judge(explained, LOW_OF_ANY).then_some(explained)
    }

    /// A quarter has ended before the sample at `phase`. If y moved by more than `least` mm from its mean, returns the part of the
    /// force that the motion explained in the last four quarters, provided that it is too small or the force no longer varies.
    #[inline(never)]
    pub(super) fn turn(&mut self, phase: u32, least: f32) -> Option<f32> {
        self.quarter = quarter(phase);
        let [first, second, third] = &mut self.before;
        let half = third.plus(&self.now);
        let all = first.plus(second).plus(&half);
        *first = *second;
        *second = *third;
        *third = core::mem::take(&mut self.now);
        if all.samples < LEAST_SAMPLES {
            return None;
        }
        let least_square = 0.5 * least * least;
        let [moved, varied] = half.variances();
        let [this, last, usual] = &mut self.least;
        if self.quarter == 0 {
            *usual = *last;
            *last = *this;
            *this = [f32::MAX; 2];
        }
        for (least, now) in this.iter_mut().zip([moved, varied]) {
            if now < *least {
                *least = now;
            }
        }
        let [usually_moved, usually_varied] = *usual;
        let stopped = self.sound == SOUND
            && moved > least_square
            && moved > AS_LARGE * usually_moved
            && varied < STOPPED * usually_varied
            // A force that follows a motion of another amplitude is still there.
            && half.explained() < EXPLAINED;
        let [all_moved, _] = all.variances();
        if all_moved <= least_square {
            self.low = 0;
            return None;
        }
        let explained = all.explained();
        (self.judge(explained, LOW) || stopped).then_some(explained)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::TAU;

    /// Cycles from its start after which a fault of the force is detected; `None` if not within four.
    fn seen_after(
        healthy: impl Fn(f32, f32) -> f32,
        faulty: impl Fn(u32) -> f32,
        begins: f32,
    ) -> Option<f32> {
        let mut watch = ForceWatch::default();
        for look in 0..32 * 14u32 {
            let (cycle, part) = (look / 32, look % 32);
            let phase = (4 * part + 1 + 2 * (cycle % 2)) << 25;
            let turns = cycle as f32 + phase as f32 / (1u64 << 32) as f32;
            let (y, v) = (libm::sinf(TAU * turns), libm::cosf(TAU * turns));
            let f = if turns < begins {
                healthy(y, v)
            } else {
                faulty(look)
            };
            let lost = watch.turns(phase) && watch.turn(phase, 0.1).is_some();
            watch.add(y, v, f);
            if lost {
                assert!(turns >= begins, "{turns}");
                return Some(turns - begins);
            }
        }
        None
    }

    /// Not pure noise, but unrelated to the motion.
    fn noise(look: u32) -> f32 {
        let x = look
            .wrapping_mul(2_654_435_761)
            .rotate_left(13)
            .wrapping_mul(0x9E37_79B9);
        x as f32 / u32::MAX as f32 - 0.5
    }

    const SPECIMENS: [fn(f32, f32) -> f32; 4] = [
        |y, v| y + 0.5 * y * y * y + 0.3 * v.signum(),
        // Friction alone, a spring alone, and a gap of half the amplitude.
        |_, v| v.signum(),
        |y, _| 3.0 + y,
        |y, _| y - y.clamp(-0.5, 0.5),
    ];

    #[test]
    fn a_force_that_is_none_of_the_motion_is_seen_within_two_cycles_and_a_quarter() {
        for specimen in SPECIMENS {
            for moment in 0..16u8 {
                let begins = 8.0 + f32::from(moment) / 16.0;
                let frozen = |look: u32| 0.7 + 1e-4 * (look % 3) as f32;
                let pickup = |look: u32| 0.05 * noise(look);
                let loud = |look: u32| 3.0 * noise(look);
                for fault in [&frozen as &dyn Fn(u32) -> f32, &pickup, &loud] {
                    let after = seen_after(specimen, fault, begins);
                    assert!(
                        after.is_some_and(|after| after <= 2.3),
                        "{after:?} at {begins}"
                    );
                }
            }
        }
        // A force that varied in every half cycle is found missing sooner.
        for moment in 0..16u8 {
            let begins = 8.0 + f32::from(moment) / 16.0;
            let after = seen_after(SPECIMENS[0], |look| 0.05 * noise(look), begins).unwrap();
            assert!(after <= 0.8, "{after}");
        }
    }

    #[test]
    fn a_specimen_that_changes_is_not_lost() {
        for specimen in SPECIMENS {
            for part in [1.0, 0.3, 5.0] {
                let changed = |look: u32| {
                    let (cycle, part_of) = (look / 32, look % 32);
                    let phase = (4 * part_of + 1 + 2 * (cycle % 2)) as f32 / 128.0;
                    part * specimen(libm::sinf(TAU * phase), libm::cosf(TAU * phase))
                };
                assert_eq!(seen_after(specimen, changed, 8.0), None);
            }
        }
    }

    /// A cycle in which the amplitude falls to 0.45 of its value, as in a ramp to another block, with a force with k3 and friction.
    #[test]
    fn a_ramp_to_another_amplitude_is_no_loss() {
        for begins in 0..8u8 {
            let mut watch = ForceWatch::default();
            for look in 0..32 * 14u32 {
                let (cycle, part) = (look / 32, look % 32);
                let phase = (4 * part + 1 + 2 * (cycle % 2)) << 25;
                let turns = cycle as f32 + phase as f32 / (1u64 << 32) as f32;
                let since = (turns - 8.0 - f32::from(begins) / 8.0).clamp(0.0, 1.0);
                let amplitude = 1.0 - 0.55 * since;
                let (y, v) = (
                    amplitude * libm::sinf(TAU * turns),
                    amplitude * libm::cosf(TAU * turns),
                );
                let f = 0.2 * y + 3.0 * y * y * y + 0.05 * v;
                let lost = watch.turns(phase) && watch.turn(phase, 0.1).is_some();
                watch.add(y, v, f);
                assert!(!lost, "{turns}");
            }
        }
    }

    #[test]
    fn any_motion_is_judged_once_it_has_moved_enough() {
        for (amplitude, lost) in [(1.0, true), (0.05, false)] {
            let mut watch = ForceWatch::default();
            let mut seen = false;
            for look in 0..2000u16 {
                let turns = f32::from(look) / 300.0;
                let y = amplitude * libm::sinf(TAU * turns);
                let v = amplitude * libm::cosf(TAU * turns);
                assert_eq!(watch.update_any(y, v, y + 0.2 * v, 0.1), None);
            }
            assert_eq!(watch.has_followed(), lost);
            for look in 0..2000u16 {
                let turns = f32::from(look) / 300.0;
                let y = amplitude * libm::sinf(TAU * turns);
                let v = amplitude * libm::cosf(TAU * turns);
                seen |= watch
                    .update_any(y, v, 0.05 * noise(look.into()), 0.1)
                    .is_some();
            }
            assert_eq!(seen, lost);
        }
    }
}

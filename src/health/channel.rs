//! Checks a channel's samples one by one: whether the channel is stuck, whether it is clipped, and whether a sample is an outlier.
//!
//! - A channel that repeats one value is held. It is stuck if its quantity meanwhile moves inwards from its value at the beginning,
//!   or has dropped out if the value is that of 0 V. A channel that was held while its quantity was further out, and that changes
//!   when the quantity comes back, is clipped.
//! - A sample is an outlier if it jumps in one direction and the next sample jumps back by more than half of it. The size is the
//!   smaller of two successive differences of opposite sign. Noise causes such jumps too, and their size is learned. Physics does
//!   not: a sudden change of the specimen lasts.

use super::cause::{Channel, HealthCause};
use crate::converter::{MIDSCALE, Sample, Scale};

/// Squared jumps may be this many times the largest that was learned, so that a jump may be twice as large. Gaussian noise of σ
/// jumps there and back by t once in about e^(t²/3σ²) ticks, so that after 1e4 ticks of learning it takes 1e16 ticks to exceed 2·t.
const SPIKE_FACTOR: i32 = 4;
/// Minus the square of a jump of 16 converter steps, which is never a spike.
const LEAST_SPIKE: i32 = -256;
/// Converter steps about 0 V within which a channel counts as showing 0 V.
const NO_VOLTAGE: i32 = 2;
/// Repeats of the value of 0 V, after a jump to it, after which a channel has dropped out.
const DROPPED_TICKS: u32 = 4;
/// Part of its amplitude by which the quantity must move while the channel is held.
const MOVED: f32 = 0.1;
/// Part by which it must move inwards: a channel that is clipped by less changes before.
const CAME_IN: f32 = 0.3;

/// The smallest level that can be learned.
const NONE_LEARNED: i32 = -1;

/// History of one channel, in steps of its converter. A difference over half of its range wraps to the opposite sign, and so does
/// that of the way back. Only a difference of exactly half has the same sign there and back.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChannelWatch {
    channel: Channel,
    /// Its unit per step.
    unit: f32,
    /// The last difference.
    step: i16,
    /// Minus the square of the largest jump there and back that is not a spike.
    lowest: i32,
    /// Largest such jump so far.
    learned: i32,
    /// Ticks for which it has been held.
    held: u32,
    /// Its quantity from the reference when that began.
    reference: f32,
    motion: f32,
    /// The difference before that began.
    jump: i16,
    /// The quantity has moved enough since.
    moved: bool,
}

/// The change of a channel by one more sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Change {
    /// The difference before the last.
    before: i16,
    /// Product of both differences.
    product: i32,
    learned: i32,
}

impl Change {
    /// Whether [`ChannelWatch::look`] must examine it: a difference opposite to the one before, with a product as large as the
    /// learned limit. A product of 0 belongs to a channel that is held, or changes again.
    #[inline(always)]
    pub(crate) fn asks(&self) -> bool {
        self.product <= self.learned || self.product == 0
    }
}

/// References for a channel's samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beside {
    /// The quantity according to the demand or the law: mm or kN.
    pub(super) reference: f32,
    /// The amplitude of that.
    pub(super) amplitude: f32,
    /// Displacement and its amplitude, mm. Without motion a force may be constant, even where the law reports a reversal.
    pub(super) motion: f32,
    pub(super) motion_amplitude: f32,
}

impl ChannelWatch {
    /// A watch for a channel with `scale`. There are no spikes until it has learned.
    pub(super) fn new(channel: Channel, scale: &Scale) -> Self {
        Self {
            channel,
            unit: scale.step(),
            step: 0,
            lowest: i32::MIN,
            learned: NONE_LEARNED,
            held: 0,
            reference: 0.0,
            motion: 0.0,
            jump: 0,
            moved: false,
        }
    }

    /// The rig starts: learns again.
    pub(super) fn restart(&mut self) {
        self.step = 0;
        self.learned = NONE_LEARNED;
        self.lowest = i32::MIN;
        self.held = 0;
        self.moved = false;
    }

    /// Number of ticks for which it has shown the same value.
    pub(super) fn held(&self) -> u32 {
        self.held
    }

    /// Starts to learn, or applies the result.
    pub(super) fn learn(&mut self, begin: bool) {
        if begin {
            self.learned = NONE_LEARNED;
            self.lowest = i32::MIN;
        } else {
            self.lowest = self.learned.saturating_mul(SPIKE_FACTOR).min(LEAST_SPIKE);
        }
    }

    /// Takes one more sample, after one with the code `last`.
    #[inline(always)]
    pub(super) fn update(&mut self, last: u16, sample: &Sample) -> Change {
        let before = self.step;
        self.step = sample.code.wrapping_sub(last) as i16;
        Change {
            before,
            product: i32::from(self.step) * i32::from(before),
            learned: self.learned,
        }
    }

    /// The fault of the last `sample`, whose `change` must be examined.
    #[inline]
    pub(super) fn look(
        &mut self,
        sample: &Sample,
        change: &Change,
        beside: &Beside,
    ) -> Option<HealthCause> {
        if self.step == 0 {
            self.hold(sample, change.before, beside)
        } else if self.held > 0 {
            self.let_go()
        } else {
            self.stand_out(sample, change.before)
        }
    }

    /// The limit of a jump, in the channel's unit.
    pub(super) fn limit(&self) -> f32 {
        crate::real::square_root(-(self.lowest as f32)) * self.unit.abs()
    }

    fn stand_out(&mut self, sample: &Sample, before: i16) -> Option<HealthCause> {
        // A sample that jumps to 0 V, much further than the jump before, may have dropped out. Otherwise the next sample jumps away
        // from there.
        let far = self.step.unsigned_abs() / 2 > before.unsigned_abs();
        if far && from_no_voltage(sample).abs() <= NO_VOLTAGE {
            return None;
        }
        // A value that moves and then steps in the opposite direction, and stays there, has not come back: a changed gain causes
        // this.
        let (there, back) = (i32::from(before), i32::from(self.step));
        if 2 * (there + back).abs() > there.abs().max(back.abs()) {
            return None;
        }
        let smaller = there.abs().min(back.abs());
        let square = -smaller * smaller;
        if square < self.lowest {
            // If it stays there, it is back and has not jumped.
            self.step = 0;
            return Some(HealthCause::SensorSpiking(self.channel));
        }
        if square < self.learned {
            self.learned = square;
        }
        None
    }

    /// It was held, and shows another value now. A channel that jumped to the held value and jumps back had dropped out meanwhile:
    /// a bad contact, and none of those samples is valid.
    fn let_go(&mut self) -> Option<HealthCause> {
        let clipped = self.moved;
        self.held = 0;
        self.moved = false;
        let (there, back) = (i32::from(self.jump), i32::from(self.step));
        let smaller = there.abs().min(back.abs());
        if there * back < 0 && -smaller * smaller < self.lowest {
            return Some(HealthCause::SensorSpiking(self.channel));
        }
        clipped.then_some(HealthCause::SensorClipped(self.channel))
    }

    fn hold(&mut self, sample: &Sample, before: i16, beside: &Beside) -> Option<HealthCause> {
        if self.held == 0 {
            self.jump = before;
            self.reference = beside.reference;
            self.motion = beside.motion;
        }
        self.held = self.held.saturating_add(1);
        let way = (beside.motion - self.motion).abs();
        let moved = if way > MOVED * beside.motion_amplitude {
            beside.reference - self.reference
        } else {
            0.0
        };
        let enough = MOVED * beside.amplitude;
        let from_zero = from_no_voltage(sample);
        if from_zero.abs() <= NO_VOLTAGE {
            let jump = i32::from(self.jump);
            let jumped = -jump * jump < self.lowest;
            let dropped = moved.abs() > enough || (jumped && self.held >= DROPPED_TICKS);
            return dropped.then_some(HealthCause::SensorDroppedOut(self.channel));
        }
        self.moved |= moved.abs() > enough;
        let is_positive = (from_zero > 0) == (self.unit > 0.0);
        let inward = if is_positive { -moved } else { moved };
        let stuck = inward > CAME_IN * beside.amplitude;
        stuck.then_some(HealthCause::SensorStuck(self.channel))
    }
}

/// The channel's value relative to 0 V, in steps of its converter.
fn from_no_voltage(sample: &Sample) -> i32 {
    i32::from(sample.code) - i32::from(MIDSCALE)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;

    /// 2 kN at full scale.
    fn watch() -> ChannelWatch {
        ChannelWatch::new(Channel::Force, &Scale::new(2.0, 0.0).unwrap())
    }

    /// Faults found in the successive `codes`, with a force that moves inwards from −0.5 kN by `step` kN per sample.
    fn found(watch: &mut ChannelWatch, codes: &[u16], step: f32) -> std::vec::Vec<HealthCause> {
        let found = (0u8..).zip(codes.windows(2)).filter_map(|(number, pair)| {
            let sample = Sample {
                value: 0.0,
                code: pair[1],
            };
            let reference = step * f32::from(number) - 0.5;
            let beside = Beside {
                reference,
                amplitude: 1.0,
                motion: reference,
                motion_amplitude: 1.0,
            };
            let change = watch.update(pair[0], &sample);
            let asks = change.asks();
            asks.then(|| watch.look(&sample, &change, &beside))?
        });
        found.collect()
    }

    /// Number of spikes with a constant force, and no other fault.
    fn spikes(watch: &mut ChannelWatch, codes: &[u16]) -> usize {
        let found = found(watch, codes, 0.0);
        let spike = HealthCause::SensorSpiking(Channel::Force);
        assert!(found.iter().all(|cause| *cause == spike), "{found:?}");
        found.len()
    }

    #[test]
    fn without_noise_a_jump_of_a_few_steps_is_the_limit() {
        let mut watch = watch();
        watch.learn(true);
        watch.learn(false);
        let expected = 16.0 * 2.0 / 32768.0;
        assert!((watch.limit() - expected).abs() <= 1e-6 * expected);
        assert_eq!(spikes(&mut watch, &[40_000, 40_016, 40_000, 40_016]), 0);
        assert_eq!(
            spikes(&mut watch, &[40_016, 40_000, 40_001, 40_018, 40_001]),
            1
        );
    }

    #[test]
    fn a_jump_there_and_back_may_be_twice_the_learned_one() {
        let mut watch = watch();
        watch.learn(true);
        spikes(
            &mut watch,
            &[40_000, 40_050, 40_010, 40_050, 40_100, 40_200],
        );
        watch.learn(false);
        assert_eq!(spikes(&mut watch, &[40_200, 40_280, 40_200, 40_300]), 0);
        assert_eq!(spikes(&mut watch, &[40_300, 40_381, 40_300, 40_310]), 1);
    }

    /// While its quantity moves by more than the learned level.
    #[test]
    fn a_jump_to_no_voltage_is_no_spike_unless_it_comes_back() {
        let mut watch = watch();
        watch.learn(true);
        watch.learn(false);
        assert_eq!(
            spikes(&mut watch, &[40_000, 40_041, 40_082, 32_768, 32_768]),
            0
        );
        // It comes back two samples later.
        assert_eq!(spikes(&mut watch, &[32_768, 40_164, 40_205]), 1);
        assert_eq!(
            spikes(&mut watch, &[40_205, 40_246, 32_768, 40_287, 40_328]),
            1
        );
    }

    /// With a constant force, which gives no information.
    #[test]
    fn a_channel_that_stays_at_no_voltage_after_a_jump_has_dropped_out() {
        let mut watch = watch();
        watch.learn(true);
        watch.learn(false);
        let jumped = [40_000, 40_041, 40_082, 32_768, 32_768, 32_768, 32_768];
        assert_eq!(found(&mut watch, &jumped, 0.0), []);
        let dropped = HealthCause::SensorDroppedOut(Channel::Force);
        assert_eq!(found(&mut watch, &[32_768; 2], 0.0), [dropped]);
        watch.restart();
        watch.learn(true);
        watch.learn(false);
        let came = [32_790, 32_779, 32_768, 32_768, 32_768, 32_768, 32_768];
        assert_eq!(found(&mut watch, &came, 0.0), []);
        assert_eq!(found(&mut watch, &[32_768; 10], 0.0), []);
    }

    /// Over half of the range the difference wraps.
    #[test]
    fn a_jump_through_most_of_the_range_stands_out() {
        let mut watch = watch();
        watch.learn(true);
        spikes(&mut watch, &[8000, 8010, 8000, 8020]);
        watch.learn(false);
        for jump in [30_000, 32_767, 32_769, 50_000] {
            assert_eq!(
                spikes(&mut watch, &[8020, 8030, 8030 + jump, 8030, 8040]),
                1
            );
        }
    }

    /// A channel whose gain falls suddenly, while its quantity moves in the opposite direction by 60 steps per sample.
    #[test]
    fn a_step_against_the_motion_is_no_spike() {
        let mut watch = watch();
        watch.learn(true);
        watch.learn(false);
        let stepped = [40_000, 40_060, 40_120, 39_800, 39_860, 39_920];
        assert_eq!(spikes(&mut watch, &stepped), 0);
        // There and back it is a spike, with any motion.
        assert_eq!(
            spikes(&mut watch, &[39_920, 39_980, 39_500, 40_100, 40_160]),
            1
        );
    }

    /// At rest a spike returns to 0 V, and nothing is lost.
    #[test]
    fn a_spike_from_no_voltage_is_no_drop_out() {
        let mut watch = watch();
        watch.learn(true);
        watch.learn(false);
        assert_eq!(
            spikes(&mut watch, &[32_768, 32_770, 32_767, 40_000, 32_768]),
            1
        );
        assert_eq!(spikes(&mut watch, &[32_768; 10]), 0);
    }

    /// Held above 0 V, while the force moves inwards; an inverting channel shows less for more.
    #[test]
    fn a_channel_held_while_the_force_comes_in_is_stuck() {
        let stuck = HealthCause::SensorStuck(Channel::Force);
        for (full_scale, code, cause) in [
            (2.0, 20_000, Some(stuck)),
            (2.0, 40_000, None),
            (-2.0, 40_000, Some(stuck)),
            (-2.0, 20_000, None),
        ] {
            let scale = Scale::new(full_scale, 0.0).unwrap();
            let mut watch = ChannelWatch::new(Channel::Force, &scale);
            let first = found(&mut watch, &[code; 4], 0.5).first().copied();
            assert_eq!(first, cause, "{full_scale}, {code}");
        }
    }

    /// Held while the force went out and came back.
    #[test]
    fn a_channel_held_while_the_force_is_further_out_is_clipped_once_it_changes() {
        let mut watch = watch();
        assert_eq!(found(&mut watch, &[20_000; 4], -0.5), []);
        let clipped = HealthCause::SensorClipped(Channel::Force);
        assert_eq!(found(&mut watch, &[20_000, 20_100, 20_200], 0.0), [clipped]);
    }
}

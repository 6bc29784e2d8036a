//! A channel's samples, one by one: does it stand still, is it cut off, does a sample stand out.
//!
//! - A channel that repeats one value is held. While what it measures comes in from where that began, it is stuck, or dropped
//!   out where the value is that of no voltage. One that was held while what it measures was further out, and lets go when
//!   that comes back, is clipped.
//! - A sample stands out when it jumps one way and the next jumps back: the smaller of two differences in a row of opposite
//!   sign. Noise does that too, and by how much is learned. Physics does not: what it does at once stays.

use super::cause::{Cause, Channel};
use crate::converter::Scale;

/// Squared jumps may be this many times the largest that was learned: twice a jump itself. Gaussian noise of σ jumps there and
/// back by t once in about e^(t²/3σ²) ticks, so that after 1e4 ticks of learning it takes 1e16 to exceed 2·t.
const SPIKE_FACTOR: f32 = 4.0;
/// Jumps of so many of the converter's steps are never a spike.
const SPIKE_STEPS: f32 = 16.0;
/// Repeats of the value of no voltage, after a jump to it, from which a channel has dropped out.
const DROPPED_TICKS: u32 = 4;
/// Part of its amplitude by which what is measured must move beside a channel that is held.
const MOVED: f32 = 0.1;
/// And by which it must come in: a channel that is cut off by less lets go before.
const CAME_IN: f32 = 0.3;

/// The least that can be learned. Its sign bit is set, as that of all that is.
const NONE_LEARNED: f32 = -f32::MIN_POSITIVE;

/// What one channel did so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChannelWatch {
    channel: Channel,
    /// What it shows at no voltage, and two steps of its converter, in its unit.
    no_voltage: f32,
    two_steps: f32,
    last: f32,
    /// The last difference, and the one before.
    step: f32,
    before: f32,
    /// Minus the square of the largest jump there and back that is no spike.
    lowest: f32,
    /// Of the largest so far.
    learned: f32,
    /// Ticks for which it has been held.
    held: u32,
    /// What it measures, beside it, when that began.
    reference: f32,
    motion: f32,
    /// The difference before that began.
    jump: f32,
    /// That has moved by enough since.
    moved: bool,
}

/// What a channel's samples are held against.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beside {
    /// What it measures, as far as the demand or the law know: mm or kN.
    pub(super) reference: f32,
    /// The amplitude of that.
    pub(super) amplitude: f32,
    /// Displacement and its amplitude, mm. Where nothing moves a force may stand still, whatever the law says of a reversal.
    pub(super) motion: f32,
    pub(super) motion_amplitude: f32,
}

impl ChannelWatch {
    /// Of a channel with `scale`. No spike until learned.
    pub(super) fn new(channel: Channel, scale: &Scale) -> Self {
        Self {
            channel,
            no_voltage: scale.decode(crate::converter::MIDSCALE).value,
            two_steps: 2.0 * scale.step().abs(),
            last: f32::NAN,
            step: f32::NAN,
            before: 0.0,
            lowest: f32::NEG_INFINITY,
            learned: NONE_LEARNED,
            held: 0,
            reference: 0.0,
            motion: 0.0,
            jump: 0.0,
            moved: false,
        }
    }

    /// The rig starts: learns anew.
    pub(super) fn restart(&mut self) {
        self.last = f32::NAN;
        self.step = f32::NAN;
        self.lowest = f32::NEG_INFINITY;
        self.learned = NONE_LEARNED;
        self.held = 0;
        self.moved = false;
    }

    /// For how many ticks on end it has shown the same.
    pub(super) fn held(&self) -> u32 {
        self.held
    }

    /// Learns from here on, or takes what it has learned so far.
    pub(super) fn learn(&mut self, begin: bool) {
        if begin {
            self.learned = NONE_LEARNED;
            self.lowest = f32::NEG_INFINITY;
        } else {
            let steps = 0.5 * SPIKE_STEPS * self.two_steps;
            let floor = -(steps * steps);
            let learned = SPIKE_FACTOR * self.learned;
            self.lowest = if learned < floor { learned } else { floor };
        }
    }

    /// One more sample; whether [`ChannelWatch::look`] is to be asked about it.
    ///
    /// A step of the sign of the one before is nothing, nor one of the other sign whose product with it is smaller than what
    /// is learned. A product of 0 is a channel that is held, or lets go. As bits, less one: positive products come first,
    /// then negative ones by their size, and 0 last; adding 0 makes one 0 of both.
    #[inline(always)]
    pub(super) fn update(&mut self, value: f32) -> bool {
        let step = value - self.last;
        let before = self.step;
        self.last = value;
        self.step = step;
        let product = step * before + 0.0;
        let asked = product.to_bits().wrapping_sub(1) >= self.learned.to_bits();
        if asked {
            self.before = before;
        }
        asked
    }

    /// What is wrong with the last sample, for which [`ChannelWatch::update`] said yes.
    #[cold]
    #[inline(never)]
    pub(super) fn look(&mut self, beside: &Beside) -> Option<Cause> {
        if self.step == 0.0 {
            self.hold(beside)
        } else if self.held > 0 {
            self.let_go()
        } else {
            self.stand_out()
        }
    }

    /// The limit of a jump, in the channel's unit.
    pub(super) fn limit(&self) -> f32 {
        crate::real::square_root(-self.lowest)
    }

    /// The channel's sample.
    pub(super) fn last(&self) -> f32 {
        self.last
    }

    fn stand_out(&mut self) -> Option<Cause> {
        let (before, step) = (self.before, self.step);
        let smaller = if before.abs() < step.abs() {
            before
        } else {
            step
        };
        let square = -smaller * smaller;
        if square < self.lowest {
            return Some(Cause::SensorSpiking(self.channel));
        }
        if square < self.learned {
            self.learned = square;
        }
        None
    }

    fn let_go(&mut self) -> Option<Cause> {
        let clipped = self.moved;
        self.held = 0;
        self.moved = false;
        clipped.then_some(Cause::SensorClipped(self.channel))
    }

    fn hold(&mut self, beside: &Beside) -> Option<Cause> {
        if self.held == 0 {
            self.jump = self.before;
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
        let from_zero = self.last - self.no_voltage;
        if from_zero.abs() <= self.two_steps {
            let jumped = self.jump * self.jump > -self.lowest;
            let dropped = moved.abs() > enough || (jumped && self.held >= DROPPED_TICKS);
            return dropped.then_some(Cause::SensorDroppedOut(self.channel));
        }
        self.moved |= moved.abs() > enough;
        let inward = if from_zero > 0.0 { -moved } else { moved };
        let stuck = inward > CAME_IN * beside.amplitude;
        stuck.then_some(Cause::SensorStuck(self.channel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_noise_a_jump_of_a_few_steps_is_the_limit() {
        let scale = Scale::new(2.0, 0.0).unwrap();
        let mut watch = ChannelWatch::new(Channel::Force, &scale);
        watch.learn(true);
        watch.learn(false);
        let expected = SPIKE_STEPS * 2.0 / 32768.0;
        assert!((watch.limit() - expected).abs() <= 1e-6 * expected);
    }
}

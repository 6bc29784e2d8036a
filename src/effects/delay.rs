//! A force channel that is late: the skew of a multiplexed converter, or of a filter that the displacement does not pass.

use super::{ConfinedMotion, Motion};
use crate::error::ConfigError;
use crate::real::{Real, in_range};

/// Most ticks of a [`Delay`].
pub const MAX_DELAY: u8 = 255;
/// Forces that are kept: as many as an index of 8 bits tells apart.
const KEPT: usize = 256;

/// F(t) = F_all(t − T): of the law's force with every effect's, as it was T ago.
///
/// Of T the whole ticks are those of a force that is kept; before the first tick it is the first tick's. The rest, at most
/// half a tick to either side, is taken off the motion: a force between two ticks would be wrong where friction turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay<R> {
    /// Whole ticks.
    pub(super) whole: u8,
    /// The rest, s.
    pub(super) rest: R,
}

/// The last forces, kN.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct DelayState<R> {
    forces: [R; KEPT],
    /// Where the next one goes.
    next: u8,
    /// How many there are, at most [`MAX_DELAY`].
    filled: u8,
}

impl<R: Real> DelayState<R> {
    pub(super) const EMPTY: Self = Self {
        forces: [R::ZERO; KEPT],
        next: 0,
        filled: 0,
    };
}

impl<R: Real> Delay<R> {
    pub(super) const NONE: Self = Self {
        whole: 0,
        rest: R::ZERO,
    };

    /// * `time`: T, s, 0 to 255 ticks
    /// * `tick`: s, 1e-7…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(time: R, tick: R) -> Result<Self, ConfigError> {
        let tick = in_range("tick", tick, 1e-7, 1e3)?.to_f64();
        let most = f64::from(MAX_DELAY);
        // What rounding to a float adds is no longer a delay.
        let ticks = in_range("time", time, 0.0, most * tick)?.to_f64() / tick;
        let ticks = if ticks < most { ticks } else { most };
        let whole = (ticks + 0.5) as u8;
        Ok(Self {
            whole,
            rest: R::from_f64((ticks - f64::from(whole)) * tick),
        })
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        in_range("rest", self.rest, -500.0, 500.0).map(|_| ())
    }

    /// How many ticks late the force of [`Self::shifted`] motion is.
    pub fn whole_ticks(&self) -> usize {
        self.whole.into()
    }

    /// `motion` as it was by the rest of T before: within (ω·rest)²/2 of a sine's velocity, (ω·rest)³/6 of its displacement.
    /// Cycles and temperature stay.
    #[inline]
    pub fn shifted(&self, motion: &Motion<R>) -> Motion<R> {
        let change = self.rest * motion.acceleration;
        let velocity = motion.velocity - change;
        let mean = velocity + R::from_f64(0.5) * change;
        Motion {
            displacement: motion.displacement - self.rest * mean,
            velocity,
            ..*motion
        }
    }

    /// The same, within the limits.
    #[inline(always)]
    pub(super) fn felt(&self, motion: &ConfinedMotion<R>) -> ConfinedMotion<R> {
        self.shifted(&motion.0).confined()
    }

    /// What `force` kN of this tick becomes.
    #[inline(always)]
    pub(super) fn delayed(&self, state: &mut DelayState<R>, force: R) -> R {
        let now = state.next;
        state.forces[usize::from(now)] = force;
        state.next = now.wrapping_add(1);
        let lag = self.whole.min(state.filled);
        state.filled = state.filled.saturating_add(1);
        state.forces[usize::from(now.wrapping_sub(lag))]
    }
}

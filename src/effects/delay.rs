//! A force channel that is late: the skew of a multiplexed converter, or of a filter that the displacement does not pass.

use crate::error::ConfigError;
use crate::real::{Real, in_range};

/// Most ticks of a [`Delay`].
pub const MAX_DELAY: u8 = 255;
/// Forces that are kept: as many as an index of 8 bits tells apart.
const KEPT: usize = 256;

/// F(t) = F_all(t − T), the last of all: of the law's force with every effect's, as it was T ago. Between two ticks it is taken
/// from a straight line; before the first tick it is the first tick's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay<R> {
    /// Whole ticks.
    pub(super) whole: u8,
    /// The rest of a tick, 0 to below 1.
    pub(super) part: R,
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
        part: R::ZERO,
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
        let whole = ticks as u8;
        Ok(Self {
            whole,
            part: R::from_f64(ticks - f64::from(whole)),
        })
    }

    pub(super) fn check(&self) -> Result<(), ConfigError> {
        in_range("part", self.part, 0.0, 1.0).map(|_| ())
    }

    /// What `force` kN of this tick becomes.
    #[inline(always)]
    pub(super) fn delayed(&self, state: &mut DelayState<R>, force: R) -> R {
        let now = state.next;
        state.forces[usize::from(now)] = force;
        state.next = now.wrapping_add(1);
        let kept = |lag: u8| state.forces[usize::from(now.wrapping_sub(lag.min(state.filled)))];
        let newer = kept(self.whole);
        let older = kept(self.whole.saturating_add(1));
        state.filled = state.filled.saturating_add(1);
        newer + self.part * (older - newer)
    }
}

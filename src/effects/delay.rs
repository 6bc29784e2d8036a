//! A delayed force channel: the skew of a multiplexed converter, or a filter in the force channel only.

use super::description::{Dependence, Description, EffectKind, Energy, Growth};
use super::{ClampedMotion, Equations, Motion, Packed};
use crate::error::ConfigError;
use crate::real::{Real, compare, in_range};

/// Longest [`Delay`], ticks.
pub const MAX_DELAY: u8 = 255;
/// Number of stored forces: all values of an 8-bit index.
const KEPT: usize = 256;

/// F(t) = F_all(t − T): the sum of the law's force and of every effect's, T ago.
///
/// The whole ticks of T come from the stored forces; before the first tick it is the first tick's force. The rest, at most half a
/// tick to either side, is applied to the motion, because a force interpolated between two ticks would be wrong where friction
/// reverses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay<R> {
    /// Whole ticks.
    whole: u8,
    /// The rest, s.
    rest: R,
}

/// The stored forces, kN.
#[derive(Clone, Debug)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DelayState<R> {
    #[cfg_attr(
        feature = "serde",
        serde(
            with = "kept",
            bound(
                serialize = "R: serde::Serialize",
                deserialize = "R: Real + serde::Deserialize<'de>"
            )
        )
    )]
    forces: [R; KEPT],
    /// Index for the next force.
    next: u8,
    /// Number of stored forces, at most [`MAX_DELAY`].
    filled: u8,
}

numbers! {
    Delay of {
        time: "s" in [0.0, 255e3],
    }
}

impl<R: Real> Delay<R> {
    /// * `time`: T, s, 0 to 255 ticks
    /// * `tick`: s, 1e-7…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(time: R, tick: R) -> Result<Self, ConfigError> {
        let tick = in_range("tick", tick, 1e-7, 1e3)?.to_f64();
        let most = f64::from(MAX_DELAY);
        // Excess by rounding to a float is not a longer delay.
        let ticks = in_range("time", time, 0.0, most * tick)?.to_f64() / tick;
        let ticks = if ticks < most { ticks } else { most };
        let whole = (ticks + 0.5) as u8;
        let new = Self {
            whole,
            rest: R::from_f64((ticks - f64::from(whole)) * tick),
        };
        new.check()?;
        new.check_tick(R::from_f64(tick))?;
        Ok(new)
    }

    /// Delay in ticks of the force of the [`Self::shifted`] motion.
    pub fn whole_ticks(&self) -> usize {
        self.whole.into()
    }

    /// `motion` earlier by the rest of T: within (ω·rest)²/2 of a sine's velocity and (ω·rest)³/6 of its displacement. Cycles and
    /// temperature stay.
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
}

impl<R: Real> Equations<R> for Delay<R> {
    const DESCRIPTION: Description = Description {
        name: "delay",
        family: "delay",
        number: 14,
        kind: EffectKind::Stage,
        parameters: Self::PARAMETERS,
        typical: &[0.0012],
        depends_on: &[Dependence::Velocity, Dependence::Frequency],
        outside: Growth::OfForceBehind,
        energy: Energy::Active,
        sentence: "A force channel that is late.",
        ..Description::PLAIN
    };
    const NONE: Self = Self {
        whole: 0,
        rest: R::ZERO,
    };

    type State = DelayState<R>;
    const AT_REST: Self::State = DelayState {
        forces: [R::ZERO; KEPT],
        next: 0,
        filled: 0,
    };

    fn from_parameters(parameters: &[f64], tick: f64) -> Result<Self, ConfigError> {
        let [time] = super::numbers::exactly(parameters)?;
        Self::new(R::from_f64(time), R::from_f64(tick))
    }

    fn check(&self) -> Result<(), ConfigError> {
        // No delay is below 0 or above the longest.
        let low = if self.whole == 0 { 0.0 } else { -500.0 };
        let high = if self.whole == MAX_DELAY { 0.0 } else { 500.0 };
        in_range("rest", self.rest, low, high).map(|_| ())
    }

    /// The rest is at most half a tick, with a margin for rounding.
    fn check_tick(&self, tick: R) -> Result<(), ConfigError> {
        let most = tick * R::from_f64(0.500_001);
        compare("rest", self.rest, -most, most).map(|_| ())
    }

    #[inline(always)]
    fn felt(&self, motion: &ClampedMotion<R>) -> ClampedMotion<R> {
        self.shifted(&motion.0).clamped()
    }

    #[inline(always)]
    fn shown(&self, state: &mut Self::State, force: R) -> R {
        let now = state.next;
        state.forces[usize::from(now)] = force;
        state.next = now.wrapping_add(1);
        let lag = self.whole.min(state.filled);
        state.filled = state.filled.saturating_add(1);
        state.forces[usize::from(now.wrapping_sub(lag))]
    }
}

impl Packed for Delay<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        [f32::from(self.whole), self.rest].into_iter().for_each(put);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let &[ticks, rest] = words else { return None };
        let whole = ticks as u8;
        (f32::from(whole) == ticks).then_some(Self { whole, rest })
    }
}

/// [`KEPT`] forces as a sequence, because serde supports only shorter arrays.
#[cfg(feature = "serde")]
mod kept {
    use core::fmt;
    use core::marker::PhantomData;

    use serde::de::{Deserializer, Error, SeqAccess, Visitor};
    use serde::{Deserialize, Serialize, Serializer};

    use super::KEPT;
    use crate::real::Real;

    pub fn serialize<R: Serialize, S: Serializer>(
        forces: &[R; KEPT],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(forces)
    }

    pub fn deserialize<'de, R: Real + Deserialize<'de>, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<[R; KEPT], D::Error> {
        struct Forces<R>(PhantomData<R>);

        impl<'de, R: Real + Deserialize<'de>> Visitor<'de> for Forces<R> {
            type Value = [R; KEPT];

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{KEPT} forces")
            }

            fn visit_seq<A: SeqAccess<'de>>(
                self,
                mut sequence: A,
            ) -> Result<Self::Value, A::Error> {
                let mut forces = [R::ZERO; KEPT];
                for (place, force) in forces.iter_mut().enumerate() {
                    *force = sequence
                        .next_element()?
                        .ok_or_else(|| A::Error::invalid_length(place, &self))?;
                }
                Ok(forces)
            }
        }

        deserializer.deserialize_seq(Forces(PhantomData))
    }
}

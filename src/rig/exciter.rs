//! The source of a rig's motion: the sines of a programme, or a motion that a host streams.

use core::borrow::Borrow;

use super::fault::TripCause;
use super::stream::Stream;
use crate::sine::{Excitation, Programme, SineGenerator};

/// Gives the demanded motion at each tick.
pub trait Exciter {
    /// Returns to the start, at rest.
    fn restart(&mut self);

    /// The excitation at this tick, which follows [`Exciter::restart`] or the last call. Position, velocity and acceleration are
    /// finite, and the first excitation is at rest at 0.
    fn tick(&mut self) -> Excitation;

    /// Whether it waits, without ticks, until the rig is at its start. A stream does not wait, because its knots arrive when they
    /// are due.
    #[inline(always)]
    fn waits(&self) -> bool {
        true
    }

    /// Whether the phase of its excitation gives the position in a cycle.
    #[inline(always)]
    fn has_phase(&self) -> bool {
        true
    }

    /// Trip cause of the last tick, if it must stop the rig.
    #[inline(always)]
    fn refusal(&self) -> Option<TripCause> {
        None
    }
}

impl<const B: usize, P: Borrow<Programme<B>>> Exciter for SineGenerator<B, P> {
    #[inline(always)]
    fn restart(&mut self) {
        self.restart();
    }

    #[inline(always)]
    fn tick(&mut self) -> Excitation {
        self.tick()
    }
}

/// Either of the two, for a rig whose set-up selects one.
#[derive(Clone, Debug)]
pub enum AnyExciter<const B: usize, P = Programme<B>> {
    /// A programme of sines.
    Programme(SineGenerator<B, P>),
    /// A streamed motion.
    Stream(Stream),
}

impl<const B: usize, P> AnyExciter<B, P> {
    /// The stream, if it is one.
    pub fn stream(&mut self) -> Option<&mut Stream> {
        match self {
            Self::Programme(_) => None,
            Self::Stream(stream) => Some(stream),
        }
    }
}

impl<const B: usize, P: Borrow<Programme<B>>> Exciter for AnyExciter<B, P> {
    fn restart(&mut self) {
        match self {
            Self::Programme(generator) => generator.restart(),
            Self::Stream(stream) => stream.restart(),
        }
    }

    #[inline]
    fn tick(&mut self) -> Excitation {
        match self {
            Self::Programme(generator) => generator.tick(),
            Self::Stream(stream) => stream.tick(),
        }
    }

    #[inline(always)]
    fn waits(&self) -> bool {
        matches!(self, Self::Programme(_))
    }

    #[inline(always)]
    fn has_phase(&self) -> bool {
        matches!(self, Self::Programme(_))
    }

    #[inline(always)]
    fn refusal(&self) -> Option<TripCause> {
        match self {
            Self::Programme(_) => None,
            Self::Stream(stream) => stream.refusal(),
        }
    }
}

//! Who says where a rig goes: the sines of a programme, or a motion that a host streams.

use core::borrow::Borrow;

use super::fault::TripCause;
use super::stream::Stream;
use crate::sine::{Excitation, Programme, SineGenerator};

/// Says where a rig is to be at each tick.
pub trait Exciter {
    /// Back to the start, at rest.
    fn restart(&mut self);

    /// The excitation at this tick, which is the next one after [`Exciter::restart`] or the last call. Position, velocity and
    /// acceleration are finite, and the first is at rest at 0.
    fn tick(&mut self) -> Excitation;

    /// Whether it waits, not ticked, until the rig is at its start. A stream does not: its knots come when they are due.
    #[inline(always)]
    fn waits(&self) -> bool {
        true
    }

    /// Whether the phase of its excitation tells where a cycle is.
    #[inline(always)]
    fn has_phase(&self) -> bool {
        true
    }

    /// Why the rig is to stop at the last tick, where it is to.
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

/// Either, for a rig that learns which when it is set up.
#[derive(Clone, Debug)]
pub enum AnyExciter<const B: usize, P = Programme<B>> {
    /// A programme of sines.
    Programme(SineGenerator<B, P>),
    /// A streamed motion.
    Stream(Stream),
}

impl<const B: usize, P> AnyExciter<B, P> {
    /// The stream, where it is one.
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

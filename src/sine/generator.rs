//! The generator runs through a programme, tick by tick.

use core::borrow::Borrow;

use super::excitation::{CYCLES_PER_UNIT, Excitation, ROUNDING};
use super::phase::sin_cos;
use super::programme::Programme;
use super::segment::Segment;
use crate::error::ConfigError;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Ramp,
    Steady,
    ToRest,
    Done,
}

/// Runs through a [`Programme`], tick by tick.
///
/// The phase is an integer, 2¹²⁸ per cycle. The increment of a constant frequency is exact to one unit, so that after n ticks the
/// phase is within n units of the exact quotient: after 10¹⁰ ticks (10⁶ cycles of 1 Hz at 10 kHz) within 3e-29 of a cycle.
#[derive(Clone, Debug)]
pub struct SineGenerator<const N: usize, P = Programme<N>> {
    programme: P,
    at: Place,
}

/// A block of constant amplitude and frequency that has begun, for callers that compute its ticks by other means.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SteadyBlock {
    /// Amplitude, mm.
    pub(crate) amplitude: f32,
    /// ω, rad/s.
    pub(crate) angular: f32,
    /// Whole cycles.
    pub(crate) cycles: u32,
    /// Phase of its first tick, 2¹²⁸ per cycle.
    pub(crate) phase: u128,
    /// Increment of the phase per tick, 2¹²⁸ per cycle.
    pub(crate) increment: u128,
}

/// Position of the generator in the programme.
#[derive(Clone, Copy, Debug)]
struct Place {
    segment: Segment,
    stage: Stage,
    block: usize,
    /// Phase, with [`ROUNDING`] added.
    phase: u128,
    /// Cycles completed in this segment.
    travelled: u32,
    cycle: u32,
    cycle_end: bool,
}

impl Place {
    fn start(first: Segment) -> Self {
        Self {
            segment: first,
            stage: Stage::Ramp,
            block: 0,
            phase: ROUNDING,
            travelled: 0,
            cycle: 0,
            cycle_end: false,
        }
    }
}

impl<const N: usize, P: Borrow<Programme<N>>> SineGenerator<N, P> {
    /// A generator at rest, at the start of `programme`, which is the programme itself or a reference to it.
    ///
    /// # Errors
    /// [`ConfigError::Empty`] for a programme without a block.
    pub fn new(programme: P) -> Result<Self, ConfigError> {
        let first = programme
            .borrow()
            .planned
            .first()
            .ok_or(ConfigError::Empty("blocks"))?
            .ramp;
        Ok(Self {
            programme,
            at: Place::start(first),
        })
    }

    /// The programme.
    pub fn programme(&self) -> &Programme<N> {
        self.programme.borrow()
    }

    /// Returns to the start of the programme, at rest.
    pub fn restart(&mut self) {
        if let Some(first) = self.programme.borrow().planned.first() {
            self.at = Place::start(first.ramp);
        }
    }

    /// The excitation at this tick; the first call gives the start, at rest. After the end it stays at 0.
    #[inline]
    pub fn tick(&mut self) -> Excitation {
        let at = &self.at;
        let mut excitation = Excitation {
            phase: (at.phase >> 96) as u32,
            cycle: at.cycle,
            block: at.block,
            ramp: matches!(at.stage, Stage::Ramp | Stage::ToRest),
            cycle_end: at.cycle_end,
            done: at.stage == Stage::Done,
            ..Excitation::default()
        };
        if excitation.done {
            self.at.cycle_end = false;
            return excitation;
        }
        let (sin, cos) = sin_cos((at.phase.wrapping_sub(ROUNDING) >> 64) as u64);
        let segment = &at.segment;
        if segment.steady {
            excitation.displacement = segment.amplitude * sin;
            let speed = segment.amplitude * segment.angular;
            excitation.velocity = speed * cos;
            excitation.acceleration = -(speed * segment.angular) * sin;
        } else {
            segment.changing(at.travelled, sin, cos, &mut excitation);
        }
        self.advance();
        excitation
    }

    /// The steady block that began with the last tick's excitation, if one did.
    pub(crate) fn steady_begun(&self) -> Option<SteadyBlock> {
        let at = &self.at;
        if at.stage != Stage::Steady || !at.segment.steady || at.travelled > 0 || at.cycle_end {
            return None;
        }
        let segment = &at.segment;
        // The generator is one tick ahead; its phase shows that the block began with the tick before.
        let phase = at.phase.checked_sub(segment.increment)?;
        (phase < segment.increment).then_some(SteadyBlock {
            amplitude: segment.amplitude,
            angular: segment.angular,
            cycles: segment.cycles,
            phase: phase.saturating_sub(ROUNDING),
            increment: segment.increment,
        })
    }

    /// Skips to the end of the current steady block, and `past` into the next cycle, 2¹²⁸ per cycle: the next tick is there.
    pub(crate) fn steady_ended(&mut self, past: u128) {
        let at = &mut self.at;
        at.cycle = at.cycle.wrapping_add(at.segment.cycles);
        at.phase = past.wrapping_add(ROUNDING);
        at.cycle_end = true;
        self.next_segment();
    }

    #[inline]
    fn advance(&mut self) {
        let at = &mut self.at;
        let (phase, wrapped) = at
            .phase
            .overflowing_add(at.segment.step(at.travelled, at.phase));
        at.phase = phase;
        at.cycle_end = wrapped;
        if wrapped {
            at.cycle = at.cycle.wrapping_add(1);
            at.travelled = at.travelled.wrapping_add(1);
            if at.travelled >= at.segment.cycles {
                self.next_segment();
            }
        }
    }

    /// Continues in the next segment, with the phase that is already past the end of this one.
    fn next_segment(&mut self) {
        let programme = self.programme.borrow();
        let planned = &programme.planned;
        let at = &mut self.at;
        let (stage, block, segment) =
            match (at.stage, planned.get(at.block), planned.get(at.block + 1)) {
                (Stage::Ramp, Some(this), _) => (Stage::Steady, at.block, Some(this.steady)),
                (Stage::Steady, _, Some(next)) => (Stage::Ramp, at.block + 1, Some(next.ramp)),
                (Stage::Steady, _, None) => (Stage::ToRest, at.block, Some(programme.to_rest)),
                _ => (Stage::Done, at.block, None),
            };
        at.stage = stage;
        at.block = block;
        at.travelled = 0;
        match segment {
            Some(segment) => {
                let past = (at.phase >> 96) as u32 as f32 * CYCLES_PER_UNIT;
                // The time past the boundary is the same before and after it, but the rate of change of frequency is not: k'·f·t²/2
                // − k·f·t²/2 with t = past/f. The omitted terms are of third order in the tick.
                let correction =
                    (segment.chirp - at.segment.chirp) * past * past / (2.0 * segment.frequency);
                let correction = (correction * (1u64 << 63) as f32) as i64;
                at.phase = at
                    .phase
                    .wrapping_add(((i128::from(correction)) << 65) as u128);
                at.segment = segment;
            }
            None => at.phase = ROUNDING,
        }
    }
}

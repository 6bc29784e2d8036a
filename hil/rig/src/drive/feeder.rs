//! Gives a rig the knots of its motion in time.

use mesh_damper::rig::{Knot, STREAM_QUEUE};

use super::Motion;

/// Knots that are given at a time.
const BATCH: usize = STREAM_QUEUE / 2;

/// The host's end of a stream. It counts the ticks, by which it knows which knots the rig has taken out of its queue.
#[derive(Clone, Debug)]
pub struct Feeder {
    knots: Vec<Knot>,
    knot_ticks: u64,
    given: usize,
    ticks: u64,
    complete: bool,
}

impl Feeder {
    /// At the start of `motion`.
    pub fn new(motion: &Motion) -> Self {
        Self {
            knots: motion.knots().collect(),
            knot_ticks: motion.grid().knot_ticks().into(),
            given: 0,
            ticks: 0,
            complete: false,
        }
    }

    /// Back to the start.
    pub fn restart(&mut self) {
        self.given = 0;
        self.ticks = 0;
        self.complete = false;
    }

    /// The tick has been.
    pub fn tick(&mut self) {
        self.ticks += 1;
    }

    /// What the rig is to have before its next tick: some knots, or an empty slice, once, where there are no more; to be asked
    /// until there is nothing.
    pub fn due(&mut self) -> Option<&[Knot]> {
        let taken = self.ticks.div_ceil(self.knot_ticks) as usize;
        if self.complete || self.given.saturating_sub(taken) > BATCH {
            return None;
        }
        let from = self.given;
        self.given = (from + BATCH).min(self.knots.len());
        self.complete = self.given == from;
        Some(&self.knots[from..self.given])
    }
}

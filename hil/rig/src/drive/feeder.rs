//! Gives a rig the knots of its motion in time.

use mesh_damper::rig::{Knot, STREAM_QUEUE};

use super::Motion;

/// Number of knots given at a time.
const BATCH: usize = STREAM_QUEUE / 2;

/// The host's end of a stream. It counts the ticks, and thus knows which knots the rig has taken from its queue.
#[derive(Clone, Debug)]
pub struct Feeder {
    knots: Vec<Knot>,
    knot_ticks: u64,
    given: usize,
    ticks: u64,
    complete: bool,
}

impl Feeder {
    /// A feeder at the start of `motion`.
    pub fn new(motion: &Motion) -> Self {
        Self {
            knots: motion.knots().collect(),
            knot_ticks: motion.grid().knot_ticks().into(),
            given: 0,
            ticks: 0,
            complete: false,
        }
    }

    /// Returns to the start.
    pub fn restart(&mut self) {
        self.given = 0;
        self.ticks = 0;
        self.complete = false;
    }

    /// Counts a tick.
    pub fn tick(&mut self) {
        self.ticks += 1;
    }

    /// Knots that the rig needs before its next tick, or once an empty slice after the last knots. Call it until it returns `None`.
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

//! A force recorded late.

use mesh_damper::effects::Delay;

use super::{Entry, Form, FormSpec, Step, one};
use crate::moved::through;
use crate::shape::Shape;

/// Its shape is the time.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "delay",
    family: "delay",
    entry: Entry::Moves,
    shape_names: &["time"],
    shapes: |extent| {
        let longest = (0.2 / extent.lowest_frequency).min(250.0 * extent.tick);
        vec![Shape::spread(0.02 * extent.tick, longest, 9)]
    },
    moves: |trajectory, time, _| {
        let delay = Delay::new(time, trajectory.tick).ok()?;
        through(trajectory, |motion| delay.shifted(motion));
        Some(delay.whole_ticks())
    },
    // The force jumps a little where the crate takes another whole tick: one to either side sees past that.
    step: Step::Tick,
    elements: |value| one(vec![("time", value.shape(0))]),
    ..FormSpec::PLAIN
})];

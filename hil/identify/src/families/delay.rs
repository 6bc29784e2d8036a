//! A force recorded late.

use mesh_damper::effects::Delay;

use super::{Entry, Form, FormSpec, Step, one};
use crate::moved::through;
use crate::policy::policy;
use crate::shape::Shape;

/// Its shape is the time.
pub const FORMS: [Form; 1] = [Form(&FormSpec {
    name: "delay",
    family: "delay",
    entry: Entry::Moves,
    shape_names: &["time"],
    shapes: |extent| {
        let policy = &policy().shape;
        let longest = (policy.longest_delay / extent.lowest_frequency)
            .min(policy.longest_delay_in_ticks * extent.tick);
        vec![Shape::spread(
            policy.shortest_delay * extent.tick,
            longest,
            policy.delay_starts,
        )]
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

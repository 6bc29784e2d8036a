//! A force recorded with a delay: by a fixed time, or through a low-pass.

use std::f64::consts::{SQRT_2, TAU};

use mesh_damper::effects::{Delay, Equations, ForceFilter};

use super::{Entry, Form, FormSpec, Step, one};
use crate::moved::through;
use crate::shape::ShapePolicy;
use crate::shape::{Extent, Shape};

/// A fixed time; a low-pass, whose shape is the corner frequency.
pub const FORMS: [Form; 2] = [
    Form(&FormSpec {
        name: "delay",
        shape_names: &["time"],
        shapes: |extent| {
            let [shortest, longest] = lags(extent);
            let starts = ShapePolicy::in_use().delay_starts;
            vec![Shape::spread(shortest, longest, starts)]
        },
        moves: |trajectory, time, _| {
            let delay = Delay::new(time, trajectory.tick).ok()?;
            through(trajectory, |motion| delay.shifted(motion));
            Some(delay.whole_ticks())
        },
        // The force jumps a little where the crate uses another whole tick; a difference over one tick on each side is not affected
        // by that.
        step: Step::Tick,
        elements: |value| one(vec![("time", value.shape(0))]),
        ..LATE
    }),
    Form(&FormSpec {
        name: "force_filter",
        shape_names: &["corner"],
        // For motion well below its corner frequency it looks like a delay in the data.
        rank: 1,
        shapes: |extent| {
            let [shortest, longest] = lags(extent);
            let starts = ShapePolicy::in_use().delay_starts;
            vec![Shape::spread(SLOW / longest, SLOW / shortest, starts)]
        },
        shows: Some(|forces, corner, tick| {
            // Refused if the lag is too short for a tick.
            if let Ok(filter) = ForceFilter::new(corner, tick) {
                let mut state = ForceFilter::AT_REST;
                for force in forces {
                    *force = filter.shown(&mut state, *force);
                }
            }
        }),
        elements: |value| one(vec![("corner", value.shape(0))]),
        ..LATE
    }),
];

const LATE: FormSpec = FormSpec {
    family: "delay",
    entry: Entry::Moves,
    ..FormSpec::PLAIN
};

/// The lag of a slow force behind a low-pass, times its corner: √2/ω.
const SLOW: f64 = SQRT_2 / TAU;

/// The shortest and the longest delay of the search, s. The shortest is far below a tick, where either form has little effect and
/// from where a search converges.
fn lags(extent: &Extent) -> [f64; 2] {
    let policy = ShapePolicy::in_use();
    let longest = (policy.longest_delay / extent.lowest_frequency)
        .min(policy.longest_delay_in_ticks * extent.tick);
    [policy.shortest_delay * extent.tick, longest]
}

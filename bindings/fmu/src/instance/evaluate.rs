//! One tick.

use mesh_damper::effects::{AugmentedLaw, CONTROLS, Motion};
use mesh_damper_model::MAX_EFFECTS;
use mesh_damper_model::file::FittedRange;

use crate::state::State;
use crate::variables::{self, FIRST_CONTROL, MM_PER_M};

/// Evaluates `law` with the inputs of `state`, `after` s from the time at which they were set.
pub fn evaluate(
    law: &AugmentedLaw<f64, MAX_EFFECTS>,
    range: &FittedRange,
    state: &mut State,
    after: f64,
) {
    let motion = motion(state, after);
    let is_in = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
    state.force = law.force(&mut state.law, &motion);
    state.is_within =
        is_in(range.displacement, motion.displacement) && is_in(range.velocity, motion.velocity);
}

/// The inputs of `state`, `after` s from the time at which they were set, in mm and s.
fn motion(state: &State, after: f64) -> Motion<f64> {
    let at = |place: usize| {
        let [first, second] = state.slopes[place];
        match [first, second] == [0.0; 2] {
            // Exactly the set value.
            true => state.inputs[place],
            false => state.inputs[place] + after * (first + 0.5 * after * second),
        }
    };
    let mut controls = [0.0; CONTROLS];
    for (place, control) in controls.iter_mut().enumerate() {
        *control = at(FIRST_CONTROL + place);
    }
    Motion {
        displacement: at(variables::DISPLACEMENT) * MM_PER_M,
        velocity: at(variables::VELOCITY) * MM_PER_M,
        acceleration: at(variables::ACCELERATION) * MM_PER_M,
        cycles: at(variables::CYCLES),
        temperature: at(variables::TEMPERATURE),
        controls,
    }
}

//! The motion that reaches the law when an element stands between the law and the recorded displacement.

use std::sync::Arc;

use mesh_damper::effects::Motion;
use mesh_damper_model::predict::motion_at;
use mesh_damper_recording::trajectory::Trajectory;

use super::families::Form;
use super::solution::Deflection;

/// `trajectory` as the specimen sees it through `moves`, each a form with its shape; and the delay of the force in ticks. A spring
/// in series deflects as in `deflection`, in proportion to its compliance.
///
/// Identification holds that deflection fixed while it solves for the coefficients; the crate solves for both at once.
pub(super) fn moved(
    trajectory: &Trajectory,
    moves: &[(Form, f64)],
    deflection: Option<&Deflection>,
) -> (Trajectory, usize) {
    let mut moved = trajectory.motion_alone();
    let mut ticks = 0;
    // From the measurement to the specimen.
    let mut moves = moves.to_vec();
    moves.sort_by_key(|(form, _)| form.place());
    for (form, shape) in moves {
        ticks += (form.moves)(&mut moved, shape, deflection).unwrap_or_default();
    }
    delay_all(&mut moved, ticks);
    (moved, ticks)
}

/// Applies `change` to the motion, sample by sample.
pub(super) fn through(trajectory: &mut Trajectory, change: impl Fn(&Motion<f64>) -> Motion<f64>) {
    for index in 0..trajectory.len() {
        let inner = change(&motion_at(trajectory, index));
        trajectory.motion.displacement[index] = inner.displacement;
        trajectory.motion.velocity[index] = inner.velocity;
        trajectory.motion.acceleration[index] = inner.acceleration;
    }
}

/// The values of that many ticks ago; before the start, those of the first sample.
pub(super) fn delayed(values: &[f64], ticks: usize) -> Vec<f64> {
    let samples = 0..values.len();
    samples
        .map(|index| values[index.saturating_sub(ticks)])
        .collect()
}

/// Delays all inputs of the law and of the effects in the same way.
fn delay_all(trajectory: &mut Trajectory, ticks: usize) {
    if ticks == 0 {
        return;
    }
    let delay = |values: &mut Vec<f64>| *values = delayed(values, ticks);
    let motion = &mut trajectory.motion;
    delay(&mut motion.displacement);
    delay(&mut motion.velocity);
    delay(&mut motion.acceleration);
    let [cycles, amplitude] = [&mut trajectory.cycles, &mut trajectory.amplitude];
    for shared in [cycles, amplitude] {
        *shared = Arc::new(delayed(shared, ticks));
    }
    if let Some(temperature) = &mut trajectory.temperature {
        delay(temperature);
    }
}

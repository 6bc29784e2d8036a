//! The motion that reaches the law when something stands between it and the recorded displacement.

use mesh_damper::effects::Gap;

use super::solution::Deflection;
use super::term::Form;
use crate::predict::motion_at;
use crate::recording::trajectory::Trajectory;

/// `trajectory` as the specimen sees it through `moves`, each a form with its shape. A spring in series gives way
/// as in `deflection`, in proportion to how soft it is.
///
/// Identification takes that for given while it solves for the coefficients; the crate solves for both at once.
pub(super) fn moved(
    trajectory: &Trajectory,
    moves: &[(Form, f64)],
    deflection: Option<&Deflection>,
) -> Trajectory {
    let mut moved = trajectory.clone();
    for &(form, shape) in moves {
        match form {
            Form::Gap => through_gap(&mut moved, shape, false),
            Form::DampedGap => through_gap(&mut moved, shape, true),
            _ => {}
        }
    }
    for &(form, shape) in moves {
        if let (Form::Compliance, Some(deflection)) = (form, deflection) {
            behind_spring(&mut moved, shape, deflection);
        }
    }
    for &(form, shape) in moves {
        if form == Form::Delay {
            delayed(&mut moved, shape);
        }
    }
    moved
}

fn through_gap(trajectory: &mut Trajectory, half_width: f64, damps_inside: bool) {
    // Out of the crate's range only where nothing moves any more.
    let Ok(gap) = Gap::new(half_width, damps_inside) else {
        return;
    };
    for index in 0..trajectory.len() {
        let inner = gap.transform(&motion_at::<f64>(trajectory, index));
        trajectory.motion.displacement[index] = inner.displacement;
        trajectory.motion.velocity[index] = inner.velocity;
        trajectory.motion.acceleration[index] = inner.acceleration;
    }
}

/// x = y − d
fn behind_spring(trajectory: &mut Trajectory, stiffness: f64, known: &Deflection) {
    let part = known.stiffness / stiffness;
    for (index, (deflection, rate)) in known.deflection.iter().enumerate() {
        trajectory.motion.displacement[index] -= part * deflection;
        trajectory.motion.velocity[index] -= part * rate;
    }
}

/// Everything of `time` s ago, linearly between samples; the first sample's before there was one.
fn delayed(trajectory: &mut Trajectory, time: f64) {
    let samples = time / trajectory.tick;
    let (whole, part) = (samples.floor() as usize, samples.fract());
    let delay = |values: &mut Vec<f64>| {
        let past = |index: usize| values[index.saturating_sub(whole)];
        *values = (0..values.len())
            .map(|index| (1.0 - part) * past(index) + part * past(index.saturating_sub(1)))
            .collect();
    };
    let motion = &mut trajectory.motion;
    delay(&mut motion.displacement);
    delay(&mut motion.velocity);
    delay(&mut motion.acceleration);
    delay(&mut trajectory.cycles);
    if let Some(temperature) = &mut trajectory.temperature {
        delay(temperature);
    }
    let amplitude = &trajectory.amplitude;
    trajectory.amplitude = (0..amplitude.len())
        .map(|index| amplitude[index.saturating_sub(whole)])
        .collect();
}

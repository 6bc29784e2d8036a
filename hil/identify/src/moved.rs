//! The motion that reaches the law when something stands between it and the recorded displacement.

use mesh_damper::effects::{Delay, Gap, Motion};
use mesh_damper_model::predict::motion_at;
use mesh_damper_recording::trajectory::Trajectory;

use super::solution::Deflection;
use super::term::Form;

/// `trajectory` as the specimen sees it through `moves`, each a form with its shape, and how many ticks late the force is. A
/// spring in series gives way as in `deflection`, in proportion to how soft it is.
///
/// Identification takes that for given while it solves for the coefficients; the crate solves for both at once.
pub(super) fn moved(
    trajectory: &Trajectory,
    moves: &[(Form, f64)],
    deflection: Option<&Deflection>,
) -> (Trajectory, usize) {
    let mut moved = trajectory.clone();
    let delay = moves
        .iter()
        .find(|(form, _)| *form == Form::Delay)
        .and_then(|&(_, time)| Delay::new(time, trajectory.tick).ok());
    if let Some(delay) = &delay {
        through(&mut moved, |motion| delay.shifted(motion));
    }
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
    let ticks = delay.map_or(0, |delay| delay.whole_ticks());
    delay_all(&mut moved, ticks);
    (moved, ticks)
}

/// The motion that `change` makes of it, sample by sample.
fn through(trajectory: &mut Trajectory, change: impl Fn(&Motion<f64>) -> Motion<f64>) {
    for index in 0..trajectory.len() {
        let inner = change(&motion_at(trajectory, index));
        trajectory.motion.displacement[index] = inner.displacement;
        trajectory.motion.velocity[index] = inner.velocity;
        trajectory.motion.acceleration[index] = inner.acceleration;
    }
}

fn through_gap(trajectory: &mut Trajectory, half_width: f64, damps_inside: bool) {
    // Out of the crate's range only where nothing moves any more.
    let Ok(gap) = Gap::new(half_width, damps_inside) else {
        return;
    };
    through(trajectory, |motion| gap.transform(motion));
}

/// x = y − d
fn behind_spring(trajectory: &mut Trajectory, stiffness: f64, known: &Deflection) {
    let part = known.stiffness / stiffness;
    for (index, (deflection, rate)) in known.deflection.iter().enumerate() {
        trajectory.motion.displacement[index] -= part * deflection;
        trajectory.motion.velocity[index] -= part * rate;
    }
}

/// The values of so many ticks ago; the first sample's before there was one.
pub(super) fn delayed(values: &[f64], ticks: usize) -> Vec<f64> {
    let samples = 0..values.len();
    samples
        .map(|index| values[index.saturating_sub(ticks)])
        .collect()
}

/// All that the law and the effects see, likewise.
fn delay_all(trajectory: &mut Trajectory, ticks: usize) {
    if ticks == 0 {
        return;
    }
    let delay = |values: &mut Vec<f64>| *values = delayed(values, ticks);
    let motion = &mut trajectory.motion;
    delay(&mut motion.displacement);
    delay(&mut motion.velocity);
    delay(&mut motion.acceleration);
    delay(&mut trajectory.cycles);
    if let Some(temperature) = &mut trajectory.temperature {
        delay(temperature);
    }
    delay(&mut trajectory.amplitude);
}

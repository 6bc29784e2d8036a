//! The conditions of the fitted samples: the zero of the displacement, the temperature, the cycles.

use mesh_damper_recording::trajectory::Trajectory;

use super::Role;
use super::result::OperatingConditions;

/// Conditions of all samples that are not held out; `None` if there are none.
pub(super) fn conditions(recordings: &[(&Trajectory, Vec<Role>)]) -> Option<OperatingConditions> {
    let is_fitted = |role: &Role| *role != Role::HeldOut;
    let fitted = || {
        let some = recordings.iter();
        some.filter(|(_, roles)| roles.iter().any(is_fitted))
    };
    let samples = |of: fn(&Trajectory, usize) -> f64| {
        let each = fitted().flat_map(move |(trajectory, roles)| {
            let open = (0..trajectory.len()).filter(move |&index| is_fitted(&roles[index]));
            open.map(move |index| of(trajectory, index))
        });
        range(each)
    };
    let has_temperature = fitted().all(|(trajectory, _)| trajectory.temperature.is_some());
    Some(OperatingConditions {
        displacement_zero: range(fitted().map(|(trajectory, _)| trajectory.centre))?,
        temperature: has_temperature
            .then(|| samples(Trajectory::temperature_at))
            .flatten(),
        cycles: samples(|trajectory, index| trajectory.cycles[index])?,
    })
}

/// Smallest and largest of the finite values.
fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.filter(|value| value.is_finite());
    finite.fold(None, |range, value| {
        let [low, high] = range.unwrap_or([value; 2]);
        Some([value.min(low), value.max(high)])
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use mesh_damper_recording::Recording;

    #[test]
    fn has_what_is_fitted_and_nothing_of_what_is_held_out() {
        // About 0.3 mm, warmer by a degree a second; the last half is held out.
        let time: Vec<f64> = (0..2000).map(|i| f64::from(i) / 500.0).collect();
        let sine = |t: &f64| 0.1 * (TAU * t).sin();
        let mut recording = Recording::new(
            "test",
            time.clone(),
            time.iter().map(|t| 0.3 + sine(t)).collect(),
            time.iter().map(|t| 2.0 * sine(t)).collect(),
        )
        .unwrap();
        recording.temperature = Some(time.iter().map(|t| 20.0 + t).collect());
        let trajectory = Trajectory::of(&recording).unwrap();
        let role = |index: usize| match index < trajectory.len() / 2 {
            true => Role::Fit,
            false => Role::HeldOut,
        };
        let roles = (0..trajectory.len()).map(role).collect();
        let found = conditions(&[(&trajectory, roles)]).unwrap();
        let [zero, same] = found.displacement_zero;
        assert!(zero == same && (zero - 0.3).abs() < 1e-3, "{found:?}");
        let [low, high] = found.temperature.unwrap();
        assert!(
            (low - 20.0).abs() < 1e-6 && (high - 22.0).abs() < 0.01,
            "{found:?}"
        );
        let [low, high] = found.cycles;
        assert!(low.abs() < 0.1 && (high - 2.0).abs() < 0.1, "{found:?}");
        assert!(conditions(&[(&trajectory, vec![Role::HeldOut; trajectory.len()])]).is_none());
    }
}

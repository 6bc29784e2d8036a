//! Held-out recordings outside the conditions of the fitted samples. Their error is that of an extrapolation.

use mesh_damper_model::extrapolation::Extrapolation;
use mesh_damper_recording::extremes::least_and_largest;

use super::split::Role;
use super::{Trace, Traced};

mesh_damper_recording::numbers! {
    /// The conditions of held-out recordings.
    HeldRangePolicy {
        /// A held-out temperature lies outside the fitted ones if it differs from them by more than this, °C.
        temperature: f64 = 1.5, Derived("the tolerance of a class 1 thermocouple of type K, IEC 60584-1");
    }
}

/// A warning for each held-out recording, and each quantity, outside the conditions of the fitted samples.
pub(super) fn warnings(trace: &Trace) -> Vec<String> {
    let mut warnings = Vec::new();
    let range = trace.fitted_range();
    let is_held = |traced: &&Traced| traced.roles.iter().all(|role| *role == Role::HeldOut);
    for Traced { trajectory, .. } in trace.recordings.iter().filter(is_held) {
        let name = &trajectory.name;
        let motion = Extrapolation::of(
            &range,
            &trajectory.motion.displacement,
            &trajectory.motion.velocity,
        );
        let samples = format!("samples of {name}");
        warnings.extend(
            motion
                .in_words(&samples, "the fitted data")
                .map(|text| format!("{text}; the held-out error is in part an extrapolation")),
        );
        let fitted = trace.result.operating_conditions;
        let Some([low, high]) = fitted.and_then(|fitted| fitted.temperature) else {
            continue;
        };
        let Some(held) = &trajectory.temperature else {
            continue;
        };
        let (least, most) = least_and_largest(held);
        let margin = HeldRangePolicy::in_use().temperature;
        if least < low - margin || most > high + margin {
            warnings.push(format!(
                "{name}: its temperature, {least:.1} … {most:.1} °C, lies outside that of the fitted data, {low:.1} … {high:.1} °C; \
                 the held-out error is in part an extrapolation"
            ));
        }
    }
    warnings
}

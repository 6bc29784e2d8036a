//! The effect of temperature or cycles that the law of a model may have absorbed, if it has no effect for them.
//!
//! A trace does not find an effect that changes the force within the recording by less than the noise or the remainder. The law
//! then has the force at the middle of the recording's temperatures, and is off at both ends.

use mesh_damper::effects::DESCRIPTIONS;
use mesh_damper_identify::trace::VerdictPolicy;
use mesh_damper_model::{Model, ModelError};

use super::Moment;
use super::chance::{Chance, differences, mean_square};
use super::common::CommonMotion;
use super::run::{Held, Run};

/// A quantity other than the motion.
struct Axis {
    common: Option<[f64; 2]>,
    own: fn(&Moment) -> Option<[f64; 2]>,
    depends: fn(&Model) -> bool,
    set: fn(Held, f64) -> Held,
    /// The relative change of the force per unit of the quantity, if no model gives it.
    typical: f64,
}

fn axes(common: &CommonMotion) -> [Axis; 2] {
    [
        Axis {
            common: common.temperature,
            own: |moment| moment.conditions()?.temperature,
            depends: Model::depends_on_temperature,
            set: Held::at_temperature,
            typical: typical_loss(),
        },
        Axis {
            common: common.cycles,
            own: |moment| Some(moment.conditions()?.cycles),
            depends: Model::depends_on_cycles,
            set: Held::after_cycles,
            // All recordings begin with their first cycle.
            typical: 0.0,
        },
    ]
}

/// The part of its force that a specimen loses per degree, from the description of the effect.
fn typical_loss() -> f64 {
    let mut all = DESCRIPTIONS.iter();
    let effect = all.find(|each| each.family == "temperature");
    effect.map_or(0.0, |effect| effect.typical[0].abs())
}

/// The mean square of the possible error of the force of `moment`, kN², on a run with the force `force`.
pub(super) fn chance(
    moment: &Moment,
    force: &[f64],
    moments: &[Moment],
    (common, run): (&CommonMotion, &Run),
) -> Result<Chance, ModelError> {
    let mut all = Chance {
        sum: 0.0,
        squares: 0.0,
    };
    for axis in axes(common) {
        if (axis.depends)(&moment.model.model()) {
            continue;
        }
        if let Some((common, own)) = axis.common.zip((axis.own)(moment)) {
            all = all.and(Chance::of(off(
                &axis, common, own, moment, force, moments, run,
            )?));
        }
    }
    Ok(all)
}

fn off(
    axis: &Axis,
    common: [f64; 2],
    own: [f64; 2],
    moment: &Moment,
    force: &[f64],
    moments: &[Moment],
    run: &Run,
) -> Result<f64, ModelError> {
    let middle = 0.5 * (own[0] + own[1]);
    // For a uniform distribution of values.
    let deviation = (own[1] - own[0]) / 12.0_f64.sqrt();
    let unseen = moment.trace.as_ref().map_or(f64::INFINITY, |trace| {
        let noise = trace.noise_floor_nrmse;
        // A trace attributes a remainder up to this multiple of the noise to noise; a larger remainder is seen.
        let limited = VerdictPolicy::in_use().noise_limited * noise;
        let errors = trace.augmented;
        let error = errors.nrmse_fitted.max(errors.nrmse_held_out).max(limited);
        (error * error - noise * noise).sqrt()
    });
    let size = mean_square(force);
    // A temperature that rises with the cycles is found as an effect of either. One that differs between amplitudes is found as
    // coefficients over amplitude or as a residual table. In these cases the remainder gives no limit.
    let own_model = moment.model.model();
    let takes_in = own_model.depends_on_temperature()
        || own_model.depends_on_cycles()
        || own_model.law.len() > 1
        || own_model.correction.is_some();
    let mut squares = 0.0;
    for end in common {
        let distance = (end - middle).abs();
        let by_noise = match deviation > 0.0 && !takes_in {
            true => (unseen * distance / deviation).powi(2) * size,
            false => f64::INFINITY,
        };
        let mut by_effect: Option<f64> = None;
        for other in moments {
            let model = other.model.model();
            if (axis.depends)(&model) {
                let at = |value| run.held(&model, 0.0, &(axis.set)(run.middle(), value));
                let change = mean_square(&differences(&at(end)?, &at(middle)?));
                by_effect = Some(by_effect.map_or(change, |known| known.max(change)));
            }
        }
        let by_effect = by_effect.unwrap_or((axis.typical * distance).powi(2) * size);
        squares += 0.5 * by_noise.min(by_effect);
    }
    Ok(squares)
}

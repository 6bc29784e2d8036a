//! The force of models on one motion: it describes the specimen independently of the parameters.

use mesh_damper_model::ModelError;
use mesh_damper_model::file::model_error;
use mesh_damper_output::error::InputError;
use serde::Serialize;

use super::chance::{Chance, Spread, differences, mean_product, mean_square};
use super::common::CommonMotion;
use super::run::Run;
use super::unexcited::{self, Undecided};
use super::{ComparePolicy, EffectChange, Moment, hidden};

/// The force of a model compared with the force of the first model.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForceChange {
    /// The model, counted from 0.
    pub model: usize,
    /// RMS of the difference of the forces over the RMS of the first model's force. If the zeros of the two models differ, the
    /// smallest ratio for any zero between them.
    pub difference: f64,
    /// RMS of the model's force over the RMS of the first model's force.
    pub ratio: f64,
    /// The ratio of the difference expected for an unchanged specimen. It follows from the intervals of the parameters, from the models' remainders
    /// beyond the noise, and from effects of temperature or cycles that a law may have absorbed. Null if intervals are not known.
    pub expected: Option<f64>,
    /// The probability, 0…1, of a difference this large for an unchanged specimen; null if intervals are not known.
    pub p: Option<f64>,
    /// Whether a change is claimed.
    pub changed: bool,
    /// The assumed position of the model's zero above the first model's zero, mm.
    pub shift_mm: f64,
    /// The place of the largest difference.
    pub largest: Place,
}

/// A place of the motion, and the difference of the forces there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Place {
    /// Displacement, mm, in the coordinates of the first model's recordings.
    pub displacement_mm: f64,
    /// Velocity, mm/s.
    pub velocity_mm_s: f64,
    /// Temperature, °C.
    #[serde(rename = "temperature_degC")]
    pub temperature: f64,
    /// Cycles since a recording began.
    pub cycles: f64,
    /// The model's force minus the first model's force, kN.
    #[serde(rename = "difference_kN")]
    pub difference: f64,
    /// The same difference over the RMS of the first model's force.
    pub part: f64,
}

/// The results from the forces of all models.
pub(super) struct Found {
    /// For every model except the first.
    pub changes: Vec<ForceChange>,
    /// Effects that the motion does not show.
    pub undecided: Vec<Undecided>,
    /// For each model, whether its law may hide a larger effect of temperature or cycles than its intervals say: its coefficients
    /// are off by that.
    pub hides: Vec<bool>,
}

/// Compares the force of every model with that of the first, and finds effects that the motion does not show.
pub(super) fn changes(
    moments: &[Moment],
    common: &CommonMotion,
    effects: &[EffectChange],
    numbers: &ComparePolicy,
    notes: &mut Vec<String>,
) -> Result<Found, InputError> {
    let zero = moments[0].zero();
    let forces = Forces {
        run: &Run::new(common, zero, &moments.iter().collect::<Vec<_>>(), numbers),
        moments,
        common,
        numbers,
    };
    let refused = |model: usize| {
        let name = &moments[model].name;
        move |error: ModelError| model_error(name, &error)
    };
    let (first, hides) = forces.spread(0, 0.0).map_err(refused(0))?;
    let mut changes = Vec::new();
    let (mut chances, mut hides) = (vec![first.chance], vec![hides]);
    for model in 1..moments.len() {
        let (mut change, chance, hides_more) =
            forces.beside(&first, model).map_err(refused(model))?;
        if change.ratio.max(1.0 / change.ratio) >= numbers.another_size {
            notes.push(format!(
                "the force of {} is {:.1e} times that of {}: check the units of the recordings' displacement and force",
                moments[model].name, change.ratio, moments[0].name
            ));
        }
        let [least, largest] = shifts(&moments[0], &moments[model], numbers);
        if least < largest {
            let has_nodes = |moment: &Moment| moment.model.model().law.len() > 1;
            notes.push(format!(
                "{} has its zero at {:.4} mm, {} at {:.4} mm. Either the specimen or the sensor's zero may have moved, so the difference given is the \
                 smallest over all zeros between the two",
                moments[0].name,
                zero,
                moments[model].name,
                moments[model].zero()
            ));
            if has_nodes(&moments[0]) || has_nodes(&moments[model]) {
                notes.push(format!(
                    "{} cannot be compared with {}: a law with an amplitude grid is valid about its own zero only",
                    moments[model].name, moments[0].name
                ));
                (change.p, change.expected) = (None, None);
            }
        }
        chances.push(chance);
        hides.push(hides_more);
        changes.push(change);
    }
    for (moment, _) in moments
        .iter()
        .zip(&chances)
        .filter(|(moment, chance)| moment.trace.is_some() && chance.is_none())
    {
        notes.push(format!(
            "the uncertainty of the force of {} is unknown, because its recordings do not bound a parameter, or cannot tell parameters apart: \
             trace more recordings of that time together, with other amplitudes and frequencies",
            moment.name
        ));
    }
    let mut undecided = Vec::new();
    for effect in effects {
        let pair = chances[effect.model].zip(chances[effect.model - 1]);
        if let Some((one, other)) = pair {
            let chance = one.and(other);
            undecided.extend(unexcited::of(effect, moments, forces.run, chance, numbers)?);
        }
    }
    Ok(Found {
        changes,
        undecided,
        hides,
    })
}

/// The range of possible positions of the zero of `other` above that of `first`, mm: either the same place on the specimen, if the
/// sensor's zero moved, or the value of the sensor. Each zero that was subtracted has its own error.
fn shifts(first: &Moment, other: &Moment, numbers: &ComparePolicy) -> [f64; 2] {
    let apart = other.zero() - first.zero();
    let error = |moment: &Moment| {
        let [low, high] = moment.model.displacement_zero();
        let [least, largest] = moment.model.fitted_range().displacement;
        let taken = 0.5 * numbers.zero_error * (largest - least);
        match low == 0.0 && high == 0.0 {
            true => 0.0,
            false => 0.5 * (high - low) + taken,
        }
    };
    let error = error(first) + error(other);
    [apart.min(0.0) - error, apart.max(0.0) + error]
}

struct Forces<'a> {
    run: &'a Run,
    moments: &'a [Moment],
    common: &'a CommonMotion,
    numbers: &'a ComparePolicy,
}

impl Forces<'_> {
    /// Also returns whether it may hide more than its intervals say.
    fn spread(&self, model: usize, shift: f64) -> Result<(Spread, bool), ModelError> {
        let moment = &self.moments[model];
        let mut spread = Spread::of(moment, self.run, shift, self.numbers)?;
        let of_run = (self.common, self.run);
        let hidden = hidden::chance(moment, &spread.force, self.moments, of_run)?;
        let hides = spread.chance.is_some_and(|own| hidden.sum > own.sum);
        spread.chance = spread.chance.map(|chance| chance.and(hidden));
        Ok((spread, hides))
    }

    /// A model compared to the `first`, its own chance, and whether it hides more than its intervals say.
    fn beside(
        &self,
        first: &Spread,
        model: usize,
    ) -> Result<(ForceChange, Option<Chance>, bool), ModelError> {
        let shift = self.likely_shift(first, model)?;
        let (spread, hides) = self.spread(model, shift)?;
        let off = differences(&spread.force, &first.force);
        let scale = mean_square(&first.force);
        let chance = first.chance.zip(spread.chance).map(|(a, b)| a.and(b));
        let difference = mean_square(&off);
        let largest = (0..off.len()).max_by(|&a, &b| off[a].abs().total_cmp(&off[b].abs()));
        let largest = largest.unwrap_or_default();
        let at = &self.run.kept[largest];
        let change = ForceChange {
            model,
            difference: (difference / scale).sqrt(),
            ratio: (mean_square(&spread.force) / scale).sqrt(),
            expected: chance.map(|chance| (chance.sum / scale).sqrt()),
            p: chance.and_then(|chance| chance.exceeds(difference)),
            changed: false,
            shift_mm: shift,
            largest: Place {
                displacement_mm: at.displacement + self.moments[0].zero(),
                velocity_mm_s: at.velocity,
                temperature: at.held.temperature,
                cycles: at.held.cycles,
                difference: off[largest],
                part: off[largest] / scale.sqrt(),
            },
        };
        Ok((change, spread.chance, hides))
    }

    /// The possible shift for which the two forces differ least, by Gauss–Newton from the better end.
    fn likely_shift(&self, first: &Spread, model: usize) -> Result<f64, ModelError> {
        let moment = &self.moments[model];
        let [least, largest] = shifts(&self.moments[0], moment, self.numbers);
        if least == largest {
            return Ok(least);
        }
        let model = moment.model.model();
        let off = |shift: f64| -> Result<Vec<f64>, ModelError> {
            Ok(differences(&self.run.force(&model, shift)?, &first.force))
        };
        let mut best = (f64::INFINITY, least);
        for end in [least, largest] {
            let square = mean_square(&off(end)?);
            if square < best.0 {
                best = (square, end);
            }
        }
        let mut shift = best.1;
        for _ in 0..SHIFT_STEPS {
            // Away from the nearer end.
            let step = match shift < 0.5 * (least + largest) {
                true => SHIFT_STEP * (largest - least),
                false => -SHIFT_STEP * (largest - least),
            };
            let here = off(shift)?;
            let slope = differences(&off(shift + step)?, &here);
            let size = mean_square(&slope);
            if size == 0.0 {
                break;
            }
            shift -= step * mean_product(&here, &slope) / size;
            shift = shift.clamp(least, largest);
            let square = mean_square(&off(shift)?);
            if square < best.0 {
                best = (square, shift);
            }
        }
        Ok(best.1)
    }
}

/// Steps towards the likeliest shift. They bound a loop: the forces are cubic in the shift, and the third step changes nothing
/// visible.
const SHIFT_STEPS: usize = 4;
/// The fraction of the range of shifts over which a slope is taken. Any value works that is small compared to the range and large
/// compared to rounding.
const SHIFT_STEP: f64 = 1e-3;

//! The common conditions of all models: the motion, the temperature, the cycles, the control inputs.

use mesh_damper_model::Control;
use mesh_damper_output::error::InputError;
use serde::Serialize;

use super::{ComparePolicy, Moment};

/// The conditions of the comparison: the range in which all models were fitted, at both ends of temperature, cycles and control
/// inputs.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CommonMotion {
    /// Smallest and largest displacement, mm, in the coordinates of the first model's recordings.
    pub displacement_mm: [f64; 2],
    /// Largest velocity in either direction, mm/s.
    pub velocity_mm_s: f64,
    /// Smallest and largest temperature, °C; null if it is not known for all.
    #[serde(rename = "temperature_degC")]
    pub temperature: Option<[f64; 2]>,
    /// Smallest and largest number of cycles since a recording began; null if it is not known for all.
    pub cycles: Option<[f64; 2]>,
    /// Control inputs with the smallest and the largest value.
    pub controls: Vec<Control>,
}

impl CommonMotion {
    /// The conditions in which one model was fitted, relative to its own zero.
    pub(super) fn own(moment: &Moment) -> Self {
        let range = moment.model.fitted_range();
        let [slow, fast] = range.velocity;
        let conditions = moment.conditions();
        Self {
            displacement_mm: range.displacement,
            velocity_mm_s: fast.min(-slow),
            temperature: conditions.and_then(|conditions| conditions.temperature),
            cycles: conditions.map(|conditions| conditions.cycles),
            controls: moment.model.model().controls,
        }
    }

    /// The conditions in which every model was fitted. Each displacement is within the range of every model, whether its zero is a
    /// place on the specimen or one of the sensor.
    pub(super) fn of(
        moments: &[Moment],
        numbers: &ComparePolicy,
        notes: &mut Vec<String>,
    ) -> Result<Self, InputError> {
        for moment in moments {
            if !moment.knows_zero() {
                return Err(cannot(
                    format!(
                        "the displacement's zero of {} was subtracted, but its trace.json does not state it",
                        moment.name
                    ),
                    "trace its recordings again",
                ));
            }
        }
        Ok(Self {
            displacement_mm: displacement(moments)?,
            velocity_mm_s: velocity(moments)?,
            temperature: temperature(moments, numbers, notes)?,
            cycles: cycles(moments)?,
            controls: controls(moments)?,
        })
    }
}

pub(super) fn cannot(why: String, remedy: impl Into<String>) -> InputError {
    InputError::new("the models", format!("cannot be compared: {why}"), remedy)
}

/// The common part of ranges.
fn shared(ranges: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    ranges.fold([f64::NEG_INFINITY, f64::INFINITY], |all, [low, high]| {
        [all[0].max(low), all[1].min(high)]
    })
}

/// The model whose range begins last, and the one whose range ends first: if these have no common part, all have none.
fn apart<'a>(ranges: &[(&'a Moment, [f64; 2])]) -> Option<[(&'a Moment, [f64; 2]); 2]> {
    let last = ranges.iter().max_by(|a, b| a.1[0].total_cmp(&b.1[0]))?;
    let first = ranges.iter().min_by(|a, b| a.1[1].total_cmp(&b.1[1]))?;
    Some([*first, *last])
}

/// The message that two models have no common part of a quantity.
fn nothing_shared(
    ranges: &[(&Moment, [f64; 2])],
    what: &str,
    unit: &str,
    remedy: &str,
) -> InputError {
    let said = |(moment, [low, high]): (&Moment, [f64; 2])| {
        format!("{} has {low:.4} to {high:.4} {unit}", moment.name)
    };
    let pair =
        apart(ranges).map_or_else(String::new, |[a, b]| format!(" ({}, {})", said(a), said(b)));
    cannot(format!("they share no {what}{pair}"), remedy)
}

fn displacement(moments: &[Moment]) -> Result<[f64; 2], InputError> {
    let first = moments[0].zero();
    let placed: Vec<(&Moment, [f64; 2])> = moments
        .iter()
        .map(|moment| {
            let [low, high] = moment.model.fitted_range().displacement;
            (moment, [low + moment.zero(), high + moment.zero()])
        })
        .collect();
    let as_is = moments.iter().map(|moment| {
        let [low, high] = moment.model.fitted_range().displacement;
        [low + first, high + first]
    });
    let [low, high] = shared(placed.iter().map(|(_, range)| *range).chain(as_is));
    if high > low {
        return Ok([low, high]);
    }
    Err(nothing_shared(
        &placed,
        "displacement",
        "mm",
        "record them about one position; if the sensor's zero moved, subtract the shift from the recordings and trace them again",
    ))
}

fn velocity(moments: &[Moment]) -> Result<f64, InputError> {
    let ranges = moments
        .iter()
        .map(|moment| moment.model.fitted_range().velocity);
    let [low, high] = shared(ranges);
    let largest = high.min(-low);
    if largest > 0.0 {
        return Ok(largest);
    }
    Err(cannot(
        "they share no velocities of both signs".to_owned(),
        "record a motion in both directions, and trace it again",
    ))
}

/// Those that have intervals: nothing is claimed about the others.
fn claimed(moments: &[Moment]) -> impl Iterator<Item = &Moment> {
    moments.iter().filter(|moment| moment.trace.is_some())
}

fn temperature(
    moments: &[Moment],
    numbers: &ComparePolicy,
    notes: &mut Vec<String>,
) -> Result<Option<[f64; 2]>, InputError> {
    let known =
        claimed(moments).filter_map(|moment| Some((moment, moment.conditions()?.temperature?)));
    let known: Vec<(&Moment, [f64; 2])> = known.collect();
    let unknown = claimed(moments).find(|moment| {
        let conditions = moment.conditions();
        conditions.is_none_or(|conditions| conditions.temperature.is_none())
    });
    if let Some(unknown) = unknown {
        let mut depending = moments.iter();
        if let Some(other) = depending.find(|other| other.model.model().depends_on_temperature()) {
            return Err(cannot(
                format!(
                    "the force of {} depends on the temperature, but the temperature of {} is unknown",
                    other.name, unknown.name
                ),
                "record the temperature with each, and trace them again",
            ));
        }
        notes.push(format!(
            "the temperature of {} is unknown: a change may come from the temperature",
            unknown.name
        ));
        return Ok(None);
    }
    if known.is_empty() {
        return Ok(None);
    }
    let [low, high] = shared(known.iter().map(|(_, range)| *range));
    if low <= high {
        return Ok(Some([low, high]));
    }
    if low - high <= numbers.same_temperature {
        return Ok(Some([0.5 * (low + high); 2]));
    }
    Err(nothing_shared(
        &known,
        "temperature",
        "°C",
        "record them at one temperature, or over a range that they share",
    ))
}

fn cycles(moments: &[Moment]) -> Result<Option<[f64; 2]>, InputError> {
    let known = claimed(moments).filter_map(|moment| Some((moment, moment.conditions()?.cycles)));
    let known: Vec<(&Moment, [f64; 2])> = known.collect();
    let mut depending = moments.iter();
    let depending = depending.find(|moment| moment.model.model().depends_on_cycles());
    if known.len() < claimed(moments).count() || known.is_empty() {
        return match depending {
            Some(depending) if claimed(moments).count() > 0 => Err(cannot(
                format!(
                    "the force of {} depends on the number of cycles, which the trace.json of another model does not state",
                    depending.name
                ),
                "trace their recordings again",
            )),
            _ => Ok(None),
        };
    }
    let [low, high] = shared(known.iter().map(|(_, range)| *range));
    match depending {
        _ if low <= high => Ok(Some([low, high])),
        None => Ok(None),
        Some(_) => Err(nothing_shared(
            &known,
            "number of cycles",
            "cycles",
            "record as many cycles with each",
        )),
    }
}

fn controls(moments: &[Moment]) -> Result<Vec<Control>, InputError> {
    let first = moments[0].model.model().controls;
    let names = |moment: &Moment| {
        let controls = moment.model.model().controls;
        let names = controls.into_iter().map(|control| control.name);
        names.collect::<Vec<_>>()
    };
    if let Some(other) = moments
        .iter()
        .find(|moment| names(moment) != names(&moments[0]))
    {
        let said = |names: Vec<String>| match names.is_empty() {
            true => "none".to_owned(),
            false => names.join(", "),
        };
        return Err(cannot(
            format!(
                "they have different control inputs ({}: {}; {}: {})",
                moments[0].name,
                said(names(&moments[0])),
                other.name,
                said(names(other))
            ),
            "compare models with the same control inputs",
        ));
    }
    let each = first.iter().enumerate().map(|(place, control)| {
        let ranges = moments
            .iter()
            .map(|moment| (moment, moment.model.model().controls[place].range));
        let ranges: Vec<(&Moment, [f64; 2])> = ranges.collect();
        let [low, high] = shared(ranges.iter().map(|(_, range)| *range));
        if low > high {
            return Err(nothing_shared(
                &ranges,
                &format!("value of {}", control.name),
                "",
                "record them under values that they share",
            ));
        }
        Ok(Control {
            name: control.name.clone(),
            range: [low, high],
        })
    });
    each.collect()
}

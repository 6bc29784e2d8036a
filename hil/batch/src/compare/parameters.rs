//! Parameters of the law and of effects, from model to model.

use mesh_damper_identify::trace::result::Estimate;
use mesh_damper_model::predict::NINETY_PERCENT;
use mesh_damper_model::{base_name, parameter_unit};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF as _};

use super::{ComparePolicy, Moment};

/// A parameter in all models.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterChange {
    /// The owner of the parameter: `law`, or the family of the effect.
    pub of: String,
    /// For a parameter of the law, the amplitude of the coefficient, mm; 0 if it holds for all amplitudes. Null for a parameter of
    /// an effect.
    pub amplitude_mm: Option<f64>,
    /// The parameter's name.
    pub parameter: String,
    /// The unit of its values.
    pub unit: String,
    /// Its value in each model; null if a model has no such parameter.
    pub values: Vec<Option<Bounds>>,
    /// The model, counted from 0, whose value differs most from the first model's value, relative to its interval; null if no
    /// values can be compared.
    pub most_in: Option<usize>,
    /// The value of that model minus the first model's value, relative to the first value's magnitude.
    pub change: Option<f64>,
    /// The probability, 0…1, of values this different if the parameter is the same in all models; null if not known.
    pub p: Option<f64>,
    /// Whether a change of the parameter is claimed. This requires a claimed change of the force.
    pub changed: bool,
}

/// A value and its 90 % interval. An end is null if it is not known, or if the data set no bound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bounds {
    /// The value in the model, in the unit of the parameter.
    pub value: f64,
    /// Lower end, in the same unit.
    pub low: Option<f64>,
    /// Upper end, in the same unit.
    pub high: Option<f64>,
}

impl Bounds {
    /// A value of a model, with the interval that its trace gives for the same value.
    fn of(value: f64, estimate: Option<&Estimate>) -> Self {
        // A law that was not adopted has other values: their intervals do not apply here.
        let of_this =
            estimate.filter(|estimate| (estimate.value - value).abs() <= 1e-9 * value.abs());
        let finite = |end: f64| end.is_finite().then_some(end);
        Self {
            value,
            low: of_this.and_then(|estimate| finite(estimate.low)),
            high: of_this.and_then(|estimate| finite(estimate.high)),
        }
    }

    /// Its standard deviation, if known.
    pub(super) fn deviation(&self, numbers: &ComparePolicy) -> Option<f64> {
        let half = 0.5 * (self.high? - self.low?);
        (half > 0.0).then(|| numbers.widened * half / NINETY_PERCENT)
    }
}

/// One parameter of a model: its owner, amplitude, name and value.
pub(super) struct Parameter {
    pub of: String,
    pub amplitude: Option<f64>,
    pub name: String,
    pub bounds: Bounds,
}

/// All parameters of a model.
pub(super) fn of_model(moment: &Moment) -> Vec<Parameter> {
    let model = moment.model.model();
    let trace = moment.trace.as_ref();
    let mut all = Vec::new();
    for (place, node) in model.law.iter().enumerate() {
        let known = trace.and_then(|trace| trace.law.get(place));
        for (name, value, estimate) in [
            ("k1", node.k1, known.map(|known| &known.k1)),
            ("k3", node.k3, known.map(|known| &known.k3)),
            ("c", node.c, known.map(|known| &known.c)),
            ("alpha", node.alpha, known.map(|known| &known.alpha)),
        ] {
            all.push(Parameter {
                of: "law".to_owned(),
                amplitude: Some(node.amplitude),
                name: name.to_owned(),
                bounds: Bounds::of(value, estimate),
            });
        }
    }
    for effect in &model.effects {
        let known = trace.and_then(|trace| {
            let mut found = trace.effects.iter().chain(&trace.unconfirmed);
            found.find(|found| found.family == effect.family.name())
        });
        for (name, &value) in &effect.parameters {
            all.push(Parameter {
                of: effect.family.name().to_owned(),
                amplitude: None,
                name: name.clone(),
                bounds: Bounds::of(value, known.and_then(|known| known.parameters.get(name))),
            });
        }
    }
    all
}

/// The parameters of all models. They are compared if the models have the same effects, and laws at the same amplitudes about one
/// zero, that do not hide an effect of temperature or cycles.
pub(super) fn changes(
    moments: &[Moment],
    hides: &[bool],
    numbers: &ComparePolicy,
    notes: &mut Vec<String>,
) -> Vec<ParameterChange> {
    let of_models: Vec<Vec<Parameter>> = moments.iter().map(of_model).collect();
    let same_amplitude =
        |a: f64, b: f64| (a - b).abs() <= numbers.same_amplitude * a.abs().max(b.abs());
    let is_same = |a: &Parameter, b: &Parameter| {
        let at_same = match (a.amplitude, b.amplitude) {
            (Some(a), Some(b)) => same_amplitude(a, b),
            (None, None) => true,
            _ => false,
        };
        a.of == b.of && a.name == b.name && at_same
    };
    let is_alike = |moment: &Moment| {
        let amplitudes = |moment: &Moment| {
            moment
                .model
                .model()
                .law
                .iter()
                .map(|node| node.amplitude)
                .collect::<Vec<_>>()
        };
        let (own, first) = (amplitudes(moment), amplitudes(&moments[0]));
        let same_law =
            own.len() == first.len() && own.iter().zip(&first).all(|(&a, &b)| same_amplitude(a, b));
        // About another zero the same force has other coefficients.
        let same_zero = moment.model.displacement_zero() == moments[0].model.displacement_zero();
        same_law && same_zero && moment.families() == moments[0].families()
    };
    let mut alike: Vec<bool> = moments.iter().map(is_alike).collect();
    for (moment, _) in moments.iter().zip(&alike).filter(|(_, alike)| !**alike) {
        notes.push(format!(
            "{} and {} differ in effects, amplitude grid or zero: their forces are compared, their parameters are not",
            moment.name, moments[0].name
        ));
    }
    for (moment, _) in moments.iter().zip(hides).filter(|(_, hides)| **hides) {
        notes.push(format!(
            "the law of {} may include effects of temperature or cycles beyond its intervals: its parameters are not compared",
            moment.name
        ));
    }
    // The others are compared with the first.
    for (alike, own) in alike.iter_mut().zip(hides) {
        *alike = *alike && !own && !hides[0];
    }
    let mut distinct: Vec<&Parameter> = Vec::new();
    for parameter in of_models.iter().flatten() {
        if !distinct.iter().any(|known| is_same(known, parameter)) {
            distinct.push(parameter);
        }
    }
    distinct
        .into_iter()
        .map(|parameter| {
            let of_model = |all: &Vec<Parameter>| {
                let mut own = all.iter().filter(|other| is_same(parameter, other));
                own.next().map(|own| own.bounds)
            };
            let values: Vec<Option<Bounds>> = of_models.iter().map(of_model).collect();
            let compared: Vec<Bounds> = values
                .iter()
                .zip(&alike)
                .filter_map(|(bounds, alike)| bounds.filter(|_| *alike))
                .collect();
            let places = values.iter().zip(&alike).enumerate();
            let places = places
                .filter_map(|(place, (bounds, alike))| Some((place, bounds.filter(|_| *alike)?)));
            let most = most_off(&places.collect::<Vec<_>>(), numbers);
            ParameterChange {
                of: parameter.of.clone(),
                amplitude_mm: parameter.amplitude,
                parameter: parameter.name.clone(),
                unit: parameter_unit(&parameter.name)
                    .map_or_else(|| law_unit(&parameter.name), str::to_owned),
                values,
                most_in: most.map(|(model, _)| model),
                change: most.and_then(|(_, change)| change),
                p: match of_models.iter().any(|all| has_several(all, parameter)) {
                    true => None,
                    false => chance(&compared, numbers),
                },
                changed: false,
            }
        })
        .collect()
}

/// The model whose value is farthest from the first one's, in deviations if all have one; and the relative difference.
fn most_off(values: &[(usize, Bounds)], numbers: &ComparePolicy) -> Option<(usize, Option<f64>)> {
    let ((_, first), others) = values.split_first()?;
    let is_known = |bounds: &Bounds| bounds.deviation(numbers).is_some();
    let all_known = values.iter().all(|(_, bounds)| is_known(bounds));
    let distance = |bounds: &Bounds| {
        let apart = (bounds.value - first.value).abs();
        let deviations = first.deviation(numbers).zip(bounds.deviation(numbers));
        match deviations.filter(|_| all_known) {
            Some((a, b)) => apart / a.hypot(b),
            None => apart,
        }
    };
    let farthest = others
        .iter()
        .max_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
    let (model, bounds) = farthest?;
    let change = (bounds.value - first.value) / first.value.abs();
    Some((*model, (first.value != 0.0).then_some(change)))
}

/// Whether its effect has several elements: these share the force, so only their total force shows a change.
fn has_several(all: &[Parameter], parameter: &Parameter) -> bool {
    let mut own = all.iter().filter(|other| other.of == parameter.of);
    parameter.amplitude.is_none() && own.any(|other| base_name(&other.name) != other.name)
}

/// The unit of a coefficient of the law.
fn law_unit(name: &str) -> String {
    match name {
        "k1" => "kN/mm",
        "k3" => "kN/mm^3",
        "c" => "kN*(s/mm)^alpha",
        _ => "1",
    }
    .to_owned()
}

/// The chance that values of one parameter scatter this much: χ² of their distances from their weighted mean. `None` if fewer than
/// two have an interval.
fn chance(values: &[Bounds], numbers: &ComparePolicy) -> Option<f64> {
    let known: Vec<(f64, f64)> = values
        .iter()
        .filter_map(|bounds| Some((bounds.value, bounds.deviation(numbers)?.powi(-2))))
        .collect();
    let freedom = known.len().checked_sub(1).filter(|freedom| *freedom > 0)?;
    let weights: f64 = known.iter().map(|(_, weight)| weight).sum();
    let mean = known
        .iter()
        .map(|(value, weight)| weight * value)
        .sum::<f64>()
        / weights;
    let scatter = known
        .iter()
        .map(|(value, weight)| weight * (value - mean).powi(2))
        .sum();
    Some(ChiSquared::new(freedom as f64).ok()?.sf(scatter))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(value: f64, half: f64) -> Bounds {
        Bounds {
            value,
            low: Some(value - half),
            high: Some(value + half),
        }
    }

    #[test]
    fn the_model_that_is_off_is_named_though_the_last_is_as_the_first() {
        let numbers = ComparePolicy::default();
        let values = [
            (0, bounds(2.0, 0.1)),
            (1, bounds(2.1, 0.1)),
            (3, bounds(1.999, 0.1)),
        ];
        let (model, change) = most_off(&values, &numbers).unwrap();
        assert!(model == 1 && (change.unwrap() - 0.05).abs() < 1e-12);
        // A wide interval says less.
        let values = [
            (0, bounds(2.0, 0.1)),
            (1, bounds(2.1, 9.0)),
            (2, bounds(1.95, 0.1)),
        ];
        assert_eq!(most_off(&values, &numbers).unwrap().0, 2);
        assert_eq!(most_off(&values[..1], &numbers), None);
    }

    #[test]
    fn two_values_differ_by_the_chance_of_a_normal_variable() {
        let numbers = ComparePolicy::default();
        let chance = |values: &[Bounds]| chance(values, &numbers);
        // 1.645 deviations of a difference whose deviation is √2 of theirs: 10 %.
        let apart = 2.0_f64.sqrt() * NINETY_PERCENT * numbers.widened;
        let p = chance(&[
            bounds(5.0, NINETY_PERCENT),
            bounds(5.0 + apart, NINETY_PERCENT),
        ])
        .unwrap();
        assert!((p - 0.1).abs() < 1e-3, "{p}");
        // A value without a known interval makes no difference.
        let unknown = Bounds {
            high: None,
            ..bounds(99.0, 1.0)
        };
        let with = chance(&[
            bounds(5.0, NINETY_PERCENT),
            unknown,
            bounds(5.0 + apart, NINETY_PERCENT),
        ]);
        assert_eq!(with, Some(p));
        assert_eq!(chance(&[bounds(1.0, 1.0), unknown]), None);
        let same = chance(&[bounds(5.0, 1.0), bounds(5.0, 2.0), bounds(5.0, 0.1)]).unwrap();
        assert!((same - 1.0).abs() < 1e-12);
    }
}

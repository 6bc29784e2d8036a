//! The force of models on one motion: what they say of the specimen, whatever parameters say it.

use std::f64::consts::TAU;

use mesh_damper::effects::{CONTROLS, Motion};
use mesh_damper_model::file::model_error;
use mesh_damper_model::{Model, ModelError};
use mesh_damper_recording::error::InputError;
use mesh_damper_reference::protocol::{MotionSample, TestBlock, motion};
use nalgebra::{Cholesky, DMatrix};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF as _};

use super::parameters::{Parameter, of_model};
use super::{ComparePolicy, Moment};

/// Temperature of the motion, °C: that of a recording without one.
const ROOM: f64 = 20.0;

/// The motion that all models are put through: sines at parts of the range that all were fitted in, beside each other in amplitude and in
/// velocity.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CommonMotion {
    /// Largest displacement, mm.
    pub displacement_mm: f64,
    /// Largest velocity, mm/s.
    pub velocity_mm_s: f64,
    /// Control inputs, in the middle of what all were fitted under.
    pub controls: Vec<(String, f64)>,
}

/// The force of a model beside that of the first.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForceChange {
    /// The model, counted from 0.
    pub model: usize,
    /// RMS of the difference of the forces over the RMS of the first one's.
    pub difference: f64,
    /// The ratio that is expected of a specimen that did not change: by the intervals of the parameters, and by what the models leave beyond the
    /// noise. Null where intervals are not known.
    pub expected: Option<f64>,
    /// The chance, 0…1, of a difference as large as this of a specimen that did not change; null where intervals are not known.
    pub p: Option<f64>,
    /// Whether a change is claimed.
    pub changed: bool,
    /// Where the difference is largest.
    pub largest: Place,
}

/// A place of the motion, and the difference there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Place {
    /// Displacement, mm.
    pub displacement_mm: f64,
    /// Velocity, mm/s.
    pub velocity_mm_s: f64,
    /// The model's force less the first one's, kN.
    #[serde(rename = "difference_kN")]
    pub difference: f64,
    /// The same over the RMS of the first one's force.
    pub part: f64,
}

impl CommonMotion {
    /// The largest that every model was fitted on.
    pub(super) fn of(moments: &[Moment]) -> Result<Self, InputError> {
        let reach = |[low, high]: [f64; 2]| low.abs().max(high.abs());
        let least = |of: fn(&Moment) -> [f64; 2]| {
            moments
                .iter()
                .map(|moment| reach(of(moment)))
                .fold(f64::INFINITY, f64::min)
        };
        let displacement = least(|moment| moment.model.fitted_range().displacement);
        let velocity = least(|moment| moment.model.fitted_range().velocity);
        if !(displacement > 0.0 && velocity > 0.0) {
            return Err(InputError::new(
                "the models",
                "have no motion in common: the operating range of one is empty",
                "trace its recording again",
            ));
        }
        let first = moments[0].model.model().controls;
        let mut controls = Vec::new();
        for (place, control) in first.iter().enumerate() {
            let [mut low, mut high] = control.range;
            for moment in moments {
                let own = moment.model.model().controls;
                let Some(same) = own.get(place).filter(|own| own.name == control.name) else {
                    return Err(other_controls(moment, &moments[0]));
                };
                low = low.max(same.range[0]);
                high = high.min(same.range[1]);
            }
            controls.push((control.name.clone(), 0.5 * (low + high)));
        }
        match moments
            .iter()
            .find(|moment| moment.model.model().controls.len() != first.len())
        {
            Some(moment) => Err(other_controls(moment, &moments[0])),
            None => Ok(Self {
                displacement_mm: displacement,
                velocity_mm_s: velocity,
                controls,
            }),
        }
    }

    /// The blocks, and the samples in them after the first cycle of each.
    fn samples(&self, numbers: &ComparePolicy) -> (f64, Vec<(TestBlock, Vec<MotionSample>)>) {
        let parts = || (1..=numbers.steps).map(|step| step as f64 / numbers.steps as f64);
        let blocks = parts().flat_map(|of_displacement| {
            parts().map(move |of_velocity| {
                let amplitude = of_displacement * self.displacement_mm;
                TestBlock {
                    amplitude,
                    frequency: of_velocity * self.velocity_mm_s / (TAU * amplitude),
                    cycles: numbers.cycles,
                }
            })
        });
        let blocks: Vec<TestBlock> = blocks.collect();
        let fastest = blocks
            .iter()
            .map(|block| block.frequency)
            .fold(0.0, f64::max);
        let rate = numbers.samples * fastest;
        let mut samples = motion(&blocks, rate).into_iter().peekable();
        let mut end = 0.0;
        let of_blocks = blocks.into_iter().map(|block| {
            end += f64::from(block.cycles) / block.frequency;
            let mut own = Vec::new();
            while let Some(sample) = samples.next_if(|sample| sample.time < end - 0.5 / rate) {
                own.push(sample);
            }
            (block, own)
        });
        (rate, of_blocks.collect())
    }
}

fn other_controls(moment: &Moment, first: &Moment) -> InputError {
    InputError::new(
        &moment.name,
        format!("sees other control inputs than {}", first.name),
        "compare models that see the same",
    )
}

/// The force of every model but the first beside the first's.
pub(super) fn changes(
    moments: &[Moment],
    common: &CommonMotion,
    numbers: &ComparePolicy,
) -> Result<Vec<ForceChange>, InputError> {
    let run = Run::new(common, numbers);
    let spreads = moments.iter().map(|moment| {
        Spread::of(moment, &run, numbers).map_err(|error| model_error(&moment.name, &error))
    });
    let spreads: Vec<Spread> = spreads.collect::<Result<_, _>>()?;
    let first = &spreads[0];
    let scale = mean_square(&first.force);
    let later = spreads.iter().enumerate().skip(1);
    Ok(later
        .map(|(model, spread)| {
            let pairs = spread.force.iter().zip(&first.force);
            let off: Vec<f64> = pairs.map(|(force, first)| force - first).collect();
            let chance = first.chance.zip(spread.chance).map(|(a, b)| a.and(b));
            let difference = mean_square(&off);
            let largest = (0..off.len()).max_by(|&a, &b| off[a].abs().total_cmp(&off[b].abs()));
            let largest = largest.unwrap_or_default();
            ForceChange {
                model,
                difference: (difference / scale).sqrt(),
                expected: chance.map(|chance| (chance.sum / scale).sqrt()),
                p: chance.and_then(|chance| chance.exceeds(difference)),
                changed: false,
                largest: Place {
                    displacement_mm: run.kept[largest].0,
                    velocity_mm_s: run.kept[largest].1,
                    difference: off[largest],
                    part: off[largest] / scale.sqrt(),
                },
            }
        })
        .collect())
}

/// A sum of squares of independent normal variables: the sum of their variances, and that of the squares of these.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Chance {
    sum: f64,
    squares: f64,
}

impl Chance {
    fn and(self, other: Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
        }
    }

    /// The chance of a sum as large as `square`: that of a scaled χ² with the same mean and variance (Satterthwaite 1946).
    fn exceeds(self, square: f64) -> Option<f64> {
        let freedom = self.sum * self.sum / self.squares;
        Some(
            ChiSquared::new(freedom)
                .ok()?
                .sf(freedom * square / self.sum),
        )
    }
}

fn mean_square(values: &[f64]) -> f64 {
    mean_product(values, values)
}

fn mean_product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64
}

/// The motion, and the samples of it that count.
struct Run {
    rate: f64,
    blocks: Vec<(TestBlock, Vec<MotionSample>)>,
    controls: [f64; CONTROLS],
    /// Displacement and velocity of the samples that count.
    kept: Vec<(f64, f64)>,
}

impl Run {
    fn new(common: &CommonMotion, numbers: &ComparePolicy) -> Self {
        let (rate, blocks) = common.samples(numbers);
        let mut controls = [0.0; CONTROLS];
        for (control, (_, value)) in controls.iter_mut().zip(&common.controls) {
            *control = *value;
        }
        let counting = blocks
            .iter()
            .flat_map(|(block, samples)| &samples[settling(block, rate, samples.len())..]);
        let kept = counting.map(|at| (at.displacement, at.velocity)).collect();
        Self {
            rate,
            blocks,
            controls,
            kept,
        }
    }

    /// The model's force at the samples that count, kN.
    fn force(&self, model: &Model) -> Result<Vec<f64>, ModelError> {
        let first = self
            .blocks
            .first()
            .map_or(0.0, |(block, _)| block.amplitude);
        let mut law = model.augmented::<f64>(first, 1.0 / self.rate)?;
        let mut state = law.at_rest();
        let mut force = Vec::with_capacity(self.kept.len());
        let mut cycles = 0.0;
        for (block, samples) in &self.blocks {
            law.set_law(model.law_at(block.amplitude)?);
            let begin = samples.first().map_or(0.0, |at| at.time);
            let settling = settling(block, self.rate, samples.len());
            for (place, at) in samples.iter().enumerate() {
                let motion = Motion {
                    displacement: at.displacement,
                    velocity: at.velocity,
                    acceleration: at.acceleration,
                    cycles: cycles + (at.time - begin) * block.frequency,
                    temperature: ROOM,
                    controls: self.controls,
                };
                let now = law.force(&mut state, &motion);
                if place >= settling {
                    force.push(now);
                }
            }
            cycles += f64::from(block.cycles);
        }
        Ok(force)
    }
}

/// Samples of the first cycle of a block.
fn settling(block: &TestBlock, rate: f64, samples: usize) -> usize {
    ((rate / block.frequency).round() as usize).min(samples)
}

/// A model's force, and how far it may be off.
struct Spread {
    force: Vec<f64>,
    /// The mean square of what it is off by, kN²; `None` where an interval is not known.
    chance: Option<Chance>,
}

impl Spread {
    fn of(moment: &Moment, run: &Run, numbers: &ComparePolicy) -> Result<Self, ModelError> {
        let model = moment.model.model();
        let force = run.force(&model)?;
        let chance = Self::chance(moment, &model, &force, run, numbers);
        Ok(Self { force, chance })
    }

    /// Of the parameters, which were fitted together, and of what the model leaves beyond the noise.
    ///
    /// A trace gives the deviation of each parameter, and not how they err together. A fit to this motion would have its parameters err as
    /// (HᵀH)⁻¹ says of the columns H, what each changes the force by; from that the correlations are taken.
    fn chance(
        moment: &Moment,
        model: &Model,
        force: &[f64],
        run: &Run,
        numbers: &ComparePolicy,
    ) -> Option<Chance> {
        let trace = moment.trace.as_ref()?;
        let mut columns = Vec::new();
        for parameter in of_model(moment) {
            match parameter.bounds.deviation(numbers) {
                Some(deviation) => {
                    columns.push(changed_by(model, &parameter, deviation, force, run)?)
                }
                // What has no width errs by nothing; what has no bound by anything.
                None if is_exact(&parameter) => {}
                None => return None,
            }
        }
        // What the trace takes for noise, that of the motion included, is in the intervals already.
        let left = trace.remainder.as_ref().map_or(0.0, |left| left.nrmse);
        let left = left * left * mean_square(force);
        Some(of_parameters(&columns)?.and(Chance {
            sum: left,
            squares: left * left,
        }))
    }
}

/// The mean square of the sum of `columns`, each times a normal variable of deviation 1, which are correlated as in a fit of them.
/// `None` where the columns are no independent ones.
fn of_parameters(columns: &[Vec<f64>]) -> Option<Chance> {
    let count = columns.len();
    let products = DMatrix::from_fn(count, count, |i, j| mean_product(&columns[i], &columns[j]));
    let size: Vec<f64> = (0..count).map(|i| products[(i, i)].sqrt()).collect();
    let scaled = DMatrix::from_fn(count, count, |i, j| products[(i, j)] / (size[i] * size[j]));
    let inverse = Cholesky::new(scaled)?.inverse();
    let deviation: Vec<f64> = (0..count).map(|i| inverse[(i, i)].sqrt()).collect();
    let correlated = DMatrix::from_fn(count, count, |i, j| {
        inverse[(i, j)] / (deviation[i] * deviation[j])
    });
    let off = correlated * products;
    let squares = (&off * &off).trace();
    let chance = Chance {
        sum: off.trace(),
        squares,
    };
    (chance.sum.is_finite() && squares.is_finite()).then_some(chance)
}

/// Whether an interval has two ends that are one.
fn is_exact(parameter: &Parameter) -> bool {
    let bounds = &parameter.bounds;
    bounds.low.is_some() && bounds.low == bounds.high
}

/// What the force changes by where a parameter is off by a deviation, kN. `None` where the crate refuses it both above and below.
fn changed_by(
    model: &Model,
    parameter: &Parameter,
    deviation: f64,
    force: &[f64],
    run: &Run,
) -> Option<Vec<f64>> {
    [deviation, -deviation].into_iter().find_map(|off| {
        let mut other = model.clone();
        *value_in(&mut other, parameter)? += off;
        let other = run.force(&other).ok()?;
        let pairs = other.iter().zip(force);
        Some(
            pairs
                .map(|(other, force)| (other - force) * off.signum())
                .collect(),
        )
    })
}

/// Where a model has the value of a parameter.
fn value_in<'a>(model: &'a mut Model, parameter: &Parameter) -> Option<&'a mut f64> {
    let Some(amplitude) = parameter.amplitude else {
        let mut effects = model.effects.iter_mut();
        let effect = effects.find(|effect| effect.family.name() == parameter.of)?;
        return effect.parameters.get_mut(&parameter.name);
    };
    let mut nodes = model.law.iter_mut();
    let node = nodes.find(|node| node.amplitude == amplitude)?;
    Some(match parameter.name.as_str() {
        "k1" => &mut node.k1,
        "k3" => &mut node.k3,
        "c" => &mut node.c,
        _ => &mut node.alpha,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_fitted_together_errs_together() {
        // Two columns that are alike but for a tenth: fitted, one errs against the other, and their sum by much less than either.
        let time: Vec<f64> = (0..1000).map(|i| TAU * f64::from(i) / 1000.0).collect();
        let one: Vec<f64> = time.iter().map(|t| t.sin()).collect();
        let other: Vec<f64> = time.iter().map(|t| t.sin() + 0.1 * t.cos()).collect();
        let alone = of_parameters(std::slice::from_ref(&one)).unwrap();
        assert!((alone.sum - 0.5).abs() < 1e-12 && (alone.squares - 0.25).abs() < 1e-12);
        let both = of_parameters(&[one, other]).unwrap();
        // With K = ½·[1, 1; 1, 1.01] the correlation is −1/√1.01, and the mean square ½·(2.01 − 2/√1.01).
        let expected = 0.5 * (2.01 - 2.0 / 1.01_f64.sqrt());
        assert!((both.sum - expected).abs() < 1e-9, "{both:?}");
        assert!(of_parameters(&[vec![1.0, 2.0], vec![2.0, 4.0]]).is_none());
    }

    #[test]
    fn a_sum_of_two_equal_variables_is_exceeded_as_a_chi_square_of_two() {
        let one = Chance {
            sum: 0.5,
            squares: 0.25,
        };
        // e^(−x/2) of χ² = 6, which is a sum of 3.
        let p = one.and(one).exceeds(3.0).unwrap();
        assert!((p - (-3.0_f64).exp()).abs() < 1e-9, "{p}");
    }
}

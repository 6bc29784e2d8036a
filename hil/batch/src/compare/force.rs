//! The force of models on one motion: what they say of the specimen, whatever parameters say it.

use std::f64::consts::TAU;

use mesh_damper::effects::{CONTROLS, Motion};
use mesh_damper_model::file::model_error;
use mesh_damper_model::{Model, ModelError};
use mesh_damper_recording::error::InputError;
use mesh_damper_reference::protocol::{MotionSample, TestBlock, motion};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF as _};

use super::parameters::{Parameter, of_model};
use super::{ComparePolicy, Moment};

/// Temperature of the motion, °C: that of a recording without one.
const ROOM: f64 = 20.0;

/// The motion that all models are put through: sines at parts of the range that all were fitted in, beside each other in amplitude and in
/// velocity.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
pub struct ForceChange {
    /// The model, counted from 0.
    pub model: usize,
    /// RMS of the difference of the forces over the RMS of the first one's.
    pub difference: f64,
    /// What that would be of a specimen that did not change: by the intervals of the parameters, and by what the models leave beyond the
    /// noise. Null where intervals are not known.
    pub expected: Option<f64>,
    /// The chance of a difference as large as this of a specimen that did not change; null where intervals are not known.
    pub p: Option<f64>,
    /// Whether a change is claimed.
    pub changed: bool,
    /// Where the difference is largest.
    pub largest: Place,
}

/// A place of the motion, and the difference there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Place {
    /// mm.
    pub displacement_mm: f64,
    /// mm/s.
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
    let spreads = moments
        .iter()
        .map(|moment| Spread::of(moment, &run).map_err(|error| model_error(&moment.name, &error)));
    let spreads: Vec<Spread> = spreads.collect::<Result<_, _>>()?;
    let first = &spreads[0];
    let scale = mean_square(&first.force);
    let later = spreads.iter().enumerate().skip(1);
    Ok(later
        .map(|(model, spread)| {
            let off: Vec<f64> = spread
                .force
                .iter()
                .zip(&first.force)
                .map(|(force, first)| force - first)
                .collect();
            let expected = first.variances.as_ref().zip(spread.variances.as_ref());
            let expected: Option<Vec<f64>> =
                expected.map(|(a, b)| a.iter().chain(b).copied().collect());
            let difference = mean_square(&off);
            let largest = (0..off.len()).max_by(|&a, &b| off[a].abs().total_cmp(&off[b].abs()));
            let largest = largest.unwrap_or_default();
            ForceChange {
                model,
                difference: (difference / scale).sqrt(),
                expected: expected
                    .as_ref()
                    .map(|parts| (parts.iter().sum::<f64>() / scale).sqrt()),
                p: expected.and_then(|parts| chance(difference, &parts)),
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

/// The chance of a mean square as large as `difference` of a sum of squares of normal variables with these `variances`: that of a scaled
/// χ² with the same mean and variance (Satterthwaite 1946).
fn chance(difference: f64, variances: &[f64]) -> Option<f64> {
    let sum: f64 = variances.iter().sum();
    let squares: f64 = variances.iter().map(|variance| variance * variance).sum();
    let freedom = sum * sum / squares;
    Some(
        ChiSquared::new(freedom)
            .ok()?
            .sf(freedom * difference / sum),
    )
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64
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
    /// Mean squares of what it is off by, kN², of independent causes; `None` where an interval is not known.
    variances: Option<Vec<f64>>,
}

impl Spread {
    fn of(moment: &Moment, run: &Run) -> Result<Self, ModelError> {
        let model = moment.model.model();
        let force = run.force(&model)?;
        let variances = Self::variances(moment, &model, &force, run);
        Ok(Self { force, variances })
    }

    /// One for each parameter, as if each erred by itself: together they err less, as they were fitted together. And one for what the model
    /// leaves beyond the noise.
    fn variances(moment: &Moment, model: &Model, force: &[f64], run: &Run) -> Option<Vec<f64>> {
        let trace = moment.trace.as_ref()?;
        let mut variances = Vec::new();
        for parameter in of_model(moment) {
            let deviation = parameter.bounds.deviation();
            // What stands at the end of its range has no width there.
            let Some(deviation) = deviation.or(is_exact(&parameter).then_some(0.0)) else {
                return None;
            };
            variances.push(effect_of(model, &parameter, deviation, force, run)?);
        }
        let left = trace.augmented.nrmse_held_out.powi(2) - trace.noise_floor_nrmse.powi(2);
        variances.push(left.max(0.0) * mean_square(force));
        Some(variances)
    }
}

/// Whether an interval has two ends that are one.
fn is_exact(parameter: &Parameter) -> bool {
    let bounds = &parameter.bounds;
    bounds.low.is_some() && bounds.low == bounds.high
}

/// The mean square of what the force changes by where a parameter is off by a deviation, kN². `None` where the crate refuses it both
/// above and below.
fn effect_of(
    model: &Model,
    parameter: &Parameter,
    deviation: f64,
    force: &[f64],
    run: &Run,
) -> Option<f64> {
    [deviation, -deviation].into_iter().find_map(|off| {
        let mut other = model.clone();
        let value = match parameter.amplitude {
            Some(amplitude) => {
                let mut nodes = other.law.iter_mut();
                let node = nodes.find(|node| node.amplitude == amplitude)?;
                match parameter.name.as_str() {
                    "k1" => &mut node.k1,
                    "k3" => &mut node.k3,
                    "c" => &mut node.c,
                    _ => &mut node.alpha,
                }
            }
            None => {
                let mut effects = other.effects.iter_mut();
                let effect = effects.find(|effect| effect.family.name() == parameter.of)?;
                effect.parameters.get_mut(&parameter.name)?
            }
        };
        *value += off;
        let other = run.force(&other).ok()?;
        Some(mean_square(
            &other
                .iter()
                .zip(force)
                .map(|(a, b)| a - b)
                .collect::<Vec<_>>(),
        ))
    })
}

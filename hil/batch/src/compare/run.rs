//! The common motion for all models, and the force of a model on it.

use std::f64::consts::TAU;

use mesh_damper::effects::{CONTROLS, Motion};
use mesh_damper_model::{Model, ModelError};
use mesh_damper_reference::protocol::{MotionSample, TestBlock, motion};

use super::common::CommonMotion;
use super::{ComparePolicy, Moment};

/// Temperature if none is known, °C: that of a recording without temperature. No force depends on it then.
const ROOM: f64 = 20.0;

/// The conditions that stay constant during the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held {
    /// °C.
    pub temperature: f64,
    /// Since the recording began.
    pub cycles: f64,
    pub controls: [f64; CONTROLS],
}

impl Held {
    /// The same conditions at another temperature, °C.
    pub fn at_temperature(mut self, temperature: f64) -> Self {
        self.temperature = temperature;
        self
    }

    /// The same conditions after another number of cycles.
    pub fn after_cycles(mut self, cycles: f64) -> Self {
        self.cycles = cycles;
        self
    }
}

/// A sample that counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    /// Relative to the first model's zero, mm.
    pub displacement: f64,
    /// mm/s.
    pub velocity: f64,
    pub held: Held,
}

/// The motion, and its samples that count.
pub(super) struct Run {
    rate: f64,
    /// Each with the index of the first sample that counts.
    blocks: Vec<(TestBlock, Vec<MotionSample>, usize)>,
    /// All ends of the constant conditions.
    ends: Vec<Held>,
    /// End by end.
    pub kept: Vec<Kept>,
}

impl Run {
    /// Displacements are relative to the first model's `zero`. Conditions on which no force of `moments` depends stay at the
    /// middle.
    pub fn new(
        common: &CommonMotion,
        zero: f64,
        moments: &[&Moment],
        numbers: &ComparePolicy,
    ) -> Self {
        let [low, high] = common.displacement_mm.map(|end| end - zero);
        let (middle, largest) = (0.5 * (low + high), 0.5 * (high - low));
        let (rate, blocks) = blocks(largest, middle, common.velocity_mm_s, numbers);
        let ends = ends(common, moments);
        let counting = blocks
            .iter()
            .flat_map(|(_, samples, settling)| &samples[*settling..]);
        let kept = ends.iter().flat_map(|held| {
            counting.clone().map(|at| Kept {
                displacement: at.displacement,
                velocity: at.velocity,
                held: *held,
            })
        });
        Self {
            kept: kept.collect(),
            rate,
            blocks,
            ends,
        }
    }

    /// The model's force at the samples that count, kN, with its zero `shift` mm above the first model's.
    pub fn force(&self, model: &Model, shift: f64) -> Result<Vec<f64>, ModelError> {
        let each = self.ends.iter().map(|held| self.held(model, shift, held));
        Ok(each.collect::<Result<Vec<_>, _>>()?.concat())
    }

    /// The middle of temperatures and cycles, at the first end of the control inputs.
    pub fn middle(&self) -> Held {
        let (first, last) = (self.ends[0], self.ends[self.ends.len() - 1]);
        first
            .at_temperature(0.5 * (first.temperature + last.temperature))
            .after_cycles(0.5 * (first.cycles + last.cycles))
    }

    /// The same under the conditions `held`.
    pub fn held(&self, model: &Model, shift: f64, held: &Held) -> Result<Vec<f64>, ModelError> {
        let first = self.blocks[0].0.amplitude;
        let mut law = model.augmented::<f64>(first, 1.0 / self.rate)?;
        let mut state = law.at_rest();
        let mut force = Vec::with_capacity(self.kept.len());
        for (block, samples, settling) in &self.blocks {
            law.set_law(model.law_at(block.amplitude)?);
            let begin = samples.first().map_or(0.0, |at| at.time);
            for (place, at) in samples.iter().enumerate() {
                let motion = Motion {
                    displacement: at.displacement - shift,
                    velocity: at.velocity,
                    acceleration: at.acceleration,
                    // A table over the frequency counts cycles by their fractions.
                    cycles: held.cycles.floor() + ((at.time - begin) * block.frequency).fract(),
                    temperature: held.temperature,
                    controls: held.controls,
                };
                let now = law.force(&mut state, &motion);
                if place >= *settling {
                    force.push(now);
                }
            }
        }
        Ok(force)
    }
}

/// Sines about `middle` at fractions of the `largest` amplitude in mm, and at fractions of the velocity in mm/s. The first cycle of
/// each does not count. An additional cycle before all of them brings friction away from its start.
fn blocks(
    largest: f64,
    middle: f64,
    velocity: f64,
    numbers: &ComparePolicy,
) -> (f64, Vec<(TestBlock, Vec<MotionSample>, usize)>) {
    let parts = || (1..=numbers.steps).map(|step| step as f64 / numbers.steps as f64);
    let settling = TestBlock::new(largest, velocity / (TAU * largest), 1);
    let sines = parts().flat_map(|of_displacement| {
        parts().map(move |of_velocity| {
            let amplitude = of_displacement * largest;
            TestBlock {
                amplitude,
                frequency: of_velocity * velocity / (TAU * amplitude),
                cycles: numbers.cycles,
            }
        })
    });
    let blocks: Vec<TestBlock> = std::iter::once(settling).chain(sines).collect();
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
            own.push(MotionSample {
                displacement: sample.displacement + middle,
                ..sample
            });
        }
        let settling = ((rate / block.frequency).round() as usize).min(own.len());
        (block, own, settling)
    });
    (rate, of_blocks.collect())
}

/// Both ends of all conditions that a force depends on, in all combinations.
fn ends(common: &CommonMotion, moments: &[&Moment]) -> Vec<Held> {
    let of = |range: [f64; 2], is_felt: bool| match range {
        [low, high] if is_felt && low < high => vec![low, high],
        [low, high] => vec![0.5 * (low + high)],
    };
    let any = |depends: fn(&Model) -> bool| {
        let mut models = moments.iter().map(|moment| moment.model.model());
        models.any(|model| depends(&model))
    };
    let temperatures = of(
        common.temperature.unwrap_or([ROOM; 2]),
        any(Model::depends_on_temperature),
    );
    let cycles = of(
        common.cycles.unwrap_or_default(),
        any(Model::depends_on_cycles),
    );
    let mut ends = Vec::new();
    for &temperature in &temperatures {
        for &cycles in &cycles {
            ends.push(Held {
                temperature,
                cycles,
                controls: [0.0; CONTROLS],
            });
        }
    }
    for (place, control) in common.controls.iter().enumerate() {
        let values = of(control.range, true);
        ends = values
            .iter()
            .flat_map(|&value| {
                ends.iter().map(move |held| {
                    let mut held = *held;
                    held.controls[place] = value;
                    held
                })
            })
            .collect();
    }
    ends
}

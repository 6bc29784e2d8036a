//! Dynamic stiffness and loss factor for every cycle of a recording, and for the averaged cycle of each block, eqs 3–7.
//!
//! Eq 5 applies to N samples that fill a cycle, which is rarely the case in a recording: so each cycle is interpolated from
//! crossing to crossing of its mid level. Noise makes the extremes of eq 3 too large. The average of a block's cycles, phase by
//! phase, has less noise.

use mesh_damper_output::error::{InputError, Place};
use mesh_damper_recording::Recording;
use mesh_damper_recording::cycles::FoundBlock;
use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::dynamic_test::{self, DynamicResult};
use serde::Serialize;

use super::{Spread, spread};

/// A cycle belongs to a ramp if its amplitude or frequency differs from its block's by more than this fraction.
const RAMP: f64 = 0.02;
/// Fewest samples of a cycle.
const FEWEST: usize = 16;
/// Most samples of an averaged cycle.
const MOST: usize = 1000;
/// ∮F dx and eq 5 agree for a sine; a note reports a difference above this fraction.
const NO_SINE: f64 = 0.02;

/// One cycle.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DynamicCycle {
    /// Start of the cycle, s.
    pub time: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Whether the cycle is steady: its amplitude and frequency are those of its block, and no channel had a fault in it.
    pub steady: bool,
    /// Results of eqs 3–6.
    #[serde(flatten)]
    pub result: Figures,
}

/// Results of eqs 3–7 for one cycle, measured or averaged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Figures {
    /// Amplitude X0, mm.
    pub amplitude: f64,
    /// Largest force, kN.
    pub force_max: f64,
    /// Smallest force, kN.
    pub force_min: f64,
    /// Dynamic stiffness K, eq 3, kN/mm.
    pub stiffness: f64,
    /// Dissipated energy ΔW, eq 5, J, for the fundamental of the motion.
    pub dissipated: f64,
    /// Loop area ∮F dx, J, for the motion as measured.
    pub loop_area: f64,
    /// Elastic potential W, eq 6, J.
    pub elastic_potential: f64,
    /// Dynamic loss factor η_d, eqs 4 and 7.
    pub loss_factor: f64,
}

/// Consecutive cycles of similar amplitude and frequency.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DynamicBlock {
    /// The cycles of the block, in order.
    pub cycles: Vec<DynamicCycle>,
    /// Mean frequency of the steady cycles, Hz.
    pub frequency: f64,
    /// Dynamic stiffness K of the steady cycles, kN/mm.
    pub stiffness: Spread,
    /// Dynamic loss factor η_d of the steady cycles.
    pub loss_factor: Spread,
    /// Results for the average of the steady cycles.
    pub averaged: Figures,
    /// Displacement and force of the averaged cycle, mm and kN.
    #[serde(skip)]
    pub averaged_loop: Vec<(f64, f64)>,
    /// Displacement and force of all steady cycles, mm and kN.
    #[serde(skip)]
    pub measured: Vec<(f64, f64)>,
}

/// A recording of cycles.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DynamicTest {
    /// The blocks of the recording, in order.
    pub blocks: Vec<DynamicBlock>,
    /// Peculiarities of the recording.
    pub notes: Vec<String>,
}

/// Eqs 3–7 for every whole cycle of a recording and for the averaged cycle of every block. The channels are checked for faults
/// first, as before a trace; the force stays at its recorded times.
///
/// # Errors
/// The recording is mostly gaps or noise, or it has no whole cycle or too few samples per cycle.
pub fn dynamic_test(recording: &Recording) -> Result<DynamicTest, InputError> {
    let trajectory = Trajectory::as_recorded(recording)?;
    let refused = |problem: String, remedy: &str| {
        InputError::new(&recording.name, problem, remedy).at(Place::Column("displacement".into()))
    };
    let lengths = trajectory.blocks.iter().flat_map(|block| &block.cycles);
    let Some(shortest) = lengths.map(ExactSizeIterator::len).min() else {
        return Err(refused(
            "there is no whole cycle".into(),
            "record at least one whole cycle, or take --static for a load–unload curve",
        ));
    };
    if shortest < FEWEST {
        return Err(refused(
            format!("a cycle has {shortest} samples only"),
            "record at least 16 samples to a cycle",
        ));
    }
    let start = recording.time[0];
    let mut blocks: Vec<DynamicBlock> = trajectory
        .blocks
        .iter()
        .filter_map(|block| DynamicBlock::of(block, &trajectory, start))
        .collect();
    if blocks.is_empty() {
        return Err(refused(
            "no cycle is steady and without a fault".into(),
            "record cycles of one amplitude and frequency",
        ));
    }
    let mut notes: Vec<String> = trajectory.faults.iter().map(ToString::to_string).collect();
    // If there are blocks of several cycles, a single cycle is a transition between blocks.
    let single = |block: &DynamicBlock| block.stiffness.deviation.is_none();
    if !blocks.iter().all(single) {
        let all = blocks.len();
        blocks.retain(|block| !single(block));
        if blocks.len() < all {
            let dropped = all - blocks.len();
            notes.push(format!("single cycles between blocks, left out: {dropped}"));
        }
    }
    for block in &blocks {
        let figures = &block.averaged;
        if (figures.loop_area - figures.dissipated).abs() > NO_SINE * figures.dissipated.abs() {
            notes.push(format!(
                "{:.3} mm, {:.3} Hz: the motion is no sine, ∮F dx differs from eq 5, which counts the fundamental's \
                 energy only",
                figures.amplitude, block.frequency
            ));
        }
    }
    if blocks.iter().any(|block| block.averaged.dissipated < 0.0) {
        notes.push(
            "cycles give energy: check the order of time and the signs of force and displacement"
                .into(),
        );
    }
    Ok(DynamicTest { blocks, notes })
}

impl DynamicBlock {
    /// `None` without a steady cycle that was measured from end to end. `start` is the time of the first sample, s.
    fn of(block: &FoundBlock, trajectory: &Trajectory, start: f64) -> Option<Self> {
        let (displacement, force) = (&trajectory.motion.displacement, &trajectory.force);
        let (low, high) = least_and_largest(displacement);
        let level = 0.5 * (low + high);
        let crossing = |index: usize| match index.checked_sub(1) {
            // The last cycle may end with the recording.
            Some(before)
                if index < displacement.len()
                    && (displacement[before] < level) != (displacement[index] <= level) =>
            {
                let (a, b) = (displacement[before] - level, displacement[index] - level);
                before as f64 + a / (a - b)
            }
            _ => index as f64,
        };
        let longest = block.cycles.iter().map(ExactSizeIterator::len).max()?;
        // A multiple of 4, so that the phases of a sine include its extremes and both crossings of the middle.
        let phases = 4 * longest.min(MOST).div_ceil(4);
        let mut cycles = Vec::new();
        let (mut sum_x, mut sum_f) = (vec![0.0; phases], vec![0.0; phases]);
        let mut measured = Vec::new();
        for samples in &block.cycles {
            let (from, to) = (crossing(samples.start), crossing(samples.end));
            let sampled = |values: &[f64], count: usize| -> Vec<f64> {
                let place = |i: usize| from + (to - from) * i as f64 / count as f64;
                (1..=count).map(|i| linear(values, place(i))).collect()
            };
            let (x, f) = (
                sampled(displacement, samples.len()),
                sampled(force, samples.len()),
            );
            let figures = Figures::of(&x, &f)?;
            let frequency = 1.0 / ((to - from) * trajectory.tick);
            let steady = (figures.amplitude / block.amplitude - 1.0).abs() <= RAMP
                && (frequency / block.frequency - 1.0).abs() <= RAMP
                && trajectory.measured[samples.clone()]
                    .iter()
                    .all(|&measured| measured);
            if steady {
                for (sum, value) in sum_x.iter_mut().zip(sampled(displacement, phases)) {
                    *sum += value;
                }
                for (sum, value) in sum_f.iter_mut().zip(sampled(force, phases)) {
                    *sum += value;
                }
                measured.extend(x.iter().copied().zip(f.iter().copied()));
            }
            cycles.push(DynamicCycle {
                time: start + from * trajectory.tick,
                frequency,
                steady,
                result: figures,
            });
        }
        let steady: Vec<&DynamicCycle> = cycles.iter().filter(|cycle| cycle.steady).collect();
        if steady.is_empty() {
            return None;
        }
        let count = steady.len() as f64;
        let mean = |sums: &[f64]| -> Vec<f64> { sums.iter().map(|sum| sum / count).collect() };
        let (x, f) = (mean(&sum_x), mean(&sum_f));
        let of = |figure: fn(&Figures) -> f64| -> Vec<f64> {
            steady.iter().map(|cycle| figure(&cycle.result)).collect()
        };
        let frequency = steady.iter().map(|cycle| cycle.frequency).sum::<f64>() / count;
        Some(Self {
            averaged: Figures::of(&x, &f)?,
            averaged_loop: x.into_iter().zip(f).collect(),
            frequency,
            stiffness: spread(&of(|figures| figures.stiffness)),
            loss_factor: spread(&of(|figures| figures.loss_factor)),
            cycles,
            measured,
        })
    }
}

impl Figures {
    fn of(displacement: &[f64], force: &[f64]) -> Option<Self> {
        let DynamicResult {
            force_max,
            force_min,
            amplitude,
            stiffness,
            dissipated,
            elastic_potential,
            loss_factor,
        } = dynamic_test::characterize(displacement, force)?;
        Some(Self {
            amplitude,
            force_max,
            force_min,
            stiffness,
            dissipated,
            loop_area: dynamic_test::loop_area(displacement, force),
            elastic_potential,
            loss_factor,
        })
    }
}

/// Interpolates `values` between its samples.
fn linear(values: &[f64], place: f64) -> f64 {
    let last = values.len() - 1;
    let before = (place.max(0.0) as usize).min(last);
    let after = (before + 1).min(last);
    let part = place - before as f64;
    values[before] + part * (values[after] - values[before])
}

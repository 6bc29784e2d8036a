//! Dynamic stiffness and loss factor for every cycle of a recording, and for the averaged cycle of each block, eqs 3–7.
//!
//! Eq 5 applies to N samples that fill a cycle, which is rarely the case in a recording: so each cycle is interpolated from
//! crossing to crossing of its mid level. Noise makes the extremes of eq 3 too large. The average of a block's cycles, phase by
//! phase, has less noise, and the [harmonics](super::harmonics) of the cycles are without that bias.

use mesh_damper_output::error::{InputError, Place};
use mesh_damper_recording::Recording;
use mesh_damper_recording::cycles::{FoundBlock, median};
use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_recording::faults::ChannelFault;
use mesh_damper_recording::rig::RigFacts;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::dynamic_test::{self, DynamicResult};
use serde::Serialize;

use super::harmonics::{Stiffness, stiffnesses};
use super::{Spread, spread};

/// A cycle belongs to a ramp if its amplitude or frequency differs from its block's by more than this fraction,
const RAMP: f64 = 0.02;
/// and by more than this many deviations of the displacement's noise.
const NOISES: f64 = 3.0;
/// The start of a cycle is at most this many samples from a crossing of the mid level: blocks begin where the motion has a kink.
const NEAR: isize = 2;
/// kN per kg·mm/s².
const KILONEWTON: f64 = 1e-6;
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
    /// Whether the cycle counts: its amplitude and frequency are those of its block, so were those of the cycle before it, which a
    /// specimen with a memory still feels, and no channel had a fault in it.
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
    /// Dynamic stiffness K of the steady cycles by eq 3, from their harmonics, kN/mm.
    pub stiffness: Spread,
    /// The 90 % interval of the mean stiffness, kN/mm.
    pub stiffness_interval: [f64; 2],
    /// Dynamic loss factor η_d of the steady cycles by eq 4, with that stiffness.
    pub loss_factor: Spread,
    /// Results for the average of the steady cycles.
    pub averaged: Figures,
    /// Whether every cycle that counts follows a change of amplitude or frequency, because there is no other.
    #[serde(skip)]
    pub follows_a_change: bool,
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
    dynamic_test_on(recording, &RigFacts::default())
}

/// The same on a rig with these facts: a force that is late is moved back, and that of the fixture's mass is subtracted. Where the
/// displacement is 0 does not matter.
///
/// # Errors
/// As [`dynamic_test`], and a delay of the force that leaves too little of it.
pub fn dynamic_test_on(recording: &Recording, rig: &RigFacts) -> Result<DynamicTest, InputError> {
    let mut trajectory = Trajectory::as_recorded(recording, rig)?;
    let mass = rig.fixture_mass.unwrap_or_default();
    let accelerations = &trajectory.motion.acceleration;
    for (force, acceleration) in trajectory.force.iter_mut().zip(accelerations) {
        *force -= KILONEWTON * mass * acceleration;
    }
    let refused = |problem: String, remedy: String| {
        InputError::new(&recording.name, problem, remedy).at(Place::Column("displacement".into()))
    };
    if trajectory
        .blocks
        .iter()
        .all(|block| block.cycles.is_empty())
    {
        return Err(refused(
            "there is no whole cycle".into(),
            "record at least one whole cycle, or take --static for a load–unload curve".into(),
        ));
    }
    let start = recording.time[0];
    let faults: Vec<String> = trajectory
        .faults
        .iter()
        .map(ChannelFault::to_string)
        .collect();
    let mut notes = faults.clone();
    let found: Vec<Result<DynamicBlock, LeftOut>> = (trajectory.blocks.iter())
        .filter(|block| !block.cycles.is_empty())
        .map(|block| DynamicBlock::of(block, &trajectory, start))
        .collect();
    let left_out = || found.iter().filter_map(|block| block.as_ref().err());
    // If there are blocks of several cycles, a single cycle is a transition between blocks.
    let single = |block: &DynamicBlock| block.cycles.len() == 1;
    let all_are_single = found.iter().flatten().all(single);
    let is_between = |block: &DynamicBlock| !all_are_single && single(block);
    if found.iter().all(Result::is_err) {
        let reasons: Vec<String> = left_out().map(LeftOut::to_string).collect();
        let problem = format!("no cycle can be used: {}", reasons.join("; "));
        let remedy = match &faults[..] {
            [] => {
                "record cycles of one amplitude and frequency, with at least 16 samples to a cycle"
                    .into()
            }
            faults => format!("correct this first: {}", faults.join("; ")),
        };
        return Err(refused(problem, remedy));
    }
    notes.extend(left_out().map(|left_out| format!("left out: {left_out}")));
    let blocks = found.into_iter().flatten();
    let blocks: Vec<DynamicBlock> = blocks.filter(|block| !is_between(block)).collect();
    for block in &blocks {
        let figures = &block.averaged;
        if (figures.loop_area - figures.dissipated).abs() > NO_SINE * figures.dissipated.abs() {
            notes.push(format!(
                "{}: the motion is no sine, ∮F dx differs from eq 5, which counts the fundamental's energy only",
                condition(figures.amplitude, block.frequency)
            ));
        }
        if block.follows_a_change {
            notes.push(format!(
                "{}: all cycles that can be used follow a change of amplitude or frequency, which a specimen with a memory still feels",
                condition(figures.amplitude, block.frequency)
            ));
        }
    }
    if blocks.iter().any(|block| block.averaged.dissipated < 0.0) {
        notes.push(
            "cycles give energy: check the order of time and the signs of force and displacement"
                .into(),
        );
    }
    if mass != 0.0 {
        notes.push(format!("the force of a mass of {mass} kg was subtracted"));
    }
    if let Some(delay) = rig.force_delay.filter(|delay| *delay != 0.0) {
        notes.push(format!("the force was moved back by {delay} s"));
    }
    Ok(DynamicTest { blocks, notes })
}

fn condition(amplitude: f64, frequency: f64) -> String {
    format!("{amplitude:.3} mm, {frequency:.3} Hz")
}

/// A block without a row, and why.
struct LeftOut {
    /// mm
    amplitude: f64,
    /// Hz
    frequency: f64,
    reason: String,
}

impl std::fmt::Display for LeftOut {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let condition = condition(self.amplitude, self.frequency);
        write!(f, "{condition}: {}", self.reason)
    }
}

impl DynamicBlock {
    /// Fails if no cycle can be used. `start` is the time of the first sample, s.
    fn of(block: &FoundBlock, trajectory: &Trajectory, start: f64) -> Result<Self, LeftOut> {
        let left_out = |reason: String| LeftOut {
            amplitude: block.amplitude,
            frequency: block.frequency,
            reason,
        };
        let longest = block.cycles.iter().map(ExactSizeIterator::len).max();
        let longest = longest.unwrap_or_default();
        if longest < FEWEST {
            return Err(left_out(format!(
                "a cycle has {longest} samples only, of at least {FEWEST}"
            )));
        }
        let (displacement, force) = (&trajectory.motion.displacement, &trajectory.force);
        // A multiple of 4, so that the phases of a sine include its extremes and both crossings of the middle.
        let phases = 4 * longest.min(MOST).div_ceil(4);
        let level = {
            let (low, high) = least_and_largest(displacement);
            0.5 * (low + high)
        };
        let mut cycles = Vec::new();
        let mut ends = Vec::new();
        for samples in &block.cycles {
            let [from, to] = [samples.start, samples.end].map(|i| crossing(displacement, level, i));
            let sampled = |values: &[f64]| along(values, [from, to], samples.len());
            let Some(result) = Figures::of(&sampled(displacement), &sampled(force)) else {
                continue;
            };
            cycles.push(DynamicCycle {
                time: start + from * trajectory.tick,
                frequency: 1.0 / ((to - from) * trajectory.tick),
                steady: false,
                result,
            });
            ends.push((samples.clone(), [from, to]));
        }
        let median_of = |figure: fn(&DynamicCycle) -> f64| median(cycles.iter().map(figure));
        let (Some(amplitude), Some(frequency)) = (
            median_of(|cycle| cycle.result.amplitude),
            median_of(|cycle| cycle.frequency),
        ) else {
            return Err(left_out("the displacement does not move in a cycle".into()));
        };
        let apart = RAMP.max(NOISES * trajectory.motion.noise / amplitude);
        let is_like = |cycle: &DynamicCycle| {
            (cycle.result.amplitude / amplitude - 1.0).abs() <= apart
                && (cycle.frequency / frequency - 1.0).abs() <= apart
        };
        let like: Vec<bool> = cycles.iter().map(is_like).collect();
        let measured: Vec<bool> = (ends.iter())
            .map(|(samples, _)| trajectory.measured[samples.clone()].iter().all(|&has| has))
            .collect();
        let settled = |index: usize| like[index] && measured[index] && index > 0 && like[index - 1];
        let follows_a_change = !(0..cycles.len()).any(settled);
        for (index, cycle) in cycles.iter_mut().enumerate() {
            cycle.steady = match follows_a_change {
                true => like[index] && measured[index],
                false => settled(index),
            };
        }
        let steady: Vec<usize> = (0..cycles.len())
            .filter(|&index| cycles[index].steady)
            .collect();
        if steady.is_empty() {
            return Err(left_out(match measured.iter().any(|&has| has) {
                true => "no two cycles have the same amplitude and frequency".into(),
                false => "every cycle has a fault of a channel in it".into(),
            }));
        }
        let spans: Vec<[f64; 2]> = steady.iter().map(|&index| ends[index].1).collect();
        let averaged = |values: &[f64]| -> Vec<f64> {
            let mut mean = vec![0.0; phases];
            for &span in &spans {
                for (mean, value) in mean.iter_mut().zip(along(values, span, phases)) {
                    *mean += value / spans.len() as f64;
                }
            }
            mean
        };
        let (x, f) = (averaged(displacement), averaged(force));
        let measured = steady.iter().flat_map(|&index| {
            let (samples, span) = &ends[index];
            let sampled = |values: &[f64]| along(values, *span, samples.len());
            sampled(displacement).into_iter().zip(sampled(force))
        });
        let measured = measured.collect();
        let Stiffness { each, interval } = stiffnesses(displacement, force, &spans);
        // Eqs 4 and 6 with that stiffness.
        let losses: Vec<f64> = (steady.iter().zip(&each))
            .map(|(&index, stiffness)| {
                let of_extremes = &cycles[index].result;
                of_extremes.loss_factor * of_extremes.stiffness / stiffness
            })
            .collect();
        let frequencies = steady.iter().map(|&index| cycles[index].frequency);
        Ok(Self {
            averaged: Figures::of(&x, &f)
                .ok_or_else(|| left_out("the averaged cycle does not move".into()))?,
            averaged_loop: x.into_iter().zip(f).collect(),
            frequency: frequencies.sum::<f64>() / steady.len() as f64,
            stiffness: spread(&each),
            stiffness_interval: interval,
            loss_factor: spread(&losses),
            follows_a_change,
            cycles,
            measured,
        })
    }
}

/// The place, in samples, at which `values` cross `level` near the sample `index`; the sample itself if they do not.
fn crossing(values: &[f64], level: f64, index: usize) -> f64 {
    let between = |after: usize| -> Option<f64> {
        let before = after.checked_sub(1)?;
        let (a, b) = (values.get(before)? - level, values.get(after)? - level);
        ((a < 0.0) != (b <= 0.0)).then(|| before as f64 + a / (a - b))
    };
    let nearest = (0..=NEAR).flat_map(|off| [off, -off]);
    let mut near = nearest.filter_map(|off| between(index.checked_add_signed(off)?));
    near.next().unwrap_or(index as f64)
}

/// `values` at `count` places between the two ends `from` (excluded) and `to` (included), in samples.
fn along(values: &[f64], [from, to]: [f64; 2], count: usize) -> Vec<f64> {
    let place = |i: usize| from + (to - from) * i as f64 / count as f64;
    (1..=count).map(|i| linear(values, place(i))).collect()
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

//! The remainder of a law, and the variables that it depends on.

use mesh_damper_model::predict::predict;
use mesh_damper_model::{Model, ModelError};
use mesh_damper_recording::cycles::{FoundBlock, levels, same_amplitude};
use mesh_damper_recording::trajectory::Trajectory;

use super::wander::wanders;
use crate::tolerance::held_to;

mesh_damper_recording::numbers! {
    /// Which variables the residual of the final model depends on.
    RemainderPolicy {
        /// The range of a variable is divided into this many zones, and the residual is averaged over each.
        zones: usize = 12, Convention("as fine as in a residual table, with some hundred samples in each zone");
        /// The residual depends on a variable if the means over its zones explain at least this fraction of its square beyond the noise.
        explains: f64 = 0.15, Convention("less cannot be seen in a picture");
    }
}

/// A sample of the remainder.
struct Sample {
    left: f64,
    displacement: usize,
    velocity: usize,
    block: usize,
    amplitude: usize,
    frequency: usize,
}

/// The variables that the remainder of `model` depends on, at samples that `counts` picks, by their names in `trace.json`. A
/// variable is included if means over its zones explain enough of the remainder. Displacement and velocity are tested alone;
/// amplitude and frequency are tested for the part beyond both. The part within a block that displacement and velocity do not
/// explain belongs to the history, or to the time if it changes from cycle to cycle.
pub(super) fn depends_on(
    trajectories: &[&Trajectory],
    counts: impl Fn(usize, usize) -> bool,
    model: &Model,
) -> Result<Vec<&'static str>, ModelError> {
    let (samples, noise) = samples(trajectories, &counts, model)?;
    let energy: f64 = samples.iter().map(|one| one.left * one.left).sum();
    let beyond = energy - noise;
    let RemainderPolicy { zones, explains } = *RemainderPolicy::in_use();
    if beyond <= explains * energy {
        return Ok(Vec::new());
    }
    let explained = |key: &dyn Fn(&Sample) -> usize| explained(&samples, key) / beyond;
    let state = |one: &Sample| one.displacement * zones + one.velocity;
    let of_state = explained(&state);
    let of_block = explained(&|one| one.block * zones * zones + state(one));
    let beside = |level: fn(&Sample) -> usize| {
        explained(&|one| level(one) * zones * zones + state(one)) - of_state
    };
    let wanders = wanders(trajectories, &counts, model)?;
    let parts = [
        ("displacement", explained(&|one| one.displacement)),
        ("velocity", explained(&|one| one.velocity)),
        ("amplitude", beside(|one| one.amplitude)),
        ("frequency", beside(|one| one.frequency)),
        (if wanders { "time" } else { "history" }, 1.0 - of_block),
    ];
    let some = parts.into_iter().filter(|&(_, part)| part >= explains);
    Ok(some.map(|(name, _)| name).collect())
}

/// The samples that count and are telling, and the energy of their noise.
fn samples(
    trajectories: &[&Trajectory],
    counts: &impl Fn(usize, usize) -> bool,
    model: &Model,
) -> Result<(Vec<Sample>, f64), ModelError> {
    let blocks = || trajectories.iter().flat_map(|one| &one.blocks);
    let amplitudes = levels(blocks().map(|block| block.amplitude));
    let frequencies = levels(blocks().map(|block| block.frequency));
    let level = |levels: &[f64], value: f64| {
        let mut each = levels.iter();
        each.position(|&level| same_amplitude(level, value))
            .unwrap_or(levels.len())
    };
    let largest = |of: fn(&Trajectory) -> &[f64]| {
        let each = trajectories.iter().enumerate();
        let counted = each.flat_map(|(which, one)| {
            let values = of(one).iter().enumerate();
            let counted = values.filter(move |(sample, _)| counts(which, *sample));
            counted.map(|(_, value)| value.abs())
        });
        counted.fold(0.0_f64, f64::max)
    };
    let displacement = largest(|one| &one.motion.displacement);
    let velocity = largest(|one| &one.motion.velocity);
    let zones = RemainderPolicy::in_use().zones;
    let zone = |value: f64, largest: f64| {
        let place = 0.5 * (value / largest + 1.0) * zones as f64;
        (place as usize).min(zones - 1)
    };
    let (mut samples, mut noise, mut number) = (Vec::new(), 0.0, 0);
    for (which, trajectory) in trajectories.iter().enumerate() {
        let predicted = predict(model, trajectory)?;
        let motion = &trajectory.motion;
        for block in &trajectory.blocks {
            let FoundBlock {
                amplitude,
                frequency,
                ..
            } = *block;
            let telling = block.samples.clone();
            for i in telling.filter(|&i| counts(which, i) && trajectory.is_telling(i)) {
                noise += held_to(trajectory, i);
                samples.push(Sample {
                    left: trajectory.force[i] - predicted[i],
                    displacement: zone(motion.displacement[i], displacement),
                    velocity: zone(motion.velocity[i], velocity),
                    block: number,
                    amplitude: level(&amplitudes, amplitude),
                    frequency: level(&frequencies, frequency),
                });
            }
            number += 1;
        }
    }
    Ok((samples, noise))
}

/// The energy of the means over the samples with one key.
fn explained(samples: &[Sample], key: impl Fn(&Sample) -> usize) -> f64 {
    let mut sums: std::collections::HashMap<usize, (f64, f64)> = std::collections::HashMap::new();
    for sample in samples {
        let sum = sums.entry(key(sample)).or_default();
        sum.0 += sample.left;
        sum.1 += 1.0;
    }
    sums.values().map(|(sum, count)| sum * sum / count).sum()
}

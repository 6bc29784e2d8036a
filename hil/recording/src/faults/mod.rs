//! Channel faults: found between reading and identification, reported, and kept from looking like physics.
//!
//! A feature that repeats with the motion is physics, however sharp. A feature is a fault if it comes once, stands still while the
//! rest moves, or is impossible for a passive damper. A recording without faults is unchanged.
//!
//! Whole channels come first, by one list of repairs of the recording as read. Then single samples follow, on the uniform time base:
//! `clipping`, `held`, `spikes`. Hum comes last, when nothing hides it. Invalid forces are left out. Invalid displacements are
//! bridged, because the motion of the samples around them, and the memory of the specimen, depend on them.

use std::borrow::Cow;

pub(crate) mod bridge;
pub(crate) mod clipping;
pub(crate) mod counter;
pub(crate) mod exchanged;
pub(crate) mod held;
pub(crate) mod hum;
pub(crate) mod kind;
pub(crate) mod scale;
pub(crate) mod shift;
pub(crate) mod sign;
pub(crate) mod slower;
pub(crate) mod spikes;
pub(crate) mod velocity;

use super::Recording;
use super::resample::Uniform;
use crate::extremes::quantile;
use mesh_damper_tables::channel::Channel;

crate::numbers! {
    /// What all searches for channel faults share.
    FaultsPolicy {
        /// Two values of a channel are equal if they differ by at most this fraction of its spread.
        same_value: f64 = 1e-7, Convention("below the last digit in files, above the rounding when a value is read");
        /// The spread of a channel is the distance from its median within which this fraction of its samples lie. The usual deviation
        /// around a spike is such a distance too.
        usually: f64 = 0.9, Convention("nine in ten, so that a spike does not decide");
    }
}

pub use kind::{Between, ChannelFault, ChannelFaultKind};
pub use scale::ScalePolicy;
pub use shift::{Shift, ShiftPolicy};

/// A repair of a recording: whether there was something to repair, or to say. It then adds a fault.
type Repair = fn(&mut Recording) -> bool;

/// All of them. Rows that are no measurement come first, then jumps, because both look like a late force, a wrong unit or a wrong sign;
/// then exchanged channels, whose units and signs are those of the other.
const REPAIRS: [Repair; 5] = [
    slower::repair,
    counter::repair,
    exchanged::repair,
    scale::repair,
    sign::repair,
];

/// Each kind of repair may be made again after another. Convention: more would undo each other.
const MOST_REPAIRS: usize = 4 * REPAIRS.len();

impl Recording {
    /// The recording with channels repaired that are wrong as a whole or from some time on: `REPAIRS`. [`Recording::faults`] lists
    /// the repairs; repairing twice changes nothing more. Without a repair the copy is dropped at once.
    #[must_use]
    pub fn repaired(&self) -> Cow<'_, Self> {
        let mut recording = self.clone();
        // What one repair uncovers is seen by those before it.
        for _ in 0..MOST_REPAIRS {
            if !REPAIRS.iter().any(|repair| repair(&mut recording)) {
                break;
            }
        }
        // Every repair is reported.
        if recording.faults.len() == self.faults.len() {
            Cow::Borrowed(self)
        } else {
            Cow::Owned(recording)
        }
    }

    /// The repairs of [`Recording::repaired`], and rows that were written twice.
    pub fn faults(&self) -> &[ChannelFault] {
        &self.faults
    }
}

/// Finds faults of single samples, excludes them from the measured samples, and bridges the displacement.
pub(super) fn examine(uniform: &mut Uniform) -> Vec<ChannelFault> {
    let mut faults = Vec::new();
    let count = uniform.len();
    let mut absent = [vec![false; count], vec![false; count]];
    let present: Vec<bool> = uniform.measured.clone();
    held::find(uniform, &present, &mut absent, &mut faults);
    clipping::find(uniform, &present, &mut absent, &mut faults);
    spikes::find(uniform, &present, &mut absent, &mut faults);
    let [no_displacement, no_force] = absent;
    let unknown: Vec<bool> = (0..count)
        .map(|index| no_displacement[index] || !present[index] && !uniform.is_uneven())
        .collect();
    bridge::bridge(&mut uniform.displacement, &unknown, uniform.period);
    for index in 0..count {
        if no_force[index] || no_displacement[index] {
            uniform.measured[index] = false;
        }
    }
    bridge::bridge(&mut uniform.force, &no_force, uniform.period);
    hum::find(uniform, &mut faults);
    velocity::examine(uniform, &unknown, &mut faults);
    faults
}

/// The channels whose single samples may be faulty, with the `absent` samples of each.
fn sampled<'a>(
    uniform: &'a Uniform,
    absent: &'a mut [Vec<bool>; 2],
) -> [(Channel, &'a [f64], &'a mut Vec<bool>); 2] {
    let [displacement, force] = absent;
    [
        (Channel::Displacement, &uniform.displacement, displacement),
        (Channel::Force, &uniform.force, force),
    ]
}

/// Marks the samples of `more` too.
fn mark(marked: &mut [bool], more: &[bool]) {
    for (marked, more) in marked.iter_mut().zip(more) {
        *marked |= more;
    }
}

/// Runs of `true`.
fn runs(marked: &[bool]) -> Vec<std::ops::Range<usize>> {
    let mut runs = Vec::new();
    let mut index = 0;
    while index < marked.len() {
        if !marked[index] {
            index += 1;
            continue;
        }
        let start = index;
        while index < marked.len() && marked[index] {
            index += 1;
        }
        runs.push(start..index);
    }
    runs
}

/// Median of the `2·half + 1` values around each; those nearer to an end than `half` stay.
fn median_filtered(values: &[f64], half: usize) -> Vec<f64> {
    let mut filtered = values.to_vec();
    let mut window = vec![0.0; 2 * half + 1];
    for (index, around) in values.windows(2 * half + 1).enumerate() {
        window.copy_from_slice(around);
        filtered[index + half] = *window.select_nth_unstable_by(half, f64::total_cmp).1;
    }
    filtered
}

/// Spread of a channel: the range about the median that contains nine tenths of its samples.
fn spread(values: &[f64]) -> f64 {
    let median = quantile(&mut values.to_vec(), 0.5);
    let mut apart: Vec<f64> = values.iter().map(|value| (value - median).abs()).collect();
    quantile(&mut apart, FaultsPolicy::in_use().usually)
}

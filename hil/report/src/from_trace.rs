//! Prepares the result of a trace for a report.

use std::ops::Range;

use mesh_damper_identify::trace::{Role, Trace, Traced};
use mesh_damper_recording::Recording;
use mesh_damper_recording::cycles::FoundBlock;

use super::{ReportData, Series, SeriesBlock};

impl ReportData {
    /// The report of `trace`, which it consumes, with `facts` about the test as pairs of a name and a text.
    pub fn of_trace(title: impl Into<String>, facts: Vec<(String, String)>, trace: Trace) -> Self {
        Self {
            title: title.into(),
            facts,
            result: trace.result,
            series: trace
                .recordings
                .into_iter()
                .map(Series::of_traced)
                .collect(),
        }
    }
}

/// The specimen, device and excitation declared in the recordings' comments, as the facts of a report.
pub fn declared(recordings: &[Recording]) -> Vec<(String, String)> {
    ["specimen", "device", "excitation"]
        .into_iter()
        .filter_map(|key| {
            let text = recordings.iter().find_map(|r| r.declared(key))?;
            // Recordings of one specimen differ in their excitation.
            let same = recordings.iter().all(|r| r.declared(key) == Some(text));
            same.then(|| (key.to_owned(), text.to_owned()))
        })
        .collect()
}

impl Series {
    fn of_traced(traced: Traced) -> Self {
        let trajectory = traced.trajectory;
        let blocks = trajectory.blocks.iter();
        Self {
            blocks: blocks
                .filter_map(|block| representative(block, &traced.roles))
                .collect(),
            time: (0..trajectory.motion.displacement.len())
                .map(|sample| sample as f64 * trajectory.tick)
                .collect(),
            name: trajectory.name,
            displacement: trajectory.motion.displacement,
            velocity: trajectory.motion.velocity,
            force: trajectory.force,
            before: traced.before,
            after: traced.after,
            measured: trajectory.measured,
        }
    }
}

/// The last cycle that was held out completely, or else the last of the block. If possible, a cycle with a successor, so that its
/// loop closes.
fn representative(block: &FoundBlock, roles: &[Role]) -> Option<SeriesBlock> {
    let is_held_out = |cycle: &&Range<usize>| {
        roles
            .get((*cycle).clone())
            .is_some_and(|roles| roles.iter().all(|role| *role == Role::HeldOut))
    };
    let (last, others) = block.cycles.split_last()?;
    let held_out = others
        .iter()
        .rev()
        .chain(Some(last))
        .find(|cycle| is_held_out(cycle));
    let cycle = held_out.or(others.last()).unwrap_or(last);
    let closing = usize::from(cycle != last);
    Some(SeriesBlock {
        cycle: cycle.start..cycle.end + closing,
        cycles: block.cycles.clone(),
        amplitude: block.amplitude,
        frequency: block.frequency,
        held_out: held_out.is_some(),
    })
}

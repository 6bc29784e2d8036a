//! What a trace leaves, as a report needs it.

use std::ops::Range;

use mesh_damper_identify::trace::{Role, Trace, Traced};
use mesh_damper_recording::cycles::FoundBlock;

use super::{ReportData, Series, SeriesBlock};

impl ReportData {
    /// The report of `trace`, with `facts` about the test as pairs of a name and a text.
    pub fn of_trace(title: impl Into<String>, facts: Vec<(String, String)>, trace: &Trace) -> Self {
        Self {
            title: title.into(),
            facts,
            result: trace.result.clone(),
            series: trace.recordings.iter().map(Series::of_traced).collect(),
        }
    }
}

impl Series {
    fn of_traced(traced: &Traced) -> Self {
        let trajectory = &traced.trajectory;
        Self {
            name: trajectory.name.clone(),
            time: (0..trajectory.len())
                .map(|sample| sample as f64 * trajectory.tick)
                .collect(),
            displacement: trajectory.motion.displacement.clone(),
            velocity: trajectory.motion.velocity.clone(),
            force: trajectory.force.clone(),
            before: traced.before.clone(),
            after: traced.after.clone(),
            measured: trajectory.measured.clone(),
            blocks: trajectory
                .blocks
                .iter()
                .filter_map(|block| representative(block, &traced.roles))
                .collect(),
        }
    }
}

/// The last cycle that was held out as a whole, or else the last of the block; one that the block goes on after where
/// there is one, as its loop closes.
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
        amplitude: block.amplitude,
        frequency: block.frequency,
        held_out: held_out.is_some(),
    })
}

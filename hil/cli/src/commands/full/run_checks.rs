//! The checks of a run for a build server: one for each block, and one for the trip.

use mesh_damper::sine::{Block, Programme};

use super::junit::{Case, Junit};
use super::programme::MOST_BLOCKS;
use super::run::Summary;

impl Summary {
    /// Adds to `junit` a case for each block of `programme` (or one for a motion), and one for a trip.
    pub(super) fn checked(
        &self,
        mut junit: Junit,
        programme: Option<&Programme<MOST_BLOCKS>>,
    ) -> Junit {
        junit.property("on", &self.on);
        junit.property("specimen", &self.specimen);
        junit.property("seed", self.seed);
        junit.property("tick rate, Hz", self.tick_rate);
        junit.property("ticks", self.ticks);
        let mut trip = self.stopped.as_ref();
        for (index, block) in programme
            .into_iter()
            .flat_map(Programme::blocks)
            .enumerate()
        {
            let steady = self.cycles.iter().filter(|cycle| cycle.is_steady_in(index));
            let done = steady.count();
            let case = match trip {
                _ if done >= block.cycles() as usize => Case::Passed,
                Some(stop) => {
                    trip = None;
                    Case::Failed(format!(
                        "{} after {done} of {} cycles, {:.3} s after the start",
                        stop.fault,
                        block.cycles(),
                        stop.time
                    ))
                }
                None => Case::Skipped("the rig tripped before it".into()),
            };
            junit.case("block", &name_of(index, block), case, None);
        }
        if let Some(motion) = &self.drive {
            junit.case("motion", motion.source(), self.ended(), None);
        }
        junit.case("trip", "the rig runs to its end", self.ended(), None);
        junit
    }

    fn ended(&self) -> Case {
        match &self.stopped {
            Some(stop) => Case::Failed(format!(
                "{}, {:.3} s after the start",
                stop.fault, stop.time
            )),
            None => Case::Passed,
        }
    }
}

fn name_of(index: usize, block: &Block) -> String {
    let [from, to] = [block.from(), block.to()];
    let frequency = if from == to {
        format!("{from} Hz")
    } else {
        format!("{from} to {to} Hz")
    };
    format!(
        "block {}: {} mm, {frequency}, {} cycles",
        index + 1,
        block.amplitude(),
        block.cycles()
    )
}

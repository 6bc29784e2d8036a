//! The checks of a run for a build server: one for each block, and one for the trip.

use mesh_damper::sine::{Block, Programme};

use super::super::junit::{Case, Junit};
use super::super::programme::MOST_BLOCKS;
use super::test::Summary;
use super::trip::Stop;

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
        let trip = self.stopped.as_ref();
        let mut is_short = false;
        for (index, block) in programme
            .into_iter()
            .flat_map(Programme::blocks)
            .enumerate()
        {
            let steady = self.cycles.iter().filter(|cycle| cycle.is_steady_in(index));
            let case = case_of([steady.count(), block.cycles() as usize], trip, is_short);
            is_short |= matches!(case, Case::Failed(_));
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

/// A block with the cycles `done` of `wanted`. A trip ends the first block that is short; `is_after` says that there was one before.
fn case_of([done, wanted]: [usize; 2], trip: Option<&Stop>, is_after: bool) -> Case {
    match trip {
        _ if done >= wanted => Case::Passed,
        Some(_) if is_after => Case::Skipped("the rig tripped before it".into()),
        Some(stop) => Case::Failed(format!(
            "{} after {done} of {wanted} cycles, {:.3} s after the start",
            stop.fault, stop.time
        )),
        None => Case::Failed(format!(
            "{done} of {wanted} cycles, although the rig did not trip"
        )),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_that_is_short_without_a_trip_fails() {
        let said = |case| match case {
            Case::Passed => "passed".to_owned(),
            Case::Failed(reason) => format!("failed: {reason}"),
            Case::Skipped(reason) => format!("skipped: {reason}"),
        };
        let stop = Stop {
            time: 1.25,
            fault: "the force exceeded its limit".into(),
        };
        assert_eq!(said(case_of([3, 3], None, false)), "passed");
        for is_after in [false, true] {
            assert_eq!(
                said(case_of([2, 3], None, is_after)),
                "failed: 2 of 3 cycles, although the rig did not trip"
            );
        }
        assert_eq!(
            said(case_of([2, 3], Some(&stop), false)),
            "failed: the force exceeded its limit after 2 of 3 cycles, 1.250 s after the start"
        );
        assert_eq!(
            said(case_of([0, 3], Some(&stop), true)),
            "skipped: the rig tripped before it"
        );
    }
}

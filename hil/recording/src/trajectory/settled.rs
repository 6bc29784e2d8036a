//! What a specimen remembers from before its recording, and for how long.
//!
//! A slider is stretched, and stress relaxes. Where the motion before is not recorded, the force is off by what nothing shows.

use std::ops::Range;

use super::Trajectory;

crate::numbers! {
    /// When a recording shows what its specimen remembers.
    SettledPolicy {
        /// What a specimen remembers from before its recording is forgotten after this many cycles.
        forgotten: f64 = 1.0, Derived("both ends of the motion were reached: a slider slips there, and a Preisach model is wiped out");
        /// The same after a pause of the channels of at least this many cycles.
        lost: f64 = 0.25, Convention("a shorter one has at most one turn, and the displacement is continued through it");
        /// Such a cycle is left out only if it is at most this fraction of its block, or half of it of a recording without blocks, whose
        /// cycles may be one each of an amplitude.
        spared: f64 = 0.26, Convention("of a block of four cycles one; of three, two would be left");
        /// A recording begins at rest too if its first velocity and acceleration are at most this fraction of the largest in the first cycle.
        from_rest: f64 = 0.1, Convention("a sine has 0.7 of one of them or more; one that grows from nothing has neither");
    }
}

impl Trajectory {
    /// Whether the force at a sample can be compared with that of a model: it was measured, and the recording shows how the specimen was
    /// moved before.
    pub fn is_comparable(&self, index: usize) -> bool {
        let after = self.unsettled.partition_point(|run| run.end <= index);
        let unsettled = self.unsettled.get(after);
        self.measured[index] && unsettled.is_none_or(|run| index < run.start)
    }

    fn begins_at_rest(&self) -> bool {
        let first = self.cycles.partition_point(|&cycle| cycle < 1.0);
        let starts = |channel: &[f64]| {
            let largest = channel[..first]
                .iter()
                .fold(0.0, |a: f64, v| a.max(v.abs()));
            channel[0].abs() <= SettledPolicy::in_use().from_rest * largest
        };
        let motion = &self.motion;
        motion.is_at_rest(0) || starts(&motion.velocity) && starts(&motion.acceleration)
    }

    /// The first cycle of a recording that does not begin at rest, and that after each pause of its channels.
    pub(super) fn unsettled(&self) -> Vec<Range<usize>> {
        let SettledPolicy {
            forgotten,
            lost,
            spared,
            ..
        } = *SettledPolicy::in_use();
        let mut all = Vec::new();
        let mut leave_out = |from: usize| {
            let known = self.cycles[from] + forgotten;
            let until = from + self.cycles[from..].partition_point(|&cycle| cycle < known);
            let mut blocks = self.blocks.iter().filter(|block| block.cycles.len() > 1);
            let block = blocks.find(|block| block.samples.contains(&from));
            let whole = block.map_or(self.len() / 2, |block| block.samples.len());
            if (until - from) as f64 <= spared * whole as f64 {
                all.push(from..until);
            }
        };
        if !self.begins_at_rest() {
            leave_out(0);
        }
        let mut start = 0;
        for run in self.measured.chunk_by(|a, b| a == b) {
            let end = start + run.len();
            if !run[0] && end < self.len() && self.cycles[end] - self.cycles[start] >= lost {
                leave_out(end);
            }
            start = end;
        }
        all
    }
}

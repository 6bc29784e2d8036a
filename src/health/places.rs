//! The ticks of a cycle for a close look: 32 places, with other ones in every second cycle.

/// Bits of the phase that number the parts of a cycle: 32 parts, with a close look at the end of each.
const LOOKS: u32 = 5;

/// Delay of the ends of the parts, 2³² per cycle: a quarter of a part and three quarters in turn, so that two cycles are looked at
/// in 64 places. Not 0, because the tick that ends a cycle has enough work already.
pub(super) fn late(cycle: u32) -> u32 {
    const QUARTER: u32 = 1 << (30 - LOOKS);
    (1 + 2 * (cycle & 1)) * QUARTER
}

/// End of the part at `phase` of a `cycle`; after the last part, the end of the first part of the next cycle.
pub(super) fn part_end(phase: u32, cycle: u32) -> u32 {
    let late_now = late(cycle);
    let Some(past) = phase.checked_sub(late_now) else {
        return late_now;
    };
    let end = ((past >> (32 - LOOKS)) + 1) << (32 - LOOKS);
    // The phase of the last part's end is 0.
    end + if end > 0 { late_now } else { late(cycle ^ 1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In units of 1/128 cycle the ends are at 1, 5, 9… in one cycle and at 3, 7, 11… in the next.
    #[test]
    fn two_cycles_are_looked_at_in_64_places() {
        let mut due = late(0);
        for look in 0..64u32 {
            let (cycle, part) = (look / 32, look % 32);
            assert_eq!(due, (4 * part + 1 + 2 * cycle) << 25);
            let next = part_end(due, cycle);
            assert_eq!(part_end(due + (1 << 24), cycle), next);
            due = next;
        }
        assert_eq!(due, late(2));
        // The last part's look may come after the cycle's end.
        assert_eq!((part_end(0, 0), part_end(0, 1)), (late(0), late(1)));
    }
}

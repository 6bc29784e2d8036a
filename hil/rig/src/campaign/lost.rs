//! Duration of a channel's loss.

/// Cycles that it takes to detect a loss, at most: the longest time in the safety concept's table, for a force channel in the first
/// cycles.
const KNOWN_WITHIN: f64 = 2.25;

/// Duration for which a channel has shown false values, in ticks while the rig ran.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LostSince {
    /// Ticks for which it has not been right.
    lost: usize,
    /// Number of the last of these that were right again, because the quantity passes through the shown value.
    again: usize,
}

impl LostSince {
    /// Takes a tick while the rig ran.
    pub(super) fn tick(&mut self, is_false: bool, cycle_ticks: usize) {
        if !is_false && self.lost == 0 {
            return;
        }
        self.lost += 1;
        self.again = if is_false { 0 } else { self.again + 1 };
        if self.again >= cycle_ticks {
            *self = Self::default();
        }
    }

    /// Whether it is lost, for no longer than it takes to detect it.
    pub(super) fn is_new(&self, cycle_ticks: usize) -> bool {
        self.lost > 0 && self.lost as f64 <= KNOWN_WITHIN * cycle_ticks as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loss_is_new_until_it_must_be_known() {
        let mut since = LostSince::default();
        for _ in 0..1000 {
            since.tick(false, 100);
            assert!(!since.is_new(100));
        }
        for lost in 1..400 {
            since.tick(true, 100);
            assert_eq!(since.is_new(100), lost <= 225, "{lost}");
        }
    }

    /// The quantity passes through the shown value twice in each cycle.
    #[test]
    fn what_is_right_by_chance_is_lost_all_the_same() {
        let mut since = LostSince::default();
        for tick in 0..300 {
            since.tick(tick % 50 > 10, 100);
        }
        assert!(!since.is_new(100));
        // A cycle of right samples ends it, and one false sample is a new loss.
        for _ in 0..100 {
            since.tick(false, 100);
        }
        since.tick(true, 100);
        assert!(since.is_new(100));
    }
}

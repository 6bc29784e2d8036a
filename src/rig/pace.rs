//! Checks that ticks are in time, with a counter that the caller reads at each tick.

use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::in_range;

/// Fastest counter, Hz.
const FASTEST: f64 = 4e9;
/// Most counts per tick: one and a half times this is below the counter's 2³².
const MOST_COUNTS: f64 = 2e9;

/// Permitted counts of a tick, validated: with p counts per tick from ⌈p/2⌉ to ⌊3p/2⌋.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PaceConfig {
    least: u32,
    /// The most minus the least, so that one comparison checks both.
    span: u32,
}

impl PaceConfig {
    /// Both in Hz. A `clock_rate` of 0 is a counter of ticks.
    pub(super) fn new(tick_rate: f64, clock_rate: f64) -> Result<Self, ConfigError> {
        in_range("tick_rate", tick_rate, 1.0, 1e6)?;
        let counts = if clock_rate == 0.0 {
            1.0
        } else {
            let fastest = FASTEST.min(MOST_COUNTS * tick_rate);
            in_range("clock_rate", clock_rate, tick_rate, fastest)? / tick_rate
        };
        // The casts truncate: half a tick is rounded up, and one and a half is rounded down.
        let below = (0.5 * counts) as u32;
        let half = f64::from(below);
        let rounded = half < 0.5 * counts;
        let least = below + u32::from(rounded);
        Ok(Self {
            least,
            span: (1.5 * counts) as u32 - least,
        })
    }

    /// Whether these limits belong to a number p of counts per tick, at least 1: from 2·(least − 1) < p ≤ 2·least follows 3·(least
    /// − 1) ≤ most ≤ 3·least.
    fn is_sound(self) -> bool {
        let (least, span) = (u64::from(self.least), u64::from(self.span));
        least >= 1 && span + 3 >= 2 * least && span <= 2 * least
    }
}

impl Fields for PaceConfig {
    fn write(&self, writer: &mut Writer<'_>) {
        writer.words([self.least, self.span]);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [least, span] = reader.words()?;
        Some(Self { least, span }).filter(|config| config.is_sound())
    }
}

/// The last count, and the number of late or early ticks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pace {
    last: u32,
    late: u32,
}

impl Pace {
    /// Takes a tick at which the counter reads `clock`; returns whether it was in time. The `first` one always is.
    #[inline]
    pub(super) fn tick(&mut self, config: &PaceConfig, clock: u32, first: bool) -> bool {
        let elapsed = clock.wrapping_sub(self.last);
        self.last = clock;
        // A difference below the least wraps.
        if elapsed.wrapping_sub(config.least) <= config.span || first {
            return true;
        }
        self.late = self.late.wrapping_add(1);
        false
    }

    /// Ticks that were not in time; wraps.
    pub(super) fn late(&self) -> u32 {
        self.late
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(tick_rate: f64, clock_rate: f64) -> [u32; 2] {
        let config = PaceConfig::new(tick_rate, clock_rate).unwrap();
        assert!(config.is_sound(), "{config:?}");
        [config.least, config.least + config.span]
    }

    #[test]
    fn half_a_tick_to_one_and_a_half() {
        assert_eq!(limits(10_000.0, 0.0), [1, 1]);
        assert_eq!(limits(10_000.0, 10_000.0), [1, 1]);
        assert_eq!(limits(10_000.0, 168e6), [8_400, 25_200]);
        // 1.5, 3 and 3.1 counts per tick.
        assert_eq!(limits(2.0, 3.0), [1, 2]);
        assert_eq!(limits(1.0, 3.0), [2, 4]);
        assert_eq!(limits(10.0, 31.0), [2, 4]);
        assert_eq!(limits(1.0, 2e9), [1_000_000_000, 3_000_000_000]);
        for counts in 1..10_000u32 {
            limits(7.0, 7.0 + f64::from(counts) / 3.0);
        }
    }

    #[test]
    fn a_clock_that_cannot_tell_is_refused() {
        for rate in [f64::NAN, f64::INFINITY] {
            let refused = PaceConfig::new(1000.0, rate);
            assert_eq!(refused, Err(ConfigError::NonFinite("clock_rate")));
        }
        for (tick_rate, rate) in [
            (1000.0, -1.0),
            (1000.0, 999.0),
            (1000.0, 4.1e9),
            (1.0, 2.1e9),
        ] {
            let field = "clock_rate";
            let refused = PaceConfig::new(tick_rate, rate);
            assert!(
                matches!(refused, Err(ConfigError::OutOfRange { field: which, .. }) if which == field),
                "{tick_rate} {rate}: {refused:?}"
            );
        }
        assert!(PaceConfig::new(0.5, 0.0).is_err());
    }

    #[test]
    fn the_first_tick_is_not_judged_and_the_counter_wraps() {
        let config = PaceConfig::new(1000.0, 10_000.0).unwrap();
        // For any count, also one that happens to be in time.
        for start in [0, 10, 12_345, u32::MAX] {
            let mut pace = Pace::default();
            let mut clock = start;
            assert!(pace.tick(&config, clock, true));
            for (counts, in_time) in [
                (10, true),
                (5, true),
                (15, true),
                (4, false),
                (16, false),
                (0, false),
                (u32::MAX, false),
                (10, true),
            ] {
                clock = clock.wrapping_add(counts);
                assert_eq!(
                    pace.tick(&config, clock, false),
                    in_time,
                    "{counts} from {start}"
                );
            }
            assert_eq!(pace.late(), 4);
        }
    }

    #[test]
    fn limits_that_no_clock_has_are_not_read() {
        let mut bytes = [0; 8];
        let written = PaceConfig::new(10_000.0, 168e6).unwrap();
        written.write(&mut Writer::new(&mut bytes));
        assert_eq!(PaceConfig::read(&mut Reader(&bytes)), Some(written));
        for words in [
            [0, 0],
            [0, 1],
            [3, 2],
            [1, 3],
            [8_400, 16_801],
            [8_400, 16_796],
            [1, u32::MAX],
            [u32::MAX, u32::MAX],
        ] {
            Writer::new(&mut bytes).words(words);
            assert_eq!(PaceConfig::read(&mut Reader(&bytes)), None, "{words:?}");
        }
    }
}

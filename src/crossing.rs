//! Finds where cycles begin without a generator: at zero crossings of the displacement.
//!
//! A cycle begins where the displacement rises through its running mean, which is the mean of the cycle before. Noise about the
//! mean must not start cycles. So the displacement must have been below the mean by the hysteresis before a crossing counts; before
//! the next crossing it must have been above the mean by the hysteresis, and below it again.
//!
//! After a jump of the mean by more than the amplitude, or after one outlier, the displacement swings entirely on one side of the
//! assumed mean. After four such swings in a row ([`SWINGS`]), each of more than twice the hysteresis up and down, the detector
//! starts again. It counts swings of the motion, not time: at rest, or in a slow motion, it waits.

use crate::cycle::{Cycle, CycleAccumulator};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};
use crate::sum::{FOLD, Sum};

/// Result of the detector for one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Crossing {
    /// Phase, 2³² per cycle, assuming that the cycle lasts as long as the one before. If it lasts longer, the phase waits just
    /// below a whole cycle until the crossing. 0 until a first cycle has been measured.
    pub phase: u32,
    /// A cycle ended between the last sample and this one, at this part of the interval, 0…1.
    pub boundary: Option<f32>,
    /// The mean is lost and the detector starts again: no cycle is under way until the next boundary.
    pub lost: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Side {
    /// The displacement has not been above the mean by the hysteresis since the last crossing.
    #[default]
    Rising,
    /// It has been above.
    Above,
    /// It has been above and then below: the next crossing counts.
    Below,
}

/// The detector's state.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// At least one sample has been taken.
    begun: bool,
    /// Crossings so far, up to [`SETTLED`].
    crossings: u8,
    side: Side,
    last: f32,
    highest: f32,
    lowest: f32,
    /// Displacement taken as zero, mm.
    centre: f32,
    swings: Swings,
    /// Sum of the samples since the last crossing, and their number.
    sum: Sum,
    ticks: u32,
    /// The part of a tick between the last crossing and the sample before it.
    offset: f32,
    /// 2³² divided by the period in ticks; 0 while no period is known.
    turn: f32,
}

/// Crossings before the first boundary is given: the first cycle gives a mean, and the second begins and ends at means.
const SETTLED: u8 = 3;

/// Swings on one side of the mean after which the mean is rejected.
pub const SWINGS: u8 = 4;

/// Counts how often the displacement has gone up and down by more than a given span.
#[derive(Clone, Copy, Debug, Default)]
struct Swings {
    up: bool,
    /// Highest displacement on the way up, lowest on the way down, mm.
    turning: f32,
    /// Number of turns from up to down.
    count: u8,
}

impl Swings {
    #[inline(always)]
    fn update(&mut self, y: f32, span: f32) {
        let beyond = if self.up {
            y - self.turning
        } else {
            self.turning - y
        };
        if beyond > 0.0 {
            self.turning = y;
        } else if beyond < -span {
            self.turning = y;
            self.count = self.count.saturating_add(u8::from(self.up));
            self.up = !self.up;
        }
    }
}

/// Finds the cycles of a displacement.
///
/// Before the first crossing the midpoint of the extremes so far serves as the mean. The first two whole cycles settle mean and
/// period; the end of the second is the first boundary.
#[derive(Clone, Copy, Debug)]
pub struct CrossingDetector {
    hysteresis: f32,
    seen: Seen,
}

impl CrossingDetector {
    /// * `hysteresis`: mm, 1e-9…1e4, above the noise's peak and below the motion's amplitude
    ///
    /// # Errors
    /// `hysteresis` is not finite or out of range.
    pub fn new(hysteresis: f32) -> Result<Self, ConfigError> {
        Ok(Self {
            hysteresis: in_range("hysteresis", hysteresis, 1e-9, 1e4)?,
            seen: Seen::default(),
        })
    }

    /// Resets the detector to its initial state.
    pub fn reset(&mut self) {
        self.seen = Seen::default();
    }

    /// Takes one tick's displacement in mm. A value beyond ±[`limits::DISPLACEMENT`] is treated as the limit, NaN as 0.
    #[inline]
    pub fn update(&mut self, displacement: f32) -> Crossing {
        let y = displacement.clamped(limits::DISPLACEMENT as f32);
        let seen = &mut self.seen;
        seen.swings.update(y, 2.0 * self.hysteresis);
        let lost = seen.swings.count >= SWINGS;
        if lost || !seen.begun {
            *seen = Seen::start(y);
            return Crossing {
                lost,
                ..Crossing::default()
            };
        }
        if seen.crossings == 0 {
            if y > seen.highest {
                seen.highest = y;
            }
            if y < seen.lowest {
                seen.lowest = y;
            }
            seen.centre = 0.5 * (seen.highest + seen.lowest);
        }
        let last = core::mem::replace(&mut seen.last, y);
        let mut boundary = None;
        seen.sum.add(y);
        seen.ticks = seen.ticks.saturating_add(1);
        if seen.ticks.is_multiple_of(FOLD) {
            seen.sum.fold();
        }
        match seen.side {
            Side::Rising if y > seen.centre + self.hysteresis => {
                seen.side = Side::Above;
                seen.swings.count = 0;
            }
            Side::Above if y < seen.centre - self.hysteresis => {
                seen.side = Side::Below;
                seen.swings.count = 0;
            }
            Side::Below if y >= seen.centre => {
                let part = ((seen.centre - last) / (y - last)).clamped(1.0);
                boundary = seen.crossing(y, part);
            }
            _ => {}
        }
        let phase = ((seen.ticks as f32 - seen.offset) * seen.turn) as u32;
        Crossing {
            phase,
            boundary,
            lost: false,
        }
    }
}

impl Seen {
    fn start(y: f32) -> Self {
        Self {
            begun: true,
            last: y,
            highest: y,
            lowest: y,
            centre: y,
            swings: Swings {
                turning: y,
                ..Swings::default()
            },
            ..Self::default()
        }
    }

    /// The displacement has risen through the mean at `part` of a tick, to `y`, which the sum already contains.
    fn crossing(&mut self, y: f32, part: f32) -> Option<f32> {
        let samples = self.ticks.saturating_sub(1).max(1) as f32;
        if self.crossings > 0 {
            self.centre = (self.sum.total() - y) / samples;
            self.turn = (1u64 << 32) as f32 / (samples + part - self.offset);
        }
        self.crossings = self.crossings.saturating_add(1).min(SETTLED);
        self.side = Side::Rising;
        self.swings.count = 0;
        self.sum = Sum::default();
        self.sum.add(y);
        self.ticks = 1;
        self.offset = part;
        (self.crossings == SETTLED).then_some(part)
    }
}

/// A [`CycleAccumulator`] that finds its cycles from the displacement.
///
/// The energy of the first harmonics needs the phase within the current cycle, which is computed from the period of the cycle
/// before. The accumulator is therefore meant for a steady motion; its error is about the relative difference between successive
/// periods.
#[derive(Clone, Copy, Debug)]
pub struct CrossingAccumulator {
    detector: CrossingDetector,
    accumulator: CycleAccumulator<1>,
}

impl CrossingAccumulator {
    /// * `hysteresis`: mm, 1e-9…1e4, above the noise's peak and below the motion's amplitude
    ///
    /// # Errors
    /// `hysteresis` is not finite or out of range.
    pub fn new(hysteresis: f32) -> Result<Self, ConfigError> {
        Ok(Self {
            detector: CrossingDetector::new(hysteresis)?,
            accumulator: CycleAccumulator::new(),
        })
    }

    /// Resets the accumulator to its initial state.
    pub fn reset(&mut self) {
        self.detector.reset();
        self.accumulator.reset();
    }

    /// Takes one tick's displacement (mm) and force (kN), treated as in [`CycleAccumulator::update`]. Returns each complete cycle,
    /// from the third on.
    #[inline]
    pub fn update(&mut self, displacement: f32, force: f32) -> Option<Cycle> {
        let Crossing {
            phase,
            boundary,
            lost,
        } = self.detector.update(displacement);
        if lost {
            self.accumulator.reset();
        }
        self.accumulator
            .update_at(displacement, [force], phase, boundary)
            .map(|[cycle]| cycle)
    }
}

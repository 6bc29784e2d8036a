//! The operating range of a law: the motion on which it was fitted. Checks whether a motion lies within it.
//!
//! A law gives a finite force outside the range too. Its error there depends on how its effects grow; see
//! [`Growth`](crate::effects::description::Growth). A firmware checks an [`OperatingRange`] in addition to calling its law, and a
//! [`RangeCounter`] counts the ticks outside. A firmware that uses neither has no cost: law and rig do not use them.
//!
//! ```
//! use mesh_damper::operating_range::{OperatingRange, RangeCounter};
//!
//! // mm and mm/s, with a margin of 5 % for overshoot and noise.
//! let range = OperatingRange::new([-0.2_f32, 0.2], [-6.3, 6.3])?.widened(0.05)?;
//! let mut counter = RangeCounter::new(range);
//! assert!(counter.tick(0.205, -6.3));
//! assert!(!counter.tick(0.25, 0.0));
//! assert_eq!(counter.outside(), 1);
//! # Ok::<(), mesh_damper::error::ConfigError>(())
//! ```

use crate::error::ConfigError;
use crate::real::{Real, in_range};

/// Least and largest displacement and velocity of the motion on which a law was fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "Ends<R>",
        bound(deserialize = "R: Real + serde::Deserialize<'de>")
    )
)]
pub struct OperatingRange<R> {
    displacement: [R; 2],
    velocity: [R; 2],
}

/// An [`OperatingRange`] as read, before it is validated.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename = "OperatingRange")]
struct Ends<R> {
    displacement: [R; 2],
    velocity: [R; 2],
}

#[cfg(feature = "serde")]
impl<R: Real> TryFrom<Ends<R>> for OperatingRange<R> {
    type Error = ConfigError;

    fn try_from(ends: Ends<R>) -> Result<Self, ConfigError> {
        Self::new(ends.displacement, ends.velocity)
    }
}

impl<R: Real> OperatingRange<R> {
    /// * `displacement`: least and largest, mm
    /// * `velocity`: least and largest, mm/s
    ///
    /// # Errors
    /// A bound that is not finite, or a largest value below its least: [`ConfigError::OutOfRange`] with the largest as the value.
    pub fn new(displacement: [R; 2], velocity: [R; 2]) -> Result<Self, ConfigError> {
        Ok(Self {
            displacement: ordered("displacement", displacement)?,
            velocity: ordered("velocity", velocity)?,
        })
    }

    /// Widens each range at both ends by `part` of the end that is further from 0, because overshoot and noise take a motion beyond
    /// the fitted one.
    ///
    /// * `part`: 0…1e3
    ///
    /// # Errors
    /// `part` is not finite or out of range, or a bound is no longer finite.
    pub fn widened(&self, part: R) -> Result<Self, ConfigError> {
        let part = in_range("part", part, 0.0, 1e3)?;
        let wider = |[low, high]: [R; 2]| {
            let margin = part * larger(low.abs(), high.abs());
            [low - margin, high + margin]
        };
        Self::new(wider(self.displacement), wider(self.velocity))
    }

    /// Least and largest displacement, mm.
    pub fn displacement(&self) -> [R; 2] {
        self.displacement
    }

    /// Least and largest velocity, mm/s.
    pub fn velocity(&self) -> [R; 2] {
        self.velocity
    }

    /// Whether a `displacement` in mm and a `velocity` in mm/s are both within, bounds included. NaN is outside.
    #[inline(always)]
    pub fn holds(&self, displacement: R, velocity: R) -> bool {
        let within = |value: R, [low, high]: [R; 2]| value >= low && value <= high;
        within(displacement, self.displacement) && within(velocity, self.velocity)
    }
}

/// Counts the ticks outside an [`OperatingRange`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeCounter<R> {
    range: OperatingRange<R>,
    outside: u64,
}

impl<R: Real> RangeCounter<R> {
    /// A counter at 0.
    pub const fn new(range: OperatingRange<R>) -> Self {
        Self { range, outside: 0 }
    }

    /// Counts a tick with a `displacement` in mm and a `velocity` in mm/s, those of a [`crate::rig::Telemetry`] for instance, and
    /// returns whether it was within.
    #[inline(always)]
    pub fn tick(&mut self, displacement: R, velocity: R) -> bool {
        let holds = self.range.holds(displacement, velocity);
        self.outside = self.outside.wrapping_add(u64::from(!holds));
        holds
    }

    /// Ticks outside since construction or [`RangeCounter::clear`].
    pub fn outside(&self) -> u64 {
        self.outside
    }

    /// Sets the count to 0.
    pub fn clear(&mut self) {
        self.outside = 0;
    }

    /// The range.
    pub fn range(&self) -> &OperatingRange<R> {
        &self.range
    }
}

/// Returns `range` if its bounds are finite and in order.
fn ordered<R: Real>(field: &'static str, range: [R; 2]) -> Result<[R; 2], ConfigError> {
    let [low, high] = range;
    if !(low.is_finite() && high.is_finite()) {
        return Err(ConfigError::NonFinite(field));
    }
    if high < low {
        return Err(ConfigError::OutOfRange {
            field,
            value: high.to_f64(),
            low: low.to_f64(),
            high: f64::INFINITY,
        });
    }
    Ok(range)
}

fn larger<R: Real>(a: R, b: R) -> R {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use proptest::prelude::*;
    use std::string::ToString as _;

    fn range() -> OperatingRange<f32> {
        OperatingRange::new([-0.1, 0.3], [-6.0, 6.0]).unwrap()
    }

    #[test]
    fn a_motion_is_within_where_both_are() {
        for (displacement, velocity, within) in [
            (0.0, 0.0, true),
            (-0.1, -6.0, true),
            (0.3, 6.0, true),
            (0.300_01, 0.0, false),
            (-0.100_01, 0.0, false),
            (0.0, 6.000_1, false),
            (0.0, -6.000_1, false),
            (f32::NAN, 0.0, false),
            (0.0, f32::NAN, false),
            (f32::INFINITY, 0.0, false),
        ] {
            assert_eq!(
                range().holds(displacement, velocity),
                within,
                "{displacement} {velocity}"
            );
        }
    }

    #[test]
    fn bounds_that_are_none_are_refused_by_name() {
        let refused = |displacement, velocity| {
            OperatingRange::<f32>::new(displacement, velocity)
                .unwrap_err()
                .to_string()
        };
        let fine = [-1.0, 1.0];
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for (displacement, velocity, field) in [
                ([bad, 1.0], fine, "displacement"),
                ([-1.0, bad], fine, "displacement"),
                (fine, [bad, 1.0], "velocity"),
                (fine, [-1.0, bad], "velocity"),
            ] {
                assert_eq!(
                    refused(displacement, velocity),
                    std::format!("{field} is not a finite number")
                );
            }
        }
        assert_eq!(
            refused([0.5, -0.5], fine),
            "displacement = -0.5 is outside 0.5…inf"
        );
        assert_eq!(refused(fine, [2.0, 1.0]), "velocity = 1 is outside 2…inf");
        // A motion at a single point is a range.
        assert!(OperatingRange::<f32>::new([0.0; 2], [0.0; 2]).is_ok());
        for part in [-0.1, 1.1e3, f32::NAN] {
            assert!(range().widened(part).is_err());
        }
        let largest = OperatingRange::new([0.0, f32::MAX], fine).unwrap();
        assert_eq!(
            largest.widened(1.0),
            Err(ConfigError::NonFinite("displacement"))
        );
    }

    #[test]
    fn a_margin_is_a_part_of_the_larger_end_on_both_sides() {
        let wider = range().widened(0.5).unwrap();
        assert_eq!(wider.displacement(), [-0.1 - 0.15, 0.3 + 0.15]);
        assert_eq!(wider.velocity(), [-9.0, 9.0]);
    }

    proptest! {
        /// The count is the number of motions outside the range, and `clear` restarts it.
        #[test]
        fn ticks_outside_are_counted(motions in prop::collection::vec((-0.5..0.5f32, -9.0..9.0f32), 0..50)) {
            let mut counter = RangeCounter::new(range());
            for (count, &(y, v)) in motions.iter().enumerate() {
                let expected = !(-0.1..=0.3).contains(&y) || v.abs() > 6.0;
                prop_assert_eq!(counter.tick(y, v), !expected);
                let before = motions[..=count].iter();
                let outside = before.filter(|(y, v)| !range().holds(*y, *v)).count();
                prop_assert_eq!(counter.outside(), outside as u64);
            }
            counter.clear();
            prop_assert_eq!(counter.outside(), 0);
        }
    }
}

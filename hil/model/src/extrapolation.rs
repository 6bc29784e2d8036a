//! The part of a motion outside the operating range of a model, and its distance from the range.

use mesh_damper::error::ConfigError;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::real::Real;
use serde::Serialize;

use crate::file::FittedRange;

/// Margin for overshoot and noise: a motion counts as outside if it exceeds the operating range by more than this fraction of the
/// range's larger end.
pub const RANGE_MARGIN: f64 = 0.05;

/// The part of a motion outside the operating range, sample by sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Extrapolation {
    /// Fraction, 0…1, of the samples whose displacement or velocity is outside.
    pub part: f64,
    /// Displacement outside its range.
    pub displacement: Beyond,
    /// Velocity outside its range.
    pub velocity: Beyond,
}

/// The part of a channel outside its range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Beyond {
    /// Fraction, 0…1, of the samples that are outside by more than [`RANGE_MARGIN`].
    pub part: f64,
    /// Largest distance outside, as a multiple of the range's larger end, with the margin included. It is 0 for a motion within the
    /// range, and infinite for a range of 0.
    pub most: f64,
}

impl Extrapolation {
    /// The extrapolation of a motion's samples: `displacement` in mm and `velocity` in mm/s, of the same length.
    pub fn of<'a>(
        range: &FittedRange,
        displacement: impl IntoIterator<Item = &'a f64>,
        velocity: impl IntoIterator<Item = &'a f64>,
    ) -> Self {
        let samples = displacement.into_iter().zip(velocity);
        Self::of_motions(
            range,
            samples.map(|(&y, &v)| FittedRange {
                displacement: [y; 2],
                velocity: [v; 2],
            }),
        )
    }

    /// The extrapolation of motions that count as one sample each, such as the sines of a sweep, given by their ranges.
    pub fn of_motions(range: &FittedRange, motions: impl IntoIterator<Item = FittedRange>) -> Self {
        let mut count = 0_usize;
        let mut outside = [0_usize; 3];
        let mut most = [0.0_f64; 2];
        for motion in motions {
            let beyond = range.exceeded_in(&motion);
            let [y, v] = beyond.map(|beyond| beyond > RANGE_MARGIN);
            count += 1;
            for (outside, is) in outside.iter_mut().zip([y || v, y, v]) {
                *outside += usize::from(is);
            }
            for (most, beyond) in most.iter_mut().zip(beyond) {
                *most = most.max(beyond);
            }
        }
        let [part, y, v] = outside.map(|outside| outside as f64 / count.max(1) as f64);
        let channel = |part, most| Beyond { part, most };
        Self {
            part,
            displacement: channel(y, most[0]),
            velocity: channel(v, most[1]),
        }
    }

    /// The larger of both channels' distances, as a multiple of the range.
    pub fn most(&self) -> f64 {
        self.displacement.most.max(self.velocity.most)
    }

    /// The warning, with the name `samples` for the samples and `model` for the model with the range. `None` if all are within, or
    /// beyond by no more than [`RANGE_MARGIN`].
    pub fn in_words(&self, samples: &str, model: &str) -> Option<String> {
        let channels = [
            ("displacement", self.displacement),
            ("velocity", self.velocity),
        ];
        let words: Vec<String> = channels
            .into_iter()
            .filter(|(_, beyond)| beyond.part > 0.0)
            .map(|(name, Beyond { part, most })| {
                format!(
                    "{name} at {} by up to {most:.2} times the range",
                    percent(part)
                )
            })
            .collect();
        (!words.is_empty()).then(|| {
            format!(
                "{} of the {samples} lie outside the operating range of {model}: {}",
                percent(self.part),
                words.join(", ")
            )
        })
    }
}

/// Less than a tenth of a percent does not print as zero.
pub fn percent(part: f64) -> String {
    match 100.0 * part {
        some if some > 0.0 && some < 0.1 => "less than 0.1 %".into(),
        percent => format!("{percent:.1} %"),
    }
}

impl FittedRange {
    /// The range for a firmware, without a margin. [`OperatingRange::widened`] by [`RANGE_MARGIN`] contains the samples that
    /// [`Extrapolation`] counts as within.
    ///
    /// # Errors
    /// A bound is not finite in `R`, or the bounds are reversed.
    pub fn operating_range<R: Real>(&self) -> Result<OperatingRange<R>, ConfigError> {
        OperatingRange::new(
            self.displacement.map(R::from_f64),
            self.velocity.map(R::from_f64),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RANGE: FittedRange = FittedRange {
        displacement: [-0.1, 0.2],
        velocity: [-6.0, 6.0],
    };

    #[test]
    fn samples_outside_are_counted_and_the_furthest_is_told() {
        // Within; displacement by a half; velocity by a quarter; both; within the margin.
        let displacement = [0.1, 0.3, 0.0, -0.2, 0.205];
        let velocity = [0.0, 0.0, 7.5, -6.6, 6.0];
        let found = Extrapolation::of(&RANGE, &displacement, &velocity);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(found.part, 0.6);
        close(found.displacement.part, 0.4);
        close(found.velocity.part, 0.4);
        close(found.displacement.most, 0.5);
        close(found.velocity.most, 0.25);
        close(found.most(), 0.5);
        assert_eq!(
            found.in_words("samples", "model.json").unwrap(),
            "60.0 % of the samples lie outside the operating range of model.json: displacement at 40.0 % by up to 0.50 times the \
             range, velocity at 40.0 % by up to 0.25 times the range"
        );
    }

    #[test]
    fn a_tiny_overshoot_is_told_as_a_number_and_is_no_warning() {
        let found = Extrapolation::of(&RANGE, &[0.209, 0.0], &[0.0, 6.2]);
        assert_eq!((found.part, found.in_words("samples", "m")), (0.0, None));
        assert!((found.most() - 0.045).abs() < 1e-12);
        assert_eq!(Extrapolation::of(&RANGE, &[], &[]).part, 0.0);
        let many = Extrapolation {
            part: 1e-4,
            velocity: Beyond {
                part: 1e-4,
                most: 2.0,
            },
            displacement: Beyond::default(),
        };
        assert_eq!(
            many.in_words("ticks", "m").unwrap(),
            "less than 0.1 % of the ticks lie outside the operating range of m: velocity at less than 0.1 % by up to 2.00 times \
             the range"
        );
    }

    #[test]
    fn a_sine_is_outside_with_either_end() {
        let sine = |amplitude: f64| FittedRange {
            displacement: [-amplitude, amplitude],
            velocity: [-1.0, 1.0],
        };
        // Its lower end is beyond −0.1 mm by half of the larger end.
        let found = Extrapolation::of_motions(&RANGE, [sine(0.1), sine(0.2)]);
        assert_eq!((found.part, found.displacement.most), (0.5, 0.5));
    }

    #[test]
    fn a_range_that_is_none_makes_no_operating_range() {
        let reversed = FittedRange {
            displacement: [0.1, -0.1],
            ..RANGE
        };
        let error = reversed.operating_range::<f64>().unwrap_err();
        assert!(error.to_string().starts_with("displacement = -0.1"));
        let beyond_f32 = FittedRange {
            velocity: [0.0, 1e300],
            ..RANGE
        };
        assert!(beyond_f32.operating_range::<f64>().is_ok());
        assert_eq!(
            beyond_f32.operating_range::<f32>(),
            Err(ConfigError::NonFinite("velocity"))
        );
    }

    proptest! {
        /// A sample counts as outside exactly when the firmware reports it outside the range with the margin, up to rounding.
        #[test]
        fn the_firmware_and_a_prediction_agree(y in -0.4..0.4f64, v in -12.0..12.0f64) {
            let range = RANGE.operating_range::<f32>().unwrap().widened(RANGE_MARGIN as f32).unwrap();
            let next_to = |value: f64, bounds: [f32; 2]| {
                bounds.iter().any(|bound| (value - f64::from(*bound)).abs() < 1e-5 * value.abs())
            };
            prop_assume!(!next_to(y, range.displacement()) && !next_to(v, range.velocity()));
            let found = Extrapolation::of(&RANGE, &[y], &[v]);
            prop_assert_eq!(found.part == 0.0, range.holds(y as f32, v as f32));
        }
    }
}

//! An axis: its quantity, its range, and its numbered ticks.

use std::ops::Range;

use mesh_damper_recording::extremes::least_and_largest;

use crate::text;

/// The spacing of values along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By their logarithm; values are positive.
    Logarithmic,
    /// By their cube root, which widens the neighbourhood of 0.
    CubeRoot,
}

impl Scale {
    /// The place of a value.
    pub fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic => value.log10(),
            Self::CubeRoot => value.cbrt(),
        }
    }

    /// Its name for the script.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "lin",
            Self::Logarithmic => "log",
            Self::CubeRoot => "cbrt",
        }
    }
}

/// One axis of a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Its quantity, for example `displacement`.
    pub name: String,
    /// The unit; empty for a pure number.
    pub unit: String,
    /// The spacing of values along it.
    pub scale: Scale,
    /// The values at its ends; `None` for those of the curves with a margin.
    pub range: Option<Range<f64>>,
    /// Labels at given places instead of numbers.
    pub labels: Option<Vec<(f64, String)>>,
}

impl Axis {
    /// A linear axis around the curves.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            scale: Scale::Linear,
            range: None,
            labels: None,
        }
    }

    /// The same axis with a logarithmic scale.
    pub fn logarithmic(self) -> Self {
        Self {
            scale: Scale::Logarithmic,
            ..self
        }
    }

    /// The same axis over a given range.
    pub fn over(self, range: Range<f64>) -> Self {
        Self {
            range: Some(range),
            ..self
        }
    }

    /// `displacement, mm`
    pub fn label(&self) -> String {
        match &self.unit[..] {
            "" => self.name.clone(),
            unit => format!("{}, {unit}", self.name),
        }
    }

    /// The places of its ends for these values.
    pub fn ends(&self, values: impl Iterator<Item = f64>) -> Range<f64> {
        if let Some(range) = &self.range {
            return self.scale.place(range.start)..self.scale.place(range.end);
        }
        padded(values.map(|value| self.scale.place(value)))
    }

    /// Places of ticks with their labels, about `most` of them between two places.
    pub fn ticks(&self, ends: &Range<f64>, most: usize) -> Vec<(f64, String)> {
        if let Some(labels) = &self.labels {
            let places = labels
                .iter()
                .map(|(value, label)| (self.scale.place(*value), label.clone()));
            return places.filter(|(place, _)| ends.contains(place)).collect();
        }
        match self.scale {
            Scale::Linear => even(ends, most)
                .into_iter()
                .map(|(value, decimals)| (value, written(value, decimals)))
                .collect(),
            Scale::Logarithmic => of_decades(ends, most),
            Scale::CubeRoot => {
                let places = even(ends, most.min(5)).into_iter();
                places
                    .map(|(place, _)| (place, text::nominal(place.powi(3))))
                    .collect()
            }
        }
    }
}

/// The range of `values` with a margin; never empty.
pub fn padded(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = least_and_largest(values.filter(|value| value.is_finite()));
    if low > high {
        return -1.0..1.0;
    }
    let room = (0.06 * (high - low)).max(1e-9 + 1e-6 * high.abs());
    low - room..high + room
}

/// Multiples of 1, 2 or 5 times a power of ten, at most `most`, with the decimals that distinguish them.
///
/// For steps of tens and more the decimals are below 0.
fn even(ends: &Range<f64>, most: usize) -> Vec<(f64, i32)> {
    let span = ends.end - ends.start;
    if span.is_nan() || span <= 0.0 {
        return Vec::new();
    }
    let least = span / most.max(1) as f64;
    let power = 10_f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * power)
        .into_iter()
        .find(|step| *step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * power);
    let decimals = -(step * 1.000_001).log10().floor() as i32;
    let first = (ends.start / step - 1e-9).ceil();
    let last = (ends.end / step + 1e-9).floor();
    let count = (last - first).max(-1.0) as usize;
    (0..=count)
        .filter(|_| last >= first)
        .map(|i| ((first + i as f64) * step, decimals))
        .collect()
}

/// 1, 2 and 5 of each decade, or fewer if there are many; plain numbers within less than a decade.
fn of_decades(ends: &Range<f64>, most: usize) -> Vec<(f64, String)> {
    let span = ends.end - ends.start;
    if span < 1.0 {
        let values = 10_f64.powf(ends.start)..10_f64.powf(ends.end);
        let mut ticks: Vec<(f64, String)> = Vec::new();
        for (value, decimals) in even(&values, most) {
            let place = value.log10();
            // They crowd towards the upper end.
            let apart = ticks
                .last()
                .is_none_or(|last| place - last.0 > 0.6 * span / most.max(1) as f64);
            if place.is_finite() && apart {
                ticks.push((place, written(value, decimals)));
            }
        }
        return ticks;
    }
    let most = most.max(2) as f64;
    let factors: &[f64] = match span {
        span if 3.0 * span <= most => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    let stride = (span / most).ceil().max(1.0) as i32;
    (ends.start.floor() as i32..=ends.end.ceil() as i32)
        .filter(|decade| decade.rem_euclid(stride) == 0)
        .flat_map(|decade| factors.iter().map(move |f| f * 10_f64.powi(decade)))
        .map(|value| (value.log10(), text::nominal(value)))
        .filter(|(place, _)| ends.contains(place))
        .collect()
}

/// A tick's number: plain, unless that takes too many digits. With an exponent, it has the digits that distinguish it from the
/// next.
fn written(value: f64, decimals: i32) -> String {
    let magnitude = value.abs().log10().floor();
    // A value closer to 0 than a step is 0.
    if value == 0.0 || magnitude < f64::from(-decimals) - 1.0 {
        return "0".into();
    }
    if decimals > 6 || value.abs() >= 1e6 {
        let digits = (magnitude as i32 + decimals).clamp(0, 15) as usize;
        return format!("{value:.digits$e}").replace('-', "−");
    }
    let decimals = decimals.max(0) as usize;
    let label = format!("{value:.decimals$}");
    match label.trim_start_matches('-').trim_matches(['0', '.']) {
        "" => "0".into(),
        _ => label.replace('-', "−"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, range: Range<f64>, most: usize) -> Vec<String> {
        let ends = axis.clone().over(range).ends(std::iter::empty());
        let ticks = axis.ticks(&ends, most);
        assert!(ticks.iter().all(|(place, _)| *place >= ends.start - 1e-9));
        assert!(ticks.iter().all(|(place, _)| *place <= ends.end + 1e-9));
        ticks.into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_as_fine_as_the_range() {
        let axis = Axis::new("force", "kN");
        assert_eq!(
            labels(&axis, -0.2..0.2, 5),
            ["−0.2", "−0.1", "0.0", "0.1", "0.2"].map(|l| if l == "0.0" { "0" } else { l })
        );
        assert_eq!(
            labels(&axis, 0.0..100.0, 6),
            ["0", "20", "40", "60", "80", "100"]
        );
        assert_eq!(
            labels(&axis, 0.0013..0.0031, 4),
            ["0.0015", "0.0020", "0.0025", "0.0030"]
        );
        // A narrow range far from 0 takes all the decimals that distinguish its ticks.
        assert_eq!(
            labels(&axis, 0.029_98..0.030_02, 3),
            ["0.02998", "0.03000", "0.03002"]
        );
        assert_eq!(
            labels(&axis, 1.0..1.000_000_4, 2),
            ["1.0000000e0", "1.0000002e0", "1.0000004e0"]
        );
        assert_eq!(labels(&axis, 2e6..3e6, 2), ["2.0e6", "2.5e6", "3.0e6"]);
        assert_eq!(axis.label(), "force, kN");
        assert_eq!(Axis::new("loss factor", "").label(), "loss factor");
    }

    #[test]
    fn decades_have_ticks_that_fit() {
        let axis = Axis::new("frequency", "Hz").logarithmic();
        assert_eq!(
            labels(&axis, 0.5..40.0, 6),
            ["0.5", "1", "2", "5", "10", "20"]
        );
        assert_eq!(labels(&axis, 0.9..1100.0, 4), ["1", "10", "100", "1000"]);
        // Within a decade.
        assert_eq!(labels(&axis, 1.9..4.1, 3), ["2", "3", "4"]);
        // Nine is too close to ten.
        assert_eq!(labels(&axis, 1.2..11.0, 8), ["2", "4", "6", "8", "10"]);
        assert!(labels(&axis, 1e-9..1e9, 4).len() <= 5);
    }

    #[test]
    fn a_cube_root_widens_what_is_near_nothing() {
        let axis = Axis {
            scale: Scale::CubeRoot,
            ..Axis::new("velocity", "mm/s")
        };
        assert_eq!(labels(&axis, -8.0..8.0, 5), ["−8", "−1", "0", "1", "8"]);
    }

    #[test]
    fn a_range_is_never_empty() {
        for values in [vec![], vec![1.0], vec![f64::NAN, 3.0, 3.0]] {
            let range = padded(values.into_iter());
            assert!(range.end > range.start);
        }
        assert!(even(&(1.0..1.0), 5).is_empty());
    }
}

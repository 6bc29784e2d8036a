//! Control inputs of a specimen during a recording.

use super::channel::Channel;

/// Units of a control input: of quantities that set a force, unlike a motion or a time.
pub(crate) const UNITS: &[&str] = &[
    "A", "mA", "V", "mV", "kV", "bar", "mbar", "Pa", "kPa", "MPa", "psi", "N", "kN", "lbf", "kip",
    "T", "mT", "W",
];

/// What the name of a column begins with that holds no measurement.
pub(crate) const PREDICTED: &str = "predicted_";

/// A setting stays within this fraction. Convention: a hundredth, the noise of a sensor that measures it.
const STEADY: f64 = 0.01;

/// A length whose correlation with the displacement is above this follows it. Convention: a half; noise has none.
const FOLLOWS: f64 = 0.5;

/// A control input: the current of a coil, a voltage, a pressure, a tension.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlChannel {
    /// Its column's name, with the unit: `current_A`.
    pub name: String,
    /// Values in that unit, one per sample.
    pub values: Vec<f64>,
}

impl ControlChannel {
    /// Its mean over the samples.
    pub fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len() as f64
    }

    /// The same if it is a setting beside this `displacement`, which is in a unit of `scale` times its own: it stays within a hundredth of
    /// the travel, or of its own value without following the displacement. The setting is then its mean. `None` if it moves.
    #[must_use]
    pub fn set_beside(mut self, displacement: &[f64], scale: f64) -> Option<Self> {
        let [(low, high), (least, most)] = [&self.values, displacement].map(ends);
        let range = high - low;
        let is_still = range <= STEADY * scale * (most - least);
        let is_steady = range <= STEADY * low.abs().max(high.abs());
        if !(is_still || is_steady && correlation(&self.values, displacement).abs() <= FOLLOWS) {
            return None;
        }
        if range > 0.0 {
            let mean = self.mean();
            self.values.fill(mean);
        }
        Some(self)
    }

    /// Whether it varies.
    pub fn changes(&self) -> bool {
        self.values.windows(2).any(|pair| pair[0] != pair[1])
    }
}

/// The smallest and the largest.
fn ends(values: &[f64]) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    values.iter().fold(none, |(low, high), &value| {
        (low.min(value), high.max(value))
    })
}

/// Correlation of two channels where both have values; 0 if one does not vary.
pub fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let pairs = || {
        let pairs = a.iter().zip(b);
        pairs.filter(|(a, b)| a.is_finite() && b.is_finite())
    };
    let count = pairs().count() as f64;
    let (of_a, of_b) = pairs().fold((0.0, 0.0), |(of_a, of_b), (a, b)| (of_a + a, of_b + b));
    let about = || pairs().map(|(a, b)| (a - of_a / count, b - of_b / count));
    let square: f64 =
        about().map(|(a, _)| a * a).sum::<f64>() * about().map(|(_, b)| b * b).sum::<f64>();
    if square > 0.0 {
        about().map(|(a, b)| a * b).sum::<f64>() / square.sqrt()
    } else {
        0.0
    }
}

/// Whether a column of this name is a control input. A name with a word for a channel, such as `displacement_command_V`, belongs to
/// that channel, and a predicted value says nothing about the specimen.
pub(crate) fn is_control(name: &str) -> bool {
    let Some((quantity, unit)) = name.rsplit_once('_') else {
        return false;
    };
    let is_of = |channel: Channel| {
        let mut words = quantity.split('_');
        words.any(|word| word.eq_ignore_ascii_case(channel.name()))
    };
    !quantity.is_empty()
        && !quantity.starts_with(PREDICTED)
        && UNITS.contains(&unit)
        && !Channel::ALL.into_iter().any(is_of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_of_another_quantity_with_a_unit_is_one() {
        for name in [
            "current_A",
            "voltage_V",
            "pressure_bar",
            "tension_N",
            "coil_current_mA",
        ] {
            assert!(is_control(name), "{name}");
        }
        let others = [
            "predicted_force_N",
            "predicted_band_kN",
            "predicted_beyond",
            "displacement_command_V",
            "current",
            "_A",
            "stroke_mm",
            "phase_s",
            "cycle_number",
        ];
        for name in others {
            assert!(!is_control(name), "{name}");
        }
    }
}

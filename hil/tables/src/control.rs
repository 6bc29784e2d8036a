//! Control inputs of a specimen during a recording.

use super::channel::Channel;

/// Units of a control input: of quantities that set a force, unlike a motion or a time.
pub(crate) const UNITS: &[&str] = &[
    "A", "mA", "V", "mV", "kV", "bar", "mbar", "Pa", "kPa", "MPa", "psi", "N", "kN", "lbf", "kip",
    "T", "mT", "W",
];

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

    /// Whether it varies.
    pub fn changes(&self) -> bool {
        self.values.windows(2).any(|pair| pair[0] != pair[1])
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
        && !quantity.starts_with("predicted_")
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

//! The scales of bridges, resistance thermometers and thermistors, which are solved from their circuits. NI documents these with its
//! modules. A thermocouple needs the tables of its standard and is not read.

use super::scale::ScaleProperties;

/// A bridge of strain gauges: volts to strain.
#[derive(Debug, PartialEq)]
pub(super) struct Bridge {
    configuration: u32,
    poisson: f64,
    /// The inverse of the gauge's part of the resistance in its arm, leads included.
    leads: f64,
    initial: f64,
    factor: f64,
    gain: f64,
    excitation: f64,
}

impl Bridge {
    pub fn of(said: &ScaleProperties<'_>) -> Result<Self, String> {
        let number = |name: &str| said.number(&format!("Strain_{name}"));
        let configuration = number("Configuration")? as u32;
        if ![10183, 10184, 10185, 10188, 10189, 10271, 10272].contains(&configuration) {
            return Err(format!(
                "the bridge {configuration}, which is not known here"
            ));
        }
        Ok(Self {
            configuration,
            poisson: number("Poisson_Ratio")?,
            leads: 1.0 + number("Lead_Wire_Resistance")? / number("Gage_Resistance")?,
            initial: number("Initial_Bridge_Voltage")?,
            factor: number("Gage_Factor")?,
            gain: number("Bridge_Shunt_Calibration_Gain_Adjustment")?,
            excitation: number("Voltage_Excitation")?,
        })
    }

    /// The strain at which the bridge gives this voltage.
    pub fn strain(&self, volts: f64) -> f64 {
        // Relative to the excitation.
        let ratio = (volts - self.initial) / self.excitation;
        let (nu, g) = (self.poisson, self.factor);
        self.gain
            * match self.configuration {
                // Four gauges in bending; in bending with two across; in tension with two across.
                10183 => -ratio / g,
                10184 => -2.0 * ratio / (g * (1.0 + nu)),
                10185 => -2.0 * ratio / (g * ((1.0 + nu) + ratio * (1.0 - nu))),
                // Two gauges, one across; two in bending.
                10188 => -4.0 * ratio * self.leads / (g * ((1.0 + nu) + 2.0 * ratio * (1.0 - nu))),
                10189 => -2.0 * ratio * self.leads / g,
                // One gauge.
                _ => -4.0 * ratio * self.leads / (g * (1.0 + 2.0 * ratio)),
            }
    }
}

/// A resistance thermometer: volts at a current to °C.
#[derive(Debug, PartialEq)]
pub(super) struct Rtd {
    current: f64,
    zero: f64,
    a: f64,
    b: f64,
    c: f64,
    leads: f64,
}

impl Rtd {
    pub fn of(said: &ScaleProperties<'_>) -> Result<Self, String> {
        let number = |name: &str| said.number(&format!("RTD_{name}"));
        let lead = number("Lead_Wire_Resistance")?;
        Ok(Self {
            current: number("Current_Excitation")?,
            zero: number("R0_Nominal_Resistance")?,
            a: number("A")?,
            b: number("B")?,
            c: number("C")?,
            leads: lead * wires(number("Resistance_Configuration")?, true),
        })
    }

    /// The temperature at which Callendar and Van Dusen's equation gives the resistance.
    pub fn celsius(&self, volts: f64) -> f64 {
        let ratio = (volts / self.current - self.leads) / self.zero;
        let (a, b, c) = (self.a, self.b, self.c);
        let above = ((a * a - 4.0 * b * (1.0 - ratio)).sqrt() - a) / (2.0 * b);
        if ratio >= 1.0 || ratio.is_nan() {
            return above;
        }
        // Below 0 °C a further term has little influence, so that three of Newton's steps from there leave the rounding.
        let mut t = above;
        for _ in 0..3 {
            let value = 1.0 + a * t + b * t * t + c * (t - 100.0) * t.powi(3) - ratio;
            let slope = a + 2.0 * b * t + c * (4.0 * t.powi(3) - 300.0 * t * t);
            t -= value / slope;
        }
        t
    }
}

/// A thermistor: volts to K minus an offset, by the equation of Steinhart and Hart.
#[derive(Debug, PartialEq)]
pub(super) struct Thermistor {
    is_current: bool,
    excitation: f64,
    reference: f64,
    leads: f64,
    a: f64,
    b: f64,
    c: f64,
    offset: f64,
}

impl Thermistor {
    pub fn of(said: &ScaleProperties<'_>) -> Result<Self, String> {
        let number = |name: &str| said.number(&format!("Thermistor_{name}"));
        let is_current = match number("Excitation_Type")? as u32 {
            10134 => true,
            10322 => false,
            kind => return Err(format!("the excitation {kind}, which is not known here")),
        };
        let lead = number("Lead_Wire_Resistance")?;
        Ok(Self {
            is_current,
            excitation: number("Excitation_Value")?,
            reference: number("R1_Reference_Resistance")?,
            leads: lead * wires(number("Resistance_Configuration")?, is_current),
            a: number("A")?,
            b: number("B")?,
            c: number("C")?,
            offset: number("Temperature_Offset")?,
        })
    }

    pub fn temperature(&self, volts: f64) -> f64 {
        let resistance = if self.is_current {
            volts / self.excitation
        } else {
            // The lower one of a divider.
            self.reference / (self.excitation / volts - 1.0)
        };
        let log = (resistance - self.leads).ln();
        1.0 / (self.a + self.b * log + self.c * log.powi(3)) - self.offset
    }
}

/// Number of lead resistances in the measurement, for two, three or four wires.
fn wires(configuration: f64, is_current: bool) -> f64 {
    match configuration as u32 {
        3 => 1.0,
        2 if is_current => 2.0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::tdms::cursor::{Properties, Property};
    use crate::files::tdms::scale::Scale;

    fn scale(said: &[(&str, f64)], kind: &str) -> Scale {
        let mut properties: Properties = said
            .iter()
            .map(|(name, value)| {
                let name = format!("NI_Scale[0]_{kind}_{name}");
                (name.into(), Property::Number(*value))
            })
            .collect();
        properties.insert("NI_Scale[0]_Scale_Type".into(), Property::Text(kind.into()));
        let said = ScaleProperties {
            properties: &properties,
            index: 0,
        };
        Scale::of(&said).unwrap().0
    }

    /// Volts of each bridge from its four resistances; the strain is recovered.
    #[test]
    fn bridges_give_the_strain_that_was_put_in() {
        let (nu, g, excitation) = (0.29, 2.1, 3.3);
        for strain in [-2e-3, 0.0, 1e-5, 1.5e-3] {
            let (e, across) = (g * strain, nu * g * strain);
            let of = |arms: [f64; 4]| {
                let [r1, r2, r3, r4] = arms;
                excitation * (r3 / (r3 + r4) - r2 / (r1 + r2))
            };
            for (configuration, arms) in [
                (10183, [1.0 - e, 1.0 + e, 1.0 - e, 1.0 + e]),
                (10184, [1.0 - across, 1.0 + across, 1.0 - e, 1.0 + e]),
                (10185, [1.0 - across, 1.0 + e, 1.0 - across, 1.0 + e]),
                (10188, [1.0, 1.0, 1.0 - across, 1.0 + e]),
                (10189, [1.0, 1.0, 1.0 - e, 1.0 + e]),
                (10271, [1.0, 1.0, 1.0, 1.0 + e]),
            ] {
                let bridge = scale(
                    &[
                        ("Configuration", f64::from(configuration)),
                        ("Poisson_Ratio", nu),
                        ("Gage_Resistance", 350.0),
                        ("Lead_Wire_Resistance", 0.0),
                        ("Initial_Bridge_Voltage", 1e-4),
                        ("Gage_Factor", g),
                        ("Bridge_Shunt_Calibration_Gain_Adjustment", 1.0),
                        ("Voltage_Excitation", excitation),
                    ],
                    "Strain",
                );
                let found = bridge.value(of(arms) + 1e-4);
                assert!(
                    (found - strain).abs() < 1e-12,
                    "{configuration}: {found} for {strain}"
                );
            }
        }
    }

    #[test]
    fn thermometers_give_the_temperature_that_was_put_in() {
        // IEC 60751, Pt100.
        let (a, b, c) = (3.9083e-3, -5.775e-7, -4.183e-12);
        let rtd = scale(
            &[
                ("Current_Excitation", 1e-3),
                ("R0_Nominal_Resistance", 100.0),
                ("A", a),
                ("B", b),
                ("C", c),
                ("Lead_Wire_Resistance", 0.2),
                ("Resistance_Configuration", 2.0),
            ],
            "RTD",
        );
        for t in [-150.0, -20.0, 0.0, 20.0, 300.0_f64] {
            let cold = if t < 0.0 {
                c * (t - 100.0) * t.powi(3)
            } else {
                0.0
            };
            let resistance = 100.0 * (1.0 + a * t + b * t * t + cold);
            let found = rtd.value(1e-3 * (resistance + 0.4));
            assert!((found - t).abs() < 1e-8, "{found} for {t}");
        }
        // The standard's own table: 107.79 Ω at 20 °C.
        assert!((rtd.value(0.107_794 + 4e-4) - 20.0).abs() < 0.01);
        let thermistor = scale(
            &[
                ("Excitation_Type", 10322.0),
                ("Excitation_Value", 2.5),
                ("R1_Reference_Resistance", 5000.0),
                ("Lead_Wire_Resistance", 0.0),
                ("Resistance_Configuration", 4.0),
                ("A", 1.295_361e-3),
                ("B", 2.343_159e-4),
                ("C", 1.018_703e-7),
                ("Temperature_Offset", 273.15),
            ],
            "Thermistor",
        );
        // These coefficients are of 5 kΩ at 25 °C, with which the divider halves its voltage.
        let celsius = thermistor.value(1.25);
        assert!((celsius - 25.0).abs() < 0.01, "{celsius}");
    }
}

//! The scales from raw to measured values, which NI's drivers store in a channel's properties.
//!
//! Linear, polynomial and table scales are given by their numbers. Bridge, resistance and thermistor scales are solved from their
//! circuits, which NI documents with its modules. A thermocouple needs the tables of its standard and is not read.

use std::collections::HashMap;

use super::segments::{Pieces, Property};

/// The input number of the raw values themselves.
const RAW: u32 = u32::MAX;
/// Largest number of consecutive scales. Convention: a driver has three.
const MOST: usize = 64;

/// The scales of a channel; the last one gives its values.
#[derive(Debug)]
pub(super) struct Scales {
    all: Vec<(Scale, u32)>,
}

/// One scale, with the number of its input.
#[derive(Debug, PartialEq)]
pub(super) enum Scale {
    /// The DAQmx scaler with this number.
    Scaler,
    Same,
    Linear {
        slope: f64,
        intercept: f64,
    },
    Polynomial(Vec<f64>),
    Table(Vec<(f64, f64)>),
    /// Adds the other input.
    Add(u32),
    /// The other input minus this one, as NI's own programs compute it.
    Subtract(u32),
    Strain(Bridge),
    Resistance(Rtd),
    Thermistor(Thermistor),
}

type Properties = HashMap<String, Property>;

/// The properties of one scale.
struct ScaleProperties<'p> {
    properties: &'p Properties,
    index: usize,
}

impl ScaleProperties<'_> {
    fn number(&self, name: &str) -> Result<f64, String> {
        let key = format!("NI_Scale[{}]_{name}", self.index);
        match self.properties.get(&key) {
            Some(Property::Number(number)) => Ok(*number),
            _ => Err(format!("raw values without their scale: {key} is missing")),
        }
    }

    fn or(&self, name: &str, otherwise: f64) -> f64 {
        self.number(name).unwrap_or(otherwise)
    }

    fn input(&self, name: &str) -> u32 {
        self.or(&format!("{name}_Input_Source"), f64::from(RAW)) as u32
    }

    fn list(&self, name: &str, count: f64) -> Result<Vec<f64>, String> {
        let most = self.properties.len();
        let count = (count as usize).min(most);
        (0..count)
            .map(|n| self.number(&format!("{name}[{n}]")))
            .collect()
    }
}

impl Scales {
    /// The scales of a channel, of its group or of its file: the first that has any; `None` if the values are measured ones
    /// already.
    ///
    /// # Errors
    /// An unknown or incomplete part, in words.
    pub fn of(said: &[&Properties; 3], raw: &[(u32, Pieces)]) -> Result<Option<Self>, String> {
        for properties in said {
            let count = match properties.get("NI_Number_Of_Scales") {
                Some(Property::Number(count)) => *count as usize,
                _ => continue,
            };
            let is_done = matches!(properties.get("NI_Scaling_Status"),
                Some(Property::Text(status)) if status == "scaled");
            if is_done || count == 0 {
                return Ok(None);
            }
            if count > MOST {
                return Err(format!("{count} scales"));
            }
            let mut all = Vec::new();
            for index in 0..count {
                let (scale, input) = Scale::of(&ScaleProperties { properties, index })?;
                // Scales are computed in their order.
                let inputs = [Some(input), scale.other_input()].into_iter().flatten();
                for input in inputs {
                    if input != RAW && input as usize >= index {
                        return Err("scales that refer to each other in a circle".into());
                    }
                }
                let has_raw = |number: u32| raw.iter().any(|(scale, _)| *scale == number);
                if scale == Scale::Scaler && !has_raw(index as u32) && !has_raw(0) {
                    return Err("raw values of no scale".into());
                }
                all.push((scale, input));
            }
            return Ok(Some(Self { all }));
        }
        // For DAQmx without scales, several values at once are not one channel.
        match raw {
            [_] => Ok(None),
            _ => Err("several raw values without scales".into()),
        }
    }

    /// The channel's values, from raw ones by the number of their scale.
    pub fn apply(&self, raw: &[(u32, Vec<f64>)]) -> Vec<f64> {
        let mut done: Vec<Vec<f64>> = Vec::new();
        for (index, (scale, input)) in self.all.iter().enumerate() {
            let of_scale = |number: u32| {
                let found = raw
                    .iter()
                    .find(|(scale, _)| *scale == number)
                    .or(raw.first());
                found.map(|(_, values)| values.clone()).unwrap_or_default()
            };
            let input_of = |input: u32| match done.get(input as usize) {
                Some(values) if input != RAW => values.clone(),
                _ => of_scale(0),
            };
            let mut values = match scale {
                Scale::Scaler => of_scale(index as u32),
                _ => input_of(*input),
            };
            match scale.other_input() {
                Some(other) => {
                    for (value, other) in values.iter_mut().zip(input_of(other)) {
                        *value = if matches!(scale, Scale::Add(_)) {
                            other + *value
                        } else {
                            other - *value
                        };
                    }
                }
                None => values
                    .iter_mut()
                    .for_each(|value| *value = scale.value(*value)),
            }
            done.push(values);
        }
        done.pop().unwrap_or_default()
    }
}

impl Scale {
    fn of(said: &ScaleProperties<'_>) -> Result<(Self, u32), String> {
        let key = format!("NI_Scale[{}]_Scale_Type", said.index);
        let kind = match said.properties.get(&key) {
            Some(Property::Text(kind)) => kind.as_str(),
            _ => return Ok((Self::Scaler, RAW)),
        };
        let scale = match kind {
            "Linear" => Self::Linear {
                slope: said.number("Linear_Slope")?,
                intercept: said.number("Linear_Y_Intercept")?,
            },
            "Polynomial" => {
                let count = said.or("Polynomial_Coefficients_Size", 4.0);
                Self::Polynomial(said.list("Polynomial_Coefficients", count)?)
            }
            "Table" => {
                let count = said.number("Table_Scaled_Values_Size")?;
                let from = said.list("Table_Pre_Scaled_Values", count)?;
                let to = said.list("Table_Scaled_Values", count)?;
                let mut table: Vec<(f64, f64)> = from.into_iter().zip(to).collect();
                table.sort_by(|a, b| a.0.total_cmp(&b.0));
                if table.is_empty() {
                    return Err("a table without values".into());
                }
                Self::Table(table)
            }
            "Add" | "Subtract" => {
                let [left, right] =
                    ["Left", "Right"].map(|side| said.input(&format!("{kind}_{side}_Operand")));
                let scale = if kind == "Add" {
                    Self::Add(right)
                } else {
                    Self::Subtract(right)
                };
                return Ok((scale, left));
            }
            "AdvancedAPI" => Self::Same,
            "Strain" => Self::Strain(Bridge::of(said)?),
            "RTD" => Self::Resistance(Rtd::of(said)?),
            "Thermistor" => Self::Thermistor(Thermistor::of(said)?),
            kind => return Err(format!("the scale {kind}, which is not known here")),
        };
        Ok((scale, said.input(kind)))
    }

    fn other_input(&self) -> Option<u32> {
        match self {
            Self::Add(other) | Self::Subtract(other) => Some(*other),
            _ => None,
        }
    }

    /// Converts one value.
    fn value(&self, x: f64) -> f64 {
        match self {
            Self::Scaler | Self::Same | Self::Add(_) | Self::Subtract(_) => x,
            Self::Linear { slope, intercept } => slope * x + intercept,
            Self::Polynomial(coefficients) => coefficients
                .iter()
                .rev()
                .fold(0.0, |sum, each| sum * x + each),
            Self::Table(table) => between(table, x),
            Self::Strain(bridge) => bridge.strain(x),
            Self::Resistance(rtd) => rtd.celsius(x),
            Self::Thermistor(thermistor) => thermistor.temperature(x),
        }
    }
}

/// A table's value, linear between its rows, and constant beyond its ends.
fn between(table: &[(f64, f64)], x: f64) -> f64 {
    if x.is_nan() {
        return x;
    }
    let after = table.partition_point(|(from, _)| *from < x);
    match (
        after.checked_sub(1).map(|before| table[before]),
        table.get(after),
    ) {
        (Some((x0, y0)), Some(&(x1, y1))) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some((_, y)), None) | (None, Some(&(_, y))) => y,
        (None, None) => f64::NAN,
    }
}

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
    fn of(said: &ScaleProperties<'_>) -> Result<Self, String> {
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
    fn strain(&self, volts: f64) -> f64 {
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
    fn of(said: &ScaleProperties<'_>) -> Result<Self, String> {
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
    fn celsius(&self, volts: f64) -> f64 {
        let ratio = (volts / self.current - self.leads) / self.zero;
        let (a, b, c) = (self.a, self.b, self.c);
        let above = ((a * a - 4.0 * b * (1.0 - ratio)).sqrt() - a) / (2.0 * b);
        if ratio >= 1.0 || ratio.is_nan() {
            return above;
        }
        // Below 0 °C a further term has little influence, so that Newton's method from there converges at once.
        let mut t = above;
        for _ in 0..20 {
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
    fn of(said: &ScaleProperties<'_>) -> Result<Self, String> {
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

    fn temperature(&self, volts: f64) -> f64 {
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

    fn scale(said: &[(&str, f64)], kind: &str) -> Scale {
        let mut properties: Properties = said
            .iter()
            .map(|(name, value)| {
                (
                    format!("NI_Scale[0]_{kind}_{name}"),
                    Property::Number(*value),
                )
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

    #[test]
    fn a_table_is_a_line_between_its_rows() {
        let table = [(0.0, 1.0), (2.0, 5.0), (3.0, 4.0)];
        for (x, y) in [(-1.0, 1.0), (0.0, 1.0), (1.0, 3.0), (2.5, 4.5), (9.0, 4.0)] {
            assert_eq!(between(&table, x), y, "{x}");
        }
        assert!(between(&table, f64::NAN).is_nan());
    }
}

//! The scales from raw to measured values, which NI's drivers store in a channel's properties.
//!
//! Linear, polynomial and table scales are given by their numbers. Bridge, resistance and thermistor scales are solved from their
//! circuits, which NI documents with its modules. A thermocouple needs the tables of its standard and is not read.

use std::collections::HashMap;

use super::Refused;
use super::cursor::{Properties, Property};
use super::layout::Read;
use crate::budget::Budget;

const PART: &str = "the scales of its channels";
/// The input number of the raw values themselves.
const RAW: u32 = u32::MAX;

/// The scales of a channel; the last one gives its values.
#[derive(Debug)]
pub(super) struct Scales {
    all: Vec<(Scale, u32)>,
    /// Which of them the last one needs.
    is_needed: Vec<bool>,
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

/// The properties of one scale.
struct ScaleProperties<'p> {
    properties: &'p Properties,
    index: usize,
}

impl ScaleProperties<'_> {
    fn number(&self, name: &str) -> Result<f64, String> {
        let key = format!("NI_Scale[{}]_{name}", self.index);
        match self.properties.get(key.as_str()) {
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

/// Raw values of a channel: how they are read, by the scale that takes them, and the scale that takes the first.
#[derive(Clone, Copy)]
pub(super) struct Raw<'r> {
    pub reads: &'r HashMap<u32, Read>,
    pub first: u32,
}

impl Raw<'_> {
    /// The raw values that the scale `number` takes, by the number under which they are.
    fn of(&self, number: u32) -> u32 {
        match self.reads.contains_key(&number) {
            true => number,
            false => self.first,
        }
    }
}

impl Scales {
    /// The number of scales that some properties state; `None` if they state none.
    pub fn count(said: &Properties) -> Option<usize> {
        match said.get("NI_Number_Of_Scales") {
            Some(Property::Number(count)) => Some(*count as usize),
            _ => None,
        }
    }

    /// The scales that properties with a number of them state; `None` if the values are measured ones already.
    ///
    /// # Errors
    /// An unknown or incomplete part, in words; or a budget that is used up.
    pub fn of(
        properties: &Properties,
        count: usize,
        budget: &Budget,
    ) -> Result<Result<Option<Self>, String>, Refused> {
        let is_done = matches!(properties.get("NI_Scaling_Status"),
            Some(Property::Text(status)) if &**status == "scaled");
        if is_done || count == 0 {
            return Ok(Ok(None));
        }
        let mut all = Vec::new();
        for index in 0..count {
            budget.work(64, PART)?;
            budget.hold(2 * size_of::<(Scale, u32)>() as u64, PART)?;
            let said = ScaleProperties { properties, index };
            let (scale, input) = match Scale::of(&said) {
                Ok(found) => found,
                Err(what) => return Ok(Err(what)),
            };
            budget.work(64 * scale.numbers(), PART)?;
            budget.hold(32 * scale.numbers(), PART)?;
            // Scales are computed in their order.
            let inputs = [Some(input), scale.other_input()].into_iter().flatten();
            for input in inputs {
                if input != RAW && input as usize >= index {
                    return Ok(Err("scales that refer to each other in a circle".into()));
                }
            }
            all.push((scale, input));
        }
        let mut is_needed = vec![false; count];
        is_needed[count - 1] = true;
        for index in (0..count).rev() {
            if !is_needed[index] {
                continue;
            }
            let (scale, input) = &all[index];
            for input in [Some(*input), scale.other_input()].into_iter().flatten() {
                if let Some(needed) = is_needed.get_mut(input as usize) {
                    *needed = true;
                }
            }
        }
        Ok(Ok(Some(Self { all, is_needed })))
    }

    /// Whether the channel has the raw values that the scales take.
    pub fn fit(&self, raw: Raw<'_>) -> bool {
        let has = |number: u32| raw.reads.contains_key(&number);
        let mut all = self.all.iter().enumerate();
        all.all(|(index, (scale, _))| *scale != Scale::Scaler || has(index as u32) || has(0))
    }

    /// The raw values that the scales need, each once.
    pub fn raw(&self, raw: Raw<'_>) -> Vec<u32> {
        let mut needed = Vec::new();
        for (index, (scale, input)) in self.all.iter().enumerate() {
            let numbers = match scale {
                _ if !self.is_needed[index] => [None, None],
                Scale::Scaler => [Some(index as u32), None],
                _ => [Some(*input), scale.other_input()]
                    .map(|input| input.filter(|&input| input == RAW).map(|_| 0)),
            };
            let numbers = numbers.into_iter().flatten();
            needed.extend(numbers.map(|number| raw.of(number)));
        }
        needed.sort_unstable();
        needed.dedup();
        needed
    }

    /// Steps for a value.
    pub fn cost(&self) -> u64 {
        let needed = self.all.iter().zip(&self.is_needed);
        needed
            .map(|((scale, _), &is_needed)| if is_needed { scale.cost() } else { 1 })
            .sum()
    }

    /// The channel's values, made of the raw ones in the place of the first of them, which are sorted by their numbers.
    pub fn apply(&self, raw: Raw<'_>, mut of: Vec<(u32, Vec<f64>)>) -> Vec<f64> {
        let place = |number: u32| {
            let number = raw.of(number);
            of.binary_search_by_key(&number, |(known, _)| *known)
                .unwrap_or_default()
        };
        // The raw values that each scale takes, if it takes them.
        let taken: Vec<usize> = (0..self.all.len() as u32).map(place).collect();
        let plain = place(0);
        let rows = of.first().map_or(0, |(_, values)| values.len());
        let mut done = vec![0.0; self.all.len()];
        for row in 0..rows {
            for (index, (scale, input)) in self.all.iter().enumerate() {
                if !self.is_needed[index] {
                    continue;
                }
                let input_of = |input: u32| match input {
                    RAW => of[plain].1[row],
                    input => done[input as usize],
                };
                done[index] = match scale {
                    Scale::Scaler => of[taken[index]].1[row],
                    // As NI's own programs compute it.
                    Scale::Add(other) => input_of(*other) + input_of(*input),
                    Scale::Subtract(other) => input_of(*other) - input_of(*input),
                    scale => scale.value(input_of(*input)),
                };
            }
            if let Some(last) = done.last() {
                of[0].1[row] = *last;
            }
        }
        let first = of.into_iter().next();
        first.map(|(_, values)| values).unwrap_or_default()
    }
}

impl Scale {
    fn of(said: &ScaleProperties<'_>) -> Result<(Self, u32), String> {
        let key = format!("NI_Scale[{}]_Scale_Type", said.index);
        let kind = match said.properties.get(key.as_str()) {
            Some(Property::Text(kind)) => &**kind,
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

    /// The numbers that it has of its own, if there may be many.
    fn numbers(&self) -> u64 {
        match self {
            Self::Polynomial(numbers) => numbers.len() as u64,
            Self::Table(rows) => 2 * rows.len() as u64,
            _ => 0,
        }
    }

    /// Steps for a value.
    fn cost(&self) -> u64 {
        match self {
            Self::Polynomial(numbers) => 1 + numbers.len() as u64,
            Self::Table(rows) => 4 + u64::from(rows.len().max(1).ilog2()),
            Self::Strain(_) => 4,
            Self::Resistance(_) | Self::Thermistor(_) => 8,
            _ => 1,
        }
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
            let before = t;
            t -= value / slope;
            if t == before {
                break;
            }
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

    #[test]
    fn a_table_is_a_line_between_its_rows() {
        let table = [(0.0, 1.0), (2.0, 5.0), (3.0, 4.0)];
        for (x, y) in [(-1.0, 1.0), (0.0, 1.0), (1.0, 3.0), (2.5, 4.5), (9.0, 4.0)] {
            assert_eq!(between(&table, x), y, "{x}");
        }
        assert!(between(&table, f64::NAN).is_nan());
    }
}

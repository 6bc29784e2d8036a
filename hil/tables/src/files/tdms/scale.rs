//! The scales from raw to measured values, which NI's drivers store in a channel's properties.
//!
//! Linear, polynomial and table scales are given by their numbers; others follow from their circuits.

use std::collections::HashMap;

use super::circuits::{Bridge, Rtd, Thermistor};
use super::cursor::{Properties, Property};
use super::layout::Read;
use crate::budget::Budget;
use crate::files::refused::Refused;

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
pub(super) struct ScaleProperties<'p> {
    pub properties: &'p Properties,
    pub index: usize,
}

impl ScaleProperties<'_> {
    pub fn number(&self, name: &str) -> Result<f64, String> {
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
    pub fn of(said: &ScaleProperties<'_>) -> Result<(Self, u32), String> {
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
            Self::Resistance(_) => 12,
            Self::Thermistor(_) => 8,
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
    pub fn value(&self, x: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_a_line_between_its_rows() {
        let table = [(0.0, 1.0), (2.0, 5.0), (3.0, 4.0)];
        for (x, y) in [(-1.0, 1.0), (0.0, 1.0), (1.0, 3.0), (2.5, 4.5), (9.0, 4.0)] {
            assert_eq!(between(&table, x), y, "{x}");
        }
        assert!(between(&table, f64::NAN).is_nan());
    }
}

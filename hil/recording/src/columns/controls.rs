//! The control inputs among the columns.

use std::collections::BTreeMap;

use super::asked::{MOST, listed, option};
use super::choose::{Choice, ChosenControl, Used, said};
use super::name::Name;
use super::taken::{self, Control};
use super::unit_found::{ControlUnit, control_unit_and_words};
use crate::channel::Channel;
use crate::control::{UNITS, is_control};
use crate::error::{InputError, Place, quoted};

/// A column whose unit for a control input is not clear.
struct Unclear {
    quantity: String,
    column: usize,
    error: InputError,
}

impl Unclear {
    /// Whether it may be the control input `name`: `current_A`.
    fn is_of(&self, name: &str) -> bool {
        name.rsplit_once('_')
            .is_some_and(|(quantity, _)| quantity == self.quantity)
    }
}

impl Choice<'_> {
    /// The columns that the user names and those with such a name, in the order of the file.
    pub(super) fn controls(
        &self,
        used: &[Used],
        guesses: &mut Vec<String>,
    ) -> Result<Vec<ChosenControl>, InputError> {
        let mut controls: Vec<ChosenControl> = Vec::new();
        let channels = Channel::ALL.map(Channel::name);
        for (quantity, name) in &self.reading.channels {
            if channels.contains(&quantity.as_str()) {
                continue;
            }
            let column = self.named(name, quantity)?;
            let source = &self.table.columns[column];
            let unit = match said(&self.reading.units, quantity) {
                Some(written) => super::spelling::control_unit(written, UNITS),
                None => match control_unit_and_words(source, &Name::of(&source.name)) {
                    Some((ControlUnit::Known(unit), _)) => Some(unit),
                    Some((ControlUnit::Unclear(units, either), _)) => {
                        return Err(self.unclear_input(quantity, column, &units, &either));
                    }
                    None => None,
                },
            };
            let unit = unit.ok_or_else(|| {
                InputError::new(
                    self.file,
                    format!("the unit of the control input {quantity} is not known"),
                    format!(
                        "give it: --unit {quantity}=A; units are {}",
                        UNITS.join(", ")
                    ),
                )
                .at(Place::Column(name.clone()))
                .answered_by(format!("--unit {quantity}=UNIT"))
            })?;
            controls.push(ChosenControl {
                column,
                name: format!("{quantity}_{unit}"),
            });
        }
        let is_said = |name: &str| controls.iter().any(|control| control.name == name);
        let is_quantity_said = |quantity: &str| {
            let mut names = self.reading.channels.iter();
            names.any(|(of, _)| of == quantity)
        };
        let mut found: BTreeMap<String, Vec<(bool, usize)>> = BTreeMap::new();
        let mut unclear: Vec<Unclear> = Vec::new();
        for (column, each) in self.table.columns.iter().enumerate() {
            let is_used = used.iter().any(|used| used.column == column)
                || controls.iter().any(|control| control.column == column);
            let wanted = |name: &str| match &self.needs.inputs {
                Some(inputs) => inputs.iter().any(|input| input == name),
                None => true,
            };
            let control = taken::control(each).filter(|_| !is_used);
            let Some(Control {
                quantity,
                unit,
                is_own,
            }) = control
            else {
                continue;
            };
            match unit {
                ControlUnit::Known(unit) => {
                    let name = format!("{quantity}_{unit}");
                    if wanted(&name) && !is_said(&name) {
                        found.entry(name).or_default().push((is_own, column));
                    }
                }
                ControlUnit::Unclear(..) if is_quantity_said(&quantity) => {}
                ControlUnit::Unclear(units, either) => {
                    let error = self.unclear_input(&quantity, column, &units, &either);
                    unclear.push(Unclear {
                        quantity,
                        column,
                        error,
                    });
                }
            }
        }
        for (name, mut of_it) in found {
            // A name in the form of our own files is more certain than words.
            if of_it.iter().any(|(is_own, _)| *is_own) {
                of_it.retain(|(is_own, _)| *is_own);
            } else {
                // `Current A` and `Current B`, both in mA: the letter of the first may be a unit, so it cannot be ruled out.
                let is_of = |each: &mut Unclear| each.is_of(&name);
                let rivals = unclear.extract_if(.., is_of);
                of_it.extend(rivals.map(|each| (false, each.column)));
                of_it.sort_by_key(|&(_, column)| column);
            }
            let [(is_own, column)] = of_it[..] else {
                let columns: Vec<usize> = of_it.iter().map(|&(_, column)| column).collect();
                let error = self.several_inputs(&name, &columns);
                if self.needs.inputs.is_some() {
                    return Err(error);
                }
                guesses.push(format!(
                    "{}, so none of them is read; {}",
                    error.problem, error.remedy
                ));
                continue;
            };
            if !is_own {
                let source = quoted(&self.table.columns[column].name);
                guesses.push(format!("control input {name} is read from column {source}"));
            }
            controls.push(ChosenControl { column, name });
        }
        if self.needs.inputs.is_none() {
            guesses.extend(unclear.iter().map(|Unclear { error, .. }| {
                format!("{}, so it is not read; {}", error.problem, error.remedy)
            }));
        }
        controls.sort_by_key(|control| control.column);
        match &self.needs.inputs {
            Some(inputs) => inputs
                .iter()
                .map(|name| {
                    let found = controls.iter().find(|control| control.name == *name);
                    found.cloned().ok_or_else(|| {
                        let unclear = unclear.iter().find(|each| each.is_of(name));
                        unclear.map_or_else(|| self.no_input(name), |each| each.error.clone())
                    })
                })
                .collect(),
            None => Ok(controls),
        }
    }

    /// A column's unit for a control input is not clear: `units`, which may be `either`.
    fn unclear_input(
        &self,
        quantity: &str,
        column: usize,
        units: &str,
        either: &[&str],
    ) -> InputError {
        let column = &self.table.columns[column].name;
        let channel = option("channel", quantity, column);
        let units_given = either.iter().map(|unit| option("unit", quantity, unit));
        let units_given: Vec<String> = units_given.collect();
        InputError::new(
            self.file,
            format!(
                "column {} could be the control input {quantity}, but its unit is not clear: {units}",
                quoted(column)
            ),
            format!("give it: {channel} {}", units_given.join(" or ")),
        )
        .answered_by(format!("{channel} --unit {quantity}=UNIT"))
    }

    /// No column matches a required control input.
    fn no_input(&self, name: &str) -> InputError {
        let columns = self.table.columns.iter();
        let names: Vec<&str> = columns.map(|column| column.name.as_str()).collect();
        let names = listed(&names);
        let (problem, (quantity, unit)) = match name.rsplit_once('_') {
            Some(parts) if is_control(name) => (
                format!("there is no control input {name}; found {names}"),
                parts,
            ),
            _ => (
                format!(
                    "{} is not the name of a control input, which must end in a unit; found {names}",
                    quoted(name)
                ),
                ("current", "A"),
            ),
        };
        InputError::new(
            self.file,
            problem,
            format!(
                "call its column {quantity}_{unit}, or say which one it is: --channel {quantity}=NAME --unit {quantity}={unit}"
            ),
        )
    }

    /// Columns that match a control input equally well. Columns under our own names each count as one input.
    fn several_inputs(&self, name: &str, columns: &[usize]) -> InputError {
        let quantity = name.rsplit_once('_').map_or(name, |(quantity, _)| quantity);
        let names: Vec<&str> = (columns.iter())
            .map(|&column| self.table.columns[column].name.as_str())
            .collect();
        let options: Vec<String> = names
            .iter()
            .take(MOST)
            .map(|each| option("channel", quantity, each))
            .collect();
        InputError::new(
            self.file,
            format!(
                "{} columns could be the control input {name}: {}",
                names.len(),
                listed(&names)
            ),
            format!("say which: {}", options.join(" or ")),
        )
        .answered_by(format!("--channel {quantity}=NAME"))
    }
}

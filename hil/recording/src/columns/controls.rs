//! The control inputs among the columns.

use std::collections::BTreeMap;

use super::asked::{MOST, listed, option};
use super::choose::{Choice, ChosenControl, Used, said};
use super::name::Name;
use super::taken::{self, Control};
use super::unit_found;
use crate::channel::Channel;
use crate::control::{UNITS, is_control};
use crate::error::{InputError, Place, quoted};

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
            let unit = match said(&self.reading.units, quantity) {
                Some(written) => super::spelling::control_unit(written, UNITS),
                None => {
                    let name = Name::of(&self.table.columns[column].name);
                    let found = unit_found::control_found(&self.table.columns[column], &name);
                    found.and_then(|found| found.differing.is_none().then_some(found.unit))
                }
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
        let mut found: BTreeMap<String, Vec<(bool, usize)>> = BTreeMap::new();
        for (column, each) in self.table.columns.iter().enumerate() {
            let is_used = used.iter().any(|used| used.column == column)
                || controls.iter().any(|control| control.column == column);
            let wanted = |name: &str| match &self.needs.inputs {
                Some(inputs) => inputs.iter().any(|input| input == name),
                None => true,
            };
            if is_used {
                continue;
            }
            let Some(control) = taken::control(each) else {
                continue;
            };
            match control.name() {
                Some(name) if wanted(&name) && !is_said(&name) => {
                    found
                        .entry(name)
                        .or_default()
                        .push((control.is_own, column));
                }
                Some(_) => {}
                None => guesses.extend(self.unclear_input(&control, &each.name)),
            }
        }
        for (name, mut of_it) in found {
            // A name in the form of our own files is more certain than words.
            if of_it.iter().any(|(is_own, _)| *is_own) {
                of_it.retain(|(is_own, _)| *is_own);
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
        controls.sort_by_key(|control| control.column);
        match &self.needs.inputs {
            Some(inputs) => inputs
                .iter()
                .map(|name| {
                    let found = controls.iter().find(|control| control.name == *name);
                    found.cloned().ok_or_else(|| self.no_input(name))
                })
                .collect(),
            None => Ok(controls),
        }
    }

    /// A sentence about a column whose unit is not clear, if it may be one of the wanted control inputs.
    fn unclear_input(&self, control: &Control, column: &str) -> Option<String> {
        let Control {
            quantity,
            unit,
            differing,
            ..
        } = control;
        let is_of = |input: &String| input.rsplit_once('_').is_some_and(|(of, _)| of == quantity);
        let inputs = self.needs.inputs.as_ref();
        inputs.is_none_or(|inputs| inputs.iter().any(is_of)).then(|| {
            format!(
                "column {} could be the control input {quantity}, but its unit {} is not clear, so it is not read; give it, such as {} --unit {quantity}={unit}",
                quoted(column),
                differing.as_deref().unwrap_or(unit),
                option("channel", quantity, column),
            )
        })
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

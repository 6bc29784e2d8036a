//! The control inputs among the columns.

use std::collections::{BTreeMap, HashMap, HashSet};

use mesh_damper_output::error::{InputError, Place, quoted};

use super::choose::{Choice, ChosenControl, Used, said};
use super::listed::{MOST, listed, option};
use super::name::Name;
use super::spelling::control_unit;
use super::taken::Control;
use super::unit_found::{ControlUnit, control_unit_and_words};
use super::words::Words;
use crate::channel::Channel;
use crate::control::{UNITS, is_control};

/// A column whose unit for a control input is not clear.
struct Unclear {
    quantity: String,
    /// The stated units, in words, and those among them that are read.
    units: String,
    either: Vec<&'static str>,
    column: usize,
}

/// Those that may be the control input `name`, `current_A`, among such columns by their quantities.
fn may_be<'u>(
    unclear: &HashMap<&str, Vec<&'u Unclear>>,
    name: &str,
) -> impl Iterator<Item = &'u Unclear> {
    let parts = name.rsplit_once('_');
    let of_it = parts.and_then(|(quantity, unit)| Some((unclear.get(quantity)?, unit)));
    let all = of_it.into_iter().flat_map(|(list, unit)| {
        let list = list.iter().copied();
        list.filter(move |each| each.either.contains(&unit))
    });
    all.collect::<Vec<_>>().into_iter()
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
            let is_done = |each: &ChosenControl| quantity_of(&each.name) == quantity;
            // The user's last word counts.
            let is_last = said(&self.reading.channels, quantity) == Some(name);
            if channels.contains(&quantity.as_str()) || !is_last || controls.iter().any(is_done) {
                continue;
            }
            let column = self.named(name, quantity)?;
            let unit = self.unit_of_input(quantity, column, guesses)?;
            controls.push(ChosenControl {
                column,
                name: format!("{quantity}_{unit}"),
                length: None,
            });
        }
        let is_said = |name: &str| controls.iter().any(|control| control.name == name);
        let mut found: BTreeMap<String, Vec<(bool, usize)>> = BTreeMap::new();
        let mut unclear: Vec<Unclear> = Vec::new();
        let mut in_other_units: Vec<ChosenControl> = controls.clone();
        let of_channels = used.iter().map(|used| used.column);
        let is_used: HashSet<usize> = of_channels
            .chain(controls.iter().map(|control| control.column))
            .collect();
        let inputs = self.needs.inputs.as_ref();
        let inputs: Option<HashSet<&str>> =
            inputs.map(|inputs| inputs.iter().map(String::as_str).collect());
        let is_wanted = |name: &str| inputs.as_ref().is_none_or(|inputs| inputs.contains(name));
        for (column, each) in self.table.columns.iter().enumerate() {
            let meaning = &self.meanings[column];
            if !meaning.is_control || is_used.contains(&column) {
                continue;
            }
            let Some(Control {
                quantity,
                unit,
                is_own,
            }) = meaning.control(each)
            else {
                continue;
            };
            match unit {
                ControlUnit::Known(unit) => {
                    let name = format!("{quantity}_{unit}");
                    if !is_wanted(&name) {
                        in_other_units.push(ChosenControl {
                            column,
                            name,
                            length: None,
                        });
                    } else if !is_said(&name) {
                        found.entry(name).or_default().push((is_own, column));
                    }
                }
                ControlUnit::Unclear(..) if said(&self.reading.channels, &quantity).is_some() => {}
                ControlUnit::Unclear(units, either) => unclear.push(Unclear {
                    quantity,
                    units,
                    either,
                    column,
                }),
            }
        }
        let mut by_quantity: HashMap<&str, Vec<&Unclear>> = HashMap::new();
        for each in &unclear {
            by_quantity.entry(&each.quantity).or_default().push(each);
        }
        for (name, mut of_it) in found {
            // A name in the form of our own files is more certain than words.
            if of_it.iter().any(|(is_own, _)| *is_own) {
                of_it.retain(|(is_own, _)| *is_own);
            } else {
                // `Current A` and `Current B` in mA: the letter of the first may be a unit, so both may be the current.
                let rivals = may_be(&by_quantity, &name);
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
            controls.push(ChosenControl {
                column,
                name,
                length: None,
            });
        }
        if self.needs.inputs.is_none() {
            guesses.extend(unclear.iter().take(MOST).map(|each| {
                let error = self.unclear_input(each);
                format!("{}, so it is not read; {}", error.problem, error.remedy)
            }));
            if let Some(more @ 1..) = unclear.len().checked_sub(MOST) {
                guesses.push(format!(
                    "{more} more columns could be control inputs, but their units are not clear"
                ));
            }
        }
        let of_controls = controls.iter().map(|control| control.column);
        let is_used: HashSet<usize> = of_controls.chain(is_used).collect();
        let lengths = self.lengths(&is_used).into_iter();
        controls.extend(lengths.filter(|length| is_wanted(&length.name)));
        controls.sort_by_key(|control| control.column);
        match &self.needs.inputs {
            Some(inputs) => inputs
                .iter()
                .map(|name| {
                    let found = controls.iter().find(|control| control.name == *name);
                    found.cloned().ok_or_else(|| {
                        may_be(&by_quantity, name).next().map_or_else(
                            || self.no_input(name, &in_other_units),
                            |each| self.unclear_input(each),
                        )
                    })
                })
                .collect(),
            None => Ok(controls),
        }
    }

    /// The unit of the column that the user names for a control input.
    fn unit_of_input(
        &self,
        quantity: &str,
        column: usize,
        guesses: &mut Vec<String>,
    ) -> Result<&'static str, InputError> {
        let source = &self.table.columns[column];
        let name = Name::of(&source.name);
        // The user's word for it says more than the column's name.
        let means = Words::of(quantity);
        let means = if means.is_control() {
            means
        } else {
            name.words
        };
        let found = control_unit_and_words(source, &name, means).map(|(unit, _)| unit);
        let given = said(&self.reading.units, quantity);
        let (problem, either) = match (given.map(control_unit), found) {
            (Some(Some(unit)), found) => {
                let other = match found {
                    Some(ControlUnit::Known(other)) if other != unit => Some(other.to_owned()),
                    Some(ControlUnit::Unclear(units, _)) => Some(units),
                    _ => None,
                };
                guesses.extend(other.map(|other| {
                    let source = quoted(&source.name);
                    format!("column {source} is read in {unit}, as --unit says; it says {other}")
                }));
                return Ok(unit);
            }
            (None, Some(ControlUnit::Known(unit))) => return Ok(unit),
            (None, Some(ControlUnit::Unclear(units, either))) => {
                (format!("is not clear: {units}"), either)
            }
            (Some(None), _) => {
                let given = quoted(given.unwrap_or_default());
                (format!("cannot be {given}"), Vec::new())
            }
            (None, None) => ("is not known".into(), vec!["A"]),
        };
        Err(InputError::new(
            self.file,
            format!("the unit of the control input {quantity} {problem}"),
            give_unit(quantity, &either),
        )
        .at(Place::Column(source.name.clone()))
        .answered_by(format!("--unit {quantity}=UNIT")))
    }

    /// The unit of a column that may be a control input is not clear.
    fn unclear_input(&self, unclear: &Unclear) -> InputError {
        let Unclear {
            quantity,
            units,
            either,
            column,
        } = unclear;
        let column = &self.table.columns[*column].name;
        let channel = option("channel", quantity, column);
        InputError::new(
            self.file,
            format!(
                "column {} could be the control input {quantity}, but its unit is not clear: {units}",
                quoted(column)
            ),
            format!("{}, and {channel}", give_unit(quantity, either)),
        )
        .answered_by(format!("{channel} --unit {quantity}=UNIT"))
    }

    /// No column matches a required control input.
    fn no_input(&self, name: &str, controls: &[ChosenControl]) -> InputError {
        let is_in_another_unit =
            |control: &&ChosenControl| quantity_of(&control.name) == quantity_of(name);
        if let Some(control) = controls.iter().find(is_in_another_unit) {
            return InputError::new(
                self.file,
                format!(
                    "the control input {name} is needed, and column {} is {}",
                    quoted(&self.table.columns[control.column].name),
                    control.name
                ),
                format!("write a column {name} with the values in that unit"),
            );
        }
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
        let quantity = quantity_of(name);
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

/// The quantity in a control input's name: `current` of `current_A`.
fn quantity_of(name: &str) -> &str {
    name.rsplit_once('_').map_or(name, |(quantity, _)| quantity)
}

/// The remedy for a control input whose unit must be stated, which may be one of `either`.
fn give_unit(quantity: &str, either: &[&str]) -> String {
    let options = either.iter().map(|unit| option("unit", quantity, unit));
    let options: Vec<String> = options.collect();
    let units = UNITS.join(", ");
    match &options[..] {
        [] => format!("write its values in one of {units}, and give that one"),
        _ => format!(
            "give the right one of {units}, such as {}",
            options.join(" or ")
        ),
    }
}

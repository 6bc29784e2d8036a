//! The control inputs of the recordings that a trace uses.

use std::borrow::Cow;

use mesh_damper::effects::CONTROLS;
use mesh_damper_model::{Control, Model};
use mesh_damper_output::error::InputError;
use mesh_damper_recording::Recording;
use mesh_damper_recording::extremes::least_and_largest;

use super::result::{FoundEffect, TraceResult};

/// The control inputs of recordings that may influence the force: those that all recordings have and that vary among the fitted
/// ones. Each has its range there.
pub(super) struct Controlled {
    controls: Vec<Control>,
    /// Why other inputs are not used although they may matter, as sentences.
    pub warnings: Vec<String>,
}

impl Controlled {
    /// From the `fitted` recordings and the `held`-out ones; the `first` inputs, which known effects depend on, come first.
    ///
    /// # Errors
    /// A recording lacks one of the first.
    pub fn of(
        fitted: &[Cow<'_, Recording>],
        held: &[Cow<'_, Recording>],
        first: &[String],
    ) -> Result<Self, InputError> {
        let mut found = Self {
            controls: Vec::new(),
            warnings: Vec::new(),
        };
        let all = || fitted.iter().chain(held);
        let columns = all().flat_map(|recording| &recording.controls);
        let columns = columns.map(|control| &control.name);
        let mut known: Vec<&str> = Vec::new();
        for name in first.iter().chain(columns) {
            if known.contains(&name.as_str()) {
                continue;
            }
            known.push(name);
            let is_first = first.contains(name);
            if let Some(without) = all().find(|recording| range_of(recording, name).is_none()) {
                if is_first {
                    return Err(InputError::new(
                        &without.name,
                        format!("there is no column {name}, on which a known effect depends"),
                        format!("add a column {name}; one value in all rows will do"),
                    ));
                }
                found.warnings.push(format!(
                    "{name} is ignored: {} has no such column",
                    without.name
                ));
                continue;
            }
            let range = range_of_all(fitted, name);
            if range[0] == range[1] && !is_first {
                if range_of_all(held, name)
                    .iter()
                    .any(|end| end.is_finite() && *end != range[0])
                {
                    found.warnings.push(format!(
                        "{name} is ignored: it is {} in all fitted data, and different in the held-out data",
                        range[0]
                    ));
                }
            } else if found.controls.len() == CONTROLS {
                found.warnings.push(format!(
                    "{name} is ignored: a damper has at most {CONTROLS} control inputs"
                ));
            } else {
                found.controls.push(Control {
                    name: name.clone(),
                    range,
                });
            }
        }
        Ok(found)
    }

    /// A recording with these inputs alone, in this order.
    ///
    /// # Panics
    /// Never for one of the recordings that this was made from.
    pub fn arranged<'r>(&self, mut recording: Cow<'r, Recording>) -> Cow<'r, Recording> {
        let names = || self.controls.iter().map(|control| control.name.as_str());
        let is_arranged = recording
            .controls
            .iter()
            .map(|c| c.name.as_str())
            .eq(names());
        if !is_arranged {
            let arranged = recording.to_mut().arrange_controls(names());
            arranged.expect("all recordings have it");
        }
        recording
    }

    /// Names in `model` the inputs that its effects depend on, and moves them to the first places there and in `result`. Warns if
    /// held-out recordings, `held`, exceed the fitted range of these inputs.
    pub fn name_in(self, model: &mut Model, result: &mut TraceResult, held: &[Cow<'_, Recording>]) {
        let seen = |place: &usize| {
            let mut effects = model.effects.iter();
            effects.any(|effect| effect.parameters.get("input") == Some(&(*place as f64)))
        };
        let seen: Vec<usize> = (0..self.controls.len()).filter(seen).collect();
        let renumber = |input: &mut f64| {
            if let Some(place) = seen.iter().position(|place| *place as f64 == *input) {
                *input = place as f64;
            }
        };
        let parameters = model
            .effects
            .iter_mut()
            .map(|effect| &mut effect.parameters);
        parameters
            .filter_map(|parameters| parameters.get_mut("input"))
            .for_each(renumber);
        let renumber_effect = |effect: &mut FoundEffect| {
            if let Some(input) = effect.parameters.get_mut("input") {
                [&mut input.value, &mut input.low, &mut input.high]
                    .into_iter()
                    .for_each(renumber);
            }
        };
        result.effects.iter_mut().for_each(renumber_effect);
        result.unconfirmed.iter_mut().for_each(renumber_effect);
        model.controls = seen
            .iter()
            .map(|&place| self.controls[place].clone())
            .collect();
        for control in &model.controls {
            for recording in held {
                let mut channels = recording.controls.iter();
                let channel = channels.find(|each| each.name == control.name);
                let warning = channel.and_then(|channel| control.beyond(&channel.values));
                let warning = warning.map(|text| format!("{}: {text}", recording.name));
                result.warnings.extend(warning);
            }
        }
    }
}

/// Smallest and largest value of an input; `None` if a recording lacks it.
fn range_of(recording: &Recording, name: &str) -> Option<[f64; 2]> {
    let mut controls = recording.controls.iter();
    let (low, high) = least_and_largest(&controls.find(|each| each.name == name)?.values);
    Some([low, high])
}

/// The range over several recordings.
fn range_of_all(recordings: &[Cow<'_, Recording>], name: &str) -> [f64; 2] {
    let ranges = recordings
        .iter()
        .filter_map(|recording| range_of(recording, name));
    ranges.fold([f64::INFINITY, f64::NEG_INFINITY], |range, [low, high]| {
        [range[0].min(low), range[1].max(high)]
    })
}

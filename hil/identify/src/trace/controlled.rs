//! Which control inputs of the recordings a trace looks at.

use std::borrow::Cow;

use mesh_damper::effects::CONTROLS;
use mesh_damper_model::Control;
use mesh_damper_recording::Recording;
use mesh_damper_recording::extremes::least_and_largest;

/// The control inputs of recordings that may say something of the force: those that all of them have, and that are not the same in all
/// that are fitted.
pub(super) struct Controlled {
    names: Vec<String>,
    /// Of the recordings that are fitted, by the places of the names.
    pub ranges: Vec<Control>,
    /// Those that are not looked at though they might say something, in words.
    pub warnings: Vec<String>,
}

impl Controlled {
    /// Of `fitted` recordings and of others that are `held` out; the `first` stand at the first places, and stay.
    pub fn of(
        fitted: &[Cow<'_, Recording>],
        held: &[Cow<'_, Recording>],
        first: &[String],
    ) -> Self {
        let mut warnings = Vec::new();
        let mut ranges: Vec<Control> = Vec::new();
        let all = || fitted.iter().chain(held);
        let mut known: Vec<&str> = Vec::new();
        let columns = all().flat_map(|recording| &recording.controls);
        let columns = columns.map(|control| control.name.as_str());
        for name in first.iter().map(String::as_str).chain(columns) {
            if known.contains(&name) {
                continue;
            }
            known.push(name);
            let values = |recording: &Recording| {
                let control = recording.controls.iter().find(|each| each.name == name);
                control.map(|control| least_and_largest(&control.values))
            };
            if let Some(without) = all().find(|recording| values(recording).is_none()) {
                warnings.push(format!(
                    "{name} is not looked at: {} has no such column",
                    without.name
                ));
                continue;
            }
            let each = fitted.iter().filter_map(|recording| values(recording));
            let (low, high) = each
                .fold((f64::INFINITY, f64::NEG_INFINITY), |range, (low, high)| {
                    (low.min(range.0), high.max(range.1))
                });
            if low == high && !first.iter().any(|each| each == name) {
                continue;
            }
            if ranges.len() == CONTROLS {
                warnings.push(format!(
                    "{name} is not looked at: a damper has at most {CONTROLS} control inputs"
                ));
                continue;
            }
            ranges.push(Control {
                name: name.to_owned(),
                range: [low, high],
            });
        }
        for control in &ranges {
            let [low, high] = control.range;
            let beyond = held.iter().filter_map(|recording| {
                let mut channels = recording.controls.iter();
                let channel = channels.find(|each| each.name == control.name)?;
                let (least, largest) = least_and_largest(&channel.values);
                (least < low || largest > high).then_some((recording, least, largest))
            });
            warnings.extend(beyond.map(|(recording, least, largest)| {
                format!(
                    "{}: {} goes from {least} to {largest}, and {low} to {high} was fitted: the force is extrapolated",
                    recording.name, control.name
                )
            }));
        }
        Self {
            names: ranges.iter().map(|control| control.name.clone()).collect(),
            ranges,
            warnings,
        }
    }

    /// A recording with these alone, in the order of their places.
    ///
    /// # Panics
    /// Never for one of the recordings that it is of.
    pub fn arranged<'r>(&self, mut recording: Cow<'r, Recording>) -> Cow<'r, Recording> {
        let names = || self.names.iter().map(String::as_str);
        if !recording
            .controls
            .iter()
            .map(|c| c.name.as_str())
            .eq(names())
        {
            let arranged = recording.to_mut().arrange_controls(names());
            arranged.expect("all recordings have it");
        }
        recording
    }
}

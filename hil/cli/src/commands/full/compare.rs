//! `hil compare`: models of one specimen over time.

use std::path::PathBuf;

use clap::Args;
use mesh_damper_batch::compare::{
    Bounds, CommonMotion, Comparison, Moment, ParameterChange, compare,
};
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_report::over_time;
use mesh_damper_report::text;

use crate::commands::document::AddDocument as _;
use crate::commands::reading::Reading;
use crate::commands::{Failure, say};

/// Compare models of one specimen over time, and report changes beyond the confidence intervals
///
/// Compares the forces of all models on one motion. If the models have the same effects, it compares their parameters too. The claims are
/// corrected for the number of comparisons: for a specimen that did not change, 1 comparison in 20 claims a change.
///
/// A model is a folder of `hil trace`, or a model.json with the trace.json of its intervals in the same folder.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil demo --seed 4 --out may\n  hil demo --seed 4 --out july\n  \
    hil compare may/ july/ --times 0,61 --time-unit days --out compare.svg"
)]
pub struct CompareCommand {
    /// Models, or the folders of their traces, in order of time
    #[arg(value_name = "MODEL", required = true, num_args = 2..)]
    models: Vec<PathBuf>,
    /// Time of each model, in any unit; the default is 0, 1, 2, …
    #[arg(long, value_name = "TIMES", value_delimiter = ',', value_parser = time)]
    times: Vec<f64>,
    /// Unit of the times in the picture, such as `days`
    #[arg(long, value_name = "UNIT", requires = "times")]
    time_unit: Option<String>,
    /// File for a picture of force and parameters over time, SVG
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the result as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
}

impl CompareCommand {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new()
            .reads(self.models.iter().flat_map(|path| Moment::files(path)))
            .writes(&self.out)
            .writes(&self.json)
            .begin()?;
        let moments = self.moments()?;
        let comparison = compare(moments)?;
        if let Some(picture) = &self.out {
            outputs.add(
                picture,
                over_time::picture(
                    "Models of one specimen over time",
                    &self.axis(),
                    &panels(&comparison),
                ),
            );
        }
        outputs.add_document_if(&self.json, &comparison)?;
        outputs.write()?;
        if self.json.as_deref() != Some(std::path::Path::new("-")) {
            print(&comparison);
        }
        Ok(())
    }

    /// The label of the pictures' horizontal axis.
    fn axis(&self) -> String {
        match (&self.time_unit, self.times.is_empty()) {
            (Some(unit), _) => format!("time, {unit}"),
            (None, false) => "time, as --times gives it".to_owned(),
            (None, true) => "place in the list of models".to_owned(),
        }
    }

    fn moments(&self) -> Result<Vec<Moment>, InputError> {
        let given = self.times.len();
        if given > 0 && given != self.models.len() {
            return Err(InputError::new(
                "--times",
                format!("has {given} for {} models", self.models.len()),
                "give one time for each model",
            ));
        }
        let times = (0..self.models.len())
            .map(|place| self.times.get(place).copied().unwrap_or(place as f64));
        let models = self.models.iter().zip(times);
        models
            .map(|(path, time)| Moment::read(path, time, self.reading.limit))
            .collect()
    }
}

/// A time of `--times`.
fn time(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    number
        .filter(|time| time.is_finite())
        .ok_or_else(|| "not a finite number; give one for each model: 0,61,153".to_owned())
}

/// The force of each model relative to the first model's, and each parameter that more than one model has.
fn panels(comparison: &Comparison) -> Vec<over_time::Panel> {
    let times: Vec<f64> = comparison.models.iter().map(|model| model.time).collect();
    let percent = |part: f64| 100.0 * part;
    let at = |model: usize, value: f64| over_time::Value {
        time: times[model],
        value,
        interval: None,
    };
    let first = [at(0, 0.0)].into_iter();
    let force = over_time::Panel {
        title: "force compared with the first model".into(),
        name: "RMS of the difference".into(),
        unit: "%".into(),
        changed: comparison.forces.iter().any(|one| one.changed),
        p: comparison
            .forces
            .iter()
            .filter_map(|one| one.p)
            .min_by(f64::total_cmp)
            .map(chance),
        values: first
            .chain(
                comparison
                    .forces
                    .iter()
                    .map(|one| at(one.model, percent(one.difference))),
            )
            .collect(),
    };
    let parameters = comparison.parameters.iter().filter_map(|one| {
        let values: Vec<over_time::Value> = one
            .values
            .iter()
            .zip(&times)
            .filter_map(|(bounds, &time)| {
                let bounds = (*bounds)?;
                Some(over_time::Value {
                    time,
                    value: bounds.value,
                    interval: bounds.low.zip(bounds.high),
                })
            })
            .collect();
        (values.len() > 1).then(|| over_time::Panel {
            title: title(one),
            name: one.parameter.replace('_', " "),
            unit: text::unit(&one.unit),
            changed: one.changed,
            p: one.p.map(chance),
            values,
        })
    });
    [force].into_iter().chain(parameters).collect()
}

fn title(one: &ParameterChange) -> String {
    let (of, parameter) = (text::name(&one.of), one.parameter.replace('_', " "));
    match one.amplitude_mm.filter(|amplitude| *amplitude > 0.0) {
        Some(amplitude) => format!("{of} {parameter} at {} mm", text::number(amplitude)),
        None => format!("{of} {parameter}"),
    }
}

/// The conditions under which all models were compared.
fn common(motion: &CommonMotion) -> String {
    let [low, high] = motion.displacement_mm.map(text::number);
    let mut said = format!(
        "{low} to {high} mm, to {} mm/s",
        text::number(motion.velocity_mm_s)
    );
    let mut held = |[low, high]: [f64; 2], unit: &str| {
        let [from, to] = [low, high].map(|end| format!("{end:.2}"));
        let [from, to] = [from, to].map(|end| {
            end.trim_end_matches('0')
                .trim_end_matches('.')
                .replace('-', "−")
        });
        said += &match from == to {
            true => format!(", {from} {unit}"),
            false => format!(", {from} to {to} {unit}"),
        };
    };
    if let Some(range) = motion.temperature {
        held(range, "°C");
    }
    if let Some(range) = motion.cycles {
        held(range, "cycles");
    }
    for control in &motion.controls {
        held(control.range, &control.name);
    }
    said
}

fn print(comparison: &Comparison) {
    say(comparison.conclusion.sentence());
    for one in &comparison.undecided {
        say(&format!(
            "  {} with model {}: {} would show it",
            text::name(&one.family),
            one.model,
            one.would_show
        ));
    }
    for (place, model) in comparison.models.iter().enumerate() {
        let effects = match model.effects.len() {
            0 => "the law alone".to_owned(),
            _ => {
                let names = model.effects.iter().map(|family| text::name(family));
                names.collect::<Vec<_>>().join(", ")
            }
        };
        say(&format!(
            "  {place}  {} at {}: {effects}",
            model.name,
            text::nominal(model.time)
        ));
    }
    say(&format!(
        "Force compared with model 0, under the conditions shared by all: {}",
        common(&comparison.common_motion)
    ));
    for one in &comparison.forces {
        let expected = match one.expected.zip(one.p) {
            Some((expected, p)) => {
                format!(
                    "expected by chance: {}, {}",
                    text::percent(expected),
                    chance(p)
                )
            }
            None => "expected by chance: unknown".to_owned(),
        };
        say(&format!(
            "  {}  differs by {} ({expected}){}; most at {} mm and {} mm/s, by {} kN",
            one.model,
            text::percent(one.difference),
            if one.changed { ": changed" } else { "" },
            text::number(one.largest.displacement_mm),
            text::number(one.largest.velocity_mm_s),
            text::number(one.largest.difference)
        ));
    }
    say("Parameters with their 90 % intervals");
    for one in &comparison.parameters {
        let values: Vec<String> = one.values.iter().map(bounds).collect();
        let change = match one.most_in.zip(one.change) {
            Some((model, change)) if change != 0.0 => {
                let sign = if change > 0.0 { "+" } else { "" };
                format!(
                    ", model {model} by {sign}{} from model 0",
                    text::percent(change)
                )
            }
            _ => String::new(),
        };
        say(&format!(
            "  {:34} {} {}{change}{}",
            title(one),
            values.join("  →  "),
            one.unit,
            claim(one.changed, one.p)
        ));
    }
    for one in &comparison.effects {
        let verb = if one.appeared { "appears" } else { "vanishes" };
        say(&format!(
            "Effect: {} {verb} with model {}",
            text::name(&one.family),
            one.model
        ));
    }
    for note in &comparison.notes {
        say(&format!("Note: {note}"));
    }
}

fn bounds(bounds: &Option<Bounds>) -> String {
    let Some(bounds) = bounds else {
        return "–".to_owned();
    };
    match bounds.low.zip(bounds.high) {
        Some((low, high)) => {
            let [low, value, high] = text::interval(low, bounds.value, high);
            format!("{value} ({low} … {high})")
        }
        None => text::number(bounds.value),
    }
}

fn claim(changed: bool, p: Option<f64>) -> String {
    match p {
        Some(p) if changed => format!(": changed ({})", chance(p)),
        Some(p) => format!(" ({})", chance(p)),
        None => String::new(),
    }
}

fn chance(p: f64) -> String {
    // Probabilities below this cannot be distinguished.
    if p < 1e-12 {
        return "p < 1e−12".to_owned();
    }
    match p < 1e-3 {
        true => format!("p = {p:.1e}").replace('-', "−"),
        false => format!("p = {p:.3}"),
    }
}

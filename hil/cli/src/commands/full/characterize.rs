//! `hil characterize`: stiffness and loss factor of a recording.

use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};
use mesh_damper_characterize::{
    DynamicTest, Figures, Spread, StaticTest, dynamic_test_on, static_test,
};
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_report::characterization::{dynamic_chart, static_chart};
use schemars::JsonSchema;
use serde::Serialize;

use crate::commands::document::AddDocument as _;
use crate::commands::known_rig::KnownRig;
use crate::commands::reading::RecordingFiles;
use crate::commands::{Failure, say, warn};

/// Compute stiffness and loss factor of a recording by eqs 1–7 of the paper
///
/// --static reads load–unload curves. It gives the middle line, the equivalent stiffness and the static loss factor of every complete
/// curve, after it subtracts a preload or a sensor offset. --dynamic reads cycles. It gives dynamic stiffness and loss factor of each
/// cycle, and of the averaged cycle of every block of equal cycles.
#[derive(Args, Debug)]
#[command(group(ArgGroup::new("kind").required(true).args(["of_curves", "of_cycles"])))]
#[command(after_help = "Examples:\n  hil demo --seed 4\n  \
    hil characterize demo-out/recording.csv.gz --dynamic --out loops-out")]
pub struct CharacterizeCommand {
    /// The recording
    #[arg(value_name = "FILE")]
    recording: PathBuf,
    /// Static: load–unload curves, eqs 1 and 2
    #[arg(long = "static")]
    of_curves: bool,
    /// Dynamic: cycles, eqs 3–7
    #[arg(long = "dynamic")]
    of_cycles: bool,
    /// Folder for the picture characterize.svg
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the result as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    rig: KnownRig,
    #[command(flatten)]
    files: RecordingFiles,
}

/// The results, by the kind of the recording.
#[derive(JsonSchema, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Found {
    /// Results of load–unload curves.
    Static(StaticTest),
    /// Results of cycles.
    Dynamic(DynamicTest),
}

/// Stiffness and loss factor of a recording.
#[derive(JsonSchema, Serialize)]
pub(in crate::commands) struct Summary {
    /// Path of the recording.
    recording: String,
    #[serde(flatten)]
    found: Found,
}

impl CharacterizeCommand {
    pub fn run(self) -> Result<(), Failure> {
        let picture = self.out.as_ref().map(|out| out.join("characterize.svg"));
        let mut outputs = Plan::new()
            .reads([&self.recording])
            .fills(self.out.as_deref(), ["characterize.svg"])
            .writes(&self.json)
            .begin()?;
        let recording = self.files.channels(&self.recording)?;
        let rig = self.rig.facts(None);
        if self.of_curves && !rig.is_empty() {
            return Err(InputError::new(
                "--static",
                "is for slow curves, on which a mass and a delay have no influence",
                "leave --fixture-mass and --force-delay out, or take --dynamic",
            )
            .into());
        }
        let found = if self.of_curves {
            Found::Static(static_test(&recording)?)
        } else {
            Found::Dynamic(dynamic_test_on(&recording, &rig)?)
        };
        if let Some(picture) = &picture {
            outputs.add(
                picture,
                match &found {
                    Found::Static(test) => static_chart(test),
                    Found::Dynamic(test) => dynamic_chart(test),
                },
            );
        }
        let summary = Summary {
            recording: recording.name,
            found,
        };
        outputs.add_document_if(&self.json, &summary)?;
        outputs.write()?;
        let (Found::Static(StaticTest { notes, .. }) | Found::Dynamic(DynamicTest { notes, .. })) =
            &summary.found;
        for note in notes {
            warn(note);
        }
        if self.json.as_deref() != Some(Path::new("-")) {
            match &summary.found {
                Found::Static(test) => print_static(test),
                Found::Dynamic(test) => print_dynamic(test),
            }
            if let Some(picture) = &picture {
                say(&format!("The picture is {}", picture.display()));
            }
        }
        Ok(())
    }
}

fn print_static(test: &StaticTest) {
    say("cycle   from, s  x_max, mm  preload, kN      U, J     ΔW, J  k_eq, kN/mm  loss factor");
    for (index, cycle) in test.cycles.iter().enumerate() {
        say(&format!(
            "{:5} {:9.2} {:10.4} {:12.4} {:9.5} {:9.5} {:12.4} {:12.4}",
            index + 1,
            cycle.times[0],
            cycle.displacement_max,
            cycle.preload,
            cycle.elastic_potential,
            cycle.dissipated,
            cycle.equivalent_stiffness,
            cycle.loss_factor,
        ));
    }
    let (stiffness, loss) = (&test.equivalent_stiffness, &test.loss_factor);
    say(&format!(
        "mean: k_eq = {} kN/mm, loss factor = {}",
        with_deviation(stiffness),
        with_deviation(loss)
    ));
}

fn print_dynamic(test: &DynamicTest) {
    say("   at, s      mm       Hz   K, kN/mm     ΔW, J      W, J  loss factor");
    for block in &test.blocks {
        for cycle in &block.cycles {
            row(
                &format!("{:8.3}", cycle.time),
                cycle.frequency,
                &cycle.result,
                if cycle.steady { "" } else { "  left out" },
            );
        }
        row("averaged", block.frequency, &block.averaged, "");
        say(&format!(
            "    mean: K = {} kN/mm (90 %: {:.4} … {:.4}), loss factor = {}",
            with_deviation(&block.stiffness),
            block.stiffness_interval[0],
            block.stiffness_interval[1],
            with_deviation(&block.loss_factor)
        ));
    }
}

fn row(name: &str, frequency: f64, figures: &Figures, remark: &str) {
    say(&format!(
        "{name} {:7.4} {frequency:8.3} {:10.4} {:9.6} {:9.6} {:12.4}{remark}",
        figures.amplitude,
        figures.stiffness,
        figures.dissipated,
        figures.elastic_potential,
        figures.loss_factor,
    ));
}

fn with_deviation(spread: &Spread) -> String {
    match spread.deviation {
        Some(deviation) => format!("{:.4} ± {:.4}", spread.mean, deviation),
        None => format!("{:.4}", spread.mean),
    }
}

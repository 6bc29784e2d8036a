//! `hil amplitude-free`: one law for every amplitude, compared with laws that need the amplitude beforehand.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_model::file::model_error;
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_paper::amplitude_independent::{HeldOut, Study, study};
use mesh_damper_reference::tables::DENSITIES;
use mesh_damper_report::curves::{self, Curve};

use crate::commands::document::AddDocument as _;
use crate::commands::{Failure, say};

/// Fit an amplitude-independent law to force loops of the paper's tables
///
/// Fits the loops at 0.05, 0.10, 0.20 and 0.25 mm. Prints the error at 0.15 mm, which is not fitted, and compares it with three others:
/// one set of coefficients of the mixed damping law k1·y + k3·y³ + c·|v|^α·sgn v (eq 13), the tables interpolated between their rows,
/// and the paper's surfaces. With --out it writes a model for each density, which `hil predict` and `hil run` read, and a picture of
/// the loops at 0.15 mm.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  hil amplitude-free\n  \
    hil amplitude-free --frequencies 1 --out free-out\n  \
    hil run --model free-out/model-3.0.json --blocks 0.08:2:6,0.15:1:6")]
pub struct AmplitudeFreeCommand {
    /// Frequencies of the loops in Hz, 0.1 to 100
    ///
    /// The paper tested at 1 Hz. Loops at other frequencies extrapolate its tables by |v|^α. At a single frequency, the fit cannot tell
    /// friction that depends on velocity from friction that does not.
    #[arg(
        long,
        value_name = "HZ,...",
        value_delimiter = ',',
        default_value = "1,10"
    )]
    frequencies: Vec<f64>,
    /// Folder for models and pictures
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the result as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl AmplitudeFreeCommand {
    pub fn run(self) -> Result<(), Failure> {
        let sound = |&frequency: &f64| (0.1..=100.0).contains(&frequency);
        if let Some(frequency) = self.frequencies.iter().find(|&frequency| !sound(frequency)) {
            return Err(InputError::new(
                "--frequencies",
                format!("{frequency} Hz is outside 0.1…100"),
                "give frequencies within this range, such as 1,10",
            )
            .into());
        }
        let names = DENSITIES.into_iter().map(model_name);
        let mut names: Vec<String> = names
            .chain(self.frequencies.iter().copied().map(picture_name))
            .collect();
        // A frequency that is given twice has one picture.
        names.sort();
        names.dedup();
        let mut outputs = Plan::new()
            .fills(self.out.as_deref(), names)
            .writes(&self.json)
            .begin()?;
        let refused = |error| model_error("the fitted law", &error);
        let study = study(&self.frequencies).map_err(refused)?;
        if let Some(out) = &self.out {
            for one in &study.densities {
                let model = one.model_file(&study.frequencies);
                outputs.add_document(out.join(model_name(one.density)), &model)?;
            }
            for &frequency in &study.frequencies {
                let picture = picture(&study, frequency).map_err(refused)?;
                outputs.add(out.join(picture_name(frequency)), picture);
            }
        }
        outputs.add_document_if(&self.json, &study)?;
        outputs.write()?;
        if self.json.as_deref() != Some(Path::new("-")) {
            print(&study);
            if let Some(out) = &self.out {
                say(&format!("Models and pictures are in {}", out.display()));
            }
        }
        Ok(())
    }
}

fn model_name(density: f64) -> String {
    format!("model-{density:.1}.json")
}

fn picture_name(frequency: f64) -> String {
    format!("loops-{frequency}Hz.svg")
}

fn print(study: &Study) {
    let structure = &study.structure;
    say(&format!(
        "The law: the mixed damping law k1·y + k3·y³ + c·|v|^α·sgn v (eq 13){}, up to {} elements of stick-slip",
        if structure.load_friction {
            " with friction that grows with |y|"
        } else {
            ""
        },
        structure.elements
    ));
    say("Error at 0.15 mm, held out, in % of the force's RMS:");
    for (index, frequency) in study.frequencies.iter().enumerate() {
        say("");
        say(&format!(
            "{:7}  one mixed law   interpolated tables   surfaces   this law   (interpolated loops)",
            format!("{frequency} Hz")
        ));
        for one in &study.densities {
            row(&format!("{:.1}", one.density), &one.held_out[index]);
        }
        row("mean", &study.mean(index));
    }
}

fn row(name: &str, errors: &HeldOut) {
    say(&format!(
        "{name:7}  {:13.1}   {:19.1}   {:8.1}   {:8.1}   {:20.1}",
        100.0 * errors.equation_13,
        100.0 * errors.tables,
        100.0 * errors.surfaces,
        100.0 * errors.law,
        100.0 * errors.loops
    ));
}

/// Charts of the held-out loops at `frequency` Hz, one for each density.
fn picture(study: &Study, frequency: f64) -> Result<String, mesh_damper_model::ModelError> {
    let mut panels = Vec::new();
    for one in &study.densities {
        let forces = one.held_out_loop(frequency)?;
        let curve = |name, force: &[f64]| Curve {
            name,
            points: forces
                .displacement
                .iter()
                .copied()
                .zip(force.iter().copied())
                .collect(),
        };
        panels.push((
            format!("{:.1} g/cm³", one.density),
            vec![
                curve("measured", &forces.measured),
                curve("one mixed law", &forces.equation_13),
                curve("interpolated tables", &forces.tables),
                curve("surfaces", &forces.surfaces),
                curve("without amplitude", &forces.law),
            ],
        ));
    }
    let title = format!("Held-out loops at {frequency} Hz");
    Ok(curves::panels(&title, &panels))
}

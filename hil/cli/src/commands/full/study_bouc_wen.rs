//! `hil study bouc-wen`: a benchmark of nonlinear identification.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_output::Plan;
use mesh_damper_trials::bouc_wen::{BoucWenResult, Programme, bouc_wen, records};

use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::{Failure, say};

/// Trace the Bouc–Wen benchmark, and simulate its tests with the model
///
/// Simulates the benchmark of Noël and Schoukens: an oscillator of 2 kg with hysteresis. The trace gets force and displacement of the
/// training record only. Two noise-free tests score the model: by the force for their motion, and by the displacement under their force.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil study bouc-wen\n  hil study bouc-wen --seed 4 --out bouc-wen-out --json -"
)]
pub struct BoucWenCommand {
    /// Seed, a whole number: it draws the phases of the multisines and the noise
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Folder for the recordings (CSV.gz) and model.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the result as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The files in the folder.
const FILES: [&str; 4] = [
    "training.csv.gz",
    "test-multisine.csv.gz",
    "test-sweep.csv.gz",
    "model.json",
];

impl BoucWenCommand {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new()
            .fills(self.out.as_deref(), FILES)
            .writes(&self.json)
            .begin()?;
        let progress = Progress::steps();
        progress.step("simulating the benchmark");
        let programme = Programme::of_benchmark(self.seed);
        let records = records(&programme)?;
        let (found, result) = bouc_wen(&programme, &records, &|what| progress.step(what))?;
        drop(progress);
        if let Some(out) = &self.out {
            let tests = records.tests.iter().map(|test| &test.recording);
            for (name, recording) in FILES
                .iter()
                .zip([&records.training].into_iter().chain(tests))
            {
                let path = out.join(name);
                outputs.add(&path, recording.to_file(&path)?);
            }
            outputs.add_document(out.join(FILES[3]), &found.model_file())?;
        }
        outputs.add_document_if(&self.json, &result)?;
        outputs.write()?;
        if self.json.as_deref() != Some(Path::new("-")) {
            print(&result);
        }
        Ok(())
    }
}

fn print(result: &BoucWenResult) {
    say(&format!(
        "seed {}: verdict {:?}, effects: {}",
        result.seed,
        result.verdict,
        result.families.join(", ")
    ));
    match result.mass {
        Some(mass) => say(&format!("mass {mass:.4} kg, true 2 kg")),
        None => say("mass: not found (true: 2 kg)"),
    }
    say("test        force NRMSE, %   displacement, mm RMS   simulation error, m RMS");
    for score in &result.scores {
        let error = match (&score.displacement_error, &score.refused) {
            (Some(error), _) => format!("{error:.3e}"),
            (None, reason) => format!("none: {}", reason.as_deref().unwrap_or_default()),
        };
        say(&format!(
            "{:11} {:14.3} {:22.4}   {error}",
            score.test,
            100.0 * score.force_nrmse,
            1e3 * score.displacement_rms
        ));
    }
}

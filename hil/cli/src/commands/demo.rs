//! `hil demo`: the complete procedure once, without input.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_demo::{Demo, demo, loop_error};
use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_report::{self as report, ReportData, text};
use mesh_damper_rig::Journal;
use mesh_damper_rig::specimen::DrawnEffect;
use serde::Serialize;

use super::document::AddDocument as _;
use super::progress::Progress;
use super::{Failure, say, summary};

/// Test a simulated specimen with a hidden effect, trace the recording, and test again with the augmented law
///
/// Needs no input. Writes recording.csv.gz, trace.json, model.json, report.html and loop.svg into the folder of --out.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  hil demo --seed 4\n  hil demo --seed 7 --out demo-7")]
pub struct DemoCommand {
    /// Seed, a whole number: it draws the hidden effect, its size and the sensor noise
    #[arg(long, default_value_t = 4)]
    seed: u64,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "demo-out")]
    out: PathBuf,
    /// Write the result as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The complete procedure once: the hidden effect, the effect found, and the improvement of the law.
#[derive(Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
pub(super) struct Summary<'a> {
    /// Seed that drew the specimen.
    seed: u64,
    /// The effect that was hidden, and its size.
    hidden: DrawnEffect,
    /// Families of the effects that the trace found.
    found: Vec<&'a str>,
    /// Whether the trace named the hidden effect and nothing else.
    named: bool,
    /// Whether the augmented law is closer to the specimen in the closed loop than the law alone.
    nearer: bool,
    /// RMS of the baseline law's error in the closed loop over the RMS of the measured force.
    loop_error_before: f64,
    /// RMS of the augmented law's error in the closed loop over the RMS of the measured force.
    loop_error_after: f64,
    /// The result of the trace, as in `trace.json`.
    trace: &'a TraceResult,
}

impl DemoCommand {
    pub fn run(self) -> Result<(), Failure> {
        let names = [
            "recording.csv.gz",
            "trace.json",
            "model.json",
            "report.html",
            "loop.svg",
        ];
        let mut outputs = Plan::new()
            .fills(self.out.as_path(), names)
            .writes(&self.json)
            // The recording must not be mixed up with the partial recording of an interrupted run.
            .keeps(Journal::path_in(&self.out))
            .begin()?;
        let progress = Progress::steps();
        let done = demo(self.seed, &|what| progress.step(what)).map_err(|error| {
            let remedy = "give another --seed";
            InputError::new(
                format!("demo of seed {}", self.seed),
                error.to_string(),
                remedy,
            )
        })?;
        progress.step("writing the report");
        let summary = Summary {
            seed: self.seed,
            hidden: done.drawn,
            found: families(&done.trace.result),
            named: done.is_named(),
            nearer: done.is_nearer(),
            loop_error_before: loop_error(&done.before),
            loop_error_after: loop_error(&done.after),
            trace: &done.trace.result,
        };
        let report = ReportData::of_trace(
            format!("A simulated rig test, seed {}", self.seed),
            facts(&done, &summary),
            done.trace.clone(),
        );
        let recording = self.out.join("recording.csv.gz");
        outputs.add(&recording, done.recording.to_file(&recording)?);
        outputs.add_document(self.out.join("trace.json"), &done.trace.result)?;
        outputs.add_document(self.out.join("model.json"), &done.trace.model_file())?;
        outputs.add(self.out.join("report.html"), report::render(&report));
        if let Some(picture) = largest_loop(&report) {
            outputs.add(self.out.join("loop.svg"), picture);
        }
        outputs.add_document_if(&self.json, &summary)?;
        drop(progress);
        outputs.write()?;
        if self.json.as_deref() != Some(Path::new("-")) {
            for (name, text) in facts(&done, &summary) {
                say(&format!("{name}: {text}"));
            }
            summary::print(&done.trace.result);
            say(&format!(
                "The report is {}",
                self.out.join("report.html").display()
            ));
        }
        Ok(())
    }
}

fn families(result: &TraceResult) -> Vec<&str> {
    result
        .effects
        .iter()
        .map(|effect| effect.family.as_str())
        .collect()
}

fn facts(done: &Demo, summary: &Summary) -> Vec<(String, String)> {
    let hidden = done.drawn.effect.family();
    let found: Vec<String> = summary
        .found
        .iter()
        .map(|family| text::name(family))
        .collect();
    let said = if summary.named {
        "named".to_owned()
    } else if found.is_empty() {
        "missed: no effect was found".to_owned()
    } else {
        format!("missed: the trace found {}", text::listed(&found))
    };
    let change = if summary.nearer {
        "closer to the specimen than before"
    } else {
        "no closer to the specimen than before"
    };
    [
        (
            "Specimen",
            format!("simulated, {} g/cm³", done.drawn.density),
        ),
        (
            "Hidden in it",
            format!(
                "{}, {} of the law's force",
                text::name(hidden),
                text::percent(done.drawn.share)
            ),
        ),
        ("The trace", said),
        (
            "In the loop, on a test that was never fitted",
            format!(
                "{change}: error of the force from {} to {}",
                text::percent(summary.loop_error_before),
                text::percent(summary.loop_error_after)
            ),
        ),
    ]
    .map(|(name, text)| (name.to_owned(), text))
    .into()
}

/// The loop with the largest error of the law alone.
fn largest_loop(report: &ReportData) -> Option<String> {
    let error = |series: &report::Series, block: &report::SeriesBlock| {
        let samples = block.cycle.clone();
        let forces = series.before.get(samples.clone())?.iter();
        let measured = series.force.get(samples)?;
        let square = |(a, b): (&f64, &f64)| (a - b) * (a - b);
        let force: f64 = measured.iter().map(|force| force * force).sum();
        Some(forces.zip(measured).map(square).sum::<f64>() / force)
    };
    let all = report
        .series
        .iter()
        .flat_map(|series| series.blocks.iter().map(move |block| (series, block)));
    all.filter_map(|(series, block)| Some((error(series, block)?, series, block)))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, series, block)| report::loop_picture(series, block))
}

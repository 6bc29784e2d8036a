//! `hil bench`: instructions, errors and sizes, compared with those of other libraries.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_output::{Outputs, Plan};
use mesh_damper_rig::check;
use mesh_damper_sources::Sources;
use mesh_damper_trials::bench::{self, Baseline, Verdict};

use super::bench_table;
use super::image::{IMAGES, say_where};
use super::junit::{Case, Junit, judged};
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::reading::Reading;
use crate::commands::{Failure, is_free_for_text, warn};

/// Count the instructions of law, tick and effects in an emulator, and compare them with other libraries
///
/// Needs qemu-system-arm and the Rust target thumbv7em-none-eabihf. The Cortex-M0 needs the target thumbv6m-none-eabi; the comparison
/// with C needs arm-none-eabi-gcc with newlib.
///
/// Exit code 1: a count is more than 5 % above the baseline, or a limit is exceeded.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  hil bench\n  hil bench --json bench.json")]
pub struct BenchCommand {
    /// Write all results as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the checks, passed and failed, as JUnit XML to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Baseline to compare the counts with; the default is that of the repository
    #[arg(long, value_name = "FILE", conflicts_with = "bless")]
    baseline: Option<PathBuf>,
    /// Replace the repository's baseline with the counts of this run
    #[arg(long)]
    bless: bool,
    #[command(flatten)]
    reading: Reading,
}

impl BenchCommand {
    pub fn run(self) -> Result<(), Failure> {
        let path = match &self.baseline {
            Some(path) => path.clone(),
            None if self.bless => Baseline::path_in_repository()?,
            None => Baseline::path()?,
        };
        let plan = Plan::new().writes(&self.json).writes(&self.junit);
        let plan = if self.bless {
            plan.writes([&path])
        } else {
            plan.reads([&path])
        };
        let mut outputs = plan.begin()?;
        let baseline = if self.bless {
            None
        } else {
            Some(Baseline::read_within(&path, self.reading.limit)?)
        };
        say_where(&Sources::find()?, "what is counted", IMAGES);
        judged(
            "bench",
            self.junit.as_deref(),
            &mut outputs,
            |junit, outputs| self.count(&path, baseline, junit, outputs),
        )
    }

    /// Counts, and compares with `baseline`, which `path` names.
    fn count(
        &self,
        path: &Path,
        baseline: Option<Baseline>,
        mut junit: Junit,
        outputs: &mut Outputs,
    ) -> Result<(), Failure> {
        let progress = Progress::steps();
        let results = bench::run(&|what| progress.step(what))?;
        drop(progress);

        outputs.add_document_if(&self.json, &results)?;
        if self.bless {
            outputs.add_document(path, &Baseline::of(&results))?;
        }
        let counted = baseline.as_ref().map(|baseline| baseline.checks(&results));
        let counted = counted.unwrap_or_default();
        junit.property("rustc", &results.tools.rustc);
        junit.property("emulator", &results.tools.emulator);
        junit.property("C compiler", results.tools.c.as_deref().unwrap_or("none"));
        for verdict in &results.limits {
            junit.case("limit", &verdict.name, case_of(verdict), None);
        }
        junit.checks("count", counted.iter().cloned());
        junit.add(outputs, self.junit.as_deref())?;
        outputs.write()?;
        if is_free_for_text([&self.json, &self.junit]) {
            bench_table::print(&results);
        }
        for left_out in &results.left_out {
            warn(&format!("left out: {left_out}"));
        }
        let mut failures: Vec<String> =
            results.limits.iter().filter_map(Verdict::failure).collect();
        if let Some(baseline) = baseline
            && baseline.tools.rustc != results.tools.rustc
        {
            warn(&format!(
                "the baseline was counted with {}, this run with {}",
                baseline.tools.rustc, results.tools.rustc
            ));
        }
        failures.extend(check::failures(counted));
        if failures.is_empty() {
            Ok(())
        } else {
            Err(Failure::Check(failures.join("; ")))
        }
    }
}

fn case_of(verdict: &Verdict) -> Case {
    match (verdict.failure(), verdict.figure) {
        (Some(failure), _) => Case::Failed(failure),
        (None, None) => Case::Skipped("not measured here".into()),
        (None, Some(_)) => Case::Passed,
    }
}

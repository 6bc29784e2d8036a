//! `hil bench`: instructions, errors and sizes, beside the peers'.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_recording::output::Plan;
use mesh_damper_studies::bench::{self, Baseline, Verdict};

use super::bench_table;
use crate::commands::progress::Progress;
use crate::commands::reading::Reading;
use crate::commands::{Failure, warn};

/// Count the instructions of law, tick and effects in an emulator, beside their peers
///
/// Exit code 1 when a count is more than 5 % above the baseline's, or a limit that can be held is not.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil bench --json bench.json\n  hil bench --bless\n\n\
    Needs qemu-system-arm and the target thumbv7em-none-eabihf; the Cortex-M0 needs the target thumbv6m-none-eabi, the peer \
    in C needs arm-none-eabi-gcc with newlib."
)]
pub struct BenchCommand {
    /// Where everything goes as JSON as well; `-` for standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// What the counts are held against, instead of the repository's own
    #[arg(long, value_name = "FILE", conflicts_with = "bless")]
    baseline: Option<PathBuf>,
    /// Write the repository's baseline anew from this run
    #[arg(long)]
    bless: bool,
    #[command(flatten)]
    reading: Reading,
}

impl BenchCommand {
    pub fn run(self) -> Result<(), Failure> {
        let path = self.baseline.clone().unwrap_or_else(Baseline::path);
        let plan = Plan::new().writes(&self.json);
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
        let progress = Progress::steps();
        let results = bench::run(&|what| progress.step(what))?;
        drop(progress);

        if let Some(json) = &self.json {
            outputs.add_json(json, &results)?;
        }
        if self.bless {
            outputs.add_json(&path, &Baseline::of(&results))?;
        }
        outputs.write()?;
        if self.json.as_deref() != Some(Path::new("-")) {
            bench_table::print(&results);
        }
        for left_out in &results.left_out {
            warn(&format!("left out: {left_out}"));
        }
        let mut failures: Vec<String> =
            results.limits.iter().filter_map(Verdict::failure).collect();
        if let Some(baseline) = baseline {
            if baseline.tools.rustc != results.tools.rustc {
                warn(&format!(
                    "the baseline was counted with {}, this run with {}",
                    baseline.tools.rustc, results.tools.rustc
                ));
            }
            failures.extend(baseline.failures(&results));
        }
        if failures.is_empty() {
            Ok(())
        } else {
            Err(Failure::Check(failures.join("\n       ")))
        }
    }
}

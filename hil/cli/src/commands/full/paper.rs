//! `hil paper`: the paper, recomputed.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_output::Plan;
use mesh_damper_paper::claims::{self, Claim, Paper, Verdict};
use mesh_damper_report as report;

use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::{Failure, say};

/// Recompute every table, equation and claim of the paper, and print which claims hold
///
/// Writes report.html into the folder of --out: each claim with the numbers that decide it, the paper's figures as far as its tables
/// allow, and fitted surfaces of the coefficients next to the published ones.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  hil paper\n  hil paper --out paper-out --json paper.json")]
pub struct PaperCommand {
    /// Folder for the report
    #[arg(long, value_name = "DIR", default_value = "paper-out")]
    out: PathBuf,
    /// Write every number as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl PaperCommand {
    pub fn run(self) -> Result<(), Failure> {
        let page = self.out.join("report.html");
        let mut outputs = Plan::new()
            .fills(self.out.as_path(), ["report.html"])
            .writes(&self.json)
            .begin()?;
        let progress = Progress::steps();
        let paper = claims::recompute(&|step| progress.step(step));
        progress.step("drawing");
        outputs.add(&page, report::paper::render(&paper));
        outputs.add_document_if(&self.json, &paper)?;
        drop(progress);
        outputs.write()?;
        if self.json.as_deref() != Some(Path::new("-")) {
            print(&paper);
            say("");
            say(&format!("The report is {}", page.display()));
        }
        Ok(())
    }
}

fn print(paper: &Paper) {
    for claim in &paper.claims {
        let verdict = claim.verdict.in_words();
        say(&format!("{verdict:17}  {}: {}", claim.place, claim.says));
        say(&format!("{:19}{}", "", claim.reason));
    }
    let count = |verdict| {
        let of = |claim: &&Claim| claim.verdict == verdict;
        paper.claims.iter().filter(of).count()
    };
    say("");
    say(&format!(
        "{} claims: {} hold, {} fail, {} cannot be decided",
        paper.claims.len(),
        count(Verdict::Holds),
        count(Verdict::Fails),
        count(Verdict::CannotTell)
    ));
    say("");
    say("Error of the loops over the 25 cells, mean and largest, in % of the force's RMS:");
    for surfaces in &paper.surface_errors {
        say(&format!(
            "{:42} {:7.1} {:7.1}",
            surfaces.name,
            100.0 * surfaces.mean,
            100.0 * surfaces.largest
        ));
    }
}

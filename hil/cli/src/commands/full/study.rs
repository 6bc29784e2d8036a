//! `hil study`: studies of the tracer itself.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::{Args, Subcommand};
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_output::process;
use mesh_damper_output::scratch::Scratch;
use mesh_damper_trials::numbers::{Cost, Costs, Number, Policies, Score, numbers, table};

use super::policy;
use super::study_bouc_wen::BoucWenCommand;
use super::study_size::SizeCommand;
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::{Failure, say};

/// Study the trace itself: its numbers, a benchmark, its time and memory
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  hil study bouc-wen")]
pub struct StudyCommand {
    #[command(subcommand)]
    study: Study,
}

#[derive(Debug, Subcommand)]
enum Study {
    Numbers(NumbersCommand),
    BoucWen(BoucWenCommand),
    Size(SizeCommand),
}

impl StudyCommand {
    pub fn run(self) -> Result<(), Failure> {
        match self.study {
            Study::Numbers(command) => command.run(),
            Study::BoucWen(command) => command.run(),
            Study::Size(command) => command.run(),
        }
    }
}

/// Halve and double each tuned number, and run the blind trial with it
///
/// Each trial runs in its own process. All tuned numbers take hours. Use --only to measure some of them, and --known to reuse earlier
/// results of the same seeds.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil study numbers --seeds 0 --table numbers.md\n  \
    hil study numbers --only identify.score --json score.json\n  \
    hil study numbers --known score.json --only identify.select --json both.json"
)]
struct NumbersCommand {
    /// Number of seeds, 0 to 1000000; 0 measures nothing
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u64).range(..=1_000_000))]
    seeds: u64,
    /// First seed, 0 to 1000000000
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=1_000_000_000))]
    first: u64,
    /// Only numbers whose path begins with this, such as `identify.select`
    #[arg(long, value_name = "PATH", default_value = "")]
    only: String,
    /// JSON file with results of an earlier run on the same seeds; with --seeds 0, on any seeds
    #[arg(long, value_name = "FILE")]
    known: Option<PathBuf>,
    /// Write the scores as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// File for a table of all numbers, Markdown
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
}

impl NumbersCommand {
    fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new()
            .reads(&self.known)
            .writes(&self.json)
            .writes(&self.table)
            .begin()?;
        let tuned: Vec<Number> = numbers()
            .into_iter()
            .filter(|number| number.is_tuned() && number.path.starts_with(&self.only))
            .collect();
        if tuned.is_empty() {
            return Err(InputError::new(
                "--only",
                format!(
                    "no tuned number has a path that begins with `{}`",
                    self.only
                ),
                "give a path of docs/numbers.md",
            )
            .into());
        }
        let mut costs = self.known()?;
        if self.seeds > 0 {
            self.measure(&tuned, &mut costs)?;
        }
        outputs.add_document_if(&self.json, &costs)?;
        if let Some(path) = &self.table {
            outputs.add(path, table(&costs));
        }
        outputs.write()?;
        if self.json.as_deref() != Some(Path::new("-")) {
            print(&costs);
        }
        Ok(())
    }

    /// The results of an earlier run.
    fn known(&self) -> Result<Costs, Failure> {
        let seeds = self.first..self.first + self.seeds;
        let Some(path) = &self.known else {
            return Ok(Costs {
                seeds,
                default: None,
                costs: BTreeMap::new(),
            });
        };
        let costs: Costs = policy::read(path)?;
        if self.seeds > 0 && costs.seeds != seeds {
            return Err(InputError::new(
                path.display().to_string(),
                format!("holds results of seeds {:?}", costs.seeds),
                "give the same --first and --seeds, or another file",
            )
            .into());
        }
        Ok(costs)
    }

    fn measure(&self, tuned: &[Number], costs: &mut Costs) -> Result<(), Failure> {
        let progress = Progress::of(2 * tuned.len() as u64 + 1);
        progress.step("the default values");
        if costs.default.is_none() {
            costs.default = self.score(&Policies::default())?;
        }
        let mut done = 1;
        for number in tuned {
            if costs.costs.contains_key(&number.path) {
                done += 2;
                continue;
            }
            let mut scored = |factor: f64, how: &str| {
                progress.step(&format!("{} {how}", number.path));
                let score = number.varied(factor).map(|varied| self.score(&varied));
                done += 1;
                progress.done(done);
                score.transpose().map(Option::flatten)
            };
            let cost = Cost {
                halved: scored(0.5, "halved")?,
                doubled: scored(2.0, "doubled")?,
            };
            costs.costs.insert(number.path.clone(), cost);
        }
        Ok(())
    }

    /// The score of the blind trial with these numbers; `None` if the trial fails.
    fn score(&self, policies: &Policies) -> Result<Option<Score>, Failure> {
        let failed = |error: std::io::Error| InputError::io(Path::new("hil blind"), "run", &error);
        let folder = Scratch::new().map_err(failed)?;
        let file = folder.path().join("policies.json");
        let text = serde_json::to_string(policies).unwrap_or_default();
        std::fs::write(&file, text).map_err(failed)?;
        let mut trial = Command::new(std::env::current_exe().map_err(failed)?);
        trial
            .arg("--policy")
            .arg(file)
            .args(["blind", "--json", "-"])
            .args(["--first", &self.first.to_string()])
            .args(["--seeds", &self.seeds.to_string()]);
        let output = process::output(&mut trial).map_err(failed)?;
        let summary = serde_json::from_slice(&output.stdout).unwrap_or_default();
        Ok(Score::of(&summary))
    }
}

fn print(costs: &Costs) {
    let in_words = |score: Option<Score>| {
        score.map_or("-".to_owned(), |score| {
            format!("{} of {}, {}", score.right, score.of, score.augmented)
        })
    };
    say(&match costs.default {
        Some(score) => format!(
            "default values: right {} of {}, law augmented {}",
            score.right, score.of, score.augmented
        ),
        None => "default values: not measured".to_owned(),
    });
    say("each number halved and doubled: right of all that count, law augmented");
    for (path, cost) in &costs.costs {
        say(&format!(
            "{path:45} halved {:>14}   doubled {:>14}",
            in_words(cost.halved),
            in_words(cost.doubled)
        ));
    }
}

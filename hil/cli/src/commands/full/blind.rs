//! `hil blind`: the blind trial of the tracer.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use mesh_damper_output::error::InputError;
use mesh_damper_output::{Outputs, Plan};
use mesh_damper_recording::Recording;
use mesh_damper_rig::check::{Check, failures};
use mesh_damper_trials::blind::{self, Draw, Outcome, Version};

use super::blind_conditions;
use super::blind_text::{in_words, line, print, tested};
use super::junit::{Case, Junit, judged};
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::{Failure, is_free_for_text, say};

/// Trace specimens with hidden effects drawn by seed, and count how often the trace is right
///
/// Prints the rates, the error ratios and the confusion matrix. In every 50 seeds, 10 hide no effect, 18 hide one effect of a known
/// family, 9 hide two of them, and 13 hide an effect of no family. A seed counts in the rates if the mixed damping law
/// k1·y + k3·y³ + c·|v|^α·sgn v (eq 13), fitted at each amplitude separately, has a residual of at least 3 times the noise.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil blind --seeds 3\n  hil blind --show 7 --out blind-7\n  hil blind --described --seeds 3\n  hil blind --conditions --seeds 3"
)]
pub struct BlindCommand {
    /// Number of seeds, 1 to 1000000; by default 50, with --described four of each effect
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    seeds: Option<u64>,
    /// First seed, 0 to 1000000000
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=1_000_000_000))]
    first: u64,
    /// Run this seed only; print what it hides and what the trace found
    #[arg(long, value_name = "SEED", conflicts_with_all = ["seeds", "first", "check", "json", "junit"])]
    show: Option<u64>,
    /// Folder for the recordings of --show: training.csv.gz and held-out.csv.gz
    ///
    /// With --conditions one file for each condition: training-1.csv.gz, held-out-1.csv.gz, and so on.
    #[arg(long, value_name = "DIR", requires = "show")]
    out: Option<PathBuf>,
    /// Hide the effects of the crate in turn, with parameters near their typical values
    ///
    /// The other trials simulate their effects with separate code.
    #[arg(long)]
    described: bool,
    /// Hide only effects of no family; --first and --seeds count these trials only
    #[arg(long, conflicts_with = "described")]
    unlisted: bool,
    /// Use other motions and sensors instead of blocks of sines: random, stepped, slow, swept, with pauses
    #[arg(long, conflicts_with_all = ["described", "unlisted"])]
    motions: bool,
    /// Judge models on amplitudes, frequencies, speeds or control inputs that they were not fitted on
    ///
    /// Counts how often the model that a trace writes is worse there than the law alone, and how much is within the band that it states.
    #[arg(long, conflicts_with_all = ["described", "unlisted", "motions", "draw_version"])]
    conditions: bool,
    /// Version of the draw, 1 to the newest
    ///
    /// A version adds effects that a seed may hide: published figures name the version with which they were made.
    #[arg(long, value_name = "N", default_value_t = Version::NEWEST.number(), conflicts_with = "described",
        value_parser = clap::value_parser!(u32).range(1..=i64::from(Version::NEWEST.number())))]
    draw_version: u32,
    /// Fail with exit code 1 if a rate or an error is worse than its limit, the level reached before
    #[arg(long)]
    check: bool,
    /// Write all results as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the checks, passed and failed, as JUnit XML to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

impl BlindCommand {
    pub fn run(self) -> Result<(), Failure> {
        match self.show {
            Some(seed) if self.conditions => {
                return blind_conditions::show(seed, self.out.as_deref());
            }
            Some(seed) => return self.show(seed),
            None => {}
        }
        let mut outputs = Plan::new().writes(&self.json).writes(&self.junit).begin()?;
        judged(
            "blind",
            self.junit.as_deref(),
            &mut outputs,
            |junit, outputs| match self.conditions {
                true => self.conditions(junit, outputs),
                false => self.trials(junit, outputs),
            },
        )
    }

    fn conditions(&self, mut junit: Junit, outputs: &mut Outputs) -> Result<(), Failure> {
        let count = self.seeds.unwrap_or(SEEDS_OF_CONDITIONS);
        let seeds = self.first..self.first + count;
        let (summary, checks) = blind_conditions::trials(seeds, &mut junit);
        if let Some(json) = &self.json {
            outputs.add_document(json, &summary)?;
        }
        self.finish(junit, outputs, checks, || blind_conditions::print(&summary))
    }

    /// Writes the outputs, prints the results with `print` if the terminal is free, and fails if a check did and is asked for.
    fn finish(
        &self,
        junit: Junit,
        outputs: &mut Outputs,
        checks: Vec<Check>,
        print: impl FnOnce(),
    ) -> Result<(), Failure> {
        junit.add(outputs, self.junit.as_deref())?;
        outputs.write()?;
        if is_free_for_text([&self.json, &self.junit]) {
            print();
        }
        let missed = failures(checks);
        if self.check && !missed.is_empty() {
            return Err(Failure::Check(missed.join("; ")));
        }
        Ok(())
    }

    fn trials(&self, mut junit: Junit, outputs: &mut Outputs) -> Result<(), Failure> {
        let count = self.seeds.unwrap_or_else(|| self.draw().seeds());
        let progress = Progress::of(count);
        progress.step("tracing");
        let seeds = self.first..self.first + count;
        let summary = blind::run(seeds, self.draw(), self.version(), &|| progress.one_more());
        drop(progress);
        let checks = self.draw().floors().checks(&summary.results);
        junit.property("specimens", format!("{:?}", self.draw()));
        junit.property("draw version", self.draw_version);
        junit.property("first seed", self.first);
        junit.property("seeds", count);
        junit.checks("floor", checks.iter().cloned());
        for outcome in &summary.outcomes {
            let name = format!("seed {}: {}", outcome.secret.seed, outcome.truth());
            let time = Duration::from_secs_f64(outcome.seconds);
            junit.case("seed", &name, case_of(outcome), Some(time));
        }
        for seed in &summary.results.not_shown {
            let reason = "no test shows the effect that this seed hides".to_owned();
            junit.case("seed", &format!("seed {seed}"), Case::Skipped(reason), None);
        }
        match &self.json {
            Some(json) if self.motions => {
                outputs.add_document(json, &summary.clone().over_any_motion())?;
            }
            Some(json) => outputs.add_document(json, &summary)?,
            None => {}
        }
        self.finish(junit, outputs, checks, || print(&summary))
    }

    fn version(&self) -> Version {
        Version::new(self.draw_version).unwrap_or(Version::NEWEST)
    }

    fn draw(&self) -> Draw {
        if self.motions {
            Draw::Motions
        } else if self.described {
            Draw::Described
        } else if self.unlisted {
            Draw::Unlisted
        } else {
            Draw::Specimens
        }
    }

    fn show(&self, seed: u64) -> Result<(), Failure> {
        let mut outputs = Plan::new().fills(self.out.as_deref(), RECORDINGS).begin()?;
        let trial = self.draw().trial(self.version(), seed).ok_or_else(|| {
            let what = "no test shows the effect that this seed hides";
            InputError::new(format!("described seed {seed}"), what, "show another seed")
        })?;
        let recordings = [&trial.training, &trial.held_out];
        add_recordings(&mut outputs, self.out.as_deref(), &RECORDINGS, recordings)?;
        outputs.write()?;
        let progress = Progress::steps();
        progress.step("tracing");
        let outcome = blind::judge(&trial);
        drop(progress);
        say(&line(&outcome));
        say(&format!(
            "{}, draw version {}",
            tested(&outcome.secret),
            self.draw_version
        ));
        for hidden in &outcome.secret.effects {
            say(&format!(
                "{}: {}; {:.1} times the noise, {:.1} of it beyond the mixed damping law",
                hidden.effect.family(),
                in_words(&hidden.effect.parameters()),
                hidden.size,
                hidden.visible
            ));
        }
        Ok(())
    }
}

/// Adds `recordings` under their `names` in the folder `out`, if there is one.
///
/// # Errors
/// A name or a recording that no file can have.
pub fn add_recordings<'r>(
    outputs: &mut Outputs,
    out: Option<&Path>,
    names: &[impl AsRef<str>],
    recordings: impl IntoIterator<Item = &'r Recording>,
) -> Result<(), InputError> {
    let Some(out) = out else { return Ok(()) };
    for (name, recording) in names.iter().zip(recordings) {
        let path = out.join(name.as_ref());
        outputs.add(&path, recording.to_file(&path)?);
    }
    Ok(())
}

/// A seed alone is no check. The floors limit how many seeds may be named wrongly.
fn case_of(outcome: &Outcome) -> Case {
    match outcome.mark() {
        _ if !outcome.counts() => Case::Skipped(format!(
            "does not count: less than 3 times the noise; called {}",
            outcome.answer()
        )),
        mark if mark.is_named() => Case::Passed,
        _ => Case::Skipped(format!("missed; counted in the rates: {}", line(outcome))),
    }
}

/// Trials of conditions of a run that gives no number: a tenth of those that the target is for.
const SEEDS_OF_CONDITIONS: u64 = 50;

/// File names of the recordings of a trial.
const RECORDINGS: [&str; 2] = ["training.csv.gz", "held-out.csv.gz"];

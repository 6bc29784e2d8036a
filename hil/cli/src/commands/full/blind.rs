//! `hil blind`: the blind trial of the tracer.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use clap::Args;
use mesh_damper_output::error::InputError;
use mesh_damper_output::{Outputs, Plan};
use mesh_damper_recording::Recording;
use mesh_damper_rig::check::failures;
use mesh_damper_trials::blind::{self, Class, Draw, Mark, Outcome, Rate, Summary};

use super::junit::{Case, Junit, judged};
use super::motions;
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
    after_help = "Examples:\n  hil blind --seeds 3\n  hil blind --show 7 --out blind-7\n  hil blind --described --seeds 3"
)]
pub struct BlindCommand {
    /// Number of seeds, 1 to 1000000
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    seeds: u64,
    /// First seed, 0 to 1000000000
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=1_000_000_000))]
    first: u64,
    /// Run this seed only; print what it hides and what the trace found
    #[arg(long, value_name = "SEED", conflicts_with_all = ["seeds", "first", "check", "json", "junit"])]
    show: Option<u64>,
    /// Folder for the recordings of --show: training.csv.gz and held-out.csv.gz
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
        if let Some(seed) = self.show {
            if self.motions {
                return motions::show(seed, self.out.as_deref());
            }
            return self.show(seed);
        }
        if self.motions {
            let seeds = self.first..self.first + self.seeds;
            return motions::run(seeds, &self.json, &self.junit, self.check);
        }
        let mut outputs = Plan::new().writes(&self.json).writes(&self.junit).begin()?;
        judged(
            "blind",
            self.junit.as_deref(),
            &mut outputs,
            |junit, outputs| self.trials(junit, outputs),
        )
    }

    fn trials(&self, mut junit: Junit, outputs: &mut Outputs) -> Result<(), Failure> {
        let progress = Progress::of(self.seeds);
        progress.step("tracing");
        let finished = AtomicU64::new(0);
        let summary = blind::run(self.first..self.first + self.seeds, self.draw(), &|| {
            progress.done(finished.fetch_add(1, Ordering::Relaxed) + 1);
        });
        drop(progress);
        if let Some(json) = &self.json {
            outputs.add_document(json, &summary)?;
        }
        let checks = self.draw().floors().checks(&summary);
        junit.property("specimens", format!("{:?}", self.draw()));
        junit.property("first seed", self.first);
        junit.property("seeds", self.seeds);
        junit.checks("floor", checks.iter().cloned());
        for outcome in &summary.outcomes {
            let name = format!("seed {}: {}", outcome.secret.seed, outcome.truth());
            junit.case("seed", &name, case_of(outcome), None);
        }
        for seed in &summary.not_shown {
            let reason = "no test shows the effect that this seed hides".to_owned();
            junit.case("seed", &format!("seed {seed}"), Case::Skipped(reason), None);
        }
        junit.add(outputs, self.junit.as_deref())?;
        outputs.write()?;
        if is_free_for_text([&self.json, &self.junit]) {
            print(&summary);
        }
        let missed = failures(checks);
        if self.check && !missed.is_empty() {
            return Err(Failure::Check(missed.join("; ")));
        }
        Ok(())
    }

    fn draw(&self) -> Draw {
        if self.described {
            Draw::Described
        } else if self.unlisted {
            Draw::Unlisted
        } else {
            Draw::Specimens
        }
    }

    fn show(&self, seed: u64) -> Result<(), Failure> {
        let mut outputs = recordings(self.out.as_deref())?;
        let trial = (self.draw().trial(seed)).ok_or_else(|| {
            let what = "no test shows the effect that this seed hides";
            InputError::new(format!("described seed {seed}"), what, "show another seed")
        })?;
        add_recordings(
            &mut outputs,
            self.out.as_deref(),
            [&trial.training, &trial.held_out],
        )?;
        outputs.write()?;
        let progress = Progress::steps();
        progress.step("tracing");
        let outcome = blind::judge(&trial);
        drop(progress);
        say(&line(&outcome));
        let secret = &outcome.secret;
        say(&format!(
            "{:.2} g/cm3, {:?}, {} Hz, noise {:.2} %",
            secret.density,
            secret.programme.shape,
            secret.rate,
            100.0 * secret.noise
        ));
        for hidden in &secret.effects {
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

/// A seed alone is no check. The floors limit how many seeds may be named wrongly.
fn case_of(outcome: &Outcome) -> Case {
    match outcome.mark() {
        _ if !outcome.counts() => Case::Skipped(format!(
            "does not count: less than 3 times the noise; called {}",
            outcome.answer()
        )),
        Mark::Right | Mark::Among => Case::Passed,
        Mark::Wrong => Case::Skipped(format!(
            "missed; counted in the rates: called {}",
            outcome.answer()
        )),
    }
}

/// File names of the recordings of a trial.
const RECORDINGS: [&str; 2] = ["training.csv.gz", "held-out.csv.gz"];

/// The outputs of a trial whose recordings go into `out`.
pub fn recordings(out: Option<&Path>) -> Result<Outputs, InputError> {
    Plan::new().fills(out, RECORDINGS).begin()
}

/// Adds both recordings of a trial, if they were requested.
pub fn add_recordings(
    outputs: &mut Outputs,
    out: Option<&Path>,
    both: [&Recording; 2],
) -> Result<(), InputError> {
    let Some(out) = out else { return Ok(()) };
    for (name, recording) in RECORDINGS.into_iter().zip(both) {
        let path = out.join(name);
        outputs.add(&path, recording.to_file(&path)?);
    }
    Ok(())
}

/// Parameters of an effect, each with name, value and unit.
pub fn in_words(parameters: &[(&'static str, f64, &'static str)]) -> String {
    let each = parameters.iter();
    let each = each.map(|(name, value, unit)| format!("{name} {value:.4} {unit}"));
    each.collect::<Vec<_>>().join(", ")
}

/// Truth and answer in one line.
fn line(outcome: &Outcome) -> String {
    let mark = match outcome.mark() {
        Mark::Right => "right",
        Mark::Among => "among several",
        Mark::Wrong => "WRONG",
    };
    let errors = match &outcome.said {
        Ok(said) => format!(
            "held-out error {:.2} -> {:.2} times the noise",
            said.before, said.after
        ),
        Err(reason) => reason.clone(),
    };
    let visible = if outcome.secret.effects.is_empty() {
        String::new()
    } else {
        format!(" {:.1}", outcome.secret.visible())
    };
    format!(
        "{:>5} {mark}: {}{visible} was called {}; {errors}",
        outcome.secret.seed,
        outcome.truth(),
        outcome.answer()
    )
}

fn print(summary: &Summary) {
    let wrong: Vec<&Outcome> = summary
        .outcomes
        .iter()
        .filter(|outcome| outcome.counts() && outcome.mark() != Mark::Right)
        .collect();
    if !wrong.is_empty() {
        say("Seeds that count and were not named correctly:");
        for outcome in wrong {
            say(&line(outcome));
        }
    }
    if !summary.not_shown.is_empty() {
        say(&format!(
            "No test shows the effects of these seeds: {:?}",
            summary.not_shown
        ));
    }
    say("");
    say(
        "Hidden effect, number of seeds, and results of the trace (effects of no family in brackets):",
    );
    for (truth, answers) in &summary.confusion {
        let total: usize = answers.values().sum();
        let mut answers: Vec<(&String, &usize)> = answers.iter().collect();
        answers.sort_by(|a, b| b.1.cmp(a.1));
        let said: Vec<String> = answers
            .iter()
            .map(|(answer, count)| format!("{answer} {count}"))
            .collect();
        say(&format!("{truth:>28} {total:>4}   {}", said.join(", ")));
    }
    say("");
    say("Held-out error of the embedded law over the noise:  median  9 in 10   worst");
    for (class, ratios) in &summary.ratios {
        let name = match class {
            Class::None => "no hidden effect",
            Class::Listed => "one effect of a family",
            Class::Pair => "two",
            Class::Unlisted => "an effect of no family",
        };
        say(&format!(
            "{name:>50} {:>7.2} {:>8.2} {:>7.2}",
            ratios.median, ratios.ninth_decile, ratios.worst
        ));
    }
    say("");
    for (what, rate) in [
        ("one effect of a family, named alone", summary.listed),
        ("the same, or named among several", summary.listed_or_among),
        (
            "false discoveries without a hidden effect",
            summary.false_discoveries,
        ),
        ("two effects, both named", summary.pairs),
        ("the same, or named among several", summary.pairs_or_among),
        (
            "an effect of no family, verdict unmodelled",
            summary.unlisted,
        ),
        (
            "an effect of no family, given the name of a family",
            summary.unlisted_named,
        ),
        (
            "an effect of no family, the law augmented",
            summary.unlisted_augmented,
        ),
    ] {
        say(&rate_line(what, rate));
    }
}

fn rate_line(what: &str, rate: Rate) -> String {
    if rate.of == 0 {
        return format!("{what:>50}: none counted");
    }
    format!(
        "{what:>50}: {:>5.1} %  ({} of {})",
        100.0 * rate.value(),
        rate.count,
        rate.of
    )
}

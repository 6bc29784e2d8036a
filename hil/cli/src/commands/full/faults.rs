//! `hil faults`: the fault campaign.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Args;
use mesh_damper_link::image::Board;
use mesh_damper_link::lockstep::{Image, run_trial_on};
use mesh_damper_output::error::InputError;
use mesh_damper_output::{Outputs, Plan};
use mesh_damper_report::campaign;
use mesh_damper_rig::SetupError;
use mesh_damper_rig::campaign::{Campaign, Summary, Trial, requirements};
use mesh_damper_rig::check::failures;
use mesh_damper_sources::Sources;

use super::faults_text;
use super::image::{IMAGES, On, say_where};
use super::junit::{Junit, judged};
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::{Failure, is_free_for_text};

/// Inject faults into the simulated rig, attack its signals, and count what its monitor finds
///
/// Faults act on specimen, sensors and actuator. For each kind and size of fault, the command prints how many the monitor found, how soon,
/// and how many it named correctly. It prints the same for attacks and pairs of attacks, with the hazardous states that they caused and
/// the diagnostic coverage of each element. Then it prints the false alarms in healthy cycles (run-in, temperature changes, hum, bursts,
/// pauses), and how well the adaptation follows slow changes.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil faults --adversary 20\n  hil faults --part --check\n  hil faults --out faults-out"
)]
pub struct FaultsCommand {
    /// Where the controller runs; on the image, only one specimen is tested
    #[arg(long, value_enum, default_value_t = On::Host)]
    on: On,
    /// Run a part only: three specimens at 1 % noise, some of the attacks, 18000 healthy cycles
    #[arg(long, conflicts_with = "on")]
    part: bool,
    /// Total number of healthy cycles, 0 to 100000000
    #[arg(long, value_name = "N", conflicts_with = "on", value_parser = clap::value_parser!(u32).range(0..=100_000_000))]
    healthy: Option<u32>,
    /// Run N random trials only, 1 to 10000000; each draws one to four attacks
    #[arg(long, value_name = "N", conflicts_with_all = ["part", "healthy"], value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    adversary: Option<u32>,
    /// Seed of the first random trial; the same seed gives the same trial
    #[arg(long, value_name = "SEED", default_value_t = 0, requires = "adversary")]
    first: u64,
    /// Folder for the pictures: faults.svg, attacks.svg, and following.svg for slow changes
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Fail with exit code 1 if a requirement is not met
    #[arg(long)]
    check: bool,
    /// Write all results as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the checks, passed and failed, as JUnit XML to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

/// The error of a campaign that was not completed.
fn refused(error: SetupError) -> InputError {
    match error {
        SetupError::Link(error) => error,
        error => InputError::new("the fault campaign", error.to_string(), "report this"),
    }
}

/// The result of `run` for each of `all`, on all cores of the machine.
fn at_once<T: Sync, R: Send>(
    all: &[T],
    run: impl Fn(&T) -> Result<R, InputError> + Sync,
) -> Result<Vec<R>, InputError> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let work = || -> Result<Vec<(usize, R)>, InputError> {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(one) = all.get(index) else {
                return Ok(done);
            };
            done.push((index, run(one)?));
        }
    };
    let ended = std::thread::scope(|scope| {
        let started: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        let ended = started.into_iter().map(|worker| match worker.join() {
            Ok(done) => done,
            Err(panic) => std::panic::resume_unwind(panic),
        });
        ended.collect::<Result<Vec<_>, InputError>>()
    })?;
    let mut results: Vec<_> = ended.into_iter().flatten().collect();
    results.sort_by_key(|(index, _)| *index);
    Ok(results.into_iter().map(|(_, result)| result).collect())
}

/// Injects the faults and attacks of `chosen`, each into an image that was just started.
fn on_image(chosen: &Campaign) -> Result<Summary, InputError> {
    say_where(&Sources::find()?, "the firmware's image", IMAGES);
    let mut trials = chosen.trials();
    trials.retain(Trial::is_possible_over_a_link);
    let progress = Progress::of(trials.len() as u64);
    progress.step("testing the image");
    let outcomes = at_once(&trials, |trial| {
        let mut image = Image::start(Board::Mps2An386, Box::new(|_| {}))?;
        let outcome = run_trial_on(&mut image, trial).map_err(refused);
        progress.one_more();
        outcome
    })?;
    Ok(Summary::of(outcomes, Vec::new(), Vec::new(), Vec::new()))
}

impl FaultsCommand {
    fn summary(&self) -> Result<Summary, InputError> {
        let mut chosen = match (self.adversary, self.on) {
            (Some(count), _) => Campaign::adversary(count, self.first),
            (None, On::Image) => Campaign::on_image(),
            (None, On::Host) if self.part => Campaign::part(),
            (None, On::Host) => Campaign::whole(),
        };
        if self.on == On::Image {
            return on_image(&chosen);
        }
        chosen.healthy_cycles = self.healthy.unwrap_or(chosen.healthy_cycles);
        let progress = Progress::of(chosen.steps());
        progress.step("testing");
        chosen.run(&|| progress.one_more()).map_err(refused)
    }

    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new()
            .fills(
                self.out.as_deref(),
                ["faults.svg", "attacks.svg", "following.svg"],
            )
            .writes(&self.json)
            .writes(&self.junit)
            .begin()?;
        judged(
            "faults",
            self.junit.as_deref(),
            &mut outputs,
            |junit, outputs| self.campaign(junit, outputs),
        )
    }

    fn campaign(&self, mut junit: Junit, outputs: &mut Outputs) -> Result<(), Failure> {
        let picture = |name: &str| self.out.as_ref().map(|out| out.join(name));
        let (found, followed) = (picture("faults.svg"), picture("following.svg"));
        let attacked = picture("attacks.svg");
        let summary = self.summary()?;
        if let Some(found) = found.filter(|_| !summary.outcomes.is_empty()) {
            outputs.add(found, campaign::found(&summary));
        }
        if let Some(attacked) = attacked.filter(|_| summary.attacks.trials() > 0) {
            outputs.add(attacked, campaign::attacked(&summary.attacks));
        }
        if let Some(followed) = followed.filter(|_| !summary.slow.is_empty()) {
            outputs.add(followed, campaign::followed(&summary.slow));
        }
        outputs.add_document_if(&self.json, &summary)?;
        let checks = requirements(&summary);
        junit.property("on", self.on.name());
        junit.property("trials", summary.counts.trials);
        junit.property("attack trials", summary.attacks.trials());
        junit.property("healthy cycles", summary.healthy_cycles);
        junit.checks("requirement", checks.iter().cloned());
        junit.add(outputs, self.junit.as_deref())?;
        outputs.write()?;
        if is_free_for_text([&self.json, &self.junit]) {
            faults_text::print(&summary);
        }
        let missed = failures(checks);
        if self.check && !missed.is_empty() {
            return Err(Failure::Check(missed.join("; ")));
        }
        Ok(())
    }
}

//! `hil blind --motions`: the blind trial over any motion.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use mesh_damper_output::{Outputs, Plan};
use mesh_damper_rig::check::failures;
use mesh_damper_trials::blind::motions::{self, FLOORS, Mark, Outcome, Row, Summary};

use super::blind::{add_recordings, in_words, recordings};
use super::junit::{Case, Junit, judged};
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::{Failure, is_free_for_text, say};

/// Runs the trials of `seeds` and prints a table. With `check`, fails if a rate is below its floor.
pub fn run(
    seeds: Range<u64>,
    json: &Option<PathBuf>,
    junit: &Option<PathBuf>,
    check: bool,
) -> Result<(), Failure> {
    let mut outputs = Plan::new().writes(json).writes(junit).begin()?;
    judged("blind", junit.as_deref(), &mut outputs, |tests, outputs| {
        trials(seeds, (json, junit), check, (tests, outputs))
    })
}

fn trials(
    seeds: Range<u64>,
    (json, junit): (&Option<PathBuf>, &Option<PathBuf>),
    check: bool,
    (mut tests, outputs): (Junit, &mut Outputs),
) -> Result<(), Failure> {
    tests.property("specimens", "Motions");
    tests.property("first seed", seeds.start);
    tests.property("seeds", seeds.end - seeds.start);
    let progress = Progress::of(seeds.end - seeds.start);
    progress.step("tracing");
    let finished = AtomicU64::new(0);
    let summary = motions::run(seeds, &|| {
        progress.done(finished.fetch_add(1, Ordering::Relaxed) + 1);
    });
    drop(progress);
    if let Some(json) = json {
        outputs.add_document(json, &summary)?;
    }
    let checks = FLOORS.checks(&summary);
    tests.checks("floor", checks.iter().cloned());
    for outcome in &summary.outcomes {
        let hidden = hidden(outcome);
        let name = format!("seed {}: {hidden}", outcome.seed);
        let time = Duration::from_secs_f64(outcome.seconds);
        tests.case("seed", &name, case_of(outcome), Some(time));
    }
    tests.add(outputs, junit.as_deref())?;
    outputs.write()?;
    if is_free_for_text([json, junit]) {
        print(&summary);
    }
    let missed = failures(checks);
    if check && !missed.is_empty() {
        return Err(Failure::Check(missed.join("; ")));
    }
    Ok(())
}

/// As in the other trials, the floors are the checks.
fn case_of(outcome: &Outcome) -> Case {
    match outcome.mark {
        _ if !outcome.counts() => Case::Skipped("does not count".into()),
        Mark::Right | Mark::Among => Case::Passed,
        Mark::Honest | Mark::False | Mark::Missed | Mark::Refused => {
            Case::Skipped(format!("missed; counted in the rates: {}", line(outcome)))
        }
    }
}

fn print(summary: &Summary) {
    say("Seeds that count and were not named correctly:");
    for outcome in summary.outcomes.iter().filter(|o| o.counts()) {
        if outcome.mark != Mark::Right {
            say(&line(outcome));
        }
    }
    say("");
    say(&format!(
        "{:26} {:>5} {:>7} {:>6} {:>7} {:>6} {:>7} {:>8}   {:>6} {:>7} {:>8} {:>10}  {:>9} {:>9} {:>8}",
        "",
        "count",
        "right",
        "among",
        "honest",
        "false",
        "missed",
        "refused",
        "median",
        "9 in 10",
        "seconds",
        "time",
        "intervals",
        "velocity",
        "covered"
    ));
    for row in summary.rows.iter().chain([&summary.all]) {
        say(&row_of(row));
    }
    say("");
    for line in [
        "median, 9 in 10: held-out error of the embedded law over that of the true law",
        "seconds: duration of the median trace, with as many traces at a time as the machine has processors",
        "time: largest ratio of a trace's duration to the duration of its recordings",
        "intervals: part of the law's 90 % intervals that contain the true value",
        "velocity: error of the estimated velocity over that of an estimate by cubics alone",
        "covered: part of the velocity samples within their 90 % intervals",
    ] {
        say(line);
    }
}

/// Prints the hidden effects and the answer of one seed, and writes its recordings into `out`.
pub fn show(seed: u64, out: Option<&Path>) -> Result<(), Failure> {
    let mut outputs = recordings(out)?;
    let trial = motions::draw(seed);
    add_recordings(&mut outputs, out, [&trial.training, &trial.held_out])?;
    outputs.write()?;
    say(&line(&motions::judge(&trial)));
    for effect in &trial.hidden {
        say(&format!(
            "{}: {}",
            effect.family(),
            in_words(&effect.parameters())
        ));
    }
    Ok(())
}

fn hidden(outcome: &Outcome) -> String {
    match &outcome.hidden[..] {
        [] => "nothing".to_owned(),
        hidden => hidden.join(" + "),
    }
}

fn line(outcome: &Outcome) -> String {
    let hidden = hidden(outcome);
    let said = match &outcome.refused {
        Some(why) => format!("refused: {why}"),
        None => format!(
            "called {} {}; error {:.2} times the true law's",
            outcome
                .verdict
                .map_or_else(String::new, |v| format!("{v:?}").to_lowercase()),
            outcome.named.join(" + "),
            outcome.error
        ),
    };
    format!(
        "{:>5} {:8} {:?}, sensors {:?}, {} Hz: {hidden} {:.1} was {said}",
        outcome.seed,
        format!("{:?}", outcome.mark).to_lowercase(),
        outcome.kind,
        outcome.flaw,
        outcome.rate,
        outcome.visible,
    )
}

fn row_of(row: &Row) -> String {
    let [right, among, honest, wrong, missed, refused] = row.marks;
    format!(
        "{:26} {:>5} {:>5.1} % {among:>6} {honest:>7} {wrong:>6} {missed:>7} {refused:>8}   {:>6.2} {:>7.2} {:>8.1} {:>8.2} %  {:>7.1} % {:>9.2} {:>6.1} %",
        row.of,
        row.count,
        100.0 * right as f64 / row.count.max(1) as f64,
        row.median,
        row.ninth_decile,
        row.seconds,
        100.0 * row.time,
        100.0 * row.intervals,
        row.over_cubics,
        100.0 * row.covered
    )
}

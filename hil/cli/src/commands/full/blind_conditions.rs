//! `hil blind --conditions`: models judged on conditions that they were not fitted on.

use std::ops::Range;
use std::path::Path;
use std::time::Duration;

use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_output::Plan;
use mesh_damper_recording::Recording;
use mesh_damper_rig::check::Check;
use mesh_damper_trials::conditions::{self, Condition, Outcome, Programme, Row, Summary};

use super::blind::add_recordings;
use super::junit::{Case, Junit};
use crate::commands::progress::Progress;
use crate::commands::{Failure, say};

/// Runs the trials of `seeds`, with their requirements; the results are also in `junit`.
pub fn trials(seeds: Range<u64>, junit: &mut Junit) -> (Summary, Vec<Check>) {
    let progress = Progress::of(seeds.end - seeds.start);
    progress.step("tracing");
    junit.property("specimens", "Conditions");
    junit.property("first seed", seeds.start);
    junit.property("seeds", seeds.end - seeds.start);
    let summary = conditions::run(seeds, &|| progress.one_more());
    drop(progress);
    let checks = summary.checks();
    junit.checks("limit", checks.iter().cloned());
    for outcome in &summary.outcomes {
        let name = format!("seed {}: {:?}", outcome.secret.seed, outcome.secret.family);
        let case = match outcome.is_worse() {
            false => Case::Passed,
            true => Case::Skipped(format!("worse; counted in the limit: {}", line(outcome))),
        };
        let time = Duration::from_secs_f64(outcome.seconds);
        junit.case("seed", &name, case, Some(time));
    }
    (summary, checks)
}

/// Traces the trial of `seed`, prints it, and writes its recordings to the folder `out`.
///
/// # Errors
/// A file cannot be written.
pub fn show(seed: u64, out: Option<&Path>) -> Result<(), Failure> {
    let trial = conditions::trial(seed);
    let files = |of: &'static str, recordings: &[Recording]| {
        (1..=recordings.len()).map(move |number| format!("{of}-{number}.csv.gz"))
    };
    let names: Vec<String> = files("training", &trial.training)
        .chain(files("held-out", &trial.held_out))
        .collect();
    let mut outputs = Plan::new().fills(out, &names).begin()?;
    let recordings = trial.training.iter().chain(&trial.held_out);
    add_recordings(&mut outputs, out, &names, recordings)?;
    outputs.write()?;
    let progress = Progress::steps();
    progress.step("tracing");
    let outcome = conditions::judge(&trial);
    drop(progress);
    let secret = &outcome.secret;
    let programme = &secret.programme;
    say(&line(&outcome));
    say(&format!(
        "{:?} motion; device {}",
        programme.wave, secret.device
    ));
    say(&format!(
        "stiffness 1 is {:.4} kN/mm; {:?}",
        secret.stiffness, secret.sensors
    ));
    for (what, conditions) in [
        ("fitted", &programme.training),
        ("held out", &programme.held_out),
    ] {
        for condition in conditions {
            say(&format!(
                "{what}: {}",
                in_words(condition, secret.control_scale)
            ));
        }
    }
    if let Ok(conditions::Said {
        within_band: Some(within),
        ..
    }) = &outcome.said
    {
        say(&format!(
            "{:.1} % of the held-out samples are within the band",
            100.0 * within
        ));
    }
    Ok(())
}

fn in_words(condition: &Condition, control: f64) -> String {
    format!(
        "{:.4} mm, {:.4} Hz, control input {:.4}, {} cycles at {:.4} Hz",
        condition.amplitude,
        condition.frequency,
        condition.level * control,
        condition.cycles,
        condition.rate
    )
}

/// Truth and answer in one line.
fn line(outcome: &Outcome) -> String {
    let secret = &outcome.secret;
    let answer = match &outcome.said {
        Err(reason) => format!("refused: {reason}"),
        Ok(said) => {
            let verdict = match said.verdict {
                Verdict::None => "nothing missing",
                Verdict::Found => "found",
                Verdict::Ambiguous => "ambiguous",
                Verdict::Unlisted => "unmodelled",
            };
            let adopted = if said.adopted { "" } else { ", not adopted" };
            let table = if said.has_table {
                ", residual table"
            } else {
                ""
            };
            format!(
                "{:.2} % -> {:.2} %; {verdict}: {}{adopted}{table}",
                100.0 * said.before,
                100.0 * said.after,
                said.families.join(" + ")
            )
        }
    };
    format!(
        "{:>5} {:?}, {}: {answer}",
        secret.seed,
        secret.family,
        held_out(&secret.programme)
    )
}

/// The held-out values of the quantity that varies, and the fitted ones.
fn held_out(programme: &Programme) -> String {
    let kind = programme.kind;
    let values = |conditions: &[Condition]| {
        let each = conditions.iter().map(|c| format!("{:.3}", c.value(kind)));
        each.collect::<Vec<_>>().join(", ")
    };
    format!(
        "{} {} of {}",
        format!("{kind:?}").to_lowercase(),
        values(&programme.held_out),
        values(&programme.training)
    )
}

/// Everything that was counted.
pub fn print(summary: &Summary) {
    let worse: Vec<&Outcome> = summary.outcomes.iter().filter(|o| o.is_worse()).collect();
    if !worse.is_empty() {
        say("Trials whose model is worse than the law alone, or was refused:");
        for outcome in worse {
            say(&line(outcome));
        }
        say("");
    }
    say(&format!(
        "{:20} {:>5} {:>6} {:>8} {:>7} {:>7} {:>7} {:>7} {:>8}",
        "Trials", "count", "worse", "refused", "ratio", "worst", "banded", "band", "seconds"
    ));
    for row in summary.rows.iter().chain([&summary.all]) {
        say(&row_of(row));
    }
    say("");
    for line in [
        "worse: traces whose model predicts the held-out conditions worse than the law alone, by more than 2 %, or refused",
        "ratio, worst: held-out error of the model over that of the law alone, geometric mean and largest",
        "banded: models that state a band; band: part of the held-out samples within it, mean over these models",
        "seconds: duration of the median trace, with as many traces at a time as the machine has processors",
    ] {
        say(line);
    }
}

fn row_of(row: &Row) -> String {
    let of = |value: f64, text: String| if value.is_nan() { "-".to_owned() } else { text };
    format!(
        "{:20} {:>5} {:>6} {:>8} {:>7} {:>7} {:>7} {:>7} {:>8.1}",
        row.of,
        row.count,
        row.worse,
        row.refused,
        of(row.mean_ratio, format!("{:.3}", row.mean_ratio)),
        of(row.worst_ratio, format!("{:.3}", row.worst_ratio)),
        row.banded,
        of(row.within_band, format!("{:.1} %", 100.0 * row.within_band)),
        row.seconds,
    )
}

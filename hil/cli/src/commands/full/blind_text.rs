//! The output of `hil blind` as text.

use mesh_damper_trials::blind::{Class, Mark, Outcome, Rate, Results, Row, Secret, Summary, Test};

use crate::commands::say;

/// Parameters of an effect, each with name, value and unit.
pub fn in_words(parameters: &[(&'static str, f64, &'static str)]) -> String {
    let each = parameters.iter();
    let each = each.map(|(name, value, unit)| format!("{name} {value:.4} {unit}"));
    each.collect::<Vec<_>>().join(", ")
}

/// The specimen and its tests.
pub fn tested(secret: &Secret) -> String {
    let test = match &secret.test {
        Test::Blocks(test) => {
            let (shape, noise) = (test.programme.shape, 100.0 * test.noise);
            format!("{shape:?}, noise {noise:.2} %")
        }
        Test::Motion(test) => format!("{:?}, sensors {:?}", test.kind, test.sensors.flaw),
    };
    format!("{:.2} g/cm3, {} Hz, {test}", secret.density, secret.rate)
}

/// Truth and answer in one line.
pub fn line(outcome: &Outcome) -> String {
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
        "{:>5} {}: {}{visible} was called {}; {errors}; {}",
        outcome.secret.seed,
        format!("{:?}", outcome.mark()).to_lowercase(),
        outcome.truth(),
        outcome.answer(),
        tested(&outcome.secret)
    )
}

/// Everything that was counted.
pub fn print(summary: &Summary) {
    let results = &summary.results;
    say(&format!("Draw version {}", results.draw_version));
    let is_wrong = |outcome: &&Outcome| outcome.counts() && outcome.mark() != Mark::Right;
    let wrong: Vec<&Outcome> = summary.outcomes.iter().filter(is_wrong).collect();
    if !wrong.is_empty() {
        say("Seeds that count and were not named correctly:");
        for outcome in wrong {
            say(&line(outcome));
        }
    }
    if !results.not_shown.is_empty() {
        say(&format!(
            "No test shows the effects of these seeds: {:?}",
            results.not_shown
        ));
    }
    print_confusion(results);
    print_rows(results);
    print_ratios(results);
    print_rates(results);
}

fn print_confusion(results: &Results) {
    say("");
    say(
        "Hidden effect, number of seeds, and results of the trace (effects of no family in brackets):",
    );
    for (truth, answers) in &results.confusion {
        let total: usize = answers.values().sum();
        let mut answers: Vec<(&String, &usize)> = answers.iter().collect();
        answers.sort_by(|a, b| b.1.cmp(a.1));
        let said: Vec<String> = answers
            .iter()
            .map(|(answer, count)| format!("{answer} {count}"))
            .collect();
        say(&format!("{truth:>28} {total:>4}   {}", said.join(", ")));
    }
}

fn print_rows(results: &Results) {
    say("");
    say(&format!(
        "{:26} {:>5} {:>7} {:>6} {:>7} {:>6} {:>7} {:>8}   {:>6} {:>7} {:>5} {:>7} {:>8} {:>10}  {:>9} {:>9} {:>8}",
        "Seeds that count",
        "count",
        "right",
        "among",
        "honest",
        "false",
        "missed",
        "refused",
        "median",
        "9 in 10",
        "worse",
        "band",
        "seconds",
        "time",
        "intervals",
        "velocity",
        "covered"
    ));
    for row in results.rows.iter().chain([&results.all]) {
        say(&row_of(row));
    }
    say("");
    for line in [
        "median, 9 in 10: held-out error of the embedded law over that of the true law",
        "worse: traces whose law predicts the held-out motion worse than eq 13 alone, by more than 2 %",
        "band: part of the held-out samples within the band of nine in ten that the models state",
        "seconds: duration of the median trace, with as many traces at a time as the machine has processors",
        "time: largest ratio of a trace's duration to the duration of its recordings",
        "over any motion only:",
        "intervals: part of the law's 90 % intervals that contain the true value",
        "velocity: error of the estimated velocity over that of an estimate by cubics alone",
        "covered: part of the velocity samples within their 90 % intervals",
    ] {
        say(line);
    }
}

fn row_of(row: &Row) -> String {
    let [right, among, honest, wrong, missed, refused] = row.marks;
    // There is none over blocks of sines, and none without a trial.
    let of = |value: f64, factor: f64, unit: &str| match value.is_nan() {
        true => "-".to_owned(),
        false => format!(
            "{:.*}{unit}",
            if unit.is_empty() { 2 } else { 1 },
            factor * value
        ),
    };
    format!(
        "{:26} {:>5} {:>5.1} % {among:>6} {honest:>7} {wrong:>6} {missed:>7} {refused:>8}   {:>6} {:>7} {:>5} {:>7} {:>8.1} {:>8.2} %  {:>9} {:>9} {:>8}",
        row.of,
        row.count,
        100.0 * right as f64 / row.count.max(1) as f64,
        of(row.median, 1.0, ""),
        of(row.ninth_decile, 1.0, ""),
        row.worse,
        of(row.within_band, 100.0, " %"),
        row.seconds,
        100.0 * row.time,
        of(row.intervals, 100.0, " %"),
        of(row.over_cubics, 1.0, ""),
        of(row.covered, 100.0, " %"),
    )
}

fn print_ratios(results: &Results) {
    say("");
    say("Held-out error of the embedded law over the noise, all seeds:  median  9 in 10   worst");
    for (class, ratios) in &results.ratios {
        let name = match class {
            Class::None => "no hidden effect",
            Class::Listed => "one effect of a family",
            Class::Pair => "two",
            Class::Unlisted => "an effect of no family",
        };
        say(&format!(
            "{name:>61} {:>7.2} {:>8.2} {:>7.2}",
            ratios.median, ratios.ninth_decile, ratios.worst
        ));
    }
}

fn print_rates(results: &Results) {
    say("");
    for (what, rate) in [
        ("one effect of a family, named alone", results.listed),
        ("the same, or named among several", results.listed_or_among),
        (
            "false discoveries without a hidden effect",
            results.false_discoveries,
        ),
        ("two effects, both named", results.pairs),
        ("the same, or named among several", results.pairs_or_among),
        (
            "an effect of no family, verdict unmodelled",
            results.unlisted,
        ),
        (
            "an effect of no family, given the name of a family",
            results.unlisted_named,
        ),
        (
            "an effect of no family, the law augmented",
            results.unlisted_augmented,
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

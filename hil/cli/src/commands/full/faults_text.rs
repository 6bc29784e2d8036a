//! The output of `hil faults` as text.

use mesh_damper_rig::campaign::{
    CHANGING, Counts, FOLLOW, KindSummary, LossSummary, Outcome, Summary, Surroundings,
};

use crate::commands::say;

/// Largest number of trials listed one by one.
const LISTED: usize = 60;

/// Trials that failed; all trials by kind, and by set; healthy cycles, slow changes, and the coverage.
pub(super) fn print(summary: &Summary) {
    let attacks = &summary.attacks;
    if summary.outcomes.len() + attacks.trials() > 0 {
        print_failures(summary);
        print_kinds(&summary.kinds);
        print_kinds(&attacks.kinds);
        print_totals(summary);
    }
    if !summary.healthy.is_empty() {
        print_healthy(summary);
    }
    if !summary.slow.is_empty() {
        print_slow(summary);
    }
    if !summary.outcomes.is_empty() {
        say("");
        say(&format!(
            "Faults: largest displacement {:.2}, force {:.2} of their limits, beyond a limit for at most {} ticks; {} trips, {} of \
             them in time",
            summary.displacement,
            summary.force,
            summary.ticks_beyond,
            summary.stopped,
            summary.stopped_in_time
        ));
    }
    if !summary.coverage.is_empty() {
        print_coverage(summary);
    }
}

/// Hazardous trials, then those that were not found in time or not named correctly, except the adversary's.
fn print_failures(summary: &Summary) {
    let attacks = &summary.attacks.outcomes;
    let all = summary.outcomes.iter().chain(attacks.all());
    let hazardous: Vec<_> = all.filter(|one| one.is_hazardous()).collect();
    list("Hazardous states", &hazardous);
    let is_missed = |one: &&Outcome| one.hidden.is_none() && !(one.in_time && one.is_named());
    let judged = summary.outcomes.iter().chain(&attacks.singles);
    let missed: Vec<_> = judged.chain(&attacks.pairs).filter(is_missed).collect();
    list("Not found in time, or named incorrectly", &missed);
}

fn list(title: &str, outcomes: &[&Outcome]) {
    if outcomes.is_empty() {
        return;
    }
    say("");
    say(&format!("{title}: {}", outcomes.len()));
    // The listed trials are spread over all, because neighbours are alike.
    let step = outcomes.len().div_ceil(LISTED);
    for one in outcomes.iter().step_by(step) {
        say(&format!("  {}", words(one)));
    }
}

fn words(one: &Outcome) -> String {
    let trial = &one.trial;
    let changes = trial.changes.iter().map(|change| {
        let lasts = change.lasts.map(|cycles| format!(" for {cycles:.2}"));
        format!(
            "{:?} {:.3} at {:.2}{}",
            change.kind,
            change.size,
            change.begins,
            lasts.unwrap_or_default()
        )
    });
    let named = one.named.iter().take(3);
    let named = named.map(|(cycle, cause)| format!("{cause} at {cycle:.2}"));
    let hazards = one.hazards.iter().map(|hazard| {
        format!(
            "; {:?} {:.2} of its limit for {} ticks, {:?}",
            hazard.quantity, hazard.factor, hazard.steps, hazard.behind
        )
    });
    format!(
        "seed {}: {} in {} g/cm3, {} mm, {} Hz, noise {} %: {}{}",
        trial.seed,
        changes.collect::<Vec<_>>().join(", "),
        trial.density,
        trial.amplitude,
        trial.frequency,
        100.0 * trial.noise,
        if one.named.is_empty() {
            "nothing".into()
        } else {
            named.collect::<Vec<_>>().join(", ")
        },
        hazards.collect::<String>()
    )
}

fn cycles(cycles: Option<f64>) -> String {
    cycles.map_or_else(|| "-".into(), |cycles| format!("{cycles:.2}"))
}

fn row(name: &str, counts: &Counts) -> String {
    let hazards = &counts.hazards;
    format!(
        "{name:>36} {:>7} {:>6} {:>8} {:>6} {:>6} {:>6} {:>7} {:>7} {:>10}",
        counts.trials,
        counts.found,
        counts.in_time,
        counts.right,
        counts.both,
        counts.all_named,
        cycles(counts.median_cycles),
        cycles(counts.worst_cycles),
        hazards.drifting_gain + hazards.others,
    )
}

const HEAD: &str = "                    fault or attack  trials  found  in time  right   both    all  median    most  hazardous";

/// By kind and size; those that cannot be observed have a reason.
fn print_kinds(kinds: &[KindSummary]) {
    if kinds.is_empty() {
        return;
    }
    say("");
    say(HEAD);
    let (seen, hidden): (Vec<_>, Vec<_>) = kinds.iter().partition(|kind| kind.hidden.is_none());
    let name = |kind: &KindSummary| format!("{:?} {}", kind.kind, kind.size);
    for kind in seen {
        say(&row(&name(kind), &kind.counts));
    }
    for kind in hidden {
        say(&format!(
            "{:>36} {:>7} apart: {}",
            name(kind),
            kind.counts.hidden,
            kind.hidden.unwrap_or_default()
        ));
    }
}

fn print_totals(summary: &Summary) {
    let attacks = &summary.attacks;
    say("");
    say(HEAD);
    let sets = [
        ("faults", &summary.counts),
        ("attacks alone", &attacks.singles),
        ("pairs", &attacks.pairs),
        ("the adversary's", &attacks.adversary),
    ];
    for (name, counts) in sets {
        if counts.trials + counts.hidden > 0 {
            say(&row(name, counts));
            let hazards = &counts.hazards;
            say(&format!(
                "{:>36} {} of the hazardous trials had a drifting gain. Hazards that the rig cannot observe or stop: {} constant gain, \
                 {} channel lost just before, {} enable line stuck high, {} controller not called. False alarms before: {}",
                "",
                hazards.drifting_gain,
                hazards.constant_gain,
                hazards.just_lost,
                hazards.line_high,
                hazards.not_called,
                counts.early
            ));
        }
    }
    for worst in &attacks.worst {
        say(&format!(
            "{:?}: up to {:.2} of its limit, for up to {} ticks",
            worst.quantity, worst.factor, worst.steps
        ));
    }
    for loss in attacks.losses.iter().filter(|loss| loss.trials > 0) {
        let LossSummary {
            channel,
            trials,
            stopped,
            median_cycles,
            worst_cycles,
        } = loss;
        say(&format!(
            "{channel:?} lost {trials} times: {stopped} trips, after {} cycles in the median and {} at most",
            cycles(*median_cycles),
            cycles(*worst_cycles)
        ));
    }
    if !attacks.forgeries.is_empty() {
        let refused = attacks.forgeries.iter().filter(|one| one.refused).count();
        say(&format!(
            "{refused} of {} invalid settings were refused",
            attacks.forgeries.len()
        ));
    }
}

fn print_coverage(summary: &Summary) {
    say("");
    say("Diagnostic coverage: dangerous faults detected over dangerous faults injected");
    say("             element  injected  found  dangerous  detected  not observable  coverage, %");
    for one in &summary.coverage {
        let part = one.part();
        say(&format!(
            "{:>20} {:>9} {:>6} {:>10} {:>9} {:>15} {:>12}",
            format!("{:?}", one.element),
            one.injected,
            one.found,
            one.dangerous,
            one.detected,
            one.hidden,
            part.map_or_else(|| "-".into(), |part| format!("{:.1}", 100.0 * part))
        ));
    }
}

fn print_healthy(summary: &Summary) {
    say(&format!(
        "{} healthy cycles with run-in and temperature: {} false alarms",
        summary.healthy_cycles, summary.false_alarms
    ));
    for surroundings in Surroundings::ALL {
        let these = || {
            let all = summary.healthy.iter();
            all.filter(move |one| one.surroundings == surroundings)
        };
        say(&format!(
            "{:>24} {:>7} cycles, {} false alarms",
            format!("{surroundings:?}"),
            these().map(|one| u64::from(one.cycles)).sum::<u64>(),
            these().map(|one| one.false_alarms.len()).sum::<usize>(),
        ));
    }
    for one in &summary.healthy {
        for (cycle, cause) in &one.false_alarms {
            say(&format!(
                "{:?}, {} g/cm3, {} mm, cycle {cycle}: {cause}",
                one.surroundings, one.density, one.amplitude
            ));
        }
    }
}

fn print_slow(summary: &Summary) {
    say("");
    say(&format!(
        "Slow changes over {CHANGING} cycles, then a break; the adaptation follows up to {:.0} %:",
        100.0 * FOLLOW
    ));
    say("                             error of the law, %             of its energy, %");
    say(
        "  changing  by %  g/cm3    before  fixed law  adapted      fixed law  adapted   reported at; break",
    );
    for one in &summary.slow {
        let change = &one.change;
        let named = one.named.first().map_or_else(
            || {
                let broken = one.broken.as_ref();
                let broken = broken.map(|(cycles, cause)| format!("-; {cycles} cycles: {cause}"));
                broken.unwrap_or_else(|| "-".into())
            },
            |(_, cause, come_to)| format!("{:+.1} %: {cause}", 100.0 * come_to),
        );
        say(&format!(
            "{:>10} {:>+5.0} {:>6} {:>9.2} {:>10.2} {:>8.2} {:>14.2} {:>8.2}   {named}",
            format!("{:?}", change.changing),
            100.0 * change.size,
            change.density,
            100.0 * one.before,
            100.0 * one.stayed.error,
            100.0 * one.followed.error,
            100.0 * one.stayed.energy,
            100.0 * one.followed.energy,
        ));
    }
}

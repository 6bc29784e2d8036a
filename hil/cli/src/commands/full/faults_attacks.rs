//! The part of the output of `hil faults` about attacks.

use mesh_damper_rig::faults::{AttackOutcome, AttackSummary, Counts, LossSummary, Naming, Summary};

use crate::commands::say;

/// Largest number of trials listed one by one.
const LISTED: usize = 60;

/// By kind, then the pairs and the adversary's trials, lost channels, and the coverage.
pub(super) fn print(summary: &Summary) {
    let attacks = &summary.attacks;
    if attacks.trials() > 0 {
        print_failures(attacks);
        print_kinds(attacks);
        print_hidden(attacks);
        print_totals(attacks);
    }
    if !summary.coverage.is_empty() {
        print_coverage(summary);
    }
}

/// Hazardous trials, then attacks that were not found or not named correctly.
fn print_failures(attacks: &AttackSummary) {
    let outcomes = &attacks.outcomes;
    let all = || {
        let both = outcomes.singles.iter().chain(&outcomes.pairs);
        both.chain(&outcomes.adversary)
    };
    let hazardous: Vec<_> = all().filter(|one| one.is_hazardous()).collect();
    list("Hazardous states", &hazardous);
    let is_missed = |one: &&AttackOutcome| {
        let named = matches!(one.naming, Naming::Right | Naming::Both);
        one.hidden.is_none() && !(one.in_time && named)
    };
    let judged = outcomes.singles.iter().chain(&outcomes.pairs);
    let missed: Vec<_> = judged.filter(is_missed).collect();
    list("Not found in time, or named incorrectly", &missed);
}

fn list(title: &str, outcomes: &[&AttackOutcome]) {
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

fn words(one: &AttackOutcome) -> String {
    let trial = &one.trial;
    let attacks = trial.attacks.iter().map(|attack| {
        let lasts = attack.lasts.map(|cycles| format!(" for {cycles:.2}"));
        format!(
            "{:?} {:.3} at {:.2}{}",
            attack.kind,
            attack.size,
            attack.begins,
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
        attacks.collect::<Vec<_>>().join(", "),
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

fn row(name: &str, counts: &Counts) -> String {
    let cycles = |cycles: Option<f64>| cycles.map_or_else(|| "-".into(), |c| format!("{c:.2}"));
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

const HEAD: &str = "                              attack  trials  found  in time  right   both    all  median    most  hazardous";

fn print_kinds(attacks: &AttackSummary) {
    let seen = || attacks.kinds.iter().filter(|kind| kind.hidden.is_none());
    if seen().next().is_none() {
        return;
    }
    say("");
    say(HEAD);
    for kind in seen() {
        say(&row(
            &format!("{:?} {}", kind.kind, kind.size),
            &kind.counts,
        ));
    }
}

fn print_hidden(attacks: &AttackSummary) {
    for kind in &attacks.kinds {
        if let Some(reason) = kind.hidden {
            say(&format!(
                "{:>36} {:>7} apart: {reason}",
                format!("{:?} {}", kind.kind, kind.size),
                kind.counts.hidden
            ));
        }
    }
}

fn print_totals(attacks: &AttackSummary) {
    say("");
    say(HEAD);
    let sets = [
        ("alone", &attacks.singles),
        ("pairs", &attacks.pairs),
        ("the adversary's", &attacks.adversary),
    ];
    for (name, counts) in sets {
        if counts.trials + counts.hidden > 0 {
            say(&row(name, counts));
            let hazards = &counts.hazards;
            say(&format!(
                "{:>36} {} of the hazardous trials had a drifting gain. Hazards that the rig cannot observe or stop: {} constant gain, \
                 {} channel lost just before, {} enable line stuck high, {} controller not called. False alarms before an attack: {}",
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
        let cycles = |cycles: Option<f64>| cycles.map_or_else(|| "-".into(), |c| format!("{c:.2}"));
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

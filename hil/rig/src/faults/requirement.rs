//! What is asked of the monitor.

use super::attack::{AttackSummary, Hazards};
use super::summary::Summary;

/// Part of the faults that must be called what they are, or by two causes of which one is what they are.
const RIGHT: f64 = 0.95;
/// Part of the attacks that must be found, and found as soon as they have to be.
const FOUND: f64 = 0.98;
const IN_TIME: f64 = 0.95;
/// Healthy cycles to one false alarm.
const CYCLES_TO_A_FALSE_ALARM: f64 = 1e5;

/// Ticks on end for which a limit may be exceeded: those after which the rig stops.
const TICKS_BEYOND: u32 = 10;

/// What `summary` falls short of: every fault found in time, the cause right in 95 %, at most one false alarm in 1e5 healthy
/// cycles or part of them, slow changes followed or named, no limit exceeded for longer than it takes to stop, every stop in time. Of the attacks no hazardous
/// state but behind a constant gain, a channel that was just lost beside another attack or a line that stays high, or while the controller is not called, 98 % found, 95 % in time, and as many called what they are or may be; of the settings that are
/// none, none taken.
pub fn missed(summary: &Summary) -> Vec<String> {
    let mut missed = Vec::new();
    for kind in &summary.kinds {
        if kind.in_time < kind.trials {
            missed.push(format!(
                "{:?} of {}: {} of {} found within {} cycles",
                kind.kind,
                kind.size,
                kind.in_time,
                kind.trials,
                kind.group.cycles()
            ));
        }
    }
    let named = summary.right + summary.both;
    if (named as f64) < RIGHT * summary.trials as f64 {
        missed.push(format!(
            "the cause, or one of two, is right in {named} of {}",
            summary.trials
        ));
    }
    let alarms = summary.false_alarms + summary.early;
    let allowed = (summary.healthy_cycles as f64 / CYCLES_TO_A_FALSE_ALARM).floor();
    if alarms as f64 > allowed {
        missed.push(format!(
            "{alarms} false alarms in {} healthy cycles and {} trials",
            summary.healthy_cycles, summary.trials
        ));
    }
    for followed in summary.slow.iter().filter(|one| !one.holds()) {
        missed.push(format!("a slow change: {followed:?}"));
    }
    if summary.ticks_beyond > TICKS_BEYOND {
        missed.push(format!(
            "a limit was exceeded for {} ticks on end",
            summary.ticks_beyond
        ));
    }
    if summary.stopped_in_time < summary.stopped {
        missed.push(format!(
            "{} of {} stops were in time",
            summary.stopped_in_time, summary.stopped
        ));
    }
    missed_of_attacks(&summary.attacks, &mut missed);
    missed
}

/// What the attacks fall short of.
fn missed_of_attacks(attacks: &AttackSummary, missed: &mut Vec<String>) {
    let sets = [
        ("attacks alone", &attacks.singles),
        ("pairs", &attacks.pairs),
        ("the adversary's trials", &attacks.adversary),
    ];
    for (what, counts) in sets {
        let Hazards {
            drifting_gain,
            others,
            ..
        } = counts.hazards;
        if drifting_gain + others > 0 {
            missed.push(format!(
                "{} of {what} led to a hazardous state, {drifting_gain} of them behind a gain that drifts",
                drifting_gain + others
            ));
        }
    }
    // The adversary's may be too small or too short to be found.
    for (what, counts) in &sets[..2] {
        let shares = [
            ("found", counts.found, FOUND),
            ("found in time", counts.in_time, IN_TIME),
            (
                "called what they are or may be",
                counts.right + counts.both,
                RIGHT,
            ),
        ];
        for (how, count, least) in shares {
            if (count as f64) < least * counts.trials as f64 {
                missed.push(format!("{how}: {count} of {} {what}", counts.trials));
            }
        }
        if counts.early > 0 {
            missed.push(format!("{} false alarms before {what}", counts.early));
        }
    }
    let taken = attacks.forgeries.iter().filter(|one| !one.refused).count();
    if taken > 0 {
        missed.push(format!(
            "{taken} of {} settings that are none were taken",
            attacks.forgeries.len()
        ));
    }
}

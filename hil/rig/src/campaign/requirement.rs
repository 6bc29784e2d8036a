//! Requirements on the monitor.

use super::summary::{Counts, Hazards, Summary};
use crate::check::{Check, failures};

/// Part of the faults that must be named correctly, at least as one of two causes.
const RIGHT: f64 = 0.95;
/// Part of the attacks that must be found, and part that must be found in time.
const FOUND: f64 = 0.98;
const IN_TIME: f64 = 0.95;
/// Healthy cycles per false alarm.
const CYCLES_TO_A_FALSE_ALARM: f64 = 1e5;

/// Successive ticks for which a limit may be exceeded: those after which the rig stops.
const TICKS_BEYOND: u32 = 10;

/// The requirements on `summary`.
///
/// Faults: every fault found in time, the cause right in 95 %, at most one false alarm in 1e5 healthy cycles or part of them, slow
/// changes followed or reported, no limit exceeded for longer than it takes to stop, every stop in time.
///
/// Both: no hazardous state except behind a constant gain, behind a channel that was just lost together with another attack,
/// behind a line that stays high, or while the controller is not called. Attacks: 98 % found, 95 % in time, and the same part named
/// correctly. Invalid settings: none accepted.
pub fn requirements(summary: &Summary) -> Vec<Check> {
    let mut checks = Vec::new();
    for kind in &summary.kinds {
        let name = format!("{:?} of {}", kind.kind, kind.size);
        let Counts {
            trials, in_time, ..
        } = kind.counts;
        checks.push(Check::new(&name, in_time >= trials, || {
            let within = kind.kind.facts().within;
            format!("{name}: {in_time} of {trials} found within {within} cycles")
        }));
    }
    let Counts { trials, early, .. } = summary.counts;
    let named = summary.counts.named();
    let is_right = (named as f64) >= RIGHT * trials as f64;
    checks.push(
        Check::new("causes", is_right, || {
            format!("the cause, or one of two, is right in {named} of {trials}")
        })
        .of(trials),
    );
    let alarms = summary.false_alarms + early;
    let allowed = (summary.healthy_cycles as f64 / CYCLES_TO_A_FALSE_ALARM).floor();
    checks.push(
        Check::new("false alarms", alarms as f64 <= allowed, || {
            format!(
                "{alarms} false alarms in {} healthy cycles and {trials} trials",
                summary.healthy_cycles
            )
        })
        .of(summary.healthy_cycles as usize + trials),
    );
    for one in &summary.slow {
        let change = &one.change;
        let name = format!(
            "slow change of {:?} by {} at {} g/cm3",
            change.changing, change.size, change.density
        );
        checks.push(Check::new(name, one.holds(), || {
            format!("a slow change: {one:?}")
        }));
    }
    checks.push(Check::new(
        "limits",
        summary.ticks_beyond <= TICKS_BEYOND,
        || {
            format!(
                "a limit was exceeded for {} ticks on end",
                summary.ticks_beyond
            )
        },
    ));
    let in_time = summary.stopped_in_time >= summary.stopped;
    checks.push(
        Check::new("stops", in_time, || {
            format!(
                "{} of {} stops were in time",
                summary.stopped_in_time, summary.stopped
            )
        })
        .of(summary.stopped),
    );
    checks.extend(of_sets(summary));
    checks
}

/// The [`requirements`] that `summary` does not meet, one line each.
pub fn missed(summary: &Summary) -> Vec<String> {
    failures(requirements(summary))
}

/// The requirements on each set of trials, and on invalid settings.
fn of_sets(summary: &Summary) -> Vec<Check> {
    let attacks = &summary.attacks;
    let mut checks = Vec::new();
    let sets = [
        ("faults", &summary.counts),
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
        let name = format!("{what}: hazardous states");
        checks.push(Check::new(name, drifting_gain + others == 0, || {
            format!(
                "{} of {what} led to a hazardous state, {drifting_gain} of them behind a gain that drifts",
                drifting_gain + others
            )
        }).of(counts.trials));
    }
    // Faults have requirements of their own. The adversary's attacks may be too small or too short to be found.
    for (what, counts) in &sets[1..3] {
        let shares = [
            ("found", counts.found, FOUND),
            ("found in time", counts.in_time, IN_TIME),
            ("called what they are or may be", counts.named(), RIGHT),
        ];
        for (how, count, least) in shares {
            let is_enough = (count as f64) >= least * counts.trials as f64;
            checks.push(
                Check::new(format!("{what}: {how}"), is_enough, || {
                    format!("{how}: {count} of {} {what}", counts.trials)
                })
                .of(counts.trials),
            );
        }
        checks.push(
            Check::new(
                format!("{what}: false alarms before"),
                counts.early == 0,
                || format!("{} false alarms before {what}", counts.early),
            )
            .of(counts.trials),
        );
    }
    let taken = attacks.forgeries.iter().filter(|one| !one.refused).count();
    checks.push(
        Check::new("forged settings", taken == 0, || {
            format!(
                "{taken} of {} invalid settings were accepted",
                attacks.forgeries.len()
            )
        })
        .of(attacks.forgeries.len()),
    );
    checks
}

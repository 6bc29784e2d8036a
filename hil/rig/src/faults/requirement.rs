//! What is asked of the monitor.

use super::summary::Summary;

/// Part of the faults that must be called what they are.
const RIGHT: f64 = 0.95;
/// Healthy cycles to one false alarm.
const CYCLES_TO_A_FALSE_ALARM: f64 = 1e5;

/// Ticks on end for which a limit may be exceeded: those after which the rig stops.
const TICKS_BEYOND: u32 = 10;

/// What `summary` falls short of: every fault found in time, the cause right in 95 %, at most one false alarm in 1e5 healthy
/// cycles or part of them, slow changes followed or named, no limit exceeded for longer than it takes to stop, every stop in time.
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
    if (summary.right as f64) < RIGHT * summary.trials as f64 {
        missed.push(format!(
            "the cause is right in {} of {}",
            summary.right, summary.trials
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
    missed
}

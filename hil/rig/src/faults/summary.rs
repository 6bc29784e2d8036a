//! Results of a campaign.

use serde::Serialize;

use super::attack::{AttackSummary, Coverage, coverage};
use super::healthy::Healthy;
use super::kind::{Group, InjectedFault};
use super::slow::SlowOutcome;
use super::trial::Outcome;

/// Results for one kind and size.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct KindSummary {
    /// The kind.
    pub kind: InjectedFault,
    /// Size of the fault, in the unit of the trials.
    pub size: f64,
    /// The faulty part of the rig.
    pub group: Group,
    /// Number of trials.
    pub trials: usize,
    /// Number of faults found.
    pub found: usize,
    /// Number of faults found in time.
    pub in_time: usize,
    /// Number of faults named correctly.
    pub right: usize,
    /// Number of faults reported with two causes, the second of which is correct.
    pub both: usize,
    /// Median number of cycles until a cause was reported, of the faults that were found.
    pub median_cycles: Option<f64>,
    /// Largest number of these cycles.
    pub worst_cycles: Option<f64>,
}

/// Results of the monitor for all faults injected into the rig.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// Injected faults by kind, size by size.
    pub kinds: Vec<KindSummary>,
    /// Number of trials.
    pub trials: usize,
    /// Number of faults found.
    pub found: usize,
    /// Number of faults found in time.
    pub in_time: usize,
    /// Number of faults named correctly.
    pub right: usize,
    /// Number of faults reported with two causes, the second of which is correct.
    pub both: usize,
    /// Number of causes reported before there was a fault.
    pub early: usize,
    /// Largest true displacement over its limit, in any trial.
    pub displacement: f64,
    /// Largest true force over its limit, in any trial.
    pub force: f64,
    /// Largest number of successive ticks at which a quantity exceeded its limit by more than noise can hide, while the enable line
    /// was high.
    pub ticks_beyond: u32,
    /// Number of rigs that stopped.
    pub stopped: usize,
    /// Number of these rigs that were at rest in time.
    pub stopped_in_time: usize,
    /// Number of healthy cycles.
    pub healthy_cycles: u64,
    /// Number of faults reported in healthy cycles.
    pub false_alarms: usize,
    /// Healthy runs, specimen by specimen.
    pub healthy: Vec<Healthy>,
    /// Slow changes, one by one.
    pub slow: Vec<SlowOutcome>,
    /// Outcomes, trial by trial.
    pub outcomes: Vec<Outcome>,
    /// Results of all attacks.
    pub attacks: AttackSummary,
    /// Diagnostic coverage by the element that fails.
    pub coverage: Vec<Coverage>,
}

impl Summary {
    /// Summary of these trials, slow changes, healthy runs and attacks.
    pub fn of(
        outcomes: Vec<Outcome>,
        slow: Vec<SlowOutcome>,
        healthy: Vec<Healthy>,
        attacks: AttackSummary,
    ) -> Self {
        let count =
            |holds: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|one| holds(one)).count();
        let largest = |of: &dyn Fn(&Outcome) -> f64| outcomes.iter().map(of).fold(0.0, f64::max);
        let mut kinds = Vec::new();
        for kind in InjectedFault::ALL {
            for &size in kind.sizes() {
                let of_this = |one: &&Outcome| one.trial.kind == kind && one.trial.size == size;
                let these: Vec<&Outcome> = outcomes.iter().filter(of_this).collect();
                if !these.is_empty() {
                    kinds.push(KindSummary::of(kind, size, &these));
                }
            }
        }
        let mut summary = Self {
            kinds,
            trials: outcomes.len(),
            found: count(&|one| one.cycles.is_some()),
            in_time: count(&Outcome::in_time),
            right: count(&|one| one.right),
            both: count(&|one| one.both),
            early: count(&|one| one.false_alarm),
            displacement: largest(&|one| one.displacement),
            force: largest(&|one| one.force),
            ticks_beyond: outcomes
                .iter()
                .map(|one| one.ticks_beyond)
                .max()
                .unwrap_or(0),
            stopped: count(&|one| one.stopped.is_some()),
            stopped_in_time: count(&|one| one.stopped.is_some() && one.stopped_in_time),
            healthy_cycles: healthy.iter().map(|one| u64::from(one.cycles)).sum(),
            false_alarms: healthy.iter().map(|one| one.false_alarms.len()).sum(),
            healthy,
            slow,
            outcomes,
            attacks,
            coverage: Vec::new(),
        };
        summary.coverage = coverage(&summary);
        summary
    }
}

impl KindSummary {
    fn of(kind: InjectedFault, size: f64, these: &[&Outcome]) -> Self {
        let count =
            |holds: &dyn Fn(&Outcome) -> bool| these.iter().filter(|one| holds(one)).count();
        let mut cycles: Vec<f64> = these.iter().filter_map(|one| one.cycles).collect();
        cycles.sort_by(f64::total_cmp);
        Self {
            kind,
            size,
            group: kind.group(),
            trials: these.len(),
            found: cycles.len(),
            in_time: count(&|one| one.in_time()),
            right: count(&|one| one.right),
            both: count(&|one| one.both),
            median_cycles: cycles.get(cycles.len() / 2).copied(),
            worst_cycles: cycles.last().copied(),
        }
    }
}

//! Results of a campaign.

use mesh_damper::health::Channel;
use serde::Serialize;

use super::change::Change;
use super::coverage::{Coverage, coverage};
use super::facts::Element;
use super::hazard::{Behind, Quantity};
use super::healthy::Healthy;
use super::known;
use super::outcome::{Naming, Outcome};
use super::settings::Forgery;
use super::slow::SlowOutcome;
use super::trial::Set;

/// Number of trials with a hazardous state, by its reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Hazards {
    /// Hidden by a channel with a constant gain or offset, which a single channel cannot detect.
    pub constant_gain: usize,
    /// The enable line stayed high at the servo after the rig had dropped it.
    pub line_high: usize,
    /// The controller was not called. Only an external watchdog can end this.
    pub not_called: usize,
    /// Hidden by a channel that was lost shortly before, together with another attack.
    pub just_lost: usize,
    /// Hidden by a channel whose gain drifts.
    pub drifting_gain: usize,
    /// All other reasons.
    pub others: usize,
}

impl Hazards {
    fn of<'o>(outcomes: impl Iterator<Item = &'o Outcome>) -> Self {
        let mut hazards = Self::default();
        for outcome in outcomes {
            let any = |behind| outcome.hazards.iter().any(|hazard| hazard.behind == behind);
            // The worst hazard of a trial counts.
            let count = if any(Behind::Other) || (any(Behind::JustLost) && outcome.is_hazardous()) {
                &mut hazards.others
            } else if any(Behind::DriftingGain) {
                &mut hazards.drifting_gain
            } else if any(Behind::JustLost) {
                &mut hazards.just_lost
            } else if any(Behind::NotCalled) {
                &mut hazards.not_called
            } else if any(Behind::LineHigh) {
                &mut hazards.line_high
            } else if any(Behind::ConstantGain) {
                &mut hazards.constant_gain
            } else {
                continue;
            };
            *count += 1;
        }
        hazards
    }
}

/// Findings in a set of trials.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Counts {
    /// Trials with a change that can be observed.
    pub trials: usize,
    /// Number of these trials in which the change was found.
    pub found: usize,
    /// Number of these trials in which the change was found in time.
    pub in_time: usize,
    /// Number of trials whose first reported cause cannot be distinguished from the change.
    pub right: usize,
    /// Number of trials whose first event reports two causes, the second of which cannot be distinguished from the change.
    pub both: usize,
    /// Number of trials in which each change was reported at some time, or the rig stopped before it had to be.
    pub all_named: usize,
    /// Number of causes reported before there was a change, in all trials.
    pub early: usize,
    /// Number of trials with a hazardous state, of all trials.
    pub hazards: Hazards,
    /// Number of trials in which no change can be observed.
    pub hidden: usize,
    /// Median number of cycles from the time when the change counts as present until it was found.
    pub median_cycles: Option<f64>,
    /// Largest number of these cycles.
    pub worst_cycles: Option<f64>,
}

impl Counts {
    /// Counts of these trials.
    pub fn of<'o>(outcomes: impl Iterator<Item = &'o Outcome> + Clone) -> Self {
        let open = || outcomes.clone().filter(|one| one.hidden.is_none());
        let count = |holds: &dyn Fn(&Outcome) -> bool| open().filter(|one| holds(one)).count();
        let cycles = sorted(open().filter_map(|one| one.cycles));
        Self {
            trials: open().count(),
            found: count(&|one| one.found),
            in_time: count(&|one| one.in_time),
            right: count(&|one| one.naming == Naming::Right),
            both: count(&|one| one.naming == Naming::Both),
            all_named: count(&|one| one.all_named),
            early: outcomes.clone().filter(|one| one.false_alarm).count(),
            hazards: Hazards::of(outcomes.clone()),
            hidden: outcomes.clone().filter(|one| one.hidden.is_some()).count(),
            median_cycles: cycles.get(cycles.len() / 2).copied(),
            worst_cycles: cycles.last().copied(),
        }
    }

    /// Number of trials with the right name, at least as one of two causes.
    pub fn named(&self) -> usize {
        self.right + self.both
    }
}

fn sorted(cycles: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut cycles: Vec<f64> = cycles.collect();
    cycles.sort_by(f64::total_cmp);
    cycles
}

/// Findings for one kind and size, in trials of its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "AttackKindSummary")]
pub struct KindSummary {
    /// The kind.
    pub kind: Change,
    /// Size of the change, in the unit of the trials.
    pub size: f64,
    /// The element that fails.
    pub element: Element,
    /// The reason why the change cannot be observed, if it cannot.
    pub hidden: Option<&'static str>,
    /// The findings.
    pub counts: Counts,
}

impl KindSummary {
    /// Those of each kind and size that `outcomes`, of one change each, have.
    fn all(outcomes: &[Outcome]) -> Vec<Self> {
        let mut kinds = Vec::new();
        for kind in Change::all() {
            for &size in kind.sizes() {
                let these = of_kind(outcomes, kind, size);
                if these.clone().next().is_some() {
                    kinds.push(Self {
                        kind,
                        size,
                        element: kind.facts().element,
                        hidden: kind.facts().hidden,
                        counts: Counts::of(these),
                    });
                }
            }
        }
        kinds
    }

    /// The outcomes among `all`, of one change each, that it counts.
    pub fn among<'o>(&self, all: &'o [Outcome]) -> impl Iterator<Item = &'o Outcome> {
        of_kind(all, self.kind, self.size)
    }
}

fn of_kind(all: &[Outcome], kind: Change, size: f64) -> impl Iterator<Item = &Outcome> + Clone {
    all.iter().filter(move |one| {
        let change = &one.trial.changes[0];
        change.kind == kind && change.size == size
    })
}

/// Time until the rig stopped after the loss of a channel that a limit depends on.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LossSummary {
    /// The lost channel.
    #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))]
    pub channel: Channel,
    /// Number of trials.
    pub trials: usize,
    /// Number of trials in which the rig stopped.
    pub stopped: usize,
    /// Median number of cycles until the rig stopped.
    pub median_cycles: Option<f64>,
    /// Largest number of cycles until the rig stopped.
    pub worst_cycles: Option<f64>,
}

impl LossSummary {
    fn of(channel: Channel, outcomes: &[Outcome]) -> Self {
        let losses = outcomes.iter().filter_map(|one| one.lost);
        let these = losses.filter(|loss| loss.channel == channel);
        let cycles = sorted(these.clone().filter_map(|loss| loss.stopped_after));
        Self {
            channel,
            trials: these.count(),
            stopped: cycles.len(),
            median_cycles: cycles.get(cycles.len() / 2).copied(),
            worst_cycles: cycles.last().copied(),
        }
    }
}

/// A hazardous state in a trial that should not have occurred.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WorstHazard {
    /// The true quantity.
    pub quantity: Quantity,
    /// Largest value of the quantity divided by its limit.
    pub factor: f64,
    /// Largest number of successive plant steps beyond the limit.
    pub steps: u32,
}

/// Results of all attacks.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AttackSummary {
    /// Each kind and size, one attack per trial.
    pub kinds: Vec<KindSummary>,
    /// All attacks, one per trial.
    pub singles: Counts,
    /// All pairs of attacks.
    pub pairs: Counts,
    /// All trials drawn by the adversary.
    pub adversary: Counts,
    /// Lost channels, in trials of their own.
    pub losses: Vec<LossSummary>,
    /// The worst trials with a hazardous state, by quantity.
    pub worst: Vec<WorstHazard>,
    /// Invalid settings that the rig was given.
    pub forgeries: Vec<Forgery>,
    /// Outcomes trial by trial: single attacks, pairs, and the adversary's.
    pub outcomes: Outcomes,
}

/// Outcomes trial by trial.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outcomes {
    /// One attack each.
    pub singles: Vec<Outcome>,
    /// Two attacks each.
    pub pairs: Vec<Outcome>,
    /// Up to four attacks each.
    pub adversary: Vec<Outcome>,
}

impl Outcomes {
    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = &Outcome> {
        let both = self.singles.iter().chain(&self.pairs);
        both.chain(&self.adversary)
    }
}

impl AttackSummary {
    fn of(outcomes: Outcomes, forgeries: Vec<Forgery>) -> Self {
        let Outcomes {
            singles,
            pairs,
            adversary,
        } = &outcomes;
        let channels = [Channel::Displacement, Channel::Force];
        Self {
            kinds: KindSummary::all(singles),
            singles: Counts::of(singles.iter()),
            pairs: Counts::of(pairs.iter()),
            adversary: Counts::of(adversary.iter()),
            losses: channels
                .map(|channel| LossSummary::of(channel, singles))
                .into(),
            worst: worst(outcomes.all()),
            forgeries,
            outcomes,
        }
    }

    /// Number of trials.
    pub fn trials(&self) -> usize {
        self.outcomes.all().count()
    }
}

fn worst<'o>(outcomes: impl Iterator<Item = &'o Outcome>) -> Vec<WorstHazard> {
    let mut all: Vec<WorstHazard> = Vec::new();
    let outcomes = outcomes.filter(|one| one.is_hazardous());
    for hazard in outcomes.flat_map(|one| &one.hazards) {
        match all
            .iter_mut()
            .find(|known| known.quantity == hazard.quantity)
        {
            Some(known) => {
                known.factor = known.factor.max(hazard.factor);
                known.steps = known.steps.max(hazard.steps);
            }
            None => all.push(WorstHazard {
                quantity: hazard.quantity,
                factor: hazard.factor,
                steps: hazard.steps,
            }),
        }
    }
    all
}

/// Results of the monitor for all changes injected into the rig.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// Changes that the monitor knows by kind, size by size.
    #[cfg_attr(feature = "schema", schemars(with = "Vec<known::KindSummary>"))]
    #[serde(serialize_with = "known::kinds")]
    pub kinds: Vec<KindSummary>,
    /// All changes that the monitor knows.
    #[serde(flatten)]
    pub counts: Counts,
    /// Largest true displacement over its limit, in any trial of such a change.
    pub displacement: f64,
    /// Largest true force over its limit, in any trial of such a change.
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
    /// Outcomes of the changes that the monitor knows, trial by trial.
    #[cfg_attr(feature = "schema", schemars(with = "Vec<known::Outcome>"))]
    #[serde(serialize_with = "known::outcomes")]
    pub outcomes: Vec<Outcome>,
    /// Results of all attacks: changes that are defined without knowledge of the monitor.
    pub attacks: AttackSummary,
    /// Diagnostic coverage by the element that fails.
    pub coverage: Vec<Coverage>,
}

impl Summary {
    /// Summary of these trials, slow changes, healthy runs and invalid settings.
    pub fn of(
        all: Vec<Outcome>,
        slow: Vec<SlowOutcome>,
        healthy: Vec<Healthy>,
        forgeries: Vec<Forgery>,
    ) -> Self {
        let mut outcomes = Vec::new();
        let mut attacks = Outcomes::default();
        for outcome in all {
            let set = match outcome.trial.set {
                Set::Known { .. } => &mut outcomes,
                Set::Single => &mut attacks.singles,
                Set::Pair => &mut attacks.pairs,
                Set::Adversary => &mut attacks.adversary,
            };
            set.push(outcome);
        }
        let stopping = || outcomes.iter().map(|one: &Outcome| &one.stopping);
        let stopped = || outcomes.iter().filter(|one| one.stopped.is_some());
        let mut summary = Self {
            kinds: KindSummary::all(&outcomes),
            counts: Counts::of(outcomes.iter()),
            displacement: stopping().map(|one| one.displacement).fold(0.0, f64::max),
            force: stopping().map(|one| one.force).fold(0.0, f64::max),
            ticks_beyond: stopping().map(|one| one.ticks_beyond).max().unwrap_or(0),
            stopped: stopped().count(),
            stopped_in_time: stopped().filter(|one| one.stopping.in_time).count(),
            healthy_cycles: healthy.iter().map(|one| u64::from(one.cycles)).sum(),
            false_alarms: healthy.iter().map(|one| one.false_alarms.len()).sum(),
            healthy,
            slow,
            outcomes,
            attacks: AttackSummary::of(attacks, forgeries),
            coverage: Vec::new(),
        };
        summary.coverage = coverage(&summary);
        summary
    }
}

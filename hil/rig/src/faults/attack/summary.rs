//! Results of the attacks.

use mesh_damper::health::Channel;
use serde::Serialize;

use super::hazard::{Behind, Quantity};
use super::kind::{AttackKind, Element};
use super::settings::Forgery;
use super::trial::{AttackOutcome, Naming};

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
    fn of<'o>(outcomes: impl Iterator<Item = &'o AttackOutcome>) -> Self {
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
    /// Trials with an attack that can be observed.
    pub trials: usize,
    /// Number of these trials in which the attack was found.
    pub found: usize,
    /// Number of these trials in which the attack was found in time.
    pub in_time: usize,
    /// Number of trials whose first reported cause cannot be distinguished from the attack.
    pub right: usize,
    /// Number of trials whose first event reports two causes, the second of which cannot be distinguished from the attack.
    pub both: usize,
    /// Number of trials in which each attack was reported at some time, or the rig stopped before it had to be.
    pub all_named: usize,
    /// Number of causes reported before there was an attack, in all trials.
    pub early: usize,
    /// Number of trials with a hazardous state, of all trials.
    pub hazards: Hazards,
    /// Number of trials in which no attack can be observed.
    pub hidden: usize,
    /// Median number of cycles from the time when the attack counts as present until it was found.
    pub median_cycles: Option<f64>,
    /// Largest number of these cycles.
    pub worst_cycles: Option<f64>,
}

impl Counts {
    /// Counts of these trials.
    pub fn of<'o>(outcomes: impl Iterator<Item = &'o AttackOutcome> + Clone) -> Self {
        let open = || outcomes.clone().filter(|one| one.hidden.is_none());
        let count =
            |holds: &dyn Fn(&AttackOutcome) -> bool| open().filter(|one| holds(one)).count();
        let mut cycles: Vec<f64> = open().filter_map(|one| one.cycles).collect();
        cycles.sort_by(f64::total_cmp);
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
}

/// Findings for one kind and size, in trials of its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AttackKindSummary {
    /// The kind.
    pub kind: AttackKind,
    /// Size of the attack, in the unit of the trials.
    pub size: f64,
    /// The element that fails.
    pub element: Element,
    /// The reason why the attack cannot be observed, if it cannot.
    pub hidden: Option<&'static str>,
    /// The findings.
    pub counts: Counts,
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
    pub kinds: Vec<AttackKindSummary>,
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
    pub singles: Vec<AttackOutcome>,
    /// Two attacks each.
    pub pairs: Vec<AttackOutcome>,
    /// Up to four attacks each.
    pub adversary: Vec<AttackOutcome>,
}

impl AttackSummary {
    /// Summary of all these.
    pub fn of(outcomes: Outcomes, forgeries: Vec<Forgery>) -> Self {
        let Outcomes {
            singles,
            pairs,
            adversary,
        } = &outcomes;
        let mut kinds = Vec::new();
        for kind in AttackKind::all() {
            for &size in kind.sizes() {
                let of_this = |one: &&AttackOutcome| {
                    one.trial.attacks[0].kind == kind && one.trial.attacks[0].size == size
                };
                let these = singles.iter().filter(of_this);
                if these.clone().next().is_some() {
                    kinds.push(AttackKindSummary {
                        kind,
                        size,
                        element: kind.element(),
                        hidden: kind.hidden(),
                        counts: Counts::of(these),
                    });
                }
            }
        }
        let channels = [Channel::Displacement, Channel::Force];
        Self {
            kinds,
            singles: Counts::of(singles.iter()),
            pairs: Counts::of(pairs.iter()),
            adversary: Counts::of(adversary.iter()),
            losses: channels
                .map(|channel| LossSummary::of(channel, singles))
                .into(),
            worst: worst(singles.iter().chain(pairs).chain(adversary)),
            forgeries,
            outcomes,
        }
    }

    /// Number of trials.
    pub fn trials(&self) -> usize {
        let Outcomes {
            singles,
            pairs,
            adversary,
        } = &self.outcomes;
        singles.len() + pairs.len() + adversary.len()
    }
}

impl LossSummary {
    fn of(channel: Channel, outcomes: &[AttackOutcome]) -> Self {
        let losses = outcomes.iter().filter_map(|one| one.lost);
        let these = losses.filter(|loss| loss.channel == channel);
        let mut cycles: Vec<f64> = these
            .clone()
            .filter_map(|loss| loss.stopped_after)
            .collect();
        cycles.sort_by(f64::total_cmp);
        Self {
            channel,
            trials: these.count(),
            stopped: cycles.len(),
            median_cycles: cycles.get(cycles.len() / 2).copied(),
            worst_cycles: cycles.last().copied(),
        }
    }
}

fn worst<'o>(outcomes: impl Iterator<Item = &'o AttackOutcome>) -> Vec<WorstHazard> {
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

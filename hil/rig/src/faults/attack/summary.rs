//! What the attacks came to.

use mesh_damper::health::Channel;
use serde::Serialize;

use super::hazard::{Behind, Quantity};
use super::kind::{AttackKind, Element};
use super::settings::Forgery;
use super::trial::{AttackOutcome, Naming};

/// Of a kind of hazardous state: how many trials had one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Hazards {
    /// Behind a channel with a constant gain or offset only, which one channel cannot observe.
    pub constant_gain: usize,
    /// Because the enable line stayed high at the servo, which the rig had dropped.
    pub line_high: usize,
    /// While the controller was not called, which only a watchdog outside can end.
    pub not_called: usize,
    /// Behind a channel that was lost less than a cycle before, with another attack beside.
    pub just_lost: usize,
    /// Behind a channel whose gain drifts.
    pub drifting_gain: usize,
    /// All others.
    pub others: usize,
}

impl Hazards {
    fn of<'o>(outcomes: impl Iterator<Item = &'o AttackOutcome>) -> Self {
        let mut hazards = Self::default();
        for outcome in outcomes {
            let any = |behind| outcome.hazards.iter().any(|hazard| hazard.behind == behind);
            // The worst of a trial counts.
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

/// What was found of some trials.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Counts {
    /// Trials with an attack that can be observed.
    pub trials: usize,
    /// Of these, found.
    pub found: usize,
    /// Found as soon as it has to be.
    pub in_time: usize,
    /// The first cause that was named cannot be told from the attack.
    pub right: usize,
    /// The first event says two causes, and the second is such a one.
    pub both: usize,
    /// Each attack of the trial was named at some time, or the rig stopped before it had to be.
    pub all_named: usize,
    /// Causes named before there was an attack, of all trials.
    pub early: usize,
    /// Trials with a hazardous state, of all of them.
    pub hazards: Hazards,
    /// Trials of which no attack can be observed.
    pub hidden: usize,
    /// Cycles from when it counts as there until it was found.
    pub median_cycles: Option<f64>,
    /// The most cycles.
    pub worst_cycles: Option<f64>,
}

impl Counts {
    /// Of these trials.
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

/// Of one kind and size, in trials of its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AttackKindSummary {
    /// What it is.
    pub kind: AttackKind,
    /// How large, in the unit of the trials.
    pub size: f64,
    /// What fails.
    pub element: Element,
    /// Why it cannot be observed, where it cannot.
    pub hidden: Option<&'static str>,
    /// What was found.
    pub counts: Counts,
}

/// How soon the rig stopped for a channel that a limit depends on and that was lost.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LossSummary {
    /// Which.
    #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))]
    pub channel: Channel,
    /// How often.
    pub trials: usize,
    /// How often the rig stopped.
    pub stopped: usize,
    /// Cycles until then, in the middle.
    pub median_cycles: Option<f64>,
    /// The most cycles.
    pub worst_cycles: Option<f64>,
}

/// A hazardous state of a trial that ought not to have been.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WorstHazard {
    /// By which true quantity.
    pub quantity: Quantity,
    /// The most it was, over its limit.
    pub factor: f64,
    /// The most steps on end.
    pub steps: u32,
}

/// All attacks.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AttackSummary {
    /// Kind by kind, size by size, each alone.
    pub kinds: Vec<AttackKindSummary>,
    /// All attacks alone.
    pub singles: Counts,
    /// All pairs.
    pub pairs: Counts,
    /// All that the adversary drew.
    pub adversary: Counts,
    /// Lost channels, in trials of their own.
    pub losses: Vec<LossSummary>,
    /// By quantity, the worst of the trials that led to a hazardous state.
    pub worst: Vec<WorstHazard>,
    /// Settings that are none.
    pub forgeries: Vec<Forgery>,
    /// Trial by trial: of attacks alone, of pairs, of the adversary.
    pub outcomes: Outcomes,
}

/// Trial by trial.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outcomes {
    /// One attack each.
    pub singles: Vec<AttackOutcome>,
    /// Two attacks each.
    pub pairs: Vec<AttackOutcome>,
    /// Up to four.
    pub adversary: Vec<AttackOutcome>,
}

impl AttackSummary {
    /// Of all these.
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

    /// Trials.
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

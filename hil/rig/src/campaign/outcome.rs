//! What the rig reports in a trial, compared with the changes that were injected.

use std::fmt;

use mesh_damper::health::{Channel, HealthCause};
use mesh_damper::rig::TripCause;
use serde::{Serialize, Serializer};

use super::hazard::{Behind, Hazard};
use super::names::Names;
use super::trial::{Injected, Trial};

/// Report of the rig at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Said {
    /// A fault that its monitor reported, and another cause that it cannot tell from the first.
    Event(HealthCause, Option<HealthCause>),
    /// Why it stopped.
    Trip(TripCause),
    /// It refused to start.
    Refused,
}

impl Said {
    /// Its relation to changes with these names.
    fn of(self, names: &[Names]) -> Naming {
        let is_cause = |cause| names.iter().any(|names| names.has_cause(cause));
        let is_trip = |cause| names.iter().any(|names| names.has_trip(cause));
        match self {
            Self::Event(cause, _) if is_cause(cause) => Naming::Right,
            Self::Event(_, Some(or)) if is_cause(or) => Naming::Both,
            Self::Trip(cause) if is_trip(cause) => Naming::Right,
            Self::Event(..) | Self::Trip(_) | Self::Refused => Naming::Wrong,
        }
    }
}

impl fmt::Display for Said {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Event(cause, None) => write!(f, "{cause:?}"),
            Self::Event(cause, Some(or)) => write!(f, "{cause:?} or {or:?}"),
            Self::Trip(cause) => write!(f, "stop: {cause:?}"),
            Self::Refused => write!(f, "start refused"),
        }
    }
}

impl Serialize for Said {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Relation of a reported cause to the change, from the worst to the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Naming {
    /// No cause was reported.
    Nothing,
    /// The reported cause is distinguishable from the change.
    Wrong,
    /// The event reports two causes, and the second is correct.
    Both,
    /// The reported cause is correct.
    Right,
}

/// Loss of a channel that a limit depends on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Loss {
    /// The channel.
    #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))]
    pub channel: Channel,
    /// Number of cycles until the rig stopped, if it did.
    pub stopped_after: Option<f64>,
}

/// How far the rig went, and how it stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopping {
    /// Largest true displacement over its limit.
    pub displacement: f64,
    /// Largest true force over its limit.
    pub force: f64,
    /// Largest number of successive ticks at which displacement or force exceeded its limit by more than noise can hide, while the
    /// enable line was high.
    pub ticks_beyond: u32,
    /// Whether the command returned to 0 and the enable line dropped within the stated ticks after a stop.
    pub in_time: bool,
}

impl Default for Stopping {
    fn default() -> Self {
        Self {
            displacement: 0.0,
            force: 0.0,
            ticks_beyond: 0,
            in_time: true,
        }
    }
}

/// Outcome of a trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "AttackOutcome")]
pub struct Outcome {
    /// The trial.
    pub trial: Trial,
    /// Reported causes and the trip cause, in order, each with its cycle, counted as in [`Injected::begins`].
    #[cfg_attr(feature = "schema", schemars(with = "Vec<(f64, String)>"))]
    pub named: Vec<(f64, Said)>,
    /// Whether a cause was reported, or the rig stopped, after the first change began. A change that the monitor knows has to be
    /// reported.
    pub found: bool,
    /// Number of cycles to that report or stop, from the time when the first change that must be found counts as present; 0 if the
    /// report came earlier.
    pub cycles: Option<f64>,
    /// Whether the change was found in time.
    pub in_time: bool,
    /// Relation of the first reported cause to the changes.
    pub naming: Naming,
    /// Whether each observable change was correctly named at some time, also as the second cause, or the rig stopped before it had
    /// to be.
    pub all_named: bool,
    /// Whether a cause was reported before there was a change.
    pub false_alarm: bool,
    /// Trip cause, if the rig stopped.
    pub stopped: Option<String>,
    /// Hazardous states.
    pub hazards: Vec<Hazard>,
    /// Loss of a channel.
    pub lost: Option<Loss>,
    /// The reason why the change cannot be observed, if none of the changes can.
    pub hidden: Option<&'static str>,
    /// How far the rig went, and how it stopped.
    #[serde(skip)]
    pub stopping: Stopping,
}

/// Ticks within which a report of the monitor and a stop belong together: a limit stops the rig ten ticks after it was exceeded.
const TOGETHER: u64 = 12;

impl Outcome {
    /// Compares the rig's reports in `said` with the changes of the trial.
    pub(super) fn of(trial: &Trial, said: Vec<(u64, Said)>) -> Self {
        let begun = |change: &Injected| trial.tick(change.begins);
        let first_change = trial.changes.iter().map(begun).min().unwrap_or(0);
        // What the monitor knows it has to name, and at once: a stop does not count, nor does a second report.
        let together = if trial.is_known() { 0 } else { TOGETHER };
        let counts = |said: &Said| !trial.is_known() || matches!(said, Said::Event(..));
        let first = said
            .iter()
            .find(|(tick, said)| *tick >= first_change && counts(said));
        // The first observable change that must be found: when it counts as present, and the time limit.
        let is_observable = |one: &&Injected| one.kind.facts().hidden.is_none();
        let observable = || trial.changes.iter().filter(is_observable);
        let until = |change: &Injected| trial.present(change) + change.kind.facts().within;
        let due = observable()
            .map(|change| (trial.present(change), until(change)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        // The tick that finds it has passed as well.
        let found_at = first.map(|(tick, _)| trial.cycle(tick + 1));
        let naming = first.map_or(Naming::Nothing, |&(since, _)| {
            let there = trial.changes.iter().filter(|change| begun(change) <= since);
            let names: Vec<Names> = there.map(Injected::names).collect();
            let all = said.iter().filter(|(tick, _)| *tick >= since);
            let these = all.take_while(|(tick, _)| *tick <= since + together);
            let of = these.map(|(_, said)| said.of(&names));
            of.max().unwrap_or(Naming::Nothing)
        });
        // Each of them separately, up to the stop that leaves no time for it.
        let is_named = |change: &Injected| {
            let names = [change.names()];
            let until = trial.tick(until(change));
            said.iter().any(|(tick, said)| {
                let is_stop = matches!(said, Said::Trip(_) | Said::Refused);
                let is_of_it = *tick >= begun(change) && said.of(&names) > Naming::Wrong;
                is_of_it || (is_stop && *tick <= until)
            })
        };
        let stopped = said.iter().find_map(|(_, said)| match said {
            Said::Trip(cause) => Some(format!("{cause:?}")),
            Said::Refused => Some("StartRefused".into()),
            Said::Event(..) => None,
        });
        let found_and_due = found_at.zip(due);
        Self {
            trial: trial.clone(),
            found: first.is_some(),
            cycles: found_and_due.map(|(at, (there, _))| (at - there).max(0.0)),
            in_time: found_and_due.is_some_and(|(at, (_, until))| at <= until),
            naming,
            all_named: observable().all(is_named),
            false_alarm: said.iter().any(|(tick, _)| *tick < first_change),
            stopped,
            hazards: Vec::new(),
            lost: None,
            hidden: trial.hidden(),
            stopping: Stopping::default(),
            named: said
                .into_iter()
                .map(|(tick, said)| (trial.cycle(tick), said))
                .collect(),
        }
    }

    /// Whether the first report names a change, at least as one of two causes.
    pub fn is_named(&self) -> bool {
        matches!(self.naming, Naming::Right | Naming::Both)
    }

    /// Whether a state occurred that the rig should have prevented: see [`Behind`].
    pub fn is_hazardous(&self) -> bool {
        let is_alone = self.trial.changes.len() < 2;
        let mut behind = self.hazards.iter().map(|hazard| hazard.behind);
        behind.any(|behind| match behind {
            Behind::DriftingGain | Behind::Other => true,
            Behind::JustLost => is_alone,
            Behind::ConstantGain | Behind::LineHigh | Behind::NotCalled => false,
        })
    }
}

#[cfg(test)]
mod tests {
    use mesh_damper::health::Channel;

    use super::*;
    use crate::campaign::trial::Place;
    use crate::campaign::{Campaign, Change, Set};

    /// The evaluation of a kind's first single trial, for reports this many cycles after it counts as present.
    fn judged(kind: Change, said: &[(f64, Said)]) -> Outcome {
        let trials = Campaign::whole().trials();
        let of_kind = |trial: &&Trial| trial.changes[0].kind == kind;
        let trial = trials.iter().find(of_kind).unwrap();
        let Injected { begins, size, .. } = trial.changes[0];
        let there = begins + kind.lead(size, trial.follow);
        let said = said
            .iter()
            .map(|(cycles, said)| (trial.tick(there + cycles), *said));
        Outcome::of(trial, said.collect())
    }

    const WIRES: HealthCause = HealthCause::WireBreakage;
    const GAIN: HealthCause = HealthCause::SensorGain(Channel::Force);
    const LOOSE: HealthCause = HealthCause::Loosening;

    #[test]
    fn what_is_named_first_counts_and_two_causes_may_be_said() {
        let naming = |said: &[(f64, Said)]| judged(Change::Break, said).naming;
        assert_eq!(naming(&[]), Naming::Nothing);
        assert_eq!(naming(&[(2.0, Said::Event(WIRES, None))]), Naming::Right);
        // No signal distinguishes a channel that shows less from a specimen that has broken.
        assert_eq!(naming(&[(2.0, Said::Event(GAIN, None))]), Naming::Right);
        assert_eq!(
            naming(&[(2.0, Said::Event(LOOSE, Some(WIRES)))]),
            Naming::Both
        );
        assert_eq!(
            naming(&[
                (2.0, Said::Event(LOOSE, None)),
                (3.0, Said::Event(WIRES, None))
            ]),
            Naming::Wrong
        );
        assert_eq!(
            naming(&[(2.0, Said::Trip(TripCause::ForceLimit))]),
            Naming::Wrong
        );
    }

    /// The monitor has one name for it. It has to give it first, and a stop is no name.
    #[test]
    fn a_change_that_the_monitor_knows_has_to_be_called_by_its_name_at_once() {
        let of = |said: &[(f64, Said)]| judged(Change::WireBreakage, said);
        let wires = Said::Event(WIRES, None);
        let right = of(&[(2.0, wires)]);
        assert!(right.naming == Naming::Right && right.found && right.in_time);
        let gain = of(&[(2.0, Said::Event(GAIN, None)), (2.001, wires)]);
        assert!(gain.naming == Naming::Wrong && gain.all_named);
        let both = of(&[(2.0, Said::Event(GAIN, Some(WIRES)))]);
        assert_eq!(both.naming, Naming::Both);
        let stop = of(&[(2.0, Said::Trip(TripCause::ForceLimit))]);
        assert!(!stop.found && stop.naming == Naming::Nothing);
        assert_eq!(stop.stopped.as_deref(), Some("ForceLimit"));
        assert!(!of(&[(5.5, wires)]).in_time);
    }

    /// A limit takes ten ticks to stop the rig.
    #[test]
    fn a_stop_and_what_is_said_of_it_belong_together() {
        let kind = Change::Open(Channel::Displacement);
        let spike = HealthCause::SensorSpiking(Channel::Displacement);
        let trip = Said::Trip(TripCause::TrackingLimit);
        let naming =
            |later: f64| judged(kind, &[(0.001, Said::Event(spike, None)), (later, trip)]).naming;
        assert_eq!(naming(0.01), Naming::Right);
        assert_eq!(naming(0.1), Naming::Wrong);
    }

    #[test]
    fn time_counts_from_when_an_attack_is_there() {
        let kind = Change::GainDrift(Channel::Force);
        let said = |cycles| judged(kind, &[(cycles, Said::Event(GAIN, None))]);
        let soon = said(4.5);
        assert!(soon.found && soon.in_time && !soon.false_alarm);
        assert!((soon.cycles.unwrap() - 4.501).abs() < 1e-9);
        let late = said(5.5);
        assert!(late.found && !late.in_time);
        // It had begun, but had not reached its required size.
        assert_eq!(said(-2.0).cycles, Some(0.0));
        let alarm = said(-20.0);
        assert!(alarm.false_alarm && !alarm.found && !alarm.in_time);
    }

    /// A latched cause must not silence another.
    #[test]
    fn each_of_two_attacks_has_to_be_named_but_after_a_stop() {
        let spike = Change::Spike(Channel::Force);
        let attacks = [(spike, 0.5, 0.0), (Change::Break, 0.2, 4.0)];
        let attacks = attacks.map(|(kind, size, later)| kind.attack(size, 0.25, later));
        let place = Place {
            specimen: (3.0, 0.1, 10.0),
            noise: 0.004,
            follow: 0.0,
            seed: 1,
        };
        let trial = Trial::attacked(Set::Pair, attacks.into(), place);
        let all_named = |said: &[(f64, Said)]| {
            let ticks = said.iter().map(|(cycle, said)| (trial.tick(*cycle), *said));
            Outcome::of(&trial, ticks.collect()).all_named
        };
        let spike = Said::Event(HealthCause::SensorSpiking(Channel::Force), None);
        let wires = Said::Event(LOOSE, Some(WIRES));
        assert!(!all_named(&[(24.3, spike)]));
        assert!(all_named(&[(24.3, spike), (31.0, wires)]));
        assert!(!all_named(&[(31.0, wires)]));
        let stop = Said::Trip(TripCause::ForceLost);
        assert!(all_named(&[(24.3, spike), (24.4, stop)]));
    }

    #[test]
    fn a_start_that_is_refused_is_a_stop() {
        let kind = Change::NeverConnected(Channel::Force);
        let outcome = judged(kind, &[(-2.0, Said::Refused)]);
        assert_eq!(outcome.stopped.as_deref(), Some("StartRefused"));
        assert!(outcome.found && outcome.in_time);
    }
}

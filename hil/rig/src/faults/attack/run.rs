//! Runs a trial and evaluates the findings.

use mesh_damper::health::{Event, HealthCause};
use mesh_damper::rig::{State, TripCause};
use mesh_damper::sine::SineGenerator;

use super::apply::damage;
use super::hazard::HazardMeter;
use super::names::Name;
use super::trial::{Attack, AttackOutcome, AttackTrial, BLOCKS, IDLE, Loss, Naming, Prepared};
use crate::faults::damage::Damaged;
use crate::{Bench, Controlled, RigSetup, SetupError};

/// Report of the rig at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Said {
    /// A fault that its monitor reported.
    Event(HealthCause, Option<HealthCause>),
    /// Why it stopped.
    Trip(TripCause),
    /// It refused to start.
    Refused,
}

impl Said {
    /// Its relation to an attack with these names.
    fn of(self, names: &[Name]) -> Naming {
        let is_one = |cause| names.contains(&Name::Health(cause));
        match self {
            Self::Event(cause, _) if is_one(cause) => Naming::Right,
            Self::Event(_, Some(or)) if is_one(or) => Naming::Both,
            Self::Trip(cause) if names.contains(&Name::Trip(cause)) => Naming::Right,
            Self::Event(..) | Self::Trip(_) | Self::Refused => Naming::Wrong,
        }
    }
}

/// Ticks within which a report of the monitor and a stop belong together: a limit stops the rig ten ticks after it was exceeded.
const TOGETHER: u64 = 12;

/// Runs it with the controller in this process.
///
/// # Errors
/// A setup that one of its parts rejects.
pub fn run_attack(trial: &AttackTrial) -> Result<AttackOutcome, SetupError> {
    run_attack_with(trial, Bench::new)
}

/// Runs it on the rig that `wire_up` makes of its setup, wherever the controller runs.
///
/// # Errors
/// As [`run_attack`], and the errors of the link to the controller.
pub fn run_attack_with<R: Controlled<Damaged>>(
    trial: &AttackTrial,
    wire_up: impl FnOnce(RigSetup<Damaged, BLOCKS, 1>) -> Result<R, SetupError>,
) -> Result<AttackOutcome, SetupError> {
    let Prepared {
        setup,
        condition,
        healthy,
        allowed,
        mut attacks,
    } = trial.prepare()?;
    let mut demand = SineGenerator::<BLOCKS, _>::new(setup.programme.clone())?;
    // Its first tick is at rest.
    demand.tick();
    let stop_ticks = u64::from(setup.settings.stop_ticks);
    let mut rig = wire_up(setup)?;
    let mut meter = HazardMeter::new(allowed);
    let mut said: Vec<(u64, Said)> = Vec::new();
    let mut stopped: Option<u64> = None;
    let mut running = false;
    for tick in 0.. {
        for attack in &mut attacks {
            attack.at(tick, rig.plant_mut(), &healthy);
        }
        damage(&attacks, tick, &healthy, &condition);
        if tick == IDLE {
            match rig.start() {
                Err(SetupError::Start(_)) => {
                    said.push((tick, Said::Refused));
                    break;
                }
                started => started?,
            }
            running = true;
        }
        if rig.plant().signals.is_heard() {
            rig.exchange();
        }
        let telemetry = rig.tick()?;
        // The programme waits until the piston is at its start, and begins there with phase 0.
        let moves = telemetry.phase > 0 || telemetry.cycle > 0;
        let demanded = running.then(|| {
            if moves {
                f64::from(demand.tick().displacement)
            } else {
                0.0
            }
        });
        running = telemetry.state == State::Running;
        let plant = rig.plant();
        let demanded = demanded.filter(|_| running);
        let sensed = plant.signals.sensed();
        meter.tick(tick, plant.passed(), sensed, demanded, rig.is_enabled());
        said.extend(fault(telemetry.event).map(|event| (tick, event)));
        match (telemetry.state, stopped) {
            (State::Running, _) => {}
            (State::Faulted(cause), None) => {
                stopped = Some(tick);
                said.push((tick, Said::Trip(cause)));
            }
            (State::Faulted(_), Some(since)) if tick > since + stop_ticks => break,
            (State::Faulted(_), Some(_)) => {}
            (State::Idle | State::Done, _) if tick > IDLE => break,
            (State::Idle | State::Done, _) => {}
        }
    }
    let mut outcome = judge(trial, &said);
    outcome.hazards = meter.hazards();
    outcome.lost = trial.attacks.iter().find_map(|attack| {
        let from = trial.tick(attack.begins).max(IDLE);
        let after = |tick: u64| tick.saturating_sub(from) as f64 / trial.cycle_ticks();
        Some(Loss {
            channel: attack.kind.loses().filter(|_| attack.lasts.is_none())?,
            stopped_after: stopped.map(after),
        })
    });
    Ok(outcome)
}

fn fault(event: Option<Event>) -> Option<Said> {
    let event = event.filter(|event| event.cause.is_fault())?;
    Some(Said::Event(event.cause, event.or))
}

/// Compares the rig's reports in `said` with the attacks of the trial.
fn judge(trial: &AttackTrial, said: &[(u64, Said)]) -> AttackOutcome {
    let begun = |attack: &Attack| trial.tick(attack.begins);
    let first_attack = trial.attacks.iter().map(begun).min().unwrap_or(0);
    let first = said.iter().find(|(tick, _)| *tick >= first_attack);
    let together = |since: u64| {
        let all = said.iter().filter(move |(tick, _)| *tick >= since);
        all.take_while(move |(tick, _)| *tick <= since + TOGETHER)
    };
    // The first observable attack that must be found: when it counts as present, and the time limit.
    let observable = trial
        .attacks
        .iter()
        .filter(|one| one.kind.hidden().is_none());
    let due = observable
        .map(|attack| {
            let there = attack.begins.max(-1.0) + attack.kind.lead(attack.size, trial.follow);
            (there, there + attack.kind.within())
        })
        .min_by(|a, b| a.1.total_cmp(&b.1));
    // The tick that finds it has passed as well.
    let found_at = first.map(|(tick, _)| trial.cycle(tick + 1));
    let naming = first.map_or(Naming::Nothing, |&(since, _)| {
        let there = trial.attacks.iter().filter(|attack| begun(attack) <= since);
        let names: Vec<Name> = there
            .flat_map(|attack| attack.kind.names(attack.size))
            .collect();
        let of = together(since).map(|(_, said)| said.of(&names));
        of.max().unwrap_or(Naming::Nothing)
    });
    // Each of them separately, up to the stop that leaves no time for it.
    let is_named = |attack: &Attack| {
        let names = attack.kind.names(attack.size);
        let there = attack.begins.max(-1.0) + attack.kind.lead(attack.size, trial.follow);
        let until = trial.tick(there + attack.kind.within());
        said.iter().any(|(tick, said)| {
            let is_stop = matches!(said, Said::Trip(_) | Said::Refused);
            let is_of_it = *tick >= begun(attack) && said.of(&names) > Naming::Wrong;
            is_of_it || (is_stop && *tick <= until)
        })
    };
    let observable = |one: &&Attack| one.kind.hidden().is_none();
    let all_named = trial.attacks.iter().filter(observable).all(is_named);
    let stop = said.iter().find_map(|(_, said)| match said {
        Said::Trip(cause) => Some(format!("{cause:?}")),
        Said::Refused => Some("StartRefused".into()),
        Said::Event(..) => None,
    });
    AttackOutcome {
        trial: trial.clone(),
        named: said
            .iter()
            .map(|(tick, said)| (trial.cycle(*tick), words(*said)))
            .collect(),
        found: first.is_some(),
        cycles: found_at
            .zip(due)
            .map(|(at, (there, _))| (at - there).max(0.0)),
        in_time: found_at
            .zip(due)
            .is_some_and(|(at, (_, until))| at <= until),
        naming,
        all_named,
        false_alarm: said.iter().any(|(tick, _)| *tick < first_attack),
        stopped: stop,
        hazards: Vec::new(),
        lost: None,
        hidden: trial.hidden(),
    }
}

fn words(said: Said) -> String {
    match said {
        Said::Event(cause, None) => format!("{cause:?}"),
        Said::Event(cause, Some(or)) => format!("{cause:?} or {or:?}"),
        Said::Trip(cause) => format!("stop: {cause:?}"),
        Said::Refused => "start refused".into(),
    }
}

#[cfg(test)]
mod tests {
    use mesh_damper::health::Channel;

    use super::super::AttackKind;
    use super::*;
    use crate::faults::{Campaign, singles};

    /// The evaluation of a kind's first single trial, for reports this many cycles after it counts as present.
    fn judged(kind: AttackKind, said: &[(f64, Said)]) -> AttackOutcome {
        let trials = singles(&Campaign::whole());
        let of_kind = |trial: &&AttackTrial| trial.attacks[0].kind == kind;
        let trial = trials.iter().find(of_kind).unwrap();
        let Attack { begins, size, .. } = trial.attacks[0];
        let there = begins + kind.lead(size, trial.follow);
        let said: Vec<(u64, Said)> = said
            .iter()
            .map(|(cycles, said)| (trial.tick(there + cycles), *said))
            .collect();
        judge(trial, &said)
    }

    const WIRES: HealthCause = HealthCause::WireBreakage;
    const GAIN: HealthCause = HealthCause::SensorGain(Channel::Force);
    const LOOSE: HealthCause = HealthCause::Loosening;

    #[test]
    fn what_is_named_first_counts_and_two_causes_may_be_said() {
        let naming = |said: &[(f64, Said)]| judged(AttackKind::Break, said).naming;
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

    /// A limit takes ten ticks to stop the rig.
    #[test]
    fn a_stop_and_what_is_said_of_it_belong_together() {
        let kind = AttackKind::Open(Channel::Displacement);
        let spike = HealthCause::SensorSpiking(Channel::Displacement);
        let trip = Said::Trip(TripCause::TrackingLimit);
        let naming =
            |later: f64| judged(kind, &[(0.001, Said::Event(spike, None)), (later, trip)]).naming;
        assert_eq!(naming(0.01), Naming::Right);
        assert_eq!(naming(0.1), Naming::Wrong);
    }

    #[test]
    fn time_counts_from_when_an_attack_is_there() {
        let kind = AttackKind::GainDrift(Channel::Force);
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
        let spike = AttackKind::Spike(Channel::Force);
        let attacks = [(spike, 0.5, 0.0), (AttackKind::Break, 0.2, 4.0)];
        let attacks = attacks.map(|(kind, size, later)| kind.attack(size, 0.25, later));
        let trial = AttackTrial::of(attacks.into(), (3.0, 0.1), (0.004, 0.0), 1);
        let all_named = |said: &[(f64, Said)]| {
            let ticks = said.iter().map(|(cycle, said)| (trial.tick(*cycle), *said));
            judge(&trial, &ticks.collect::<Vec<_>>()).all_named
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
        let kind = AttackKind::NeverConnected(Channel::Force);
        let outcome = judged(kind, &[(-2.0, Said::Refused)]);
        assert_eq!(outcome.stopped.as_deref(), Some("StartRefused"));
        assert!(outcome.found && outcome.in_time);
    }
}

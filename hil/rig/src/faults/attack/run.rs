//! Runs a trial and judges what was found.

use mesh_damper::health::{Event, HealthCause};
use mesh_damper::rig::{State, TripCause};
use mesh_damper::sine::SineGenerator;

use super::apply::damage;
use super::hazard::HazardMeter;
use super::names::Name;
use super::trial::{AttackOutcome, AttackTrial, BLOCKS, IDLE, Loss, Naming, Prepared};
use crate::faults::damage::Damaged;
use crate::{Bench, Controlled, RigSetup, SetupError};

/// What the rig said at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Said {
    /// A fault that its monitor named.
    Event(HealthCause, Option<HealthCause>),
    /// Why it stopped.
    Trip(TripCause),
    /// It refused to start.
    Refused,
}

/// Ticks within which what its monitor names and a stop for it belong together: a limit stops the rig ten ticks after it was exceeded.
const TOGETHER: u64 = 12;

/// Runs it with the controller in this process.
///
/// # Errors
/// A setup that one of its parts refuses.
pub fn run_attack(trial: &AttackTrial) -> Result<AttackOutcome, SetupError> {
    run_attack_with(trial, Bench::new)
}

/// Runs it on the rig that `wire_up` makes of its setup, wherever the controller runs.
///
/// # Errors
/// As [`run_attack`], and those of the link to the controller.
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
        let demanded = running.then(|| f64::from(demand.tick().displacement));
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

/// What the rig `said`, beside what was done to it.
fn judge(trial: &AttackTrial, said: &[(u64, Said)]) -> AttackOutcome {
    let begun = |attack: &super::trial::Attack| trial.tick(attack.begins);
    let first_attack = trial.attacks.iter().map(begun).min().unwrap_or(0);
    let first = said.iter().find(|(tick, _)| *tick >= first_attack);
    let together = |since: u64| {
        let all = said.iter().filter(move |(tick, _)| *tick >= since);
        all.take_while(move |(tick, _)| *tick <= since + TOGETHER)
    };
    // What has to be found first, of what can be: when it counts as there, and until when.
    let observable = trial
        .attacks
        .iter()
        .filter(|one| one.kind.hidden().is_none());
    let due = observable
        .map(|attack| {
            let there = attack.begins.max(-1.0) + attack.kind.lead(attack.size);
            (there, there + attack.kind.within())
        })
        .min_by(|a, b| a.1.total_cmp(&b.1));
    // The tick that finds it is over as well.
    let found_at = first.map(|(tick, _)| trial.cycle(tick + 1));
    let naming = first.map_or(Naming::Nothing, |&(since, _)| {
        let there = trial.attacks.iter().filter(|attack| begun(attack) <= since);
        let names: Vec<Name> = there
            .flat_map(|attack| attack.kind.names(attack.size))
            .collect();
        let is_right = |said: &Said| match said {
            Said::Event(cause, _) => names.contains(&Name::Health(*cause)),
            Said::Trip(cause) => names.contains(&Name::Trip(*cause)),
            Said::Refused => false,
        };
        let is_second = |said: &Said| match said {
            Said::Event(_, Some(or)) => names.contains(&Name::Health(*or)),
            _ => false,
        };
        if together(since).any(|(_, said)| is_right(said)) {
            Naming::Right
        } else if together(since).any(|(_, said)| is_second(said)) {
            Naming::Both
        } else {
            Naming::Wrong
        }
    });
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

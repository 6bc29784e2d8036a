//! Runs a trial.

use mesh_damper::rig::State;
use mesh_damper::sine::SineGenerator;

use super::action::damage;
use super::damage::Damaged;
use super::hazard::HazardMeter;
use super::outcome::{Loss, Outcome, Said, Stopping};
use super::rig::Prepared;
use super::trial::{BLOCKS, Trial};
use crate::{Bench, Controlled, RigSetup, SetupError};

/// Part of a limit above which it is exceeded beyond doubt: three times the noise of 1 % of a force's RMS, which is a third of its
/// limit on the usual rig.
const BEYOND: f64 = 1.01;

/// Runs it with the controller in this process.
///
/// # Errors
/// A setup that one of its parts rejects.
pub fn run_trial(trial: &Trial) -> Result<Outcome, SetupError> {
    run_trial_with(trial, Bench::new)
}

/// Runs it on the rig that `wire_up` makes of its setup, wherever the controller runs.
///
/// # Errors
/// As [`run_trial`], and the errors of the link to the controller.
pub fn run_trial_with<R: Controlled<Damaged>>(
    trial: &Trial,
    wire_up: impl FnOnce(RigSetup<Damaged, BLOCKS, 1>) -> Result<R, SetupError>,
) -> Result<Outcome, SetupError> {
    let Prepared {
        setup,
        condition,
        healthy,
        allowed,
        mut changes,
    } = trial.prepare()?;
    let [displacement_limit, force_limit, _] = allowed.limits;
    let mut demand = SineGenerator::<BLOCKS, _>::new(setup.programme.clone())?;
    // Its first tick is at rest.
    demand.tick();
    let stop_ticks = u64::from(setup.settings.stop_ticks);
    let mut rig = wire_up(setup)?;
    let mut meter = HazardMeter::new(allowed);
    let mut said: Vec<(u64, Said)> = Vec::new();
    let mut stopped: Option<u64> = None;
    let mut stopping = Stopping::default();
    let mut beyond = 0;
    let mut running = false;
    let idle = trial.idle();
    for tick in 0.. {
        for change in &mut changes {
            change.at(tick, rig.plant_mut());
        }
        damage(&changes, tick, &healthy, &condition);
        if tick == idle {
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
        let enabled = rig.is_enabled();
        let plant = rig.plant();
        let demanded = demanded.filter(|_| running);
        let sensed = plant.signals.sensed();
        meter.tick(tick, plant.passed(), sensed, demanded, enabled);
        let displacement = (plant.servo.displacement() / displacement_limit).abs();
        let force = (plant.servo.force() / force_limit).abs();
        stopping.displacement = stopping.displacement.max(displacement);
        stopping.force = stopping.force.max(force);
        let is_beyond = displacement > BEYOND || force > BEYOND;
        beyond = if is_beyond && enabled { beyond + 1 } else { 0 };
        stopping.ticks_beyond = stopping.ticks_beyond.max(beyond);
        let event = telemetry.event.filter(|event| event.cause.is_fault());
        said.extend(event.map(|event| (tick, Said::Event(event.cause, event.or))));
        match telemetry.state {
            State::Running => {}
            State::Faulted(cause) => {
                stopping.in_time &= !enabled;
                match stopped {
                    None => {
                        stopped = Some(tick);
                        said.push((tick, Said::Trip(cause)));
                    }
                    Some(since) if tick > since + stop_ticks => {
                        stopping.in_time &= telemetry.command == 0.0;
                        break;
                    }
                    Some(_) => {}
                }
            }
            State::Idle | State::Done if tick > idle => break,
            State::Idle | State::Done => {}
        }
    }
    let mut outcome = Outcome::of(trial, said);
    outcome.stopping = stopping;
    outcome.hazards = meter.hazards();
    outcome.lost = trial.changes.iter().find_map(|change| {
        let from = trial.tick(change.begins).max(idle);
        let after = |tick: u64| tick.saturating_sub(from) as f64 / trial.cycle_ticks();
        Some(Loss {
            channel: (change.kind.facts().loses).filter(|_| change.lasts.is_none())?,
            stopped_after: stopped.map(after),
        })
    });
    Ok(outcome)
}

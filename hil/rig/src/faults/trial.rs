//! One fault on the rig.

use std::cell::Cell;
use std::f64::consts::TAU;
use std::rc::Rc;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::health::{Event, HealthCause};
use mesh_damper::law::Law;
use mesh_damper::rig::{State, TripCause};
use mesh_damper::sine::{Block, Programme};
use serde::Serialize;

use super::damage::{Condition, Damaged};
use super::kind::{HealthyMotion, InjectedFault};
use crate::{Bench, Controlled, RigSetup, SetupError, TICK_RATE};

/// A fault, and the test in which it occurs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Trial {
    /// The kind.
    pub kind: InjectedFault,
    /// Size of the fault: a fraction, a ratio or rad, as [`InjectedFault::sizes`] describes.
    pub size: f64,
    /// Density, g/cm³.
    pub density: f64,
    /// Amplitude, mm.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// RMS of the force channel's noise over the RMS of the force.
    pub noise: f64,
    /// Fraction of the cycle at which the fault begins.
    pub moment: f64,
    /// Largest adaptation to slow changes, as a fraction of the law's coefficients; 0 without adaptation.
    pub follow: f64,
    /// Seed of the sensors' noise.
    pub seed: u64,
}

/// Outcome of a trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outcome {
    /// The trial.
    pub trial: Trial,
    /// All reported causes in order.
    pub named: Vec<String>,
    /// Number of cycles from the time when the fault counts as present to the first report; 0 if the report came earlier.
    pub cycles: Option<f64>,
    /// Whether the first reported cause is the fault.
    pub right: bool,
    /// Whether the first event reports two causes, the second of which is the fault.
    pub both: bool,
    /// Whether a cause was reported before there was a fault.
    pub false_alarm: bool,
    /// Trip cause, if the rig stopped.
    pub stopped: Option<String>,
    /// Largest true displacement over its limit.
    pub displacement: f64,
    /// Largest true force over its limit.
    pub force: f64,
    /// Largest number of successive ticks at which displacement or force exceeded its limit by more than noise can hide, while the
    /// enable line was high.
    pub ticks_beyond: u32,
    /// Whether the command returned to 0 and the enable line dropped within the stated ticks.
    pub stopped_in_time: bool,
}

impl Outcome {
    /// Whether it was found in time.
    pub fn in_time(&self) -> bool {
        let within = self.trial.kind.group().cycles();
        self.cycles.is_some_and(|cycles| cycles <= within)
    }
}

/// Cycles at full amplitude before a fault: settling, learning and a few more.
const HEALTHY: u32 = 24;
/// Cycles for which a fault is watched, in addition to those of its lead.
const WATCHED: u32 = 8;
/// Part of a limit above which it is exceeded beyond doubt: three times the noise of 1 % of a force's RMS, which is a third of its
/// limit here.
const BEYOND: f64 = 1.01;
/// Noise of the force channel as [`RigSetup::new`] sets it, divided by the RMS of the force.
pub(super) const USUAL_NOISE: f64 = 0.004;

/// The rig that tests `specimen` at `frequency` Hz in blocks of these amplitudes in mm and cycles, with `noise` and `follow` as in
/// [`Trial`].
pub(super) fn setup<const B: usize>(
    specimen: Damaged,
    blocks: &[(f64, u32)],
    frequency: f64,
    (noise, follow): (f64, f64),
    seed: u64,
) -> Result<RigSetup<Damaged, B, 1>, SetupError> {
    let c = specimen.coefficients();
    let law = Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32)?;
    let mut programme = Programme::new(TICK_RATE, 1)?;
    for &(amplitude, cycles) in blocks {
        programme = programme.with(Block::sine(amplitude, frequency, cycles)?)?;
    }
    let mut setup = RigSetup::new(specimen, AugmentedLaw::new(law), programme, seed);
    setup.force_sensor.noise *= noise / USUAL_NOISE;
    setup.settings.health.follow = follow;
    Ok(setup)
}

/// Largest force of a sine, kN.
pub(super) fn peak(specimen: &Damaged, amplitude: f64, frequency: f64) -> f64 {
    let w = TAU * frequency;
    (0..1000)
        .map(|step| {
            let (sin, cos) = (TAU * f64::from(step) / 1000.0).sin_cos();
            let force = specimen
                .coefficients()
                .force(amplitude * sin, amplitude * w * cos);
            force.abs()
        })
        .fold(0.0, f64::max)
}

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
    wire_up: impl FnOnce(RigSetup<Damaged, 1, 1>) -> Result<R, SetupError>,
) -> Result<Outcome, SetupError> {
    let (test, setup) = Test::of(trial)?;
    test.run(&mut wire_up(setup)?)
}

/// A trial, with data for the evaluation of its rig.
struct Test<'t> {
    trial: &'t Trial,
    condition: Rc<Cell<Condition>>,
    motion: HealthyMotion,
    /// mm and kN.
    limits: [f64; 2],
    stop_ticks: u64,
}

impl<'t> Test<'t> {
    fn of(trial: &'t Trial) -> Result<(Self, RigSetup<Damaged, 1, 1>), SetupError> {
        let (specimen, condition) = Damaged::new(trial.density, trial.amplitude);
        let motion = HealthyMotion {
            amplitude: trial.amplitude,
            frequency: trial.frequency,
            force: peak(&specimen, trial.amplitude, trial.frequency),
            tick: 1.0 / TICK_RATE,
        };
        let lead = trial.kind.lead(trial.size);
        let cycles = HEALTHY + WATCHED + lead.ceil() as u32;
        let block = [(trial.amplitude, cycles)];
        let settings = (trial.noise, trial.follow);
        let setup = setup(specimen, &block, trial.frequency, settings, trial.seed)?;
        let test = Self {
            trial,
            condition,
            motion,
            limits: [
                setup.settings.displacement_limit,
                setup.settings.force_limit,
            ],
            stop_ticks: u64::from(setup.settings.stop_ticks),
        };
        Ok((test, setup))
    }

    fn run(&self, rig: &mut impl Controlled<Damaged>) -> Result<Outcome, SetupError> {
        let trial = self.trial;
        let ticks_per_cycle = TICK_RATE / trial.frequency;
        // The ramp is a cycle.
        let begins = ((f64::from(1 + HEALTHY) + trial.moment) * ticks_per_cycle) as u64;
        let mut events: Vec<(u64, Event)> = Vec::new();
        let mut outcome = Outcome {
            trial: *trial,
            named: Vec::new(),
            cycles: None,
            right: false,
            both: false,
            false_alarm: false,
            stopped: None,
            displacement: 0.0,
            force: 0.0,
            ticks_beyond: 0,
            stopped_in_time: true,
        };
        let mut beyond = 0;
        let mut stopped: Option<(u64, TripCause)> = None;
        rig.start()?;
        for tick in 0.. {
            if tick == begins {
                let kind = trial.kind;
                kind.inject(trial.size, rig.plant_mut(), &self.condition, &self.motion);
            }
            let telemetry = rig.tick()?;
            events.extend(telemetry.event.map(|event| (tick, event)));
            let [displacement_limit, force_limit] = self.limits;
            let servo = &rig.plant().servo;
            let displacement = (servo.displacement() / displacement_limit).abs();
            let force = (servo.force() / force_limit).abs();
            outcome.displacement = outcome.displacement.max(displacement);
            outcome.force = outcome.force.max(force);
            let is_beyond = displacement > BEYOND || force > BEYOND;
            let enabled = rig.is_enabled();
            beyond = if is_beyond && enabled { beyond + 1 } else { 0 };
            outcome.ticks_beyond = outcome.ticks_beyond.max(beyond);
            match (telemetry.state, stopped) {
                (State::Running, _) => {}
                (State::Faulted(fault), None) => {
                    stopped = Some((tick, fault));
                    outcome.stopped_in_time &= !enabled;
                }
                (State::Faulted(_), Some((since, _))) => {
                    outcome.stopped_in_time &= !enabled;
                    if tick > since + self.stop_ticks {
                        outcome.stopped_in_time &= telemetry.command == 0.0;
                        break;
                    }
                }
                (State::Idle | State::Done, _) => break,
            }
        }
        outcome.stopped = stopped.map(|(_, fault)| format!("{fault:?}"));
        let faults = events.iter().filter(|(_, event)| event.cause.is_fault());
        let faults: Vec<(u64, HealthCause, Option<HealthCause>)> = faults
            .map(|(tick, event)| (*tick, event.cause, event.or))
            .collect();
        outcome.named = faults
            .iter()
            .map(|(_, cause, _)| format!("{cause:?}"))
            .collect();
        if let Some(&(tick, cause, or)) = faults.first() {
            outcome.false_alarm = tick < begins;
            outcome.right = cause == trial.kind.cause();
            outcome.both = !outcome.right && or == Some(trial.kind.cause());
            // The tick that finds it has passed as well.
            let since = (tick + 1) as f64 - begins as f64;
            let lead = trial.kind.lead(trial.size);
            outcome.cycles = Some((since / ticks_per_cycle - lead).max(0.0));
        }
        Ok(outcome)
    }
}

//! A whole programme on the bench, recorded.

use mesh_damper::effects::CONTROLS;
use mesh_damper::health::Event;
use mesh_damper::law::Law;
use mesh_damper::operating_range::{OperatingRange, RangeCounter};
use mesh_damper::rig::{CycleReport, State, Telemetry, TripCause};
use mesh_damper_output::error::InputError;
use mesh_damper_recording::Recording;

use super::bench::{Bench, RigSetup, SetupError};
use super::plant::Plant;
use crate::specimen::{CURRENT, DamperForce};

/// Recorded data, one element per sample.
///
/// A sample holds the values of one tick, not a mean over the ticks since the last. c·|v|^α is too steep at a reversal for
/// averaging. Above half of the recording rate the rig has only white noise, whose size does not change when it is sampled less
/// often.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Time since the start, s.
    pub time: Vec<f64>,
    /// Measured displacement, mm.
    pub displacement: Vec<f64>,
    /// Measured force, kN.
    pub force: Vec<f64>,
    /// Velocity observed by the crate, mm/s.
    pub velocity: Vec<f64>,
    /// Force of the crate's law, kN.
    pub model_force: Vec<f64>,
    /// Command to the actuator, mm.
    pub command: Vec<f64>,
    /// Temperature of the specimen, °C.
    pub temperature: Vec<f64>,
    /// Block of the programme; 0 for a motion.
    pub block: Vec<usize>,
    /// Cycles completed.
    pub cycle: Vec<u32>,
    /// Whether in a ramp; always for a motion.
    pub ramp: Vec<bool>,
    /// Values of each control input: empty until it differs from 0, because most inputs stay 0.
    controls: [Vec<f64>; CONTROLS],
}

impl Samples {
    /// Adds a tick at a time in s after the start and a temperature in °C.
    pub fn push(&mut self, telemetry: &Telemetry, time: f64, temperature: f64) {
        let before = self.len();
        self.time.push(time);
        self.displacement.push(telemetry.displacement.into());
        self.force.push(telemetry.measured_force.into());
        self.velocity.push(telemetry.velocity.into());
        self.model_force.push(telemetry.model_force.into());
        self.command.push(telemetry.command.into());
        self.temperature.push(temperature);
        self.block.push(telemetry.block);
        self.cycle.push(telemetry.cycle);
        self.ramp.push(telemetry.ramp);
        for (column, control) in self.controls.iter_mut().zip(telemetry.controls) {
            if control != 0.0 || !column.is_empty() {
                column.resize(before, 0.0);
                column.push(control.into());
            }
        }
    }

    /// Drops samples later than `time`, s.
    pub fn cut(&mut self, time: f64) {
        let keep = self.time.partition_point(|sample| *sample <= time);
        for column in [
            &mut self.time,
            &mut self.displacement,
            &mut self.force,
            &mut self.velocity,
            &mut self.model_force,
            &mut self.command,
            &mut self.temperature,
        ] {
            column.truncate(keep);
        }
        self.block.truncate(keep);
        self.cycle.truncate(keep);
        self.ramp.truncate(keep);
        for column in &mut self.controls {
            column.truncate(keep);
        }
    }

    /// The control input at index `place` of [`CONTROLS`] that the controller got, in the units of the law's effects: one element
    /// per sample, and an empty slice if it was 0 at all of them.
    pub fn control(&self, place: usize) -> &[f64] {
        self.controls.get(place).map_or(&[], Vec::as_slice)
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }
}

/// A completed test.
#[derive(Clone, Debug, PartialEq)]
pub struct RigRun {
    /// Every `record_every`-th tick.
    pub samples: Samples,
    /// Every cycle, ramps included; empty for a motion, whose cycles are not distinguished.
    pub cycles: Vec<CycleReport>,
    /// Times of stops in s with their trip causes; empty after a test that ran to its end.
    pub faults: Vec<(f64, TripCause)>,
    /// Times of events in s, with the monitor's events.
    pub events: Vec<(f64, Event)>,
    /// Whether the specimen had a control input.
    pub is_controlled: bool,
    /// Number of ticks run.
    pub ticks: u64,
    /// Number of ticks with a measured displacement or an observed velocity outside the law's operating range; `None` if the setup
    /// has no operating range.
    pub outside: Option<u64>,
}

impl RigRun {
    /// The steady cycles of one block.
    pub fn steady_cycles(&self, block: usize) -> impl Iterator<Item = &CycleReport> {
        self.cycles
            .iter()
            .filter(move |cycle| cycle.block == block && !cycle.ramp)
    }

    /// Motion, force, temperature and, if there was one, the current that controlled the specimen, as a recording. It leaves out
    /// the crate's velocity, which is an estimate without knowledge of later samples; a reader of the whole recording can make a
    /// better one.
    ///
    /// # Errors
    /// A run that stopped before it moved.
    pub fn recording(&self, name: impl Into<String>) -> Result<Recording, InputError> {
        let samples = &self.samples;
        Recording::new(
            name,
            samples.time.clone(),
            samples.displacement.clone(),
            samples.force.clone(),
        )?
        .with_temperature(samples.temperature.clone())
        .and_then(|recording| {
            if !self.is_controlled {
                return Ok(recording);
            }
            let mut current = samples.control(0).to_vec();
            current.resize(samples.len(), 0.0);
            recording.with_control(CURRENT, current)
        })
    }
}

/// Observer of a run. Any `FnMut(f64)` is one, for the time alone.
///
/// Its methods must be fast, because the rig waits for them.
pub trait Watch {
    /// A tick `time` s after the start, at a temperature in °C. A rig in this process gives every tick; a board on its own timer
    /// gives every row that arrives, without cycle, report and event.
    fn tick(&mut self, _telemetry: &Telemetry, _time: f64, _temperature: f64) {}

    /// A cycle that ended `time` s after the start.
    fn cycle(&mut self, _report: &CycleReport, _time: f64) {}

    /// An event of the monitor `time` s after the start.
    fn event(&mut self, _event: &Event, _time: f64) {}

    /// Called now and then, and at the end however the run ends: the part of the programme's time that has passed, and the recorded
    /// samples.
    ///
    /// # Errors
    /// The error with which the run must end.
    fn see(&mut self, part: f64, samples: &Samples) -> Result<(), InputError>;
}

impl<F: FnMut(f64)> Watch for F {
    fn see(&mut self, part: f64, _: &Samples) -> Result<(), InputError> {
        self(part);
        Ok(())
    }
}

/// A rig with its plant, wherever its controller runs.
pub trait Controlled<S> {
    /// The plant.
    fn plant(&self) -> &Plant<S>;
    /// The plant, for example to make parts of it fail.
    fn plant_mut(&mut self) -> &mut Plant<S>;
    /// Begins the programme, or the motion.
    ///
    /// # Errors
    /// Why it does not start, and the errors of the link to an image.
    fn start(&mut self) -> Result<(), SetupError>;
    /// Reports the other end of the controller's link as heard. Does nothing where each tick is requested over the link.
    fn exchange(&mut self) {}
    /// One tick of the controller and of the plant.
    ///
    /// # Errors
    /// As [`Controlled::start`].
    fn tick(&mut self) -> Result<Telemetry, SetupError>;
    /// Level of the enable line after the last tick.
    fn is_enabled(&self) -> bool;
    /// Sets eq 13's coefficients from the next end of a cycle on.
    ///
    /// # Errors
    /// As [`Controlled::start`].
    fn set_law(&mut self, law: Law<f32>) -> Result<(), SetupError>;
}

/// Runs the programme of `setup`, or its motion, with the controller in this process: to its end, or to the standstill after a
/// fault.
///
/// # Errors
/// The error of a part that rejects its settings, or the error of `watch`.
pub fn run_rig<S: DamperForce + Clone, const B: usize, const N: usize>(
    setup: RigSetup<S, B, N>,
    watch: impl Watch,
) -> Result<RigRun, SetupError> {
    let plan = Plan::of(&setup);
    run_controlled(&mut Bench::new(setup)?, &plan, watch)
}

/// Parameters of a run in addition to the rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    tick_rate: f64,
    duration: f64,
    record_every: u64,
    block_laws: Vec<Law<f32>>,
    operating_range: Option<OperatingRange<f32>>,
}

impl Plan {
    /// The parameters for a run of `setup`.
    pub fn of<S, const B: usize, const N: usize>(setup: &RigSetup<S, B, N>) -> Self {
        Self {
            tick_rate: setup.programme.tick_rate(),
            duration: match &setup.drive {
                Some(motion) => motion.duration(),
                None => setup.programme.duration(),
            },
            record_every: setup.record_every.max(1),
            block_laws: setup.block_laws.clone(),
            operating_range: setup.operating_range,
        }
    }
}

/// Number of samples for which memory is reserved at the start; more is allocated when needed.
const MOST_RESERVED: usize = 1 << 20;

/// Runs `plan`'s programme as [`run_rig`] does, on a wired rig, wherever its controller runs.
///
/// # Errors
/// As [`run_rig`], and the errors of the link to the controller.
pub fn run_controlled<S: DamperForce + Clone>(
    rig: &mut impl Controlled<S>,
    plan: &Plan,
    mut watch: impl Watch,
) -> Result<RigRun, SetupError> {
    let samples = (plan.duration * plan.tick_rate / plan.record_every as f64) as usize + 16;
    let capacity = samples.min(MOST_RESERVED);
    let mut run = RigRun {
        samples: Samples::default(),
        cycles: Vec::new(),
        faults: Vec::new(),
        events: Vec::new(),
        is_controlled: rig.plant().servo.specimen().control().is_some(),
        ticks: 0,
        outside: None,
    };
    for column in [
        &mut run.samples.time,
        &mut run.samples.displacement,
        &mut run.samples.force,
        &mut run.samples.velocity,
        &mut run.samples.model_force,
        &mut run.samples.command,
        &mut run.samples.temperature,
    ] {
        column.reserve(capacity);
    }
    let ended = run_to_its_end(rig, plan, &mut run, &mut watch);
    // An observer that has failed is not called again.
    if !matches!(ended, Err(SetupError::Watch(_))) {
        watch.see(1.0, &run.samples)?;
    }
    ended.map(|()| run)
}

fn run_to_its_end<S: DamperForce + Clone>(
    rig: &mut impl Controlled<S>,
    plan: &Plan,
    run: &mut RigRun,
    watch: &mut impl Watch,
) -> Result<(), SetupError> {
    rig.start()?;
    let report_every = (plan.tick_rate / 2.0) as u64 + 1;
    let mut block = None;
    let mut range = plan.operating_range.map(RangeCounter::new);
    loop {
        let time = rig.plant().servo.time();
        let telemetry = rig.tick()?;
        let temperature = rig.plant().temperature();
        if run.ticks.is_multiple_of(plan.record_every) {
            run.samples.push(&telemetry, time, temperature);
        }
        watch.tick(&telemetry, time, temperature);
        if run.ticks.is_multiple_of(report_every) {
            watch.see((time / plan.duration).min(1.0), &run.samples)?;
        }
        run.ticks += 1;
        if let Some(range) = &mut range {
            range.tick(telemetry.displacement, telemetry.velocity);
            run.outside = Some(range.outside());
        }
        if let Some(report) = telemetry.report {
            watch.cycle(&report, time);
            run.cycles.push(report);
        }
        if let Some(event) = telemetry.event {
            watch.event(&event, time);
            run.events.push((time, event));
        }
        if block != Some(telemetry.block) {
            block = Some(telemetry.block);
            if let Some(law) = plan.block_laws.get(telemetry.block) {
                rig.set_law(*law)?;
            }
        }
        match telemetry.state {
            State::Running => {}
            State::Faulted(fault) => {
                if run.faults.is_empty() {
                    run.faults.push((time, fault));
                }
                if telemetry.command == 0.0 {
                    return Ok(());
                }
            }
            State::Idle | State::Done => return Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use mesh_damper::effects::{AugmentedLaw, Effect, StickSlip};
    use mesh_damper::sine::{Block, Programme};

    use super::*;
    use crate::specimen::Specimen;

    /// All calls of an observer.
    #[derive(Default)]
    struct Told {
        samples: Samples,
        cycles: Vec<CycleReport>,
        events: Vec<(f64, Event)>,
    }

    impl Watch for &mut Told {
        fn tick(&mut self, telemetry: &Telemetry, time: f64, temperature: f64) {
            self.samples.push(telemetry, time, temperature);
        }

        fn cycle(&mut self, report: &CycleReport, _: f64) {
            self.cycles.push(*report);
        }

        fn event(&mut self, event: &Event, time: f64) {
            self.events.push((time, *event));
        }

        fn see(&mut self, _: f64, _: &Samples) -> Result<(), InputError> {
            Ok(())
        }
    }

    /// The observer gets every tick, however few are recorded, and every cycle and event.
    #[test]
    fn who_watches_is_told_of_all_of_it() {
        // Far from its law, which the monitor reports.
        let specimen = Specimen::of_density(3.0, 0.1);
        let law = Law::new(20.0, 0.0, 0.1, 0.5).unwrap();
        let slip = Effect::StickSlip(StickSlip::new(&[(5.0, 2e-3)]).unwrap());
        let law: AugmentedLaw<f32, 1> = AugmentedLaw::new(law).with(slip).unwrap();
        let programme = Programme::<1>::new(10_000.0, 1).unwrap();
        let programme = programme.with(Block::sine(0.1, 20.0, 12).unwrap()).unwrap();
        let mut setup = RigSetup::new(specimen, law, programme, 1);
        setup.record_every = 1;
        let whole = run_rig(setup.clone(), |_| {}).unwrap();
        setup.record_every = 7;
        let mut told = Told::default();
        let run = run_rig(setup, &mut told).unwrap();
        assert_eq!(told.samples, whole.samples);
        assert_eq!(told.samples.len() as u64, run.ticks);
        assert!(run.cycles.len() >= 12 && !run.events.is_empty());
        assert_eq!(told.cycles, run.cycles);
        assert_eq!(told.events, run.events);
    }
}

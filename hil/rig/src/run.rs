//! A whole programme on the bench, recorded.

use mesh_damper::effects::CONTROLS;
use mesh_damper::health::Event;
use mesh_damper::law::Law;
use mesh_damper::operating_range::{OperatingRange, RangeCounter};
use mesh_damper::rig::{CycleReport, State, Telemetry, TripCause};
use mesh_damper_recording::Recording;
use mesh_damper_recording::error::InputError;

use super::bench::{Bench, RigSetup, SetupError};
use super::plant::Plant;
use crate::specimen::{CURRENT, DamperForce};

/// What was recorded, one element per sample.
///
/// A sample is one tick's values, not a mean over the ticks since the last: c·|v|^α is too steep at a reversal to
/// average, and what the rig has above half of the recording rate is white noise, which keeps its size when it is
/// sampled less often.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// s since the start.
    pub time: Vec<f64>,
    /// Measured, mm.
    pub displacement: Vec<f64>,
    /// Measured, kN.
    pub force: Vec<f64>,
    /// Observed by the crate, mm/s.
    pub velocity: Vec<f64>,
    /// Of the crate's law, kN.
    pub model_force: Vec<f64>,
    /// To the actuator, mm.
    pub command: Vec<f64>,
    /// Of the specimen, °C.
    pub temperature: Vec<f64>,
    /// Block of the programme; 0 of a motion.
    pub block: Vec<usize>,
    /// Cycles completed.
    pub cycle: Vec<u32>,
    /// In a ramp; always so of a motion.
    pub ramp: Vec<bool>,
    /// Of each control input: nothing until it is other than 0, which is what most of them stay.
    controls: [Vec<f64>; CONTROLS],
}

impl Samples {
    /// Adds a tick, s after the start, at a temperature in °C.
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

    /// Drops what is later than `time`, s.
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

    /// The control input at `place` of [`CONTROLS`], as the controller was given it, in the units of the law's effects: one element
    /// per sample, and none where it was 0 at all of them.
    pub fn control(&self, place: usize) -> &[f64] {
        self.controls.get(place).map_or(&[], Vec::as_slice)
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }
}

/// A test that ran.
#[derive(Clone, Debug, PartialEq)]
pub struct RigRun {
    /// Every `record_every`-th tick.
    pub samples: Samples,
    /// Every cycle, ramps included; none of a motion, whose cycles are not told apart.
    pub cycles: Vec<CycleReport>,
    /// When the rig stopped for what, s; none after a test that ran to its end.
    pub faults: Vec<(f64, TripCause)>,
    /// When the monitor named what, s.
    pub events: Vec<(f64, Event)>,
    /// Whether the specimen was under a control input.
    pub is_controlled: bool,
    /// Ticks run.
    pub ticks: u64,
    /// Ticks of these with a measured displacement or an observed velocity outside the law's operating range; `None` where the
    /// setup has none.
    pub outside: Option<u64>,
}

impl RigRun {
    /// The steady cycles of one block.
    pub fn steady_cycles(&self, block: usize) -> impl Iterator<Item = &CycleReport> {
        self.cycles
            .iter()
            .filter(move |cycle| cycle.block == block && !cycle.ramp)
    }

    /// Motion, force, temperature and, where there was one, the current that controlled the specimen, as any other recording. The crate's velocity is not among them: it is an estimate
    /// made without knowing what comes next, and whoever has the whole recording makes a better one.
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

/// Who is told how a run goes on; any `FnMut(f64)` is, of the time alone.
///
/// What is told at a tick may not take long: the rig waits for it.
pub trait Watch {
    /// A tick that was read, `time` s after the start, at a temperature in °C. Of a rig in this process every one; of a board on its own
    /// timer every row that arrives, without cycle, report and event.
    fn tick(&mut self, _telemetry: &Telemetry, _time: f64, _temperature: f64) {}

    /// A cycle that ended `time` s after the start.
    fn cycle(&mut self, _report: &CycleReport, _time: f64) {}

    /// What the monitor named `time` s after the start.
    fn event(&mut self, _event: &Event, _time: f64) {}

    /// Now and then, and at the end however it ends: which part of the programme's time has passed, and what was recorded.
    ///
    /// # Errors
    /// What the run shall end with.
    fn see(&mut self, part: f64, samples: &Samples) -> Result<(), InputError>;
}

impl<F: FnMut(f64)> Watch for F {
    fn see(&mut self, part: f64, _: &Samples) -> Result<(), InputError> {
        self(part);
        Ok(())
    }
}

/// A rig with what it works on, wherever its controller runs.
pub trait Controlled<S> {
    /// What it works on.
    fn plant(&self) -> &Plant<S>;
    /// Likewise, to have any of it fail.
    fn plant_mut(&mut self) -> &mut Plant<S>;
    /// Begins the programme, or the motion.
    ///
    /// # Errors
    /// Why it does not start, and those of the link to an image.
    fn start(&mut self) -> Result<(), SetupError>;
    /// Whoever is linked to the controller is heard. Nothing to be done where each tick is asked for over the link.
    fn exchange(&mut self) {}
    /// One tick of the controller and of the plant.
    ///
    /// # Errors
    /// As [`Controlled::start`].
    fn tick(&mut self) -> Result<Telemetry, SetupError>;
    /// Level of the enable line after the last tick.
    fn is_enabled(&self) -> bool;
    /// Eq 13's coefficients from the next end of a cycle on.
    ///
    /// # Errors
    /// As [`Controlled::start`].
    fn set_law(&mut self, law: Law<f32>) -> Result<(), SetupError>;
}

/// Runs the programme of `setup`, or its motion, to its end, or to the standstill after a fault, with the controller in this process.
///
/// # Errors
/// What one of the parts refuses, or what `watch` ends it with.
pub fn run_rig<S: DamperForce + Clone, const B: usize, const N: usize>(
    setup: RigSetup<S, B, N>,
    watch: impl Watch,
) -> Result<RigRun, SetupError> {
    let plan = Plan::of(&setup);
    run_controlled(&mut Bench::new(setup)?, &plan, watch)
}

/// What a run needs to know beside the rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    tick_rate: f64,
    duration: f64,
    record_every: u64,
    block_laws: Vec<Law<f32>>,
    operating_range: Option<OperatingRange<f32>>,
}

impl Plan {
    /// What the run of `setup` needs.
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

/// Samples for which there is room from the start; more are made room for as they come.
const MOST_RESERVED: usize = 1 << 20;

/// Runs `plan`'s programme as [`run_rig`] does, on a rig that is wired up already, wherever its controller runs.
///
/// # Errors
/// As [`run_rig`], and those of the link to the controller.
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
    // Who could not go on watching is not asked again.
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

    /// All that is told.
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

    /// Who watches is told of every tick, however few are recorded, and of every cycle and event.
    #[test]
    fn who_watches_is_told_of_all_of_it() {
        // Far from its law, which the monitor names.
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

//! A whole programme on the bench, recorded.

use mesh_damper::rig::{CycleReport, Fault, State, Telemetry};

use super::bench::{Bench, RigSetup, SetupError};
use crate::error::InputError;
use crate::recording::Recording;
use crate::specimen::DamperForce;

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
    /// Block of the programme.
    pub block: Vec<usize>,
    /// Cycles completed.
    pub cycle: Vec<u32>,
    /// In a ramp.
    pub ramp: Vec<bool>,
}

impl Samples {
    fn push(&mut self, telemetry: &Telemetry, time: f64, temperature: f64) {
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
    /// Every cycle, ramps included.
    pub cycles: Vec<CycleReport>,
    /// When the rig stopped for what, s; none after a test that ran to its end.
    pub faults: Vec<(f64, Fault)>,
    /// Ticks run.
    pub ticks: u64,
}

impl RigRun {
    /// The steady cycles of one block.
    pub fn steady_cycles(&self, block: usize) -> impl Iterator<Item = &CycleReport> {
        self.cycles
            .iter()
            .filter(move |cycle| cycle.block == block && !cycle.ramp)
    }

    /// Motion, force and temperature, as any other recording. The crate's velocity is not among them: it is an estimate
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
    }
}

/// Runs the programme of `setup` to its end, or to the standstill after a fault. `progress` is told now and then which
/// part of the programme's time has passed.
///
/// # Errors
/// What one of the parts refuses.
pub fn run_rig<S: DamperForce + Clone, const B: usize, const N: usize>(
    setup: RigSetup<S, B, N>,
    mut progress: impl FnMut(f64),
) -> Result<RigRun, SetupError> {
    let tick_rate = setup.programme.tick_rate();
    let duration = setup.programme.duration();
    let record_every = setup.record_every.max(1);
    let block_laws = setup.block_laws.clone();
    let capacity = (duration * tick_rate / record_every as f64) as usize + 16;
    let mut bench = Bench::new(setup)?;
    let mut run = RigRun {
        samples: Samples::default(),
        cycles: Vec::new(),
        faults: Vec::new(),
        ticks: 0,
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
    bench.rig.start();
    let report_every = (tick_rate / 2.0) as u64 + 1;
    let mut block = None;
    loop {
        let time = bench.servo.time();
        let telemetry = bench.tick();
        if run.ticks.is_multiple_of(record_every) {
            let temperature = bench.servo.specimen().temperature();
            run.samples.push(&telemetry, time, temperature);
        }
        if run.ticks.is_multiple_of(report_every) {
            progress((time / duration).min(1.0));
        }
        run.ticks += 1;
        run.cycles.extend(telemetry.report);
        if block != Some(telemetry.block) {
            block = Some(telemetry.block);
            if let Some(law) = block_laws.get(telemetry.block) {
                let mut next = bench.rig.law().clone();
                next.set_law(*law);
                bench.rig.swap_law(next);
            }
        }
        match telemetry.state {
            State::Running => {}
            State::Faulted(fault) => {
                if run.faults.is_empty() {
                    run.faults.push((time, fault));
                }
                if telemetry.command == 0.0 {
                    break;
                }
            }
            State::Idle | State::Done => break,
        }
    }
    progress(1.0);
    Ok(run)
}

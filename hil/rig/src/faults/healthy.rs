//! Many cycles of a healthy specimen, which settles after its start and is warmed and cooled.

use serde::Serialize;

use super::damage::{Condition, Damaged};
use super::trial::setup;
use crate::specimen::REFERENCE_TEMPERATURE;
use crate::{Bench, SetupError};
use mesh_damper::rig::State;

/// Hz: the least ticks to the cycle, and with them the most noise.
const FREQUENCY: f64 = 10.0;
/// Part of its force that it loses while it beds in, and cycles in which that settles.
const RUN_IN: (f64, f64) = (0.1, 25.0);
/// Loss of force per degree, 1/°C.
const WARM_LOSS: f64 = 0.004;
/// °C: of a chamber that warms in so many cycles, and of what swings about that with so many.
const CHAMBER: (f64, f64) = (20.0, 600.0);
const SWING: (f64, f64) = (5.0, 1000.0);

/// What came of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Healthy {
    /// g/cm³.
    pub density: f64,
    /// mm.
    pub amplitude: f64,
    /// RMS of the force channel's noise over that of the force.
    pub noise: f64,
    /// Most by which the law follows slow changes, part of its coefficients; 0 where it stays.
    pub follow: f64,
    /// Run.
    pub cycles: u32,
    /// Faults that were named, each with its cycle.
    pub false_alarms: Vec<(u32, String)>,
    /// What else was named: run-in and temperature.
    pub noted: Vec<(u32, String)>,
}

/// Runs `cycles` with `noise` and `follow` as in [`Healthy`]. After a false alarm events are cleared.
///
/// # Errors
/// A setup that one of its parts refuses.
pub fn run_healthy(
    (density, amplitude): (f64, f64),
    (noise, follow): (f64, f64),
    cycles: u32,
    seed: u64,
) -> Result<Healthy, SetupError> {
    let (specimen, condition) = Damaged::new(density, amplitude);
    let mut bench = Bench::new(setup(
        specimen,
        (amplitude, FREQUENCY),
        cycles,
        (noise, follow),
        seed,
    )?)?;
    bench.rig.start()?;
    let mut healthy = Healthy {
        density,
        amplitude,
        noise,
        follow,
        cycles: 0,
        false_alarms: Vec::new(),
        noted: Vec::new(),
    };
    while bench.rig.state() == State::Running {
        let telemetry = bench.tick();
        if let Some(event) = telemetry.event {
            let named = (telemetry.cycle, format!("{:?}", event.cause));
            if event.cause.is_fault() {
                healthy.false_alarms.push(named);
                bench.rig.clear_events();
            } else {
                healthy.noted.push(named);
            }
        }
        if let Some(report) = telemetry.report {
            healthy.cycles += 1;
            let cycle = f64::from(report.cycle);
            let (loss, settling) = RUN_IN;
            let left = 1.0 - loss * (1.0 - (-cycle / settling).exp());
            let (rise, warming) = CHAMBER;
            let (swing, period) = SWING;
            let temperature = REFERENCE_TEMPERATURE
                + rise * (1.0 - (-cycle / warming).exp())
                + swing * (std::f64::consts::TAU * cycle / period).sin();
            condition.set(Condition {
                stiffness: left,
                friction: left,
                temperature,
                warm_loss: WARM_LOSS,
                ..Condition::NEW
            });
        }
    }
    Ok(healthy)
}

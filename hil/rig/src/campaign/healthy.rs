//! Many cycles of a healthy specimen, which settles after its start and is warmed and cooled, in noisy surroundings.

use mesh_damper::health::Channel;
use mesh_damper::rig::State;
use serde::Serialize;

use super::damage::{Condition, Damaged};
use super::rig::{peak, setup};
use crate::signals::{Interference, OnChannel, OnTemperature};
use crate::specimen::REFERENCE_TEMPERATURE;
use crate::{Bench, RigSetup, SetupError};

/// Frequency, Hz: the fewest ticks per cycle, and thus the most noise.
const FREQUENCY: f64 = 10.0;
/// Part of its force that it loses while it beds in, and the cycles of that.
const RUN_IN: (f64, f64) = (0.1, 25.0);
/// Loss of force per degree, 1/°C.
const WARM_LOSS: f64 = 0.004;
/// Temperature rise of a chamber in °C with the number of cycles in which it warms, and a swing about it with its number of cycles.
const CHAMBER: (f64, f64) = (20.0, 600.0);
const SWING: (f64, f64) = (5.0, 1000.0);

/// Disturbances during the test. The specimen settles and the chamber warms in all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Surroundings {
    /// No further disturbance.
    Settling,
    /// Both channels pick up the mains, 0.2 % of their amplitudes.
    Hum,
    /// Bursts of 2 ms on both channels, up to 1 % of their amplitudes, every other cycle.
    Bursts,
    /// The rig is stopped in the middle of a block and started again.
    Pauses,
    /// Blocks of several amplitudes.
    Blocks,
    /// The temperature has noise of ±0.5 °C.
    TemperatureNoise,
}

impl Surroundings {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Settling,
        Self::Hum,
        Self::Bursts,
        Self::Pauses,
        Self::Blocks,
        Self::TemperatureNoise,
    ];

    /// Its interference with the signals, for channels with amplitudes of these voltages.
    fn interference(self, volts: [f64; 2]) -> Vec<Interference> {
        let channels = [Channel::Displacement, Channel::Force]
            .into_iter()
            .zip(volts);
        match self {
            Self::Hum => channels
                .map(|(channel, volts)| {
                    let hum = OnChannel::Hum {
                        volts: 0.002 * volts,
                        frequency: 50.0,
                    };
                    Interference::Channel(channel, hum)
                })
                .collect(),
            Self::Bursts => channels
                .map(|(channel, volts)| {
                    let bursts = OnChannel::Bursts {
                        volts: 0.01 * volts,
                        every: 2000,
                        samples: 20,
                    };
                    Interference::Channel(channel, bursts)
                })
                .collect(),
            Self::TemperatureNoise => {
                vec![Interference::Temperature(OnTemperature::Noise(0.5))]
            }
            Self::Settling | Self::Pauses | Self::Blocks => Vec::new(),
        }
    }

    /// Amplitudes relative to the largest one, with the part of the cycles of each.
    fn blocks(self) -> &'static [(f64, f64)] {
        match self {
            Self::Blocks => &[(0.6, 0.25), (1.0, 0.25), (0.8, 0.25), (0.5, 0.25)],
            _ => &[(1.0, 1.0)],
        }
    }
}

/// Cycles from one pause to the next.
const PAUSE_EVERY: u32 = 60;

/// Results of a healthy run.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Healthy {
    /// Density, g/cm³.
    pub density: f64,
    /// Amplitude, mm.
    pub amplitude: f64,
    /// RMS of the force channel's noise over the RMS of the force.
    pub noise: f64,
    /// Largest adaptation to slow changes, as a fraction of the law's coefficients; 0 without adaptation.
    pub follow: f64,
    /// Disturbances during the test.
    pub surroundings: Surroundings,
    /// Number of cycles run.
    pub cycles: u32,
    /// Reported faults and stops, each with its cycle.
    pub false_alarms: Vec<(u32, String)>,
    /// Other reports, which are no faults: run-in and temperature.
    pub noted: Vec<(u32, String)>,
}

/// Runs `cycles` with `noise` and `follow` as in [`Healthy`]. After a false alarm the events are cleared, and a stopped rig is
/// started again.
///
/// # Errors
/// A setup that one of its parts rejects.
pub fn run_healthy(
    (density, amplitude): (f64, f64),
    (noise, follow): (f64, f64),
    surroundings: Surroundings,
    cycles: u32,
    seed: u64,
) -> Result<Healthy, SetupError> {
    let (specimen, condition) = Damaged::new(density, amplitude);
    let blocks: Vec<(f64, u32)> = surroundings
        .blocks()
        .iter()
        .map(|(size, part)| (size * amplitude, (part * f64::from(cycles)).ceil() as u32))
        .collect();
    let force = peak(&specimen, amplitude, FREQUENCY);
    let setup: RigSetup<Damaged, 4, 1> =
        setup(specimen, &blocks, FREQUENCY, (noise, follow), seed)?;
    let volts = |value: f64, full_scale: f64| value / full_scale * 10.24;
    let volts = [
        volts(amplitude, setup.displacement_sensor.full_scale),
        volts(force, setup.force_sensor.full_scale),
    ];
    let mut bench = Bench::new(setup)?;
    for what in surroundings.interference(volts) {
        bench.plant.signals.begin(what);
    }
    bench.rig.start()?;
    let mut healthy = Healthy {
        density,
        amplitude,
        noise,
        follow,
        surroundings,
        cycles: 0,
        false_alarms: Vec::new(),
        noted: Vec::new(),
    };
    while healthy.cycles < cycles {
        let telemetry = bench.tick();
        let state = bench.rig.state();
        if let Some(event) = telemetry.event {
            let named = (healthy.cycles, format!("{:?}", event.cause));
            if event.cause.is_fault() {
                healthy.false_alarms.push(named);
                bench.rig.clear_events();
            } else {
                healthy.noted.push(named);
            }
        }
        if let Some(report) = telemetry.report {
            healthy.cycles += 1;
            let cycle = f64::from(healthy.cycles);
            condition.set(settled(cycle));
            let is_due = healthy.cycles.is_multiple_of(PAUSE_EVERY) && !report.ramp;
            if surroundings == Surroundings::Pauses && is_due {
                bench.rig.stop();
            }
        }
        match state {
            State::Running => {}
            State::Done if healthy.cycles > 0 && surroundings != Surroundings::Pauses => break,
            State::Faulted(cause) => {
                if telemetry.command == 0.0 {
                    let stopped = format!("stop: {cause:?}");
                    healthy.false_alarms.push((healthy.cycles, stopped));
                    // A rig at rest can clear its fault.
                    if bench.rig.clear().is_err() || bench.rig.start().is_err() {
                        break;
                    }
                }
            }
            // A start is refused until the rig has come to rest.
            State::Idle | State::Done => {
                if telemetry.command == 0.0 {
                    bench.rig.start()?;
                }
            }
        }
    }
    Ok(healthy)
}

/// The specimen after this many cycles.
fn settled(cycle: f64) -> Condition {
    let (loss, settling) = RUN_IN;
    let left = 1.0 - loss * (1.0 - (-cycle / settling).exp());
    let (rise, warming) = CHAMBER;
    let (swing, period) = SWING;
    let temperature = REFERENCE_TEMPERATURE
        + rise * (1.0 - (-cycle / warming).exp())
        + swing * (std::f64::consts::TAU * cycle / period).sin();
    Condition {
        stiffness: left,
        friction: left,
        temperature,
        warm_loss: WARM_LOSS,
        ..Condition::NEW
    }
}

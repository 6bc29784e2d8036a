//! Transmissibility: the motion of a mass relative to the sine motion of its base, over frequency and amplitude.

use std::f64::consts::TAU;

use mesh_damper_recording::trajectory::TrajectoryPolicy;
use serde::Serialize;

use super::oscillator::{Input, Oscillator};
use super::specimen::Specimen;
use super::{RespondError, Settings};
use crate::Model;

/// Steps in a cycle of the base, and in a cycle of the mass on its damper, in the finer of two runs.
const STEPS_PER_CYCLE: f64 = 512.0;
/// Cycles between two checks whether the motion is steady.
const CYCLES: usize = 8;
/// Most cycles of one point.
const MOST_CYCLES: usize = 1024;
/// The motion is steady when its amplitude and phase change by less than this fraction between two checks.
const STEADY: f64 = 1e-4;

/// The frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepRange {
    /// The first, Hz, 1e-3…1e5.
    pub from: f64,
    /// The last, Hz.
    pub to: f64,
    /// Their number, evenly spaced in octaves, 2…10 000.
    pub points: usize,
}

/// A sine of the base, and the steady motion of the mass that follows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SweepPoint {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Amplitude of the base, mm.
    pub base_amplitude: f64,
    /// Fundamental of the mass's displacement over that of the base.
    pub transmissibility: f64,
    /// Phase of that fundamental ahead of the base's fundamental, degrees, −180…180.
    pub phase: f64,
    /// Largest displacement of the mass from its mean, over the amplitude of the base.
    pub peak: f64,
    /// Half of the peak-to-peak displacement of the damper, mm.
    pub damper_amplitude: f64,
    /// Largest speed of the damper, mm/s.
    pub damper_speed: f64,
    /// Number of cycles until the motion was steady.
    pub cycles: usize,
    /// Whether the motion became steady; false for a motion that does not repeat from cycle to cycle.
    pub steady: bool,
    /// Change of the fundamental when the time steps were halved, as a fraction of the fundamental.
    pub change: f64,
}

/// Transmissibility over frequency and amplitude.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sweep {
    /// The points, amplitude by amplitude, in order of frequency at each.
    pub points: Vec<SweepPoint>,
    /// Mass of the model's own effect `inertia`, kg.
    pub model_mass: f64,
    /// Effects that act on the mass differently than in a prediction.
    pub left_out: Vec<super::LeftOut>,
}

/// The steady motion of a mass on the damper of `model`, whose base moves by sines of `amplitudes` mm. Each run begins at rest: if
/// two steady motions exist, it finds the one that is reached from rest. `progress` receives the number of completed points.
///
/// # Errors
/// As [`super::respond`]; a range or an amplitude is out of range.
pub fn sweep(
    model: &Model,
    settings: &Settings,
    amplitudes: &[f64],
    range: SweepRange,
    progress: &mut dyn FnMut(usize),
) -> Result<Sweep, RespondError> {
    settings.check()?;
    range.check()?;
    let specimen = Specimen::new(model, settings.mass, settings.offset)?;
    let mut points = Vec::new();
    for &amplitude in amplitudes {
        if !(1e-9..=1e4).contains(&amplitude) {
            return Err(RespondError::Value {
                field: "amplitudes",
                value: amplitude,
                problem: "is outside 1e-9…1e4 mm".into(),
                remedy: "give amplitudes of the base in mm",
            });
        }
        for frequency in range.frequencies() {
            points.push(steady(&specimen, settings, amplitude, frequency)?);
            progress(points.len());
        }
    }
    Ok(Sweep {
        points,
        model_mass: specimen.model_mass,
        left_out: specimen.left_out,
    })
}

impl SweepRange {
    fn check(&self) -> Result<(), RespondError> {
        let wrong = |field, value, problem: &str, remedy| {
            Err(RespondError::Value {
                field,
                value,
                problem: problem.into(),
                remedy,
            })
        };
        if !(1e-3..=1e5).contains(&self.from) {
            return wrong(
                "from",
                self.from,
                "is outside 1e-3…1e5 Hz",
                "give a frequency in Hz",
            );
        }
        if !(self.to > self.from && self.to <= 1e5) {
            return wrong(
                "to",
                self.to,
                "is not between the first frequency and 1e5 Hz",
                "give a frequency above the first, in Hz",
            );
        }
        if !(2..=10_000).contains(&self.points) {
            return wrong(
                "points",
                self.points as f64,
                "is outside 2…10000",
                "give as many frequencies as the curve needs",
            );
        }
        Ok(())
    }

    fn frequencies(self) -> impl Iterator<Item = f64> {
        let ratio = self.to / self.from;
        let last = (self.points - 1) as f64;
        (0..self.points).map(move |index| self.from * ratio.powf(index as f64 / last))
    }
}

/// One steady motion, from two runs, one with steps twice as long.
fn steady(
    specimen: &Specimen,
    settings: &Settings,
    amplitude: f64,
    frequency: f64,
) -> Result<SweepPoint, RespondError> {
    let omega = TAU * frequency;
    let faster = (specimen.fastest() / omega).max(1.0);
    let steps = 2 * (0.5 * STEPS_PER_CYCLE * faster).ceil() as usize;
    let coarse = run(specimen, settings, amplitude, frequency, steps / 2)?;
    let mut fine = run(specimen, settings, amplitude, frequency, steps)?;
    let apart = (fine.fundamental[0] - coarse.fundamental[0])
        .hypot(fine.fundamental[1] - coarse.fundamental[1]);
    let size = fine.fundamental[0].hypot(fine.fundamental[1]);
    fine.point.change = if apart > 0.0 { apart / size } else { 0.0 };
    Ok(fine.point)
}

struct Run {
    point: SweepPoint,
    /// Components of the mass's displacement along the base's sine and along its cosine, mm.
    fundamental: [f64; 2],
}

/// Runs cycles of `steps` steps until the motion repeats itself.
fn run(
    specimen: &Specimen,
    settings: &Settings,
    amplitude: f64,
    frequency: f64,
    steps: usize,
) -> Result<Run, RespondError> {
    let omega = TAU * frequency;
    let input = |index: usize| {
        let part = (index % steps) as f64 / steps as f64;
        Input {
            force: 0.0,
            base: amplitude * (TAU * part).sin(),
            temperature: TrajectoryPolicy::in_use().room,
            controls: settings.controls,
        }
    };
    let step = 1.0 / (frequency * steps as f64);
    let (mut oscillator, _) = Oscillator::new(
        specimen,
        step,
        settings.start,
        (&input(0), amplitude * omega),
    )?;
    let mut last = [f64::INFINITY; 2];
    for cycle in 1.. {
        let is_look = cycle % CYCLES == 0;
        let mut fundamental = [0.0; 2];
        let (mut mass, mut damper) = ([f64::MAX, f64::MIN], [f64::MAX, f64::MIN]);
        let mut speed = 0.0_f64;
        for index in 1..=steps {
            let now = oscillator.step(&input(index))?;
            if !is_look {
                continue;
            }
            let (sin, cos) = (TAU * index as f64 / steps as f64).sin_cos();
            let weight = 2.0 / steps as f64;
            fundamental[0] += weight * sin * now.displacement;
            fundamental[1] += weight * cos * now.displacement;
            for (range, value) in [
                (&mut mass, now.displacement),
                (&mut damper, now.relative_displacement),
            ] {
                *range = [range[0].min(value), range[1].max(value)];
            }
            speed = speed.max(now.relative_velocity.abs());
        }
        if !is_look {
            continue;
        }
        let size = fundamental[0].hypot(fundamental[1]);
        let change = (fundamental[0] - last[0]).hypot(fundamental[1] - last[1]);
        let steady = change <= STEADY * size.max(1e-6 * amplitude);
        if steady || cycle >= MOST_CYCLES {
            return Ok(Run {
                point: SweepPoint {
                    frequency,
                    base_amplitude: amplitude,
                    transmissibility: size / amplitude,
                    phase: fundamental[1].atan2(fundamental[0]).to_degrees(),
                    peak: 0.5 * (mass[1] - mass[0]) / amplitude,
                    damper_amplitude: 0.5 * (damper[1] - damper[0]),
                    damper_speed: speed,
                    cycles: cycle,
                    steady,
                    change: 0.0,
                },
                fundamental,
            });
        }
        last = fundamental;
    }
    unreachable!("the last cycle returns")
}

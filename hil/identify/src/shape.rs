//! The ranges within which shapes are searched, and where a search starts: spread over what the data can show.

use std::f64::consts::TAU;

use mesh_damper_recording::trajectory::Trajectory;

use super::term::Form;

/// The highest frequency is so many times the lowest where there are several.
const SEVERAL: f64 = 1.2;

/// Range and starts of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Where a search starts.
    pub starts: Vec<f64>,
    /// Below this the effect is a simpler one as far as the data can show.
    pub simple_below: f64,
    /// Above this likewise.
    pub simple_above: f64,
}

impl Shape {
    /// `count` starts spread evenly over the logarithm of the range, the outermost one step inside.
    fn spread(low: f64, high: f64, count: usize) -> Self {
        let step = (high / low).powf(1.0 / (count + 1) as f64);
        Self {
            low,
            high,
            starts: (1..=count).map(|i| low * step.powi(i as i32)).collect(),
            simple_below: 1.02 * low,
            simple_above: high / 1.02,
        }
    }

    /// Whether the effect with this value can't be told from a simpler one.
    pub fn is_limit(&self, value: f64) -> bool {
        value < self.simple_below || value > self.simple_above
    }
}

/// What the recordings of a fit reach: it bounds what can be found in them.
#[derive(Clone, Debug, PartialEq)]
pub struct Extent {
    /// Largest displacement either way, mm.
    above: f64,
    below: f64,
    amplitude: f64,
    /// s
    duration: f64,
    /// Longest, s.
    tick: f64,
    /// Noise of the displacement, mm.
    noise: f64,
    cycles: f64,
    /// Hz
    lowest_frequency: f64,
    highest_frequency: f64,
    /// Largest force over largest displacement, kN/mm.
    stiffness: f64,
    /// Tones that stand out of what eq 13 leaves, Hz.
    tones: Vec<f64>,
}

impl Extent {
    /// The extent of `trajectories`.
    pub fn of(trajectories: &[Trajectory]) -> Self {
        let displacement = || {
            trajectories
                .iter()
                .flat_map(|t| t.motion.displacement.iter().copied())
        };
        let force = largest(
            trajectories
                .iter()
                .flat_map(|t| t.force.iter().map(|force| force.abs())),
        );
        let frequencies = || {
            let blocks = trajectories.iter().flat_map(|t| &t.blocks);
            blocks.map(|block| block.frequency)
        };
        let (above, below) = (largest(displacement()), largest(displacement().map(|y| -y)));
        Self {
            above,
            below,
            amplitude: largest(
                trajectories
                    .iter()
                    .flat_map(|t| t.amplitude.iter().copied()),
            ),
            duration: largest(trajectories.iter().map(|t| t.len() as f64 * t.tick)),
            tick: largest(trajectories.iter().map(|t| t.tick)),
            noise: largest(trajectories.iter().map(|t| t.motion.noise)),
            cycles: largest(trajectories.iter().filter_map(|t| t.cycles.last().copied())),
            lowest_frequency: frequencies().fold(f64::INFINITY, f64::min),
            highest_frequency: largest(frequencies()),
            stiffness: force / above.max(below),
            tones: Vec::new(),
        }
    }

    /// The same with the tones that a search for one starts from, Hz.
    #[must_use]
    pub fn with_tones(&self, tones: Vec<f64>) -> Self {
        Self {
            tones,
            ..self.clone()
        }
    }

    /// Ranges and starts of the shapes of `form`.
    pub fn shapes(&self, form: Form) -> Vec<Shape> {
        // A smaller length than the noise shows cannot be told from an error of the velocity at a reversal.
        let shortest = (5.0 * self.noise)
            .max(1e-3 * self.amplitude)
            .min(0.4 * self.amplitude);
        match form {
            // An element that hardly slips is a spring.
            Form::Jenkins => vec![Shape::spread(shortest, 0.9 * self.amplitude, 10)],
            // The largest of the limits, of which the others are even parts.
            Form::Iwan => vec![Shape::spread(6.0 * shortest, 0.9 * self.amplitude, 6)],
            Form::BoucWen => vec![
                Shape::spread(shortest, 2.0 * self.amplitude, 8),
                Shape {
                    starts: vec![1.0, 2.5],
                    ..Shape::spread(0.5, 8.0, 2)
                },
            ],
            Form::StopAbove => vec![Shape::spread(0.02 * self.above, 0.98 * self.above, 16)],
            Form::StopBelow => vec![Shape::spread(0.02 * self.below, 0.98 * self.below, 16)],
            Form::Gap | Form::DampedGap => {
                vec![Shape::spread(2.0 * shortest, 0.9 * self.amplitude, 8)]
            }
            // With ω·time below 0.3 the branch is a dashpot within a tenth, beyond 1/0.1 a spring.
            // At one frequency any branch is a spring and a dashpot, and none of them is simpler than the truth may be.
            Form::Relaxation => {
                let spread = Shape::spread(0.5 * self.tick, self.duration, 12);
                if self.highest_frequency < SEVERAL * self.lowest_frequency {
                    return vec![spread];
                }
                vec![Shape {
                    simple_below: 0.2 / (TAU * self.highest_frequency),
                    simple_above: 10.0 / (TAU * self.lowest_frequency),
                    ..spread
                }]
            }
            Form::Drift | Form::DriftOfEach => vec![Shape::spread(0.3, 10.0 * self.cycles, 8)],
            Form::Delay => {
                let longest = (0.2 / self.lowest_frequency).min(250.0 * self.tick);
                vec![Shape::spread(0.02 * self.tick, longest, 9)]
            }
            // A softer spring would take up more than the whole displacement.
            Form::Compliance => vec![Shape::spread(
                1.3 * self.stiffness,
                200.0 * self.stiffness,
                6,
            )],
            Form::Periodic => vec![Shape {
                starts: self.tones.clone(),
                ..Shape::spread(4.0 / self.duration, 0.499 / self.tick, 1)
            }],
            Form::Offset
            | Form::Asymmetry
            | Form::Hardening
            | Form::Viscous
            | Form::Inertia
            | Form::Temperature
            | Form::TemperatureOfEach => Vec::new(),
        }
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::MIN_POSITIVE, f64::max)
}

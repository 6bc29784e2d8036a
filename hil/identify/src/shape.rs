//! The ranges within which shapes are searched, and where a search starts: spread over what the data can show.

use mesh_damper_recording::trajectory::Trajectory;

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
    pub(crate) fn spread(low: f64, high: f64, count: usize) -> Self {
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
    pub(crate) above: f64,
    pub(crate) below: f64,
    pub(crate) amplitude: f64,
    /// s
    pub(crate) duration: f64,
    /// Longest, s.
    pub(crate) tick: f64,
    /// Noise of the displacement, mm.
    pub(crate) noise: f64,
    pub(crate) cycles: f64,
    /// Hz
    pub(crate) lowest_frequency: f64,
    pub(crate) highest_frequency: f64,
    /// Largest force over largest displacement, kN/mm.
    pub(crate) stiffness: f64,
    /// Tones that stand out of what eq 13 leaves, Hz.
    pub(crate) tones: Vec<f64>,
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

    /// The shortest length that can be searched, mm. A smaller one than the noise shows cannot be told from an error of the
    /// velocity at a reversal.
    pub(crate) fn shortest(&self) -> f64 {
        (5.0 * self.noise)
            .max(1e-3 * self.amplitude)
            .min(0.4 * self.amplitude)
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::MIN_POSITIVE, f64::max)
}

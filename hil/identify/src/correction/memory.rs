//! The memories that a correction may depend on in addition to displacement and velocity, tried one after the other.

use mesh_damper_model::correction::Remembered;
use mesh_damper_recording::trajectory::Trajectory;
use serde::{Deserialize, Serialize};

use super::design::{Coefficients, Design};
use super::edges;

mesh_damper_recording::numbers! {
    /// The memories that a residual table may have in place of speed.
    MemoryPolicy {
        /// The kinds of memory that are tried for a residual table.
        kinds: Vec<MemoryKind> = KINDS.to_vec(),
            Tuned("the unlisted effects of the blind trial, and the recordings of others: each kind is best for some of them");
        /// The first step by which an edge is moved, as a fraction of the largest displacement; each later step is half of the one before.
        edge: f64 = 0.025, Derived("half of a zone in which edges are searched for first");
        /// The averaging time of a mean speed is at most this fraction of the longest block. A memory that hardly changes within a block
        /// would tell blocks apart, whatever it remembers.
        lasting: f64 = 0.5, Tuned("the blind trial");
        /// The shortest averaging time that is tried, as a fraction of the period of the fastest motion.
        shortest: f64 = 0.02, Derived("that motion then lags by an eighth of a radian");
        /// The shortest averaging time that is tried has at least this many ticks.
        shortest_in_ticks: f64 = 2.0, Derived("a shorter lag only leads to the next sample");
        /// The shortest averaging time of a mean speed, as a multiple of that of a displacement (see `shortest`).
        travel: f64 = 5.0, Tuned("the blind trial");
        /// The smallest and the largest slip limit that are tried, as fractions of the largest displacement.
        slip: [f64; 2] = [0.05, 0.8], Tuned("the blind trial");
        /// The shortest first step of the time since the start, which grows in powers of two, as a fraction of the duration of the
        /// recording.
        age: f64 = 0.01, Tuned("the blind trial");
        /// The frequency of the motion is averaged over this fraction of a period: of the fastest motion, of the slowest, and between.
        period: f64 = 0.5, Derived("half a period lies between one reversal and the next");
        /// The best limit or time of a memory is multiplied by these factors to find a better one.
        around: [f64; 4] = [0.65, 0.8, 1.25, 1.55], Tuned("the blind trial");
    }
}

/// The directions in which two edges may move: first the upper one alone.
const WAYS: [[f64; 2]; 6] = [
    [0.0, -1.0],
    [0.0, 1.0],
    [-1.0, 0.0],
    [1.0, 0.0],
    [-1.0, 1.0],
    [1.0, -1.0],
];

/// The kinds that are tried, in this order.
const KINDS: [MemoryKind; 9] = [
    MemoryKind::Slip,
    MemoryKind::Lag,
    MemoryKind::Travel,
    MemoryKind::Largest,
    MemoryKind::Age,
    MemoryKind::Temperature,
    MemoryKind::Place,
    MemoryKind::Frequency,
    MemoryKind::Sides,
];

/// The quantity on the axis of a residual table in place of speed. The amplitude of the motion, its cycles and its acceleration are
/// not available: they explained none of the 130 unlisted effects of the blind trial, and were chosen in none of the recordings
/// from other sources.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum MemoryKind {
    /// The deflection of a friction element, as a fraction of its slip limit.
    Slip,
    /// The earlier displacement, smoothed.
    Lag,
    /// The mean speed over some time.
    Travel,
    /// The largest displacement so far.
    Largest,
    /// The time since the start.
    Age,
    /// The temperature.
    Temperature,
    /// The displacement in finer steps.
    Place,
    /// The frequency of the motion over some time.
    Frequency,
    /// The side of one or two edges on which the displacement is.
    Sides,
}

impl MemoryKind {
    /// The limits or times that are tried first. Convention: about a factor of two apart, for times a factor of five.
    fn tried(self) -> i32 {
        match self {
            Self::Slip | Self::Lag => 6,
            Self::Travel => 5,
            Self::Age | Self::Frequency => 3,
            Self::Largest | Self::Temperature | Self::Place | Self::Sides => 1,
        }
    }
}

/// Whether it remembers how long a test has run. A temperature that only rises is also such a clock. But a temperature that stays
/// constant within every block of a test was varied on purpose.
pub(super) fn goes_on_with_time(of: Remembered) -> bool {
    matches!(of, Remembered::Age { .. })
}

/// The number of sides with a contact.
pub(super) fn sides(of: Remembered, design: &Design) -> usize {
    match of {
        Remembered::Sides { below, .. } if below <= -design.reach.displacement => 1,
        Remembered::Sides { .. } => 2,
        _ => 0,
    }
}

/// The possible memories, kind by kind, each with its limit or time over the whole range that the data can show, together with eq
/// 13 at `at`.
pub(super) fn kinds(design: &Design, at: &Coefficients) -> Vec<Vec<Remembered>> {
    let policy = MemoryPolicy::in_use();
    let trajectories = design.trajectories;
    let reach = design.reach.displacement;
    let longest =
        |value: fn(&Trajectory) -> f64| trajectories.iter().map(value).fold(0.0, f64::max);
    let (slowest, fastest) = design.frequencies();
    let duration = longest(|t| t.len() as f64 * t.tick);
    let tick = longest(|t| t.tick);
    let block = longest(|t| {
        let samples = t.blocks.iter().map(|block| block.samples.len());
        samples.max().unwrap_or_default() as f64 * t.tick
    });
    let lasting = policy.lasting * block;
    // From a time with which the fastest motion hardly lags to one with which the slowest has disappeared.
    let short = (policy.shortest / fastest).max(policy.shortest_in_ticks * tick);
    let long = (1.0 / slowest).min(duration).max(2.0 * short);
    let kind = |kind: &MemoryKind| {
        let spread = |low: f64, high: f64, of| vec![spread(low, high, kind.tried(), of)];
        match kind {
            MemoryKind::Slip => {
                let [least, most] = policy.slip;
                spread(least * reach, most * reach, |limit| Remembered::Slip {
                    limit,
                })
            }
            MemoryKind::Lag => spread(short, long, |time| Remembered::Lag { time }),
            MemoryKind::Travel => {
                let short = policy.travel * short;
                spread(short, lasting.max(2.0 * short), |time| Remembered::Travel {
                    time,
                })
            }
            MemoryKind::Largest => vec![vec![Remembered::Largest]],
            MemoryKind::Age => spread(policy.age * duration, duration, |time| Remembered::Age {
                time,
            }),
            MemoryKind::Temperature => vec![vec![Remembered::Temperature]],
            MemoryKind::Place => vec![vec![Remembered::Place]],
            MemoryKind::Frequency => {
                spread(policy.period / fastest, policy.period / slowest, |time| {
                    Remembered::Frequency { time }
                })
            }
            MemoryKind::Sides => {
                let sides = edges::likely_sides(design, at).into_iter();
                sides.flatten().collect()
            }
        }
    };
    policy.kinds.iter().flat_map(kind).collect()
}

/// The same kind with a slightly smaller and a slightly larger limit or time, or with its edges a little to either side. The
/// changes shrink with every round of `sought`.
pub(super) fn around(of: Remembered, sought: u32, design: &Design) -> Vec<Remembered> {
    let reach = design.reach.displacement;
    if let Remembered::Sides { below, above } = of {
        let step = 0.5_f64.powi(sought as i32) * MemoryPolicy::in_use().edge * reach;
        let ways = if sides(of, design) == 1 {
            &WAYS[..2]
        } else {
            &WAYS
        };
        let moved = ways
            .iter()
            .map(|[a, b]| [below + a * step, above + b * step]);
        let uncrossed = moved.filter(|[below, above]| below < above);
        let sides = uncrossed.map(|[below, above]| Remembered::Sides { below, above });
        return sides.collect();
    }
    if sought > 0 {
        return Vec::new();
    }
    let scaled = |factor: f64| match of {
        Remembered::Slip { limit } => Some(Remembered::Slip {
            limit: factor * limit,
        }),
        Remembered::Lag { time } => Some(Remembered::Lag {
            time: factor * time,
        }),
        Remembered::Travel { time } => Some(Remembered::Travel {
            time: factor * time,
        }),
        Remembered::Frequency { time } => Some(Remembered::Frequency {
            time: factor * time,
        }),
        Remembered::Largest
        | Remembered::Temperature
        | Remembered::Place
        | Remembered::Sides { .. } => None,
        Remembered::Age { time } => Some(Remembered::Age {
            time: factor * time,
        }),
    };
    let factors = MemoryPolicy::in_use().around.into_iter();
    factors.filter_map(scaled).collect()
}

/// `count` numbers from `low` to `high` in equal ratios, passed through `of`.
fn spread(low: f64, high: f64, count: i32, of: fn(f64) -> Remembered) -> Vec<Remembered> {
    let step = (high / low).powf(1.0 / f64::from(count - 1));
    (0..count).map(|i| of(low * step.powi(i))).collect()
}

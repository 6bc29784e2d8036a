//! What a correction may be over beside displacement and velocity, tried one after the other.

use mesh_damper_model::correction::Remembered;
use mesh_damper_recording::trajectory::Trajectory;

use super::design::Design;

/// The first step of an edge, over the largest displacement.
const EDGE: f64 = 0.025;
/// How two edges may move: the upper one alone first.
const WAYS: [[f64; 2]; 6] = [
    [0.0, -1.0],
    [0.0, 1.0],
    [-1.0, 0.0],
    [1.0, 0.0],
    [-1.0, 1.0],
    [1.0, -1.0],
];

/// Whether it remembers how long a test has run. A temperature that only rises is such a clock too, but one that stands still
/// within every block of a test is just how it is varied.
pub(super) fn goes_on_with_time(of: Remembered) -> bool {
    matches!(of, Remembered::Age { .. } | Remembered::Cycles { .. })
}

/// On how many sides something touches.
pub(super) fn sides(of: Remembered, design: &Design) -> usize {
    match of {
        Remembered::Sides { below, .. } if below <= -design.extent.displacement => 1,
        Remembered::Sides { .. } => 2,
        _ => 0,
    }
}

/// All kinds but sides, each with its limit or time over all that the data can show.
pub(super) fn kinds(design: &Design) -> Vec<Vec<Remembered>> {
    let trajectories = design.trajectories;
    let reach = design.extent.displacement;
    let longest =
        |value: fn(&Trajectory) -> f64| trajectories.iter().map(value).fold(0.0, f64::max);
    let (slowest, fastest) = design.frequencies();
    let duration = longest(|t| t.len() as f64 * t.tick);
    let cycles = longest(|t| t.cycles.last().copied().unwrap_or_default());
    let tick = longest(|t| t.tick);
    let block = longest(|t| {
        let samples = t.blocks.iter().map(|block| block.samples.len());
        samples.max().unwrap_or_default() as f64 * t.tick
    });
    // What hardly changes within a block would tell blocks apart, whatever it is of.
    let lasting = 0.5 * block;
    // From where the fastest motion hardly lags to where the slowest has lost it.
    let short = (0.02 / fastest).max(2.0 * tick);
    let long = (1.0 / slowest).min(duration).max(2.0 * short);
    vec![
        spread(0.05 * reach, 0.8 * reach, 6, |limit| Remembered::Slip {
            limit,
        }),
        spread(short, long, 6, |time| Remembered::Lag { time }),
        spread(5.0 * short, lasting.max(10.0 * short), 5, |time| {
            Remembered::Travel { time }
        }),
        // Over longer it would be a clock.
        spread(long, lasting.max(2.0 * long), 4, |time| Remembered::Level {
            time,
        }),
        vec![Remembered::Largest],
        spread(0.01 * duration, duration, 3, |time| Remembered::Age {
            time,
        }),
        spread(0.01 * cycles.max(1.0), cycles.max(1.0), 3, |cycles| {
            Remembered::Cycles { cycles }
        }),
        vec![Remembered::Temperature],
        vec![Remembered::Acceleration],
        vec![Remembered::Place],
        spread(0.5 / fastest, 0.5 / slowest, 3, |time| {
            Remembered::Frequency { time }
        }),
    ]
}

/// The same kind with its limit or time a little smaller and a little larger, or its edges a little to either side: the less,
/// the more often they were `sought`.
pub(super) fn around(of: Remembered, sought: u32, design: &Design) -> Vec<Remembered> {
    let reach = design.extent.displacement;
    if let Remembered::Sides { below, above } = of {
        let step = 0.5_f64.powi(sought as i32) * EDGE * reach;
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
        Remembered::Level { time } => Some(Remembered::Level {
            time: factor * time,
        }),
        Remembered::Frequency { time } => Some(Remembered::Frequency {
            time: factor * time,
        }),
        Remembered::Largest
        | Remembered::Temperature
        | Remembered::Acceleration
        | Remembered::Place
        | Remembered::Sides { .. } => None,
        Remembered::Age { time } => Some(Remembered::Age {
            time: factor * time,
        }),
        Remembered::Cycles { cycles } => Some(Remembered::Cycles {
            cycles: factor * cycles,
        }),
    };
    let factors = [0.65, 0.8, 1.25, 1.55].into_iter();
    factors.filter_map(scaled).collect()
}

/// `of` `count` numbers from `low` to `high` in equal ratios.
fn spread(low: f64, high: f64, count: i32, of: fn(f64) -> Remembered) -> Vec<Remembered> {
    let step = (high / low).powf(1.0 / f64::from(count - 1));
    (0..count).map(|i| of(low * step.powi(i))).collect()
}

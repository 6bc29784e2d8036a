//! How far what was counted is from f64: the same lines over the same inputs, run on the host.

use mesh_damper::power::{PowerSeed, PowerTable};
use serde::Serialize;

use super::count::Count;
use super::exact::{Exact, ExactCycle};
use super::suite::tally::{Meter, Region, Tally, When};
use super::suite::{self, Refused, power, tick};
use crate::reference::tables;

/// The largest error of something against f64.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LargestError {
    /// What was called, as in [`Count::name`].
    pub name: String,
    /// Which of its results, and over what the error is taken.
    pub of: &'static str,
    /// The error, without a unit.
    pub error: f64,
}

/// Calls, and keeps the checksum of what comes back.
#[derive(Default)]
struct Replay(Vec<(String, String, u32)>);

impl Meter for Replay {
    fn call<C>(&mut self, region: Region<C>, context: &mut C, a: f32, b: f32) -> (u32, f32) {
        (0, region(context, a, b))
    }

    fn report(&mut self, name: &str, moment: &str, tally: &Tally) {
        self.0.push((name.into(), moment.into(), tally.checksum));
    }
}

/// The counts whose results are not, bit by bit, those of the host, as `name moment`; and those that are missing.
///
/// # Errors
/// As the suite.
pub fn strangers(counts: &[Count]) -> Result<Vec<String>, Refused> {
    let mut replay = Replay::default();
    suite::cortex_m4f(&mut replay)?;
    let differs = |(name, moment, checksum): &(String, String, u32)| {
        !counts.iter().any(|count| {
            count.name == *name && count.moment == *moment && count.checksum == *checksum
        })
    };
    let strange = replay.0.iter().filter(|of_host| differs(of_host));
    Ok(strange
        .map(|(name, moment, _)| format!("{name} {moment}"))
        .collect())
}

/// The largest value of many; NaN once there was one.
fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |most: f64, value| {
        let value = value.abs();
        if value.is_nan() || value > most {
            value
        } else {
            most
        }
    })
}

/// Of every form of |v|^α over its own size.
///
/// # Errors
/// None: every value is in its range.
pub fn powers() -> Result<Vec<LargestError>, Refused> {
    let inputs = |alpha: f32| {
        (0..power::VELOCITIES).map(move |index| {
            let v = power::velocity(index);
            (v, f64::from(v).powf(f64::from(alpha)))
        })
    };
    let relative = |result: f32, exact: f64| f64::from(result) / exact - 1.0;
    let of = "|v|^α over itself";
    let mut errors: Vec<LargestError> = power::FORMS
        .iter()
        .map(|&(name, region)| LargestError {
            name: name.into(),
            of,
            error: largest(power::ALPHAS.into_iter().flat_map(|alpha| {
                inputs(alpha).map(move |(v, exact)| relative(region(&mut (), v, alpha), exact))
            })),
        })
        .collect();
    let (name, region) = power::TABULATED;
    let mut worst = Vec::new();
    for alpha in power::ALPHAS {
        let mut table = PowerTable::new(&PowerSeed::new(1.0, f64::from(alpha))?);
        let all = inputs(alpha).map(|(v, exact)| relative(region(&mut table, v, 0.0), exact));
        worst.push(largest(all));
    }
    errors.push(LargestError {
        name: name.into(),
        of,
        error: largest(worst),
    });
    Ok(errors)
}

/// Of the whole tick's force over the cycle's peak, and of K, ΔW and η over themselves, at full amplitude.
///
/// # Errors
/// None: every value is in its range.
pub fn ticks() -> Result<Vec<LargestError>, Refused> {
    // Force, K, ΔW, η.
    let mut worst = [0.0; 4];
    for ((_, amplitude, law), (_, own)) in tables::cells().zip(tick::laws()) {
        let exact = Exact { law, amplitude };
        let errors = of_cell(&exact, tick::Whole::new(amplitude as f32, own)?);
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = largest([*worst, error]);
        }
    }
    let of = [
        "force over its peak",
        "K over itself",
        "ΔW over itself",
        "η over itself",
    ];
    let error = |(of, error)| LargestError {
        name: "tick/whole".into(),
        of,
        error,
    };
    Ok(of.into_iter().zip(worst).map(error).collect())
}

/// The largest errors of force, K, ΔW and η of one law.
fn of_cell(exact: &Exact, mut whole: tick::Whole) -> [f64; 4] {
    let mut worst = [0.0; 4];
    let cycles: Vec<ExactCycle> = (0..6).map(|index| exact.cycle(index)).collect();
    let peak = largest((0..2000).map(|n| exact.sample(n).1));
    let mut ended = 0;
    for n in 0.. {
        let force = f64::from(whole.tick());
        let relative = |own: f32, exact: f64| f64::from(own) / exact - 1.0;
        let errors = match (whole.when, &whole.cycle, cycles.get(ended)) {
            (When::Done, ..) => break,
            // The first cycle is the ramp's.
            (_, Some(own), Some(cycle)) if ended > 0 => [
                relative(own.stiffness, cycle.stiffness),
                relative(own.energy, cycle.energy),
                relative(own.loss_factor, cycle.loss_factor),
            ],
            _ => [0.0; 3],
        };
        ended += usize::from(whole.cycle.is_some());
        let of_force = if whole.when == When::Ramp {
            0.0
        } else {
            (force - exact.sample(n).1) / peak
        };
        let all = [of_force].into_iter().chain(errors);
        for (worst, error) in worst.iter_mut().zip(all) {
            *worst = largest([*worst, error]);
        }
    }
    worst
}

/// By how much of itself a cycle of the peer in C may differ from f64: it adds up in plain f32.
const PEER_TOLERANCE: f64 = 2e-5;

/// Whether the peer's last cycle of every law, as K, ΔW and η, is that of f64: that it does the same work.
///
/// # Errors
/// What is different.
pub fn check_peer(results: &[(String, Vec<f32>)]) -> Result<(), String> {
    let cells: Vec<_> = tables::cells().collect();
    if results.len() != cells.len() {
        return Err("the peer in C gives another number of cycles".into());
    }
    // The last that ends within the ticks that it is run for.
    let last = (f64::from(tick::NAIVE_TICKS) * tick::FREQUENCY / tick::TICK_RATE) as u64 - 1;
    for ((_, own), (_, amplitude, law)) in results.iter().zip(cells) {
        let exact = Exact { law, amplitude }.cycle(last);
        let expected = [exact.stiffness, exact.energy, exact.loss_factor];
        let same = own
            .iter()
            .zip(expected)
            .all(|(own, exact)| (f64::from(*own) / exact - 1.0).abs() <= PEER_TOLERANCE);
        if own.len() != expected.len() || !same {
            return Err(format!(
                "the peer in C gives {own:?} as K, ΔW and η where f64 gives {expected:?}"
            ));
        }
    }
    Ok(())
}

//! The errors of the counted code against f64: the same lines over the same inputs, run on the host.

use std::fmt;

use mesh_damper::fixed_point::Part;
use mesh_damper::power::{PowerSeed, PowerTable};
use mesh_damper_firmware::bench::suite::tally::{Meter, Region, Tally, When};
use mesh_damper_firmware::bench::suite::{self, Refused, fixed_point, power, tick};
use mesh_damper_reference::tables;
use serde::Serialize;

use super::count::{Core, Count};
use super::exact::{Exact, ExactCycle};

/// The largest error of a result against f64.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LargestError {
    /// The function, named as in [`Count::name`].
    pub name: String,
    /// The result of the function and the reference of the error.
    pub of: &'static str,
    /// The error, dimensionless.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub error: f64,
}

/// Calls the functions, and keeps the checksum of their results.
#[derive(Default)]
struct Replay(Vec<(String, String, u32)>);

impl Meter for Replay {
    fn call<C>(&mut self, region: Region<C>, context: &mut C, a: f32, b: f32) -> (u32, f32) {
        (0, region(context, a, b))
    }

    fn report(&mut self, name: impl fmt::Display, moment: &str, tally: &Tally) {
        self.0
            .push((name.to_string(), moment.into(), tally.checksum));
    }
}

/// The counts of `core` whose results differ from the host's in any bit, as `name moment`; and those that are missing.
///
/// # Errors
/// Errors of the suite.
pub fn mismatches(core: Core, counts: &[Count]) -> Result<Vec<String>, Refused> {
    let mut replay = Replay::default();
    match core {
        Core::CortexM4f => suite::cortex_m4f(&mut replay)?,
        Core::CortexM0 => suite::cortex_m0(&mut replay)?,
    }
    let differs = |(name, moment, checksum): &(String, String, u32)| {
        !counts.iter().any(|count| {
            count.name == *name && count.moment == *moment && count.checksum == *checksum
        })
    };
    let different = replay.0.iter().filter(|of_host| differs(of_host));
    Ok(different
        .map(|(name, moment, _)| format!("{name} {moment}"))
        .collect())
}

/// The largest of several values; NaN if any is NaN.
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

/// Errors of every form of |v|^α, relative to its value.
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

/// Errors of the whole tick's force over the cycle's peak, and of K, ΔW and η relative to themselves, at full amplitude: in floats
/// and in integers.
///
/// # Errors
/// None: every value is in its range.
pub fn ticks() -> Result<Vec<LargestError>, Refused> {
    let mut floats = [0.0; 4];
    let mut integers = [0.0; 4];
    for ((_, amplitude, law), (own_amplitude, own)) in tables::cells().zip(tick::laws()) {
        let exact = Exact { law, amplitude };
        let mut test = tick::simulation(own_amplitude, own)?;
        let mut whole = tick::Whole::new(&mut test);
        exact.judge(&mut floats, Exact::demanded_cycle, || {
            let force = f64::from(whole.told(|whole| tick::tick(whole, 0.0, 0.0)));
            let cycle = whole.cycle.map(|c| [c.stiffness, c.energy, c.loss_factor]);
            (force, cycle.map(|cycle| cycle.map(f64::from)), whole.when)
        });
        let mut whole = fixed_point::Whole::new(own_amplitude, &own)?;
        exact.judge(&mut integers, Exact::cycle, || {
            let part = Part::from_bits(whole.tick().to_bits() as i32);
            let force = part.to_num::<f64>() * whole.scales.force();
            let cycle = whole.cycle.map(|cycle| cycle.over(&whole.scales));
            let cycle = cycle.map(|c| [c.stiffness, c.energy, c.loss_factor].map(f64::from));
            (force, cycle, whole.when)
        });
    }
    let of = [
        "force over its peak",
        "K over itself",
        "ΔW over itself",
        "η over itself",
    ];
    let errors = |name: &str, worst: [f64; 4]| {
        of.into_iter()
            .zip(worst)
            .map(|(of, error)| LargestError {
                name: name.to_owned(),
                of,
                error,
            })
            .collect::<Vec<_>>()
    };
    Ok([errors("tick/whole", floats), errors("fixed/tick", integers)].concat())
}

impl Exact {
    /// Runs `tick` to the end, and raises `worst` (force, K, ΔW, η) to the errors of its results. `tick` returns the force in kN,
    /// the completed cycle, as K, ΔW and η, and the events. `cycle_of` gives the true results of a cycle. `worst` is NaN unless
    /// every cycle at full amplitude appeared.
    fn judge(
        &self,
        worst: &mut [f64; 4],
        cycle_of: impl Fn(&Self, u64) -> ExactCycle,
        mut tick: impl FnMut() -> (f64, Option<[f64; 3]>, When),
    ) {
        let peak = largest((0..2000).map(|n| self.sample(n).1));
        let mut ended = 0;
        for n in 0.. {
            let (force, cycle, when) = tick();
            if when == When::Done {
                break;
            }
            let mut errors = [0.0; 4];
            if when != When::Ramp {
                errors[0] = (force - self.sample(n).1) / peak;
            }
            if let Some(cycle) = cycle {
                // The first cycle belongs to the ramp.
                if ended > 0 {
                    let exact = cycle_of(self, ended).parts();
                    for ((error, own), exact) in errors.iter_mut().skip(1).zip(cycle).zip(exact) {
                        *error = own / exact - 1.0;
                    }
                }
                ended += 1;
            }
            for (worst, error) in worst.iter_mut().zip(errors) {
                *worst = largest([*worst, error]);
            }
        }
        if ended != u64::from(tick::CYCLES) + 1 {
            *worst = [f64::NAN; 4];
        }
    }
}

/// Tolerance of a cycle of the C peer against f64, relative: it sums in plain f32.
const PEER_TOLERANCE: f64 = 2e-5;

/// Checks that the peer's last cycle of every law, as K, ΔW and η, equals that of f64: so it does the same work.
///
/// # Errors
/// The differences.
pub fn check_peer(results: &[(String, Vec<f32>)]) -> Result<(), String> {
    let cells: Vec<_> = tables::cells().collect();
    if results.len() != cells.len() {
        return Err("the peer in C gives another number of cycles".into());
    }
    // The last cycle that ends within its ticks.
    let last = (f64::from(tick::NAIVE_TICKS) * tick::FREQUENCY / tick::TICK_RATE) as u64 - 1;
    for ((_, own), (_, amplitude, law)) in results.iter().zip(cells) {
        let expected = Exact { law, amplitude }.cycle(last).parts();
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The tick of f64 itself, with the K `stiffness`, and `cycles` cycles.
    fn judged(cycles: u32, stiffness: f64) -> [f64; 4] {
        let (_, amplitude, law) = tables::cells().next().unwrap();
        let exact = Exact { law, amplitude };
        let ends: Vec<u64> = (1..=u64::from(cycles))
            .map(|cycle| (cycle as f64 * tick::TICK_RATE / tick::FREQUENCY).ceil() as u64)
            .collect();
        let mut n = 0;
        let mut worst = [0.0; 4];
        exact.judge(&mut worst, Exact::cycle, || {
            let (_, force) = exact.sample(n);
            let cycle = ends.iter().position(|end| *end == n).map(|index| {
                let [k, energy, loss_factor] = exact.cycle(index as u64).parts();
                [k * stiffness, energy, loss_factor]
            });
            n += 1;
            let when = if n == 6000 { When::Done } else { When::Steady };
            (force, cycle, when)
        });
        worst
    }

    #[test]
    fn an_error_is_seen_and_a_cycle_that_did_not_come_is_no_cycle_without_error() {
        let cycles = tick::CYCLES + 1;
        assert_eq!(judged(cycles, 1.0), [0.0; 4]);
        let [force, stiffness, energy, loss_factor] = judged(cycles, 0.999);
        assert!((stiffness - 1e-3).abs() < 1e-12);
        assert_eq!([force, energy, loss_factor], [0.0; 3]);
        for fewer in [0, cycles - 1] {
            assert!(judged(fewer, 1.0).iter().all(|error| error.is_nan()));
        }
    }

    #[test]
    fn a_peer_that_comes_to_other_cycles_is_refused() {
        let last = (f64::from(tick::NAIVE_TICKS) * tick::FREQUENCY / tick::TICK_RATE) as u64 - 1;
        let good: Vec<(String, Vec<f32>)> = tables::cells()
            .map(|(_, amplitude, law)| {
                let parts = Exact { law, amplitude }.cycle(last).parts();
                ("tick/c".into(), parts.map(|part| part as f32).into())
            })
            .collect();
        assert_eq!(check_peer(&good), Ok(()));
        assert!(check_peer(&good[1..]).is_err());
        for part in 0..3 {
            let mut bad = good.clone();
            bad[7].1[part] *= 1.0 + 3.0 * PEER_TOLERANCE as f32;
            assert!(check_peer(&bad).unwrap_err().contains("where f64 gives"));
        }
    }
}

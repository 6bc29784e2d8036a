//! Effects without a family in the tracer: behaviour of a specimen or its rig that is not in the list of families.

use std::f64::consts::TAU;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use super::branch::Step;
use super::list::effects;

/// Relaxation times of [`Unlisted::Fractional`], from the first on, three per decade over five decades, s.
const FIRST_RELAXATION_TIME: f64 = 1e-3;
const RELAXATION_TIMES: usize = 16;
const TIMES_PER_DECADE: f64 = 3.0;
/// Sines that make up [`Unlisted::RandomWalk`], the longest with a period of four times [`WALK_DURATION`].
const WALK_TERMS: usize = 80;
/// Duration for which the sum is a random walk, s; later it repeats.
const WALK_DURATION: f64 = 100.0;

effects! {
    /// An effect without a family.
    #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    #[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
    enum Unlisted {
        /// F = μ·|y|·sgn v: friction under a load that grows with displacement.
        LoadFriction = "load_friction" {
            /// Coefficient of friction times load per displacement, μ, kN/mm.
            mu: "kN/mm" scaled,
        }
        /// F = f·e^(−(v/vs)²)·sgn v: friction that weakens with velocity (Stribeck).
        VelocityWeakening = "velocity_weakening" {
            /// Force f, kN.
            force: "kN" scaled,
            /// Velocity vs, mm/s.
            velocity: "mm/s",
        }
        /// F = a·y·v.
        CrossLinear = "cross_linear" {
            /// Coefficient a, kN·s/mm².
            a: "kN*s/mm2" scaled,
        }
        /// F = a·y²·v: a dashpot that grows with displacement.
        CrossSquare = "cross_square" {
            /// Coefficient a, kN·s/mm³.
            a: "kN*s/mm3" scaled,
        }
        /// F = −f·ln(1 + t/t0): a preload that creeps.
        Creep = "creep" {
            /// Force f, kN.
            force: "kN" scaled,
            /// Time t0, s.
            time: "s",
        }
        /// F = −k·(1 − e^(−m/m0))·y with m the largest |y| so far: softening by the largest stretch (Mullins).
        Mullins = "mullins" {
            /// Stiffness k, kN/mm.
            stiffness: "kN/mm" scaled,
            /// Stretch m0, mm.
            stretch: "mm",
        }
        /// F = c·v·|v|: quadratic drag.
        QuadraticDrag = "quadratic_drag" {
            /// Coefficient c, kN·s²/mm².
            c: "kN*s2/mm2" scaled,
        }
        /// F = c·v for v > 0 only: a damper that pulls in one direction.
        OneWayDamping = "one_way_damping" {
            /// Damping c, kN·s/mm.
            c: "kN*s/mm" scaled,
        }
        /// F = c·v for y > 0 only: a damper with contact on one side.
        OneSidedDamping = "one_sided_damping" {
            /// Damping c, kN·s/mm.
            c: "kN*s/mm" scaled,
        }
        /// Relaxation on all time scales, with modulus ∝ t^−order (a spring-pot).
        Fractional = "fractional" {
            /// Stiffness at 1 s, kN/mm.
            stiffness: "kN/mm" scaled,
            /// Order of the spring-pot, 0…1.
            order: "1",
        }
        /// F = k·ln(frequency/1 Hz)·y with the frequency of the running block; 1 Hz if the frequency is not known.
        FrequencyStiffness = "frequency_stiffness" {
            /// Stiffness k, kN/mm.
            stiffness: "kN/mm" scaled,
        }
        /// F = f·e^(−((y − place)/width)²)·sgn v: friction at one position.
        PlaceFriction = "place_friction" {
            /// Force f, kN.
            force: "kN" scaled,
            /// Place, mm.
            place: "mm",
            /// Width, mm.
            width: "mm",
        }
        /// A zero of the load cell that drifts in a random walk.
        RandomWalk = "random_walk" {
            /// RMS after 1 s, kN.
            force: "kN" scaled,
            ;
            /// Seed of the walk.
            seed: u64,
        }
        /// A mass on a spring and a dashpot, hung on the moving end.
        Resonance = "resonance" {
            /// Mass, kg.
            mass: "kg" scaled,
            /// Natural frequency, Hz.
            frequency: "Hz",
            /// Damping ratio.
            damping: "1",
        }
    }
}

impl Unlisted {
    /// Whether its scales are above zero.
    pub(super) fn is_admissible(&self) -> bool {
        match *self {
            Self::VelocityWeakening { velocity, .. } => velocity > 0.0,
            Self::Creep { time, .. } => time > 0.0,
            Self::Mullins { stretch, .. } => stretch > 0.0,
            Self::Fractional { order, .. } => order > 0.0 && order < 1.0,
            Self::PlaceFriction { width, .. } => width > 0.0,
            Self::Resonance {
                frequency, damping, ..
            } => frequency > 0.0 && damping >= 0.0,
            _ => true,
        }
    }

    pub(super) fn at_rest(&self) -> Memory {
        match *self {
            Self::Mullins { .. } => Memory::Largest(0.0),
            Self::Fractional { .. } => Memory::Branches {
                stretch: [0.0; RELAXATION_TIMES],
                displacement: 0.0,
            },
            Self::RandomWalk { seed, .. } => Memory::Walk(walk(seed)),
            Self::Resonance { .. } => Memory::Mass {
                displacement: 0.0,
                velocity: 0.0,
                support: (0.0, 0.0),
            },
            _ => Memory::None,
        }
    }

    /// Force in addition to eq 13, kN.
    pub(super) fn force(&self, memory: &mut Memory, step: &Step) -> f64 {
        let (y, v) = (step.displacement, step.velocity);
        let sign = if v == 0.0 { 0.0 } else { v.signum() };
        match (*self, memory) {
            (Self::LoadFriction { mu }, _) => mu * y.abs() * sign,
            (Self::VelocityWeakening { force, velocity }, _) => {
                force * (-(v / velocity).powi(2)).exp() * sign
            }
            (Self::CrossLinear { a }, _) => a * y * v,
            (Self::CrossSquare { a }, _) => a * y * y * v,
            (Self::Creep { force, time }, _) => -force * (step.time / time).ln_1p(),
            (Self::Mullins { stiffness, stretch }, Memory::Largest(largest)) => {
                *largest = largest.max(y.abs());
                stiffness * (-*largest / stretch).exp_m1() * y
            }
            (Self::QuadraticDrag { c }, _) => c * v * v.abs(),
            (Self::OneWayDamping { c }, _) => c * v.max(0.0),
            (Self::OneSidedDamping { c }, _) => {
                if y > 0.0 {
                    c * v
                } else {
                    0.0
                }
            }
            (
                Self::Fractional { stiffness, order },
                Memory::Branches {
                    stretch,
                    displacement,
                },
            ) => {
                let moved = y - *displacement;
                *displacement = y;
                stiffness * relax(stretch, moved, step.dt, order)
            }
            (Self::FrequencyStiffness { stiffness }, _) => {
                stiffness * step.frequency.unwrap_or(1.0).ln() * y
            }
            (
                Self::PlaceFriction {
                    force,
                    place,
                    width,
                },
                _,
            ) => force * (-((y - place) / width).powi(2)).exp() * sign,
            (Self::RandomWalk { force, .. }, Memory::Walk(weights)) => {
                force * walked(weights, step.time)
            }
            (
                Self::Resonance {
                    mass,
                    frequency,
                    damping,
                },
                Memory::Mass {
                    displacement,
                    velocity,
                    support,
                },
            ) => {
                let omega = TAU * frequency;
                let acceleration = swing(
                    (displacement, velocity),
                    support,
                    (y, v),
                    (omega, damping),
                    step.dt,
                );
                mass * 1e-6 * acceleration
            }
            _ => unreachable!("at_rest() gives every effect its own memory"),
        }
    }
}

/// State of an [`Unlisted`] effect.
#[derive(Clone, Debug)]
pub(super) enum Memory {
    None,
    /// The largest past |y|, mm.
    Largest(f64),
    Branches {
        stretch: [f64; RELAXATION_TIMES],
        displacement: f64,
    },
    /// Weights of the walk's sines.
    Walk(Vec<f64>),
    Mass {
        displacement: f64,
        velocity: f64,
        /// Displacement and velocity of its support at the last call.
        support: (f64, f64),
    },
}

/// Maxwell branches with relaxation times spread evenly over the logarithm, whose moduli sum to t^−`order` between the first time
/// and the last; returns their force for unit stiffness.
///
/// ∫ τ^−order·e^(−t/τ) d ln τ = Γ(order)·t^−order.
fn relax(stretch: &mut [f64], moved: f64, dt: f64, order: f64) -> f64 {
    let step = std::f64::consts::LN_10 / TIMES_PER_DECADE;
    let mut force = 0.0;
    for (i, x) in stretch.iter_mut().enumerate() {
        let time = FIRST_RELAXATION_TIME * (i as f64 * step).exp();
        // Exact for a velocity that is constant over the step.
        let part = dt / time;
        let kept = if part > 0.0 {
            -(-part).exp_m1() / part
        } else {
            1.0
        };
        *x = *x * (-part).exp() + moved * kept;
        force += time.powf(-order) * *x;
    }
    force * step / libm::tgamma(order)
}

/// Weights of a random walk in its principal components (Karhunen–Loève), which are sines, over [`WALK_DURATION`].
fn walk(seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..WALK_TERMS)
        .map(|_| StandardNormal.sample(&mut rng))
        .collect()
}

/// √(2T)·Σ z_k·sin(ω_k·t)/(ω_k·T), ω_k = (k − ½)·π/T, whose variance at t is t over 1 s.
fn walked(weights: &[f64], time: f64) -> f64 {
    let sum: f64 = weights
        .iter()
        .enumerate()
        .map(|(k, weight)| {
            let turns = (k as f64 + 0.5) * std::f64::consts::PI;
            weight * (turns * time / WALK_DURATION).sin() / turns
        })
        .sum();
    (2.0 * WALK_DURATION).sqrt() * sum
}

/// Moves a mass on a spring by one step of constant average acceleration (Newmark, β = ¼) and returns its acceleration.
fn swing(
    (x, v): (&mut f64, &mut f64),
    support: &mut (f64, f64),
    (y, w): (f64, f64),
    (omega, damping): (f64, f64),
    dt: f64,
) -> f64 {
    let pull = |stretch: f64, rate: f64| omega * omega * stretch + 2.0 * damping * omega * rate;
    let before = pull(support.0 - *x, support.1 - *v);
    let coasting_x = *x + dt * *v + 0.25 * dt * dt * before;
    let coasting_v = *v + 0.5 * dt * before;
    let after = pull(y - coasting_x, w - coasting_v)
        / (1.0 + omega * omega * 0.25 * dt * dt + damping * omega * dt);
    *x = coasting_x + 0.25 * dt * dt * after;
    *v = coasting_v + 0.5 * dt * after;
    *support = (y, w);
    after
}

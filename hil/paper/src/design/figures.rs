//! Dynamic stiffness and loss factor of eq 13 under a sine, without sampling.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use mesh_damper_reference::dynamic_test::{characterize, elastic_potential, loss_factor};
use mesh_damper_reference::law::Coefficients;
use serde::Serialize;

use crate::amplitude_independent::Sine;

/// Phases at which the largest force is searched for; it may have two maxima if the cubic stiffens a lot.
const PHASES: usize = 48;
/// Steps that then narrow it down, each to 0.62 of the width: to 1e-8 of a radian.
const STEPS: usize = 32;

/// Samples of a cycle that is sampled.
const SAMPLES: usize = 4000;

/// K and η of one cycle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Figures {
    /// Dynamic stiffness, eq 3, kN/mm.
    pub stiffness: f64,
    /// Dynamic loss factor, eq 4.
    pub loss_factor: f64,
}

impl Figures {
    /// For `law` under A·sin(ωt), `amplitude` A in mm, `frequency` in Hz.
    ///
    /// The force is odd over half a cycle, so that K = F_max/A; and with v = Aω·cos θ
    ///
    /// ```text
    /// ΔW = 4A·c·(Aω)^α·∫₀^{π/2} cos^{1+α} θ dθ = 4A·c·(Aω)^α·(√π/2)·Γ(1 + α/2)/Γ(3/2 + α/2)
    /// ```
    pub fn of(law: &Coefficients, amplitude: f64, frequency: f64) -> Self {
        let damping = law.damping_force(TAU * frequency * amplitude);
        let force = |phase: f64| {
            let (sin, cos) = phase.sin_cos();
            law.elastic_force(amplitude * sin) + damping * cos.abs().powf(law.alpha)
        };
        let stiffness = largest(force) / amplitude;
        let half = 0.5 * law.alpha;
        let integral = 0.5 * PI.sqrt() * libm::tgamma(1.0 + half) / libm::tgamma(1.5 + half);
        let dissipated = 4.0 * amplitude * damping * integral;
        Self {
            stiffness,
            loss_factor: loss_factor(dissipated, elastic_potential(stiffness, amplitude)),
        }
    }

    /// For the same loop from its samples and eqs 3–7, as for a recording: an independent way to the same figures.
    pub fn of_samples(law: &Coefficients, amplitude: f64, frequency: f64) -> Option<Self> {
        let sine = Sine::new(amplitude, frequency, SAMPLES);
        let found = characterize(&sine.displacement, &sine.force(law))?;
        Some(Self {
            stiffness: found.stiffness,
            loss_factor: found.loss_factor,
        })
    }
}

/// The largest value of a function of phase between 0 and π/2.
fn largest(function: impl Fn(f64) -> f64) -> f64 {
    let step = FRAC_PI_2 / PHASES as f64;
    let mut best = (0, f64::NEG_INFINITY);
    for i in 0..=PHASES {
        let value = function(step * i as f64);
        if value > best.1 {
            best = (i, value);
        }
    }
    let (mut low, mut high) = (
        step * best.0.saturating_sub(1) as f64,
        step * (best.0 + 1).min(PHASES) as f64,
    );
    // Golden section.
    let part = 0.5 * (5_f64.sqrt() - 1.0);
    let inner = |low: f64, high: f64| (high - part * (high - low), low + part * (high - low));
    let (mut a, mut b) = inner(low, high);
    let (mut at_a, mut at_b) = (function(a), function(b));
    for _ in 0..STEPS {
        if at_a > at_b {
            (high, b, at_b) = (b, a, at_a);
            a = inner(low, high).0;
            at_a = function(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = inner(low, high).1;
            at_b = function(b);
        }
    }
    best.1.max(at_a).max(at_b)
}

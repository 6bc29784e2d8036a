//! Relaxation of the shear by a Prony series, eqs 11 and 12, for finite strains.
//!
//! The isochoric second Piola–Kirchhoff stress S relaxes in the same way as the deviatoric stress in eq 11. With the history H_i(t)
//! = ∫ exp(−(t − s)/τ_i)·Ṡ(s) ds of each term, the stress is g∞·S + Σ g_i·H_i. This is Simo's model in Holzapfel's form. At small
//! strains it is eq 11 with a constant bulk modulus, for which the paper gives no series.

use nalgebra::Vector6;

/// Number of terms in a series.
const TERMS: usize = 2;

/// G(t)/G(0) = g∞ + Σ g_i·exp(−t/τ_i), with g∞ = 1 − Σ g_i: the elastic constants give the response to a sudden strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prony {
    /// g_i, the share of the shear modulus that relaxes.
    pub shares: [f64; TERMS],
    /// τ_i, s.
    pub times: [f64; TERMS],
}

impl Prony {
    /// g∞: the fraction that remains.
    pub fn lasting(&self) -> f64 {
        1.0 - self.shares.iter().sum::<f64>()
    }

    /// G(t)/G(0) at `time` s: g∞ + Σ g_i·exp(−t/τ_i).
    pub fn left_after(&self, time: f64) -> f64 {
        let terms = self.shares.iter().zip(&self.times);
        self.lasting()
            + terms
                .map(|(share, tau)| share * (-time / tau).exp())
                .sum::<f64>()
    }

    /// Storage and loss modulus over the instantaneous one at `frequency` Hz: g∞ + Σ g_i·(ωτ_i)²/(1 + (ωτ_i)²) and Σ g_i·ωτ_i/(1 +
    /// (ωτ_i)²).
    pub fn moduli(&self, frequency: f64) -> (f64, f64) {
        let omega = std::f64::consts::TAU * frequency;
        let terms = self.shares.iter().zip(&self.times);
        terms.fold((self.lasting(), 0.0), |(storage, loss), (share, time)| {
            let x = omega * time;
            let part = share * x / (1.0 + x * x);
            (storage + part * x, loss + part)
        })
    }
}

/// One time step of every history: H(t + Δt) = exp(−Δt/τ)·H(t) + w·(S(t + Δt) − S(t)), exact if S changes linearly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    lasting: f64,
    shares: [f64; TERMS],
    decays: [f64; TERMS],
    weights: [f64; TERMS],
}

impl Step {
    pub fn new(prony: &Prony, duration: f64) -> Self {
        let ratio = prony.times.map(|time| duration / time);
        Self {
            lasting: prony.lasting(),
            shares: prony.shares,
            decays: ratio.map(|x| (-x).exp()),
            weights: ratio.map(|x| -(-x).exp_m1() / x),
        }
    }

    /// Weight of a change of S in the stress at the end of the step.
    pub fn factor(&self) -> f64 {
        let terms = self.shares.iter().zip(&self.weights);
        self.lasting + terms.map(|(share, weight)| share * weight).sum::<f64>()
    }
}

/// The history of one point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct History {
    stress: Vector6<f64>,
    terms: [Vector6<f64>; TERMS],
}

impl History {
    /// The part of the stress at the end of `step` that does not depend on the strain there; the rest is
    /// [`Step::factor`] times S.
    pub fn memory(&self, step: &Step) -> Vector6<f64> {
        let mut memory = Vector6::zeros();
        for (i, term) in self.terms.iter().enumerate() {
            memory += (term * step.decays[i] - self.stress * step.weights[i]) * step.shares[i];
        }
        memory
    }

    /// Ends `step` at the isochoric stress `stress`.
    pub fn advance(&mut self, step: &Step, stress: Vector6<f64>) {
        for (i, term) in self.terms.iter_mut().enumerate() {
            *term = *term * step.decays[i] + (stress - self.stress) * step.weights[i];
        }
        self.stress = stress;
    }

    /// The terms after infinitely many periods like the one that led from `start` to here: the change over the period, divided by
    /// the fraction of itself that a term loses in it.
    pub fn repeat(&mut self, start: &Self, prony: &Prony, period: f64) {
        for (i, term) in self.terms.iter_mut().enumerate() {
            let decay = (-period / prony.times[i]).exp();
            *term = (*term - start.terms[i] * decay) / (1.0 - decay);
        }
    }
}

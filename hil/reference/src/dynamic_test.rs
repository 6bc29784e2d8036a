//! Dynamic stiffness and loss factor of one cycle, eqs 3–7.

use std::f64::consts::{PI, TAU};

/// Results of one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DynamicResult {
    /// Largest force F_max, kN.
    pub force_max: f64,
    /// Smallest force F_min, kN.
    pub force_min: f64,
    /// Peak motion amplitude X0, mm: half the difference between the displacement's extremes.
    pub amplitude: f64,
    /// Dynamic stiffness K, eq 3, kN/mm.
    pub stiffness: f64,
    /// Energy dissipation ΔW, eq 5, kN·mm = J.
    pub dissipated: f64,
    /// Elastic potential W, eq 6, J.
    pub elastic_potential: f64,
    /// Dynamic loss factor η_d, eq 4.
    pub loss_factor: f64,
}

/// Eq 3: K = (F_max − F_min) / (2·X0), kN/mm, from kN and mm.
pub fn stiffness(force_max: f64, force_min: f64, amplitude: f64) -> f64 {
    (force_max - force_min) / (2.0 * amplitude)
}

/// Eq 4: η_d = ΔW / (2π·W).
pub fn loss_factor(dissipated: f64, elastic_potential: f64) -> f64 {
    dissipated / (TAU * elastic_potential)
}

/// Eq 5: ΔW = −(2π·X0/N)·Σ Fᵢ·sin(2πi/N + α), J, over the N samples (kN, i = 1…N) of one cycle.
///
/// The equation is for the displacement X0·cos(2πi/N + α): for a sine that rises through 0 at i = 0, α = −π/2.
pub fn dissipated(force: &[f64], amplitude: f64, alpha: f64) -> f64 {
    -TAU * amplitude / force.len() as f64 * phase_sum(force, alpha)
}

/// Eq 6: W = ½·K·X0², J.
pub fn elastic_potential(stiffness: f64, amplitude: f64) -> f64 {
    0.5 * stiffness * amplitude * amplitude
}

/// Eq 7: η_d = −4f / (f0·(F_max − F_min))·Σ Fᵢ·sin(2πi/N + α), with the excitation frequency f and the sampling frequency f0, both
/// Hz. It combines eqs 4–6, because N = f0/f.
pub fn loss_factor_from_samples(
    force: &[f64],
    excitation_frequency: f64,
    sampling_frequency: f64,
    alpha: f64,
) -> f64 {
    let (min, max) = extremes(force);
    -4.0 * excitation_frequency / (sampling_frequency * (max - min)) * phase_sum(force, alpha)
}

/// The smallest and the largest of `values`.
fn extremes(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| {
            (low.min(value), high.max(value))
        })
}

/// Σ Fᵢ·sin(2πi/N + α), i = 1…N.
fn phase_sum(force: &[f64], alpha: f64) -> f64 {
    let count = force.len() as f64;
    force
        .iter()
        .enumerate()
        .map(|(i, f)| f * (TAU * (i + 1) as f64 / count + alpha).sin())
        .sum()
}

/// Eqs 3–6 over the samples of one whole cycle, equally spaced in time: displacement in mm, force in kN.
///
/// α is the phase of the displacement's first harmonic.
///
/// `None` for fewer than 3 samples, for unequal lengths or without motion.
pub fn characterize(displacement: &[f64], force: &[f64]) -> Option<DynamicResult> {
    if displacement.len() != force.len() || force.len() < 3 {
        return None;
    }
    let (displacement_min, displacement_max) = extremes(displacement);
    let amplitude = 0.5 * (displacement_max - displacement_min);
    if !(amplitude.is_finite() && amplitude > 0.0) {
        return None;
    }
    // X0·cos(θ + α) has Σ x·cos θ ∝ cos α and Σ x·sin θ ∝ −sin α.
    let alpha = (-phase_sum(displacement, 0.0)).atan2(phase_sum(displacement, 0.5 * PI));
    let (force_min, force_max) = extremes(force);
    let stiffness = stiffness(force_max, force_min, amplitude);
    let dissipated = dissipated(force, amplitude, alpha);
    let elastic_potential = elastic_potential(stiffness, amplitude);
    Some(DynamicResult {
        force_max,
        force_min,
        amplitude,
        stiffness,
        dissipated,
        elastic_potential,
        loss_factor: loss_factor(dissipated, elastic_potential),
    })
}

/// ∮F dx over a closed loop by the trapezoidal rule, J: the generalization of eq 5 to any motion.
pub fn loop_area(displacement: &[f64], force: &[f64]) -> f64 {
    let count = displacement.len().min(force.len());
    (0..count)
        .map(|i| {
            let next = (i + 1) % count;
            0.5 * (force[i] + force[next]) * (displacement[next] - displacement[i])
        })
        .sum()
}

//! Storage and loss stiffness of a cycle: the part of the force's fundamental that is in phase with the displacement, and the part that
//! leads it by a quarter.
//!
//! With y = Y_c·cos φ + Y_s·sin φ and F = F_c·cos φ + F_s·sin φ, the fundamentals over the phase φ, the dynamic stiffness is
//! K* = F/y as complex numbers, K* = K′ + i·K″:
//!
//! ```text
//! K′ = (F_s·Y_s + F_c·Y_c)/Y²       K″ = (F_c·Y_s − F_s·Y_c)/Y²       Y² = Y_s² + Y_c²       η = K″/K′
//! ```
//!
//! A spring k parallel to a dashpot c has K′ = k, K″ = c·ω and η = c·ω/k. Coulomb friction of ±F has K″ = 4F/(π·Y). The
//! fundamentals do the work π·K″·Y² in a cycle, which is eq 5 of the paper. The paper's loss factor of eq 4 is K″ divided by the
//! stiffness of eq 3, between the force's extremes, and is less than η.
//!
//! Fundamentals are fitted by least squares together with a mean and two harmonics, so that samples need not fill a cycle exactly.
//! A force that drifts by D in a cycle has a fundamental of D/π, which cannot be distinguished from the specimen's.

use std::f64::consts::{PI, TAU};

use nalgebra::{Cholesky, SMatrix, SVector};

/// Terms of the fit: the mean, and cosine and sine of three harmonics.
const TERMS: usize = 7;
/// Fewest samples of a cycle: more than twice the number of terms.
pub const FEWEST: usize = 16;

/// Storage and loss stiffness of a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DynamicStiffness {
    /// Y, the fundamental of the displacement, mm; > 0.
    pub amplitude: f64,
    /// Storage stiffness K′, kN/mm.
    pub storage: f64,
    /// Loss stiffness K″, kN/mm; below 0 if the specimen supplies energy.
    pub loss: f64,
}

impl DynamicStiffness {
    /// From the samples of a cycle, or of several equal ones: displacement in mm, force in kN, and the length of a cycle in
    /// samples, fractions included.
    ///
    /// `None` for fewer samples than [`FEWEST`] or than a cycle has, for a sample that is not finite, for different lengths, or
    /// without motion.
    pub fn of(displacement: &[f64], force: &[f64], cycle: f64) -> Option<Self> {
        let count = displacement.len();
        // A cycle may end between two samples.
        let is_whole = cycle >= FEWEST as f64 - 1.0 && count as f64 > cycle - 1.0;
        if count != force.len() || count < FEWEST || !is_whole {
            return None;
        }
        let mut gram = SMatrix::<f64, TERMS, TERMS>::zeros();
        let mut right = [SVector::<f64, TERMS>::zeros(); 2];
        for (index, values) in displacement.iter().zip(force).enumerate() {
            let (sin, cos) = (TAU * index as f64 / cycle).sin_cos();
            let (sin2, cos2) = (2.0 * sin * cos, cos * cos - sin * sin);
            let (sin3, cos3) = (sin2 * cos + cos2 * sin, cos2 * cos - sin2 * sin);
            let row = SVector::from([cos, sin, 1.0, cos2, sin2, cos3, sin3]);
            gram.syger(1.0, &row, &row, 1.0);
            right[0].axpy(*values.0, &row, 1.0);
            right[1].axpy(*values.1, &row, 1.0);
        }
        let factor = Cholesky::new(gram)?;
        let [y, f] = right.map(|right| factor.solve(&right));
        let square = y[0] * y[0] + y[1] * y[1];
        // At standstill rounding leaves a small fundamental.
        if square.sqrt() <= 1e-9 * y[2].abs() {
            return None;
        }
        let of = |sum: f64| Some(sum / square).filter(|value| value.is_finite());
        Some(Self {
            amplitude: square.sqrt(),
            storage: of(f[1] * y[1] + f[0] * y[0])?,
            loss: of(f[0] * y[1] - f[1] * y[0])?,
        })
    }

    /// η = K″/K′; not finite where K′ is 0.
    pub fn loss_factor(&self) -> f64 {
        self.loss / self.storage
    }

    /// The work of the fundamentals in a cycle, J: π·K″·Y².
    pub fn energy(&self) -> f64 {
        PI * self.loss * self.amplitude * self.amplitude
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AMPLITUDE: f64 = 0.12;
    /// Length of a cycle in samples, not a whole number.
    const CYCLE: f64 = 203.7;

    /// A cycle of a sine from this phase on, with the force that `force` returns for displacement and for velocity divided by
    /// ω·amplitude.
    fn cycle(phase: f64, force: impl Fn(f64, f64) -> f64) -> DynamicStiffness {
        let at = |i: usize| (TAU * i as f64 / CYCLE + phase).sin_cos();
        let samples = 0..CYCLE.ceil() as usize;
        let y: Vec<f64> = samples.clone().map(|i| AMPLITUDE * at(i).0).collect();
        let f: Vec<f64> = samples
            .map(|i| force(AMPLITUDE * at(i).0, at(i).1))
            .collect();
        DynamicStiffness::of(&y, &f, CYCLE).unwrap()
    }

    #[test]
    fn a_spring_beside_a_dashpot_has_k_and_c_omega() {
        let (k, c, omega) = (0.9, 0.004, TAU * 7.0);
        for phase in [0.0, 1.0, 4.0] {
            let found = cycle(phase, |y, v| k * y + c * omega * AMPLITUDE * v + 0.3);
            assert!((found.amplitude / AMPLITUDE - 1.0).abs() < 1e-9);
            assert!((found.storage / k - 1.0).abs() < 1e-9, "{found:?}");
            assert!((found.loss / (c * omega) - 1.0).abs() < 1e-9, "{found:?}");
            assert!((found.loss_factor() / (c * omega / k) - 1.0).abs() < 1e-9);
            // ∮F dy of a dashpot: π·c·ω·A².
            let energy = PI * c * omega * AMPLITUDE * AMPLITUDE;
            assert!((found.energy() / energy - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn coulomb_friction_has_four_over_pi_of_its_force() {
        let friction = 0.05;
        let found = cycle(0.3, |_, v| friction * v.signum());
        let loss = 4.0 * friction / (PI * AMPLITUDE);
        // A jump is located to half a step, π/N in phase. The force turns with the displacement, so that this moves K′ by up to π/N
        // of K″, and K″ by the square of that. Harmonics above the third add an error in an incomplete cycle.
        let step = PI / CYCLE;
        assert!(
            (found.loss / loss - 1.0).abs() < 0.2 * step,
            "{found:?} {loss}"
        );
        assert!(found.storage.abs() < step * loss, "{found:?}");
        // The work of friction is 4·F·A, all of it by the fundamental, because the motion is a sine.
        assert!((found.energy() / (4.0 * friction * AMPLITUDE) - 1.0).abs() < 0.2 * step);
    }

    #[test]
    fn a_cubic_spring_stores_three_quarters_of_its_stiffness_at_the_amplitude() {
        let found = cycle(2.0, |y, _| 20.0 * y.powi(3));
        let storage = 0.75 * 20.0 * AMPLITUDE * AMPLITUDE;
        assert!((found.storage / storage - 1.0).abs() < 1e-9, "{found:?}");
        assert!(found.loss.abs() < 1e-9);
    }

    /// A saw tooth of height D has the fundamental −D/π·sin φ.
    #[test]
    fn a_drift_counts_as_its_fundamental() {
        let (amplitude, drift) = (0.1, 0.02);
        let phase = |i: i32| TAU * f64::from(i) / 2000.0;
        let y: Vec<f64> = (0..2000).map(|i| amplitude * phase(i).sin()).collect();
        let f = (0..2000).map(|i| 2.0 * amplitude * phase(i).sin() + drift * phase(i) / TAU);
        let found = DynamicStiffness::of(&y, &f.collect::<Vec<f64>>(), 2000.0).unwrap();
        let storage = 2.0 - drift / (PI * amplitude);
        // Each sample begins its step: half a step of the tooth is D/(N·Y) of stiffness.
        let step = drift / (2000.0 * amplitude);
        let apart = (found.storage - storage).abs();
        assert!(apart < 2.0 * step, "{found:?} {storage}");
        assert!(found.loss.abs() < 2.0 * step, "{found:?}");
    }

    #[test]
    fn what_is_no_cycle_has_none() {
        let some = [1.0; 40];
        assert_eq!(DynamicStiffness::of(&some, &some, 40.0), None);
        assert_eq!(DynamicStiffness::of(&some[..10], &some[..10], 10.0), None);
        assert_eq!(DynamicStiffness::of(&some, &some[..39], 40.0), None);
        let y: Vec<f64> = (0..40).map(|i| f64::from(i).sin()).collect();
        assert_eq!(DynamicStiffness::of(&y, &[f64::NAN; 40], 40.0), None);
        // Half of a cycle.
        assert_eq!(DynamicStiffness::of(&y, &y, 80.0), None);
        assert_eq!(DynamicStiffness::of(&[], &[], 0.0), None);
    }
}

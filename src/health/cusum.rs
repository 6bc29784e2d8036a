//! Two-sided cumulative sums of prediction errors (Page, Biometrika 41, 1954).
//!
//! S⁺ ← max(0, S⁺ + e − κ), S⁻ ← max(0, S⁻ − e − κ), with an alarm if either exceeds H. For errors of standard deviation σ, with k
//! = κ/σ and b = H/σ + 1.166, the run length between false alarms of one side is (Siegmund, Sequential Analysis, 1985, ch. 2)
//!
//! ```text
//! ARL = (e^(2kb) − 2kb − 1)/(2k²)
//! ```
//!
//! and κ is half of the shift that is to be found soonest.

use crate::real::Real;

/// Excess of a random walk over its threshold, in standard deviations (Siegmund).
const EXCESS: f32 = 1.166;

/// The two sums.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cusum {
    up: f32,
    down: f32,
}

impl Cusum {
    /// Adds one `error` with an allowance of `slack`, both in the statistic's unit.
    pub(super) fn update(&mut self, error: f32, slack: f32) {
        self.up = positive(self.up + error - slack);
        self.down = positive(self.down - error - slack);
    }

    /// The larger sum.
    pub(super) fn largest(&self) -> f32 {
        if self.up > self.down {
            self.up
        } else {
            self.down
        }
    }
}

/// `x`, or 0 for a negative number and for NaN.
fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

/// The threshold H for errors of standard deviation `sigma` that gives one side a run length of `run_length` cycles with an
/// allowance of `slack`; 0 if the allowance alone is enough.
///
/// 2kb = ln(2k²·ARL + 1 + 2kb), iterated four times from 0. The logarithm is linear between powers of two, which is at most 0.06
/// too small; 0.06 is added.
pub(super) fn threshold(sigma: f32, slack: f32, run_length: f32) -> f32 {
    let k = slack / sigma;
    let mut exponent = 0.0;
    for _ in 0..4 {
        let x = 2.0 * k * k * run_length + 1.0 + exponent;
        exponent = x.half_octaves() as f32 * (core::f32::consts::LN_2 / 8192.0) + 0.06;
    }
    positive(exponent / (2.0 * k) - EXCESS) * sigma
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Siegmund's formula in f64.
    fn run_length(k: f64, h: f64) -> f64 {
        let x = 2.0 * k * (h + 1.166);
        (libm::exp(x) - x - 1.0) / (2.0 * k * k)
    }

    #[test]
    fn the_threshold_gives_the_run_length_of_siegmunds_formula() {
        for k in [0.25f32, 0.5, 1.0, 2.0] {
            for wanted in [370.0f32, 1e5, 1e7] {
                for sigma in [0.003f32, 1.0] {
                    let h = threshold(sigma, k * sigma, wanted) / sigma;
                    let given = run_length(k.into(), h.into());
                    // At least the required length, and no more than the logarithm's 0.06 and its addition cause.
                    let ratio = given / f64::from(wanted);
                    assert!((0.999..1.3).contains(&ratio), "k {k}, {wanted}: {given}");
                }
            }
        }
        // An allowance of ten standard deviations is enough alone.
        assert_eq!(threshold(1.0, 10.0, 1e7), 0.0);
    }

    /// False alarms by Gaussian errors are as rare as the formula says.
    #[test]
    fn false_alarms_are_as_rare_as_stated() {
        // A 64-bit linear congruential generator (Knuth), and normal deviates of Box and Muller.
        let mut state = 1u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 32) as f64 + 0.5) / 4_294_967_296.0
        };
        let mut normal = || {
            let radius = libm::sqrt(-2.0 * libm::log(uniform()));
            (radius * libm::cos(core::f64::consts::TAU * uniform())) as f32
        };
        for (k, wanted) in [(0.5f32, 400.0f32), (1.0, 2000.0)] {
            let h = threshold(1.0, k, wanted);
            let (mut steps, mut alarms) = (0u32, 0u32);
            let mut cusum = Cusum::default();
            while alarms < 1000 {
                cusum.update(normal(), k);
                steps += 1;
                if cusum.largest() > h {
                    alarms += 1;
                    cusum = Cusum::default();
                }
            }
            // Two sides halve it. A thousand alarms give it to 3 %; the formula is accurate to 5 %, and the logarithm adds 12 %.
            let length = 2.0 * f64::from(steps) / f64::from(alarms) / f64::from(wanted);
            assert!((0.9..1.3).contains(&length), "k {k}: {length}");
        }
    }

    #[test]
    fn nan_does_not_stay() {
        let mut cusum = Cusum::default();
        cusum.update(f32::NAN, 1.0);
        cusum.update(3.0, 1.0);
        assert_eq!(cusum.largest(), 2.0);
    }
}

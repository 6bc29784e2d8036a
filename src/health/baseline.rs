//! The normal state of one statistic: a level and a trend that follow it from cycle to cycle, and its scatter about them.
//!
//! - p = level + trend, e = z − p
//! - level ← p + α·e, trend ← trend + β·e
//!
//! Over the first n cycles α = 2(2n − 1)/(n(n + 1)) and β = 6/(n(n + 1)), which gives the least-squares line through all of them
//! (Bar-Shalom, Li, Kirubarajan, Estimation, 2001, ch. 6). Once α has fallen to [`LEVEL_GAIN`] both gains stay, and the line
//! forgets. Slow settling, such as wires that bed in or a specimen that warms, is thus followed with an error of its second
//! difference divided by β. A change within a cycle is not followed.

/// Gain of the level, from the fifteenth cycle on, and gain of the trend.
const LEVEL_GAIN: f32 = 0.25;
const TREND_GAIN: f32 = 0.03;
/// Cycles after which the line is old enough for its errors to count.
const YOUNG: u32 = 4;
/// Part of the variance that one cycle replaces after learning.
const VARIANCE_GAIN: f32 = 1.0 / 64.0;

/// The line and the scatter about it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Baseline {
    level: f32,
    trend: f32,
    variance: f32,
    cycles: u32,
}

impl Baseline {
    /// Expected statistic of the cycle after the next: each cycle is processed one cycle late.
    pub(super) fn expected(&self) -> f32 {
        self.level + 2.0 * self.trend
    }

    fn predicted(&self) -> f32 {
        self.level + self.trend
    }

    /// Continues along the line without a new value.
    pub(super) fn coast(&mut self) {
        self.level += self.trend;
    }

    /// Sets the level to `z`, and the trend to 0.
    pub(super) fn place(&mut self, z: f32) {
        self.level = z;
        self.trend = 0.0;
    }

    /// Takes the statistic `z` of one more cycle.
    pub(super) fn follow(&mut self, z: f32) {
        let predicted = self.predicted();
        let error = if self.cycles == 0 { 0.0 } else { z - predicted };
        if self.cycles == 0 {
            self.level = z;
        }
        self.cycles = self.cycles.saturating_add(1);
        let n = self.cycles as f32;
        let product = n * (n + 1.0);
        let level_gain = larger((4.0 * n - 2.0) / product, LEVEL_GAIN);
        let trend_gain = larger(6.0 / product, TREND_GAIN);
        if self.cycles > 1 {
            self.level = predicted + level_gain * error;
            // A trend needs at least two points.
            self.trend += trend_gain * error;
        }
        if self.cycles > YOUNG {
            let gain = larger(1.0 / (n - YOUNG as f32), VARIANCE_GAIN);
            self.variance += gain * (error * error - self.variance);
        }
    }

    /// Upper limit of the scatter for the few errors seen: with 95 % confidence σ is below s·(1 + 1.645/√2ν) for ν errors.
    pub(super) fn deviation(&self) -> f32 {
        let errors = self.cycles.saturating_sub(YOUNG) as f32;
        let most = 1.0 / VARIANCE_GAIN;
        let errors = if errors < most { errors } else { most };
        let unsure = 1.645 / crate::real::square_root(2.0 * errors);
        crate::real::square_root(self.variance) * (1.0 + unsure)
    }

    /// The present level.
    pub(super) fn level(&self) -> f32 {
        self.level
    }
}

fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_least_squares_line_at_first() {
        // y = 3, 1, 4, 1, 5: the line through them ends at 3.6 and rises by 0.4.
        let mut baseline = Baseline::default();
        for z in [3.0, 1.0, 4.0, 1.0, 5.0] {
            baseline.follow(z);
        }
        assert!(
            (baseline.level() - 3.6).abs() < 1e-5,
            "{}",
            baseline.level()
        );
        assert!((baseline.predicted() - 4.0).abs() < 1e-5);
    }

    #[test]
    fn a_slope_is_followed_without_error_and_a_settling_nearly() {
        let mut line = Baseline::default();
        for n in 0..100u16 {
            line.follow(1.0 + 0.01 * f32::from(n));
        }
        assert!((line.predicted() - 2.0).abs() < 1e-4);
        assert!(line.deviation() < 5e-5);
        // 10 % that settle with 20 cycles: the error stays below the second difference divided by the trend's gain, 0.8 %.
        let mut settling = Baseline::default();
        let mut worst = 0.0f32;
        for n in 0..200u16 {
            let z = 0.1 * (1.0 - libm::expf(-f32::from(n) / 20.0));
            if n > 4 {
                worst = worst.max((z - settling.predicted()).abs());
            }
            settling.follow(z);
        }
        assert!(worst < 0.0085, "{worst}");
    }

    #[test]
    fn the_scatter_is_that_of_the_statistic() {
        let mut baseline = Baseline::default();
        for n in 0..400u16 {
            baseline.follow(if n % 2 == 0 { 0.01 } else { -0.01 });
        }
        // An alternation is the hardest to predict: e = 2·z/(2 − α − β/2) for each z, from the filter's transfer function at −1.
        let expected = 0.01 * 4.0 / (4.0 - 2.0 * LEVEL_GAIN - TREND_GAIN);
        // After 400 cycles the weight of each is 1/64.
        let unsure = 1.645 / libm::sqrtf(2.0 * 64.0);
        let deviation = baseline.deviation() / (1.0 + unsure);
        assert!((deviation / expected - 1.0).abs() < 0.01);
    }

    /// For 12 errors: σ is below s·√(12/χ²) for the lower 5 % of χ² of 12 degrees of freedom, 5.226, which the formula
    /// approximates.
    #[test]
    fn a_scatter_of_few_cycles_may_be_larger_than_it_looks() {
        let mut baseline = Baseline::default();
        for n in 0..16u16 {
            baseline.follow(if n % 2 == 0 { 0.01 } else { -0.01 });
        }
        let seen = libm::sqrtf(baseline.variance);
        let exact = libm::sqrtf(12.0 / 5.226);
        let ratio = baseline.deviation() / seen;
        assert!(ratio > 1.3 && ratio < exact, "{ratio} of {exact}");
    }
}

//! Parts between a specimen and the two sensors: a spring in series, and a delay of the force channel.

use std::collections::VecDeque;

/// Steps into which one call is divided for a spring in series: first order in the step, so that a force that follows the velocity
/// is late by half of it.
pub(super) const SUBSTEPS: usize = 8;
/// Largest number of bisections and secants until the forces of spring and specimen agree.
const ITERATIONS: usize = 60;
/// Accuracy of their agreement, mm.
const CLOSE: f64 = 1e-9;

/// Displacement x of the specimen at which `force`(x) is the spring's (y − x)/compliance, searched from `before` on.
///
/// `force` must not fall as x rises. Regula falsi with the Illinois rule, which the kink of |v|^α at v = 0 does not disturb.
pub(super) fn balance(
    y: f64,
    before: f64,
    compliance: f64,
    mut force: impl FnMut(f64) -> f64,
) -> f64 {
    let mut excess = |x: f64| x + compliance * force(x) - y;
    // The excess rises by at least 1 per mm, so that the root is no further away than the excess.
    let (mut low, mut at_low) = (before, excess(before));
    if at_low == 0.0 {
        return before;
    }
    let (mut high, mut at_high) = (before - at_low, excess(before - at_low));
    for _ in 0..ITERATIONS {
        if at_high == 0.0 || (high - low).abs() < CLOSE {
            break;
        }
        let x = high - at_high * (high - low) / (at_high - at_low);
        let at_x = excess(x);
        if at_x * at_high < 0.0 {
            (low, at_low) = (high, at_high);
        } else {
            at_low *= 0.5;
        }
        (high, at_high) = (x, at_x);
        if at_x.abs() < CLOSE {
            break;
        }
    }
    high
}

/// A delayed channel.
#[derive(Clone, Debug)]
pub(super) struct Late {
    by: f64,
    /// (s, kN); the first of them is the last one older than `by`.
    past: VecDeque<(f64, f64)>,
}

impl Late {
    /// A delay of this many seconds.
    pub fn by(time: f64) -> Self {
        Self {
            by: time,
            past: VecDeque::new(),
        }
    }

    /// The value `by` seconds before `time`, linear between those given; before the first, the first.
    pub fn pass(&mut self, time: f64, value: f64) -> f64 {
        self.past.push_back((time, value));
        let wanted = time - self.by;
        while self.past.len() > 2 && self.past[1].0 <= wanted {
            self.past.pop_front();
        }
        let (t0, f0) = self.past[0];
        let Some(&(t1, f1)) = self.past.get(1) else {
            return f0;
        };
        f0 + (f1 - f0) * ((wanted - t0) / (t1 - t0)).clamp(0.0, 1.0)
    }
}

//! Kinks: jumps in the velocity of a recorded displacement.

use std::ops::Range;

use super::polynomial::{Cubic, fit_polynomial, left_by_polynomial};
use crate::motion::MotionPolicy;

/// Degree of a polynomial with as many coefficients as two quadratics.
const SMOOTH: usize = 5;

crate::numbers! {
    /// Where the velocity jumps: a kink of the displacement. Polynomials are fitted on both sides of a sample, and their slopes compared.
    KinksPolicy {
        /// A kink is moved at most this many times to the place where the polynomials on its two sides meet.
        meetings: usize = 3, Tuned("the estimated motions");
        /// A kink is moved by at most this many samples at a time.
        farthest: f64 = 6.0, Tuned("the estimated motions");
        /// A kink is kept only if the polynomials on its two sides finally meet within this many samples of it.
        closest: f64 = 2.0, Tuned("the estimated motions");
        /// The windows on the two sides of a sample, over which polynomials are fitted, are this fraction of a period long.
        window: f64 = 0.05, Tuned("the estimated motions");
        /// The windows on the two sides of a sample have at least and at most this many samples.
        windows: [usize; 2] = [5, 200], Derived("fewer samples leave a quadratic no residual; more cost time and gain nothing");
        /// A jump of the slope is a kink only if it exceeds this many of its standard deviations.
        stands_out: f64 = 8.0, Tuned("the estimated motions");
        /// A jump of the slope is a kink only if it exceeds this fraction of the larger slope on its two sides.
        large: f64 = 0.1, Tuned("the estimated motions");
        /// Jumps of the slope are compared by their lower bounds, this many standard deviations below their estimates.
        surely: f64 = 3.0, Convention("three in a thousand by chance");
        /// A kink is kept only if two quadratics that meet there fit better than one smooth polynomial, by this many standard deviations of
        /// the noise.
        clearly: f64 = 5.0, Derived("noise alone does so once in a million samples");
        /// A sample up to this fraction of a tick before a kink belongs to the part after it.
        at_kink: f64 = 0.2, Tuned("the estimated motions");
    }
}

/// First samples after jumps of the displacement's slope, increasing; between two of them there are enough samples for a velocity.
///
/// At each sample a quadratic is fitted to the samples before and another to those after. In a smooth motion their slopes differ
/// only by noise. A kink is where the difference exceeds the noise, is not small compared with the velocities around it, and is the
/// largest within a window's length. The slopes also differ where a smooth motion bends more within a window than a quadratic. That
/// is not a kink, and a single polynomial with as many coefficients describes it as well.
pub(super) fn find_kinks(samples: &[f64], tick: f64, period: &[f64], noise: f64) -> Vec<usize> {
    let count = samples.len();
    let [shortest, longest] = KinksPolicy::in_use().windows;
    let width = |index: usize| {
        ((KinksPolicy::in_use().window * period[index] / tick) as usize).clamp(shortest, longest)
    };
    let widths = |index: usize| {
        (
            width(index.saturating_sub(3)),
            width((index + 3).min(count - 1)),
        )
    };
    let jump: Vec<f64> = (0..count)
        .map(|index| {
            let (before, after) = widths(index);
            let Some(jump) = Jump::at(samples, index, before, after, 2, noise) else {
                return 0.0;
            };
            let stands_out = jump.difference > KinksPolicy::in_use().stands_out * jump.deviation;
            if stands_out && jump.difference > KinksPolicy::in_use().large * jump.largest_slope {
                jump.surely()
            } else {
                0.0
            }
        })
        .collect();
    let mut kinks: Vec<(usize, f64)> = Vec::new();
    let mut index = 0;
    while index < count {
        let (before, after) = widths(index);
        let around = index.saturating_sub(before + 2)..(index + after + 3).min(count);
        let is_largest = jump[index] > 0.0 && around.clone().all(|i| jump[i] <= jump[index]);
        if is_largest {
            let (before, after) = (width(around.start), width(around.end - 1));
            let kink = locate_kink(samples, index, 2 * before, 2 * after, noise)
                .filter(|&kink| is_sharp(samples, kink, before, after, noise));
            kinks.extend(kink.map(|kink| (kink, jump[index])));
            index = around.end;
        } else {
            index += 1;
        }
    }
    // A kink, once located, may lie before one that was located earlier.
    kinks.sort_unstable_by_key(|&(kink, _)| kink);
    // Of two without a window between them one is an artefact of the other.
    kinks.dedup_by(|next, kept| {
        let is_shadow = next.0 - kept.0 <= MotionPolicy::in_use().shortest;
        if is_shadow && next.1 > kept.1 {
            *kept = *next;
        }
        is_shadow
    });
    kinks.into_iter().map(|(kink, _)| kink).collect()
}

/// Whether two quadratics that meet at the first sample after a kink describe the motion around it clearly better than one smooth
/// polynomial.
fn is_sharp(samples: &[f64], kink: usize, before: usize, after: usize, noise: f64) -> bool {
    let start = kink.saturating_sub(before);
    let end = (kink + after).min(samples.len());
    let left = |range: Range<usize>, degree| left_by_polynomial(&samples[range], degree);
    let apart = left(start..kink, 2) + left(kink..end, 2);
    left(start..end, SMOOTH) - apart > (KinksPolicy::in_use().clearly * noise).powi(2)
}

/// Polynomials on both sides of a sample that belongs to neither.
struct Jump {
    /// Difference of the slopes at the sample, mm per tick.
    difference: f64,
    /// Its standard deviation.
    deviation: f64,
    largest_slope: f64,
    /// Position where the two meet, in ticks after the sample.
    meeting: f64,
}

impl Jump {
    /// Polynomials of `degree` through `before` samples before `index` and `after` samples after it; `None` if there are not enough
    /// samples.
    fn at(
        samples: &[f64],
        index: usize,
        before: usize,
        after: usize,
        degree: usize,
        noise: f64,
    ) -> Option<Self> {
        let left = fit_polynomial(
            samples.get(index.checked_sub(before)?..index)?,
            before as f64,
            degree,
        );
        let right = fit_polynomial(samples.get(index + 1..=index + after)?, -1.0, degree);
        // A window that contains a kink has a large residual, and its slope is uncertain.
        let variance = |fit: &Cubic, length: usize| {
            (noise * noise).max(fit.error / (length - degree - 1) as f64) * fit.slope_variance
        };
        let change = right.slope - left.slope;
        Some(Self {
            difference: change.abs(),
            deviation: (variance(&left, before) + variance(&right, after)).sqrt(),
            largest_slope: left.slope.abs().max(right.slope.abs()),
            meeting: (left.value - right.value) / change,
        })
    }

    /// Lower bound of the difference, given its uncertainty.
    fn surely(&self) -> f64 {
        self.difference - KinksPolicy::in_use().surely * self.deviation
    }
}

/// The first sample after the kink near `near`: cubics through `before` and `after` samples are moved past it until their slopes
/// differ most; the kink is where they then meet.
fn locate_kink(
    samples: &[f64],
    near: usize,
    before: usize,
    after: usize,
    noise: f64,
) -> Option<usize> {
    let (index, jump) = (near.saturating_sub(before)..near + after)
        .filter_map(|index| Some((index, Jump::at(samples, index, before, after, 3, noise)?)))
        .max_by(|a, b| a.1.surely().total_cmp(&b.1.surely()))?;
    // Again without the sample at the kink, which would bend the wrong side. The first location may be off by some samples, which
    // are a small part of a long window on the other side.
    let mut at = index;
    let mut meeting = jump.meeting;
    for _ in 0..KinksPolicy::in_use().meetings {
        at = (at as f64
            + meeting.clamp(
                -KinksPolicy::in_use().farthest,
                KinksPolicy::in_use().farthest,
            ))
        .round() as usize;
        meeting = Jump::at(samples, at, before, after, 3, noise)?.meeting;
        if meeting.abs() <= KinksPolicy::in_use().closest {
            break;
        }
    }
    // The sample at the kink itself belongs to the part after it.
    let first_after = (at as f64 + meeting - KinksPolicy::in_use().at_kink).ceil();
    (meeting.abs() <= KinksPolicy::in_use().closest).then_some(first_after as usize)
}

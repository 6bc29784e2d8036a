//! Substitutes for samples that were not measured, from the samples around them.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::super::cycles::Cycles;
use super::super::polynomial::fit_polynomial;
use super::runs;
use crate::extremes::least_and_largest;

crate::numbers! {
    /// How samples that are missing or faulty are filled in.
    BridgePolicy {
        /// A gap of up to this many samples is filled by a cubic; a longer one by the sine of the motion, or by a straight line.
        short: usize = 4, Tuned("the injected channel faults");
        /// The cubic across a gap is fitted to this many samples on each side.
        neighbours: usize = 5, Tuned("the injected channel faults");
        /// The sine across a gap is fitted to the samples within this fraction of a period on each side.
        reach: f64 = 0.75, Tuned("the injected channel faults");
        /// A gap is filled by a sine only if the RMS residual of the sine is below this fraction of the RMS of the samples about their
        /// mean.
        is_sine: f64 = 0.03, Tuned("the injected channel faults");
        /// A crossing of the mid level counts if the channel then leaves a band around that level, of ± this fraction of its range.
        hysteresis: f64 = 0.05, Convention("above any noise in which a motion can still be seen");
        /// A gap is filled by a fit only if there are at least this many known samples on each side.
        fewest: usize = 3, Convention("six samples leave two degrees of freedom with four functions");
    }
}

/// Replaces the `unknown` ones of `values`, sampled every `tick` s. A few in a row are replaced by the cubic through their
/// neighbours; more by the sine of the motion around them, or by a straight line if the motion is not a sine.
pub(super) fn bridge(values: &mut [f64], unknown: &[bool], tick: f64) {
    let gaps = runs(unknown);
    if gaps.is_empty() {
        return;
    }
    for gap in &gaps {
        line(values, gap);
    }
    let (low, high) = least_and_largest(&*values);
    let cycles = Cycles::find(
        values,
        tick,
        BridgePolicy::in_use().hysteresis * (high - low),
    );
    let period = cycles.period_per_sample(values.len(), tick);
    for gap in &gaps {
        let samples = period[gap.start] / tick;
        let is_end = gap.start == 0 || gap.end == values.len();
        let filled = if is_end && gap.len() <= BridgePolicy::in_use().short {
            beyond_end(values, unknown, gap)
        } else if gap.len() <= BridgePolicy::in_use().short {
            let cubic = |x: f64| SVector::from([1.0, x, x * x, x * x * x]);
            fit(
                values,
                unknown,
                gap,
                BridgePolicy::in_use().neighbours,
                cubic,
            )
            .map(|(filled, _)| filled)
        } else {
            let reach = (BridgePolicy::in_use().reach * samples) as usize;
            // The period is known only to a few per cent; the one with the smallest residual is used.
            (-4..=4)
                .filter_map(|step| {
                    let w = TAU / (samples * (1.0 + 0.01 * f64::from(step)));
                    let sine = |x: f64| SVector::from([1.0, (w * x).cos(), (w * x).sin(), x]);
                    fit(values, unknown, gap, reach, sine)
                })
                .filter(|(_, left)| *left < BridgePolicy::in_use().is_sine)
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(filled, _)| filled)
        };
        if let Some(filled) = filled {
            values[gap.clone()].copy_from_slice(&filled);
        }
    }
}

/// Replaces the `unknown` ones of `values` by straight lines between the neighbouring samples.
pub(crate) fn lines(values: &mut [f64], unknown: &[bool]) {
    for gap in runs(unknown) {
        line(values, &gap);
    }
}

/// A straight line from the sample before to the sample after; at an end of the recording the one sample available.
fn line(values: &mut [f64], gap: &Range<usize>) {
    let before = gap.start.checked_sub(1).map(|index| values[index]);
    let after = values.get(gap.end).copied();
    let (Some(from), Some(to)) = (before.or(after), after.or(before)) else {
        return;
    };
    let steps = (gap.len() + 1) as f64;
    for (step, index) in gap.clone().enumerate() {
        values[index] = from + (to - from) * (step + 1) as f64 / steps;
    }
}

/// The parabola through the samples beside a gap at an end of the recording, continued into it.
fn beyond_end(values: &[f64], unknown: &[bool], gap: &Range<usize>) -> Option<Vec<f64>> {
    let reach = 2 * BridgePolicy::in_use().neighbours;
    let beside = if gap.start == 0 {
        gap.end..(gap.end + reach).min(values.len())
    } else {
        gap.start.saturating_sub(reach)..gap.start
    };
    if beside.len() < reach || unknown[beside.clone()].contains(&true) {
        return None;
    }
    let at = |index: usize| index as f64 - beside.start as f64;
    let filled = gap
        .clone()
        .map(|index| fit_polynomial(&values[beside.clone()], at(index), 2).value);
    Some(filled.collect())
}

/// Least squares of the four functions `basis` of the position (samples after the gap's middle) through the known samples up to
/// `reach` from the gap. Returns their values in the gap, and the RMS of the residual divided by that of the samples about their
/// mean.
///
/// `None` if one side has too few samples to show the course of the motion.
fn fit(
    values: &[f64],
    unknown: &[bool],
    gap: &Range<usize>,
    reach: usize,
    basis: impl Fn(f64) -> SVector<f64, 4>,
) -> Option<(Vec<f64>, f64)> {
    let middle = 0.5 * (gap.start + gap.end) as f64;
    let at = |index: usize| basis(index as f64 - middle);
    let around = gap.start.saturating_sub(reach)..(gap.end + reach).min(values.len());
    let known: Vec<usize> = around.filter(|&index| !unknown[index]).collect();
    let before = known.iter().filter(|&&index| index < gap.start).count();
    let fewest = BridgePolicy::in_use().fewest;
    if before < fewest || known.len() - before < fewest {
        return None;
    }
    let mut gram = SMatrix::<f64, 4, 4>::zeros();
    let mut right = SVector::<f64, 4>::zeros();
    for &index in &known {
        let row = at(index);
        gram += row * row.transpose();
        right += row * values[index];
    }
    let coefficients = gram.cholesky()?.solve(&right);
    let mean = known.iter().map(|&index| values[index]).sum::<f64>() / known.len() as f64;
    let (mut left, mut all) = (0.0, 0.0);
    for &index in &known {
        left += (values[index] - at(index).dot(&coefficients)).powi(2);
        all += (values[index] - mean).powi(2);
    }
    let filled = gap
        .clone()
        .map(|index| at(index).dot(&coefficients))
        .collect();
    Some((filled, (left / all).sqrt()))
}

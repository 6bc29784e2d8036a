//! Equal steps behind values that were rounded: printed times, and the rows in which a slower channel has a new value.
//!
//! Rounded to a quantum, the times of a steady clock are off a straight line by no more than half of it. So the line through all of
//! them tells the step, although each single one is a whole number of quanta: 80 Hz printed in hundredths of a second is neither
//! 100 Hz with missing samples nor jitter.

use crate::clock::ClockPolicy;
use crate::extremes::{least_and_largest, quantile};

/// Equal steps, with the step of each value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Steady {
    /// The step.
    pub period: f64,
    /// Number of the step of each value from the first one's; strictly increasing.
    pub ticks: Vec<usize>,
    /// What the values were rounded to; 0 if that is unknown.
    pub quantum: f64,
}

/// The regression begins with at least this many values, and takes half as many more each time. Convention: their slope is known to a
/// five-hundredth of the quantum.
const FIRST: usize = 64;

impl Steady {
    /// The equal steps behind `values`, which never fall and were rounded to a `quantum`, if no value is off its step by more than the
    /// rounding.
    ///
    /// Steps without a value and pauses of any length are allowed. The slope over many values is tried before that over few, so that
    /// the even spread of long and short steps counts before each of them; `accepts` may refuse what it gives.
    pub fn of(values: &[f64], quantum: f64, accepts: impl Fn(&Self) -> bool) -> Option<Self> {
        let fitted = |period: f64, rounding: f64, first: usize| {
            let steady = Self::fitted(values, period, rounding, first)?;
            Some(Self { quantum, ..steady }).filter(|steady| accepts(steady))
        };
        let mut stride = values.len() / 2;
        let mut is_grown = false;
        while stride > 0 {
            // Over fewer values, one that is missing cannot be told from rounding.
            if stride < FIRST && !std::mem::replace(&mut is_grown, true) {
                let grown = Self::grown(values, quantum).filter(|steady| accepts(steady));
                if grown.is_some() {
                    return grown;
                }
            }
            let [median, mean] = slopes(values, stride, quantum);
            // A period of whole quanta is never rounded.
            let whole = (median / quantum).round() * quantum;
            let is_whole = whole > 0.0 && (median - whole).abs() * (stride as f64) < 0.5 * quantum;
            let each = [(whole, 0.0), (median, quantum), (mean, quantum)];
            for (period, rounding) in each.into_iter().skip(usize::from(!is_whole)) {
                if let Some(steady) = fitted(period, rounding, 4 * stride) {
                    return Some(steady);
                }
            }
            stride = if stride > 1 { stride.div_ceil(4) } else { 0 };
        }
        // Most steps may lack a value, if a fair part of them does not: these are the shortest.
        let steps = || values.windows(2).map(|pair| pair[1] - pair[0]);
        let positive = steps().filter(|step| *step > 0.0);
        let shortest = positive.fold(f64::INFINITY, f64::min);
        let most = (1.5 * shortest).min(shortest + 1.5 * quantum);
        let whole = steps().filter(|step| *step < most);
        let (sum, count) = whole.fold((0.0, 0.0), |(sum, count), step| (sum + step, count + 1.0));
        // Values in multiples of the step itself are not rounded.
        let rounding = if shortest < 1.5 * quantum {
            0.0
        } else {
            quantum
        };
        (ClockPolicy::in_use().most_missing * count >= values.len() as f64)
            .then(|| fitted(sum / count, rounding, FIRST))
            .flatten()
    }

    /// The steps of about this `period` behind `values` that were rounded to a `quantum`, from their `first` on.
    fn fitted(values: &[f64], mut period: f64, quantum: f64, first: usize) -> Option<Self> {
        let tight = |period: f64| tolerance(period, quantum);
        // While the period is not known yet, values may drift off their steps, though not to the next ones.
        let loose = |period: f64| (2.0 * tight(period)).min(0.5 * period).max(tight(period));
        let mut count = first.clamp(FIRST, FIRST.max(values.len()));
        let followed = loop {
            count = count.min(values.len());
            let known = &values[..count];
            period = Followed::of(known, period, quantum, loose(period))?.slope(known)?;
            let followed = Followed::of(known, period, quantum, loose(period))?;
            period = followed.slope(known)?;
            if count == values.len() {
                break followed;
            }
            count += count / 2;
        };
        if is_coarse(period, quantum) {
            period = followed.narrowed(values, period, quantum);
        } else if followed.stretches.len() == 1 {
            // As exact as the times are.
            let last = values.len() - 1;
            period = (values[last] - values[0]) / followed.ticks[last] as f64;
        }
        let followed = Followed::of(values, period, quantum, tight(period))?;
        Some(Self {
            period,
            ticks: followed.ticks,
            quantum,
        })
    }

    /// The steps behind `values` that were rounded to a `quantum` nearly as long as the steps: from a few values in a row that lack
    /// none, so that those that are missing elsewhere show.
    fn grown(values: &[f64], quantum: f64) -> Option<Self> {
        let last = values.len().checked_sub(FIRST)?;
        let from_window = |window: usize| {
            let few = &values[window * last / (WINDOWS - 1)..][..FIRST];
            let slope = (few[FIRST - 1] - few[0]) / (FIRST - 1) as f64;
            let all = Followed {
                ticks: (0..FIRST).collect(),
                stretches: vec![0],
            };
            let mut period = all.narrowed(few, slope, quantum);
            if !is_coarse(period, quantum)
                || all.range(few, period) > 2.0 * tolerance(period, quantum)
            {
                return None;
            }
            let mut count = FIRST;
            loop {
                count = count.min(values.len());
                let known = &values[..count];
                let followed = Followed::of(known, period, quantum, tolerance(period, quantum))?;
                if count == values.len() {
                    let ticks = followed.ticks;
                    return Some(Self {
                        period,
                        ticks,
                        quantum,
                    });
                }
                period = followed.narrowed(known, period, quantum);
                count += count / 4;
            }
        };
        (0..WINDOWS).find_map(from_window)
    }
}

/// By how much a value may be off its step.
fn tolerance(period: f64, quantum: f64) -> f64 {
    let ClockPolicy {
        rounding, rounded, ..
    } = *ClockPolicy::in_use();
    (rounding * period).max(rounded * quantum)
}

/// Whether the rounding takes up so much of what a value may be off its step that the period must be exact to a fraction of it.
fn is_coarse(period: f64, quantum: f64) -> bool {
    period > 0.0 && quantum > ClockPolicy::in_use().rounding * period
}

/// The number of places at which a few values in a row are tried. Convention: one of them lacks none unless every eighth stretch does.
const WINDOWS: usize = 8;

/// Values with their steps.
struct Followed {
    ticks: Vec<usize>,
    /// The first values of stretches between pauses: after a pause the steps may begin anywhere.
    stretches: Vec<usize>,
}

impl Followed {
    /// Gives each value the step after the last, or a later one if it comes too late for that. `None` if a value fits no step to
    /// within `tolerance`.
    fn of(values: &[f64], period: f64, quantum: f64, tolerance: f64) -> Option<Self> {
        if !period.is_finite() || period <= 0.0 {
            return None;
        }
        let pause = ClockPolicy::in_use().gap * period.max(quantum);
        let (mut ticks, mut stretches) = (vec![0], vec![0]);
        // The first step lies between these.
        let around = |at: f64| [at - tolerance, at + tolerance];
        let [mut low, mut high] = around(*values.first()?);
        for (index, pair) in values.windows(2).enumerate() {
            let offset = |tick: usize| around(pair[1] - tick as f64 * period);
            let fits = |tick: usize| offset(tick)[0] <= high && offset(tick)[1] >= low;
            let next = ticks[index] + 1;
            let later = ((pair[1] - 0.5 * (low + high)) / period).round();
            let ahead = ((pair[1] - pair[0]) / period).round();
            if later.max(ahead) > MOST_TICKS {
                return None;
            }
            let (tick, is_pause) = if fits(next) {
                (next, false)
            } else if later as usize > next && fits(later as usize) {
                (later as usize, later as usize > ticks[index] + FAR)
            } else if pair[1] - pair[0] > pause {
                (ticks[index] + (ahead as usize).max(1), true)
            } else {
                return None;
            };
            if is_pause {
                stretches.push(index + 1);
                [low, high] = offset(tick);
            }
            low = low.max(offset(tick)[0]);
            high = high.min(offset(tick)[1]);
            ticks.push(tick);
        }
        Some(Self { ticks, stretches })
    }

    /// Values and their steps, each since the first of a stretch, for each stretch.
    fn each<'s>(
        &'s self,
        values: &'s [f64],
    ) -> impl Iterator<Item = impl Iterator<Item = (f64, f64)> + Clone + 's> + 's {
        let ends = self.stretches.iter().skip(1).copied();
        let ends = ends.chain([values.len()]);
        self.stretches.iter().zip(ends).map(|(&from, to)| {
            let (first, start) = (self.ticks[from], values[from]);
            let pairs = self.ticks[from..to].iter().zip(&values[from..to]);
            pairs.map(move |(tick, value)| ((tick - first) as f64, value - start))
        })
    }

    /// The largest range, of a stretch, of `values` about steps of this `period`.
    fn range(&self, values: &[f64], period: f64) -> f64 {
        let ranges = self.each(values).map(|each| {
            let (low, high) = least_and_largest(each.map(|(tick, value)| value - tick * period));
            high - low
        });
        ranges.fold(0.0, f64::max)
    }

    /// The period about which `values` have the least range: rounded to a `quantum`, they have one of that. Least squares gives `near`,
    /// which is not as exact, because the rounding of steady values is no noise.
    fn narrowed(&self, values: &[f64], near: f64, quantum: f64) -> f64 {
        let off = 2.0 * quantum / values.len() as f64;
        let [mut low, mut high] = [near - off, near + off];
        for _ in 0..NARROWED {
            let third = (high - low) / 3.0;
            if self.range(values, low + third) <= self.range(values, high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        0.5 * (low + high)
    }

    /// The slope of `values` over their steps, by least squares with an offset of each stretch.
    fn slope(&self, values: &[f64]) -> Option<f64> {
        let (mut product, mut square) = (0.0, 0.0);
        for each in self.each(values) {
            let each = || each.clone();
            let count = each().count() as f64;
            let mean_tick = each().map(|(tick, _)| tick).sum::<f64>() / count;
            for (tick, value) in each() {
                product += (tick - mean_tick) * value;
                square += (tick - mean_tick).powi(2);
            }
        }
        let slope = product / square;
        (slope > 0.0).then_some(slope)
    }
}

/// The number of times that the range of the period is cut by a third. Derived: to a millionth of what it may be off.
const NARROWED: usize = 34;
/// After more steps than this without a value, it is a pause. Convention: a logger loses a few samples at once.
const FAR: usize = 8;
/// More steps than this are no time of a test. Convention: three years at 10 MHz.
const MOST_TICKS: f64 = 1e15;

/// Two estimates of the step, from values that are `stride` apart: the median, and the mean of those near it.
fn slopes(values: &[f64], stride: usize, quantum: f64) -> [f64; 2] {
    let mut over: Vec<f64> = (values.windows(stride + 1))
        .map(|window| window[stride] - window[0])
        .collect();
    let median = quantile(&mut over, 0.5);
    let near = 1.01 * quantum + 1e-9 * median;
    let near = over.iter().filter(|over| (*over - median).abs() <= near);
    let (sum, count) = near.fold((0.0, 0.0), |(sum, count), over| (sum + over, count + 1.0));
    let stride = stride as f64;
    [median / stride, sum / f64::max(count, 1.0) / stride]
}

/// What `values` were rounded to: the smallest difference between two of their steps, if all steps are multiples of it; 0 if there
/// is none.
pub(super) fn quantum(values: &[f64]) -> f64 {
    let mut steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable_by(f64::total_cmp);
    let largest = values
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    // What the rounding of f64 leaves of a difference of two steps.
    let error = 8.0 * f64::EPSILON * largest;
    let apart = steps.windows(2).map(|pair| pair[1] - pair[0]);
    let least = apart
        .filter(|apart| *apart > error)
        .fold(f64::INFINITY, f64::min);
    let is_multiple = |step: &f64| {
        let times = step / least;
        let is_near = (times - times.round()).abs() <= ClockPolicy::in_use().multiple;
        *step <= error || times.round() >= 1.0 && is_near
    };
    if least.is_finite() && steps.iter().all(is_multiple) {
        least
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::SeedableRng as _;
    use rand::rngs::StdRng;

    use super::{Steady, quantum};

    /// Rounded or cut to a multiple of `quantum`.
    fn printed(time: f64, quantum: f64, is_cut: bool) -> f64 {
        let multiple = time / quantum;
        let whole = if is_cut {
            multiple.floor()
        } else {
            multiple.round()
        };
        whole * quantum
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Any rate, from many stamps that are the same to steps of many quanta, rounded or cut, from any start, with a pause.
        #[test]
        fn a_rounded_clock_keeps_its_rate(ratio in 0.1..12.0_f64, start in 0.0..100.0_f64, count in 400..4000_usize,
            is_cut: bool, pause in 0.0..60.0_f64, seed: u64) {
            let step = 0.01;
            let period = ratio * step;
            let mut random = StdRng::seed_from_u64(seed);
            let paused = random.random_range(count / 4..3 * count / 4);
            // A shorter one is taken for samples that are missing.
            let pause = if pause < 10.0 * step.max(period) { 0.0 } else { pause };
            let values: Vec<f64> = (0..count).map(|index| {
                let later = if index < paused { 0.0 } else { pause };
                printed(start + period * index as f64 + later, step, is_cut)
            }).collect();
            let steady = Steady::of(&values, quantum(&values), |_| true).expect("a clock");
            // Over a quarter of the values, both ends are known to half a quantum each, in two stretches.
            let allowed = 8.0 * step / count as f64;
            prop_assert!((steady.period - period).abs() < allowed, "{} for {period}", steady.period);
        }
    }

    #[test]
    fn steps_without_a_value_are_counted() {
        let mut random = StdRng::seed_from_u64(3);
        let mut truth = vec![0];
        for _ in 0..3000 {
            let ahead = if random.random_bool(0.2) {
                random.random_range(2..9)
            } else {
                1
            };
            truth.push(truth[truth.len() - 1] + ahead);
        }
        let values: Vec<f64> = truth.iter().map(|&tick| f64::from(tick) * 0.0025).collect();
        let steady = Steady::of(&values, quantum(&values), |_| true).unwrap();
        let ticks: Vec<usize> = truth.iter().map(|&tick| tick as usize).collect();
        assert_eq!(steady.ticks, ticks);
    }

    /// As in rows that were written only where a value changed, at a rate that the digits of the times do not divide.
    #[test]
    fn most_steps_may_lack_a_value() {
        for (seed, rate) in [(1, 269.73), (2, 383.6), (3, 256.0), (4, 128.0)] {
            let mut random = StdRng::seed_from_u64(seed);
            let mut truth = vec![0];
            for n in 0..4000 {
                let ahead = match random.random_range(0..100) {
                    0..35 => 1,
                    35..99 => random.random_range(2..7),
                    _ => random.random_range(7..600),
                };
                truth.push(truth[n] + ahead);
            }
            let values: Vec<f64> = truth
                .iter()
                .map(|&tick| printed(tick as f64 / rate, 1e-6, false))
                .collect();
            let steady = Steady::of(&values, quantum(&values), |_| true).expect("a clock");
            assert_eq!(steady.ticks, truth, "{rate} Hz");
        }
    }

    /// Neither jitter nor a step that grows is a clock.
    #[test]
    fn unsteady_values_have_no_step() {
        let mut random = StdRng::seed_from_u64(4);
        let jitter: Vec<f64> = (0..2000)
            .map(|index| 0.01 * (f64::from(index) + random.random_range(-0.3..0.3)))
            .collect();
        let growing: Vec<f64> = (0..500).map(|index| 0.001 * 1.02_f64.powi(index)).collect();
        for values in [jitter, growing] {
            assert_eq!(Steady::of(&values, quantum(&values), |_| true), None);
        }
    }
}

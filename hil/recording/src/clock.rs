//! The clock behind a recording's times: equal steps, the tick of each sample, and the error of the times.

use std::f64::consts::TAU;

use mesh_damper_tables::channel::Channel;

use crate::faults::kind::{ChannelFault, ChannelFaultKind};

crate::numbers! {
    /// How the clock behind a recording's times is found.
    ClockPolicy {
        /// If no time is off its tick by more than this fraction of a period, the samples are taken to lie on the ticks. At a velocity v
        /// the displacement is then off by at most this fraction of v·period.
        rounding: f64 = 0.05, Convention("the rounding of printed times");
        /// A time step of more than this many periods is a gap, in the first estimate of the period and in times that follow no clock.
        gap: f64 = 1.75, Tuned("the injected channel faults");
        /// Gaps are taken as whole numbers of periods if this changes the estimated period by less than this fraction.
        refinement: f64 = 1e-3, Tuned("the injected channel faults");
        /// Times follow no clock if their RMS deviation from the ticks exceeds this many periods.
        keeps_no_clock: f64 = 0.45, Tuned("the injected channel faults");
        /// Jitter is reported only if the RMS deviation of the times from the ticks exceeds this many periods.
        worth_saying: f64 = 0.03, Convention("the error of the velocity is then as small");
        /// The first estimate of a jittering clock uses this many samples.
        first: usize = 32, Tuned("the injected channel faults");
        /// Times count as rounded, and not as jittering, if none is off its tick by more than this fraction of the rounding step.
        rounded: f64 = 0.55, Derived("half a step, and a tenth of that for the error of the period");
        /// Times are rounded to a decimal step if none is off a multiple of the step by more than this fraction of it.
        decimal: f64 = 1e-4, Derived("covers the rounding when a time is read, in a recording of days");
    }
}

/// Equal time steps at which, or about which, a recording's samples lie.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Clock {
    /// Time between ticks, s.
    pub period: f64,
    /// The tick of each sample relative to the first one's, strictly increasing.
    pub ticks: Vec<usize>,
    /// Whether the samples were taken on the ticks, whatever their times say.
    pub on_ticks: bool,
    /// RMS of the times from their ticks, periods; 0 if it is only rounding.
    pub jitter: f64,
}

impl Clock {
    /// The clock of `time`, s, increasing. `displacement`, which is smooth over time, shows whether jittering times are true.
    pub fn of(time: &[f64], displacement: &[f64]) -> Self {
        let period = mean_step(time);
        let positions: Vec<f64> = time.iter().map(|t| (t - time[0]) / period).collect();
        if positions
            .iter()
            .all(|p| (p - p.round()).abs() <= ClockPolicy::in_use().rounding)
        {
            return Self {
                period,
                ticks: positions.iter().map(|p| p.round() as usize).collect(),
                on_ticks: true,
                jitter: 0.0,
            };
        }
        if let Some(clock) = Self::jittering(time, displacement) {
            return clock;
        }
        // Times that wander: gaps are long steps, and ticks follow the times.
        let mut ticks = vec![0];
        for pair in time.windows(2) {
            let step = (pair[1] - pair[0]) / period;
            let ahead = if step > ClockPolicy::in_use().gap {
                step.round() as usize
            } else {
                1
            };
            ticks.push(ticks[ticks.len() - 1] + ahead);
        }
        let apart = time
            .windows(2)
            .map(|pair| ((pair[1] - pair[0]) / period - 1.0).min(1.0));
        Self {
            period,
            ticks,
            on_ticks: false,
            jitter: rms(apart),
        }
    }

    /// A clock about which the times jitter.
    fn jittering(time: &[f64], displacement: &[f64]) -> Option<Self> {
        let (start, period) = lock(time)?;
        // Ticks in excess of the sample's number, by samples missing before it and by jitter. They can only grow.
        let ahead: Vec<f64> = (0..time.len())
            .map(|index| (time[index] - start) / period - index as f64)
            .collect();
        let missing: Vec<isize> = isotonic(&ahead)
            .iter()
            .map(|m| m.round() as isize)
            .collect();
        let ticks: Vec<usize> = missing
            .iter()
            .enumerate()
            .map(|(index, m)| index.saturating_add_signed(m - missing[0]))
            .collect();
        let apart: Vec<f64> = ahead
            .iter()
            .zip(&missing)
            .map(|(a, &m)| a - m as f64)
            .collect();
        let jitter = rms(apart.iter().copied());
        if jitter > ClockPolicy::in_use().keeps_no_clock {
            return None;
        }
        let largest = apart
            .iter()
            .fold(0.0_f64, |largest, a| largest.max(a.abs()));
        let rounded = largest * period <= ClockPolicy::in_use().rounded * rounding(time);
        let on_ticks = rounded || smoother_over_ticks(time, &ticks, displacement);
        // The channels are interpolated anyway, so the ticks end with the samples.
        let span = time[time.len() - 1] - time[0];
        let period = if on_ticks {
            period
        } else {
            span / (span / period).round()
        };
        Some(Self {
            period,
            ticks,
            on_ticks,
            jitter: if rounded { 0.0 } else { jitter },
        })
    }

    /// Steps of more than one tick: the sample before each, and the number of samples missing there.
    pub fn gaps(&self) -> Vec<(usize, usize)> {
        self.ticks
            .windows(2)
            .enumerate()
            .filter(|(_, pair)| pair[1] - pair[0] > 1)
            .map(|(index, pair)| (index, pair[1] - pair[0] - 1))
            .collect()
    }

    /// The faults of the times.
    pub fn faults(&self) -> Vec<ChannelFault> {
        let channel = Channel::Time;
        let mut faults = Vec::new();
        if self.jitter > ClockPolicy::in_use().worth_saying {
            let kind = ChannelFaultKind::Jitter {
                rms: self.jitter,
                stamps_only: self.on_ticks,
            };
            faults.push(ChannelFault { channel, kind });
        }
        let gaps = self.gaps();
        if !gaps.is_empty() {
            let kind = ChannelFaultKind::Missing {
                samples: gaps.iter().map(|(_, missing)| missing).sum(),
                gaps: gaps.len(),
            };
            faults.push(ChannelFault { channel, kind });
        }
        faults
    }
}

/// Mean of the steps that are not gaps, so that the rounding of printed times does not bias it.
fn mean_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let (short, long): (Vec<f64>, Vec<f64>) = steps
        .into_iter()
        .partition(|step| *step <= ClockPolicy::in_use().gap * median);
    let period = short.iter().sum::<f64>() / short.len() as f64;
    // Over gaps of whole periods the count is longer and the period finer.
    let missing: f64 = long.iter().map(|step| (step / period).round()).sum();
    let span = time[time.len() - 1] - time[0];
    let refined = span / (short.len() as f64 + missing);
    if (refined / period - 1.0).abs() < ClockPolicy::in_use().refinement {
        refined
    } else {
        period
    }
}

/// First tick and period of a clock with jitter and gaps. The regression begins with a few samples and doubles their number each
/// time, so that the ticks of the next ones are always known to less than half a period.
fn lock(time: &[f64]) -> Option<(f64, f64)> {
    let stride = (time.len() / 4).clamp(1, 16);
    let mut steps: Vec<f64> = time
        .windows(stride + 1)
        .map(|w| (w[stride] - w[0]) / stride as f64)
        .collect();
    let middle = steps.len() / 2;
    let mut period = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let mut start = time[0];
    let mut count = ClockPolicy::in_use().first.min(time.len());
    loop {
        for _ in 0..3 {
            start = phase(&time[..count], period);
            let ticks = |t: f64| ((t - start) / period).round();
            let n = count as f64;
            let mean_tick = time[..count].iter().map(|&t| ticks(t)).sum::<f64>() / n;
            let mean_time = time[..count].iter().sum::<f64>() / n;
            let (mut product, mut square) = (0.0, 0.0);
            for &t in &time[..count] {
                let tick = ticks(t) - mean_tick;
                product += tick * (t - mean_time);
                square += tick * tick;
            }
            let slope = product / square;
            if slope.is_nan() || slope <= 0.0 {
                return None;
            }
            (start, period) = (mean_time - slope * mean_tick, slope);
        }
        if count == time.len() {
            return Some((start, period));
        }
        count = (2 * count).min(time.len());
    }
}

/// The tick nearest to the first of `time`, s: the direction of the mean of the times' phases, which tolerates an error of half a
/// tick in the first time.
fn phase(time: &[f64], period: f64) -> f64 {
    let (sin, cos) = time.iter().fold((0.0, 0.0), |(sin, cos), t| {
        let (s, c) = (TAU * (t - time[0]) / period).sin_cos();
        (sin + s, cos + c)
    });
    time[0] + sin.atan2(cos) / TAU * period
}

/// The least-squares fit of `values` that never falls: falling neighbours are pooled.
fn isotonic(values: &[f64]) -> Vec<f64> {
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for &value in values {
        let mut pool = (value, 1);
        while let Some(&(mean, count)) = pools.last()
            && mean > pool.0
        {
            let total = count + pool.1;
            pool = (
                (mean * count as f64 + pool.0 * pool.1 as f64) / total as f64,
                total,
            );
            pools.pop();
        }
        pools.push(pool);
    }
    let pooled = pools.into_iter();
    pooled
        .flat_map(|(mean, count)| std::iter::repeat_n(mean, count))
        .collect()
}

/// The decimal step to which all of `time` were rounded, s; 0 if there is none above a nanosecond.
fn rounding(time: &[f64]) -> f64 {
    (0..=9)
        .map(|decimals| 10f64.powi(-decimals))
        .find(|step| {
            time.iter()
                .all(|t| (t / step - (t / step).round()).abs() < ClockPolicy::in_use().decimal)
        })
        .unwrap_or(0.0)
}

/// Whether the cubic through its four neighbours predicts each displacement better over the ticks than over the times.
fn smoother_over_ticks(time: &[f64], ticks: &[usize], displacement: &[f64]) -> bool {
    let left_out = |at: &dyn Fn(usize) -> f64| {
        let mut errors: Vec<f64> = (2..time.len().saturating_sub(2))
            .filter(|&index| ticks[index + 2] - ticks[index - 2] == 4)
            .map(|index| {
                let near = [index - 2, index - 1, index + 1, index + 2];
                let (mut error, mut variance) = (displacement[index], 1.0);
                for &j in &near {
                    let others = near.iter().filter(|&&k| k != j);
                    let weight: f64 = others
                        .map(|&k| (at(index) - at(k)) / (at(j) - at(k)))
                        .product();
                    error -= weight * displacement[j];
                    variance += weight * weight;
                }
                error.abs() / variance.sqrt()
            })
            .collect();
        let middle = errors.len() / 2;
        errors.sort_by(f64::total_cmp);
        errors.get(middle).copied().unwrap_or(0.0)
    };
    left_out(&|index| ticks[index] as f64) < left_out(&|index| time[index])
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
    f64::sqrt(sum / f64::max(count, 1.0))
}

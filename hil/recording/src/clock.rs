//! The clock behind a recording's times: equal steps, the tick of each sample, and the error of the times.

use std::f64::consts::TAU;

use mesh_damper_tables::channel::Channel;

use crate::extremes::{least_and_largest, quantile};
use crate::faults::kind::{ChannelFault, ChannelFaultKind};
use crate::noise::rms;
use crate::steady::{Steady, quantum};

crate::numbers! {
    /// How the clock behind a recording's times is found.
    ClockPolicy {
        /// If no time is off its tick by more than this fraction of a period, the samples are taken to lie on the ticks. At a velocity v
        /// the displacement is then off by at most this fraction of v·period.
        rounding: f64 = 0.05, Convention("the rounding of printed times");
        /// Times that are known only to a multiple of some step lie on the ticks too if none is off by more than this fraction of that step.
        rounded: f64 = 0.55, Derived("half a step, and a tenth of that for the error of the period");
        /// All times are multiples of a step if none is off one by more than this fraction of it.
        multiple: f64 = 0.05, Derived("covers the rounding when a time is read, in seconds since 1970");
        /// A time step of more than this many periods is a gap, after which the ticks may begin anywhere, and in times that follow no clock.
        gap: f64 = 1.75, Tuned("the injected channel faults");
        /// Uneven steps are due to rounding, and not to missing samples or wrong stamps, if at least this many of the rarer kind lie as
        /// evenly as rounding spreads them; fewer only if the displacement is smoother over equal steps.
        fewest_spread: usize = 9, Derived("nine values fall into nine equal parts, one into each, by chance once in a thousand: 9!/9⁹");
        /// The displacement decides between missing samples and rounding if it is smoother by this factor about the steps in question.
        smoother: f64 = 2.0, Convention("noise alone makes it as smooth over both");
        /// A clock may lack as many samples as this times those that follow the one before without a gap.
        most_missing: f64 = 4.0, Convention("a quarter of the samples is there");
        /// Steps are uneven by design, and do not jitter, if the step below which nine tenths of them lie is more than this many times that
        /// below which a tenth does.
        by_design: f64 = 3.0, Convention("no jitter that keeps the order of the samples makes such steps the rule");
        /// Samples whose steps are uneven by design are brought to the step below which this fraction of them lies.
        short: f64 = 0.1, Convention("one step in ten is shorter");
        /// Times follow no clock if their RMS deviation from the ticks exceeds this many periods.
        keeps_no_clock: f64 = 0.45, Tuned("the injected channel faults");
        /// Jitter is reported only if the RMS deviation of the times from the ticks exceeds this many periods.
        worth_saying: f64 = 0.03, Convention("the error of the velocity is then as small");
        /// The first estimate of a jittering clock uses this many samples.
        first: usize = 32, Tuned("the injected channel faults");
    }
}

/// Equal time steps at which, or about which, a recording's samples lie.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Clock {
    /// Time between ticks, s.
    pub period: f64,
    /// The tick of each sample relative to the first one's. It increases strictly, unless the steps are uneven by design.
    pub ticks: Vec<usize>,
    /// Whether the samples were taken on the ticks, whatever their times say.
    pub on_ticks: bool,
    /// RMS of the times from their ticks, periods; 0 if it is only rounding.
    pub jitter: f64,
    /// The shortest and the longest step, s, if they are uneven by design.
    pub uneven: Option<[f64; 2]>,
    /// Whether a row was written only where a value changed: it stays the same until the next.
    pub holds: bool,
}

/// A recording with uneven steps is brought to at most this many ticks. Convention: the size of a long recording, which is traced in
/// minutes.
pub(super) const MOST_TICKS: usize = 1 << 18;

/// A recording of more than [`MOST_TICKS`] with more of them per sample than this is refused: most of it is gaps.
pub(super) const MOST_TICKS_PER_SAMPLE: usize = 4;

impl Clock {
    /// The clock of `time`, s, increasing. `displacement`, which is smooth over time, shows whether jittering times are true.
    pub fn of(time: &[f64], displacement: &[f64]) -> Self {
        let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
        let mut steps: Vec<f64> = steps.collect();
        let [short, middle, long] =
            [ClockPolicy::in_use().short, 0.5, 0.9].map(|part| quantile(&mut steps, part));
        let uneven = (long > ClockPolicy::in_use().by_design * short).then(|| {
            let (shortest, longest) = least_and_largest(&steps);
            [shortest, longest]
        });
        let is_clock = |steady: &Steady| is_rounding(steady, time, displacement);
        if let Some(steady) = Steady::of(time, quantum(time), is_clock) {
            return Self {
                period: steady.period,
                ticks: steady.ticks,
                on_ticks: true,
                jitter: 0.0,
                uneven,
                holds: false,
            };
        }
        if let Some(steps) = uneven {
            return Self::uneven(time, short, steps);
        }
        if let Some(clock) = Self::jittering(time, displacement) {
            return clock;
        }
        // Times that wander: gaps are long steps, and ticks follow the times.
        let short = (steps.iter()).filter(|step| **step <= ClockPolicy::in_use().gap * middle);
        let (sum, count) = short.fold((0.0, 0.0), |(sum, count), step| (sum + step, count + 1.0));
        let period = sum / count;
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
            uneven: None,
            holds: false,
        }
    }

    /// Ticks of the length of a `short` step, s, as far as there is room for them.
    fn uneven(time: &[f64], short: f64, steps: [f64; 2]) -> Self {
        let span = time[time.len() - 1] - time[0];
        let most = MOST_TICKS.max(MOST_TICKS_PER_SAMPLE * time.len());
        let period = short.max(span / (most - 1) as f64);
        let tick = |time: f64| (time / period).round() as usize;
        Self {
            period,
            ticks: time.iter().map(|now| tick(now - time[0])).collect(),
            on_ticks: false,
            jitter: 0.0,
            uneven: Some(steps),
            holds: false,
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
        let on_ticks = is_smoother_over_ticks(time, &ticks, displacement);
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
            jitter,
            uneven: None,
            holds: false,
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
        let samples = gaps.iter().map(|(_, missing)| missing).sum();
        let kind = match self.uneven {
            _ if self.holds => ChannelFaultKind::ChangesOnly { samples },
            Some([shortest, longest]) => ChannelFaultKind::Uneven {
                shortest,
                longest,
                period: self.period,
            },
            None => ChannelFaultKind::Missing {
                samples,
                gaps: gaps.len(),
            },
        };
        if self.uneven.is_some() || samples > 0 {
            faults.push(ChannelFault { channel, kind });
        }
        faults
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

/// Whether rounding, with the steps of a clock between that of one quantum and two, explains why steps differ. A sample may be missing
/// instead where the step is two quanta, and a stamp may be wrong where it repeats.
fn is_rounding(steady: &Steady, time: &[f64], displacement: &[f64]) -> bool {
    let ClockPolicy {
        gap,
        fewest_spread,
        smoother,
        ..
    } = *ClockPolicy::in_use();
    if steady.period >= gap * steady.quantum {
        return true;
    }
    let repeats = steady.period < steady.quantum;
    let is_long = |index: usize| {
        let quanta = (time[index + 1] - time[index]) / steady.quantum;
        steady.ticks[index + 1] - steady.ticks[index] == 1
            && quanta > if repeats { 0.5 } else { 1.5 }
    };
    let long = (0..time.len() - 1).filter(|&index| is_long(index)).count();
    let rarer = long.min(time.len() - 1 - long);
    if repeats {
        return rarer >= fewest_spread;
    }
    if long == 0 {
        return true;
    }
    let about = |index: usize| (index - 2..index + 2).any(is_long);
    let [over_ticks, over_times] = roughness(time, &steady.ticks, displacement, about);
    if rarer >= fewest_spread {
        over_ticks <= smoother * over_times
    } else {
        smoother * over_ticks < over_times
    }
}

/// Whether the displacement is smoother over the ticks than over the times.
fn is_smoother_over_ticks(time: &[f64], ticks: &[usize], displacement: &[f64]) -> bool {
    let [over_ticks, over_times] = roughness(time, ticks, displacement, |_| true);
    over_ticks < over_times
}

/// How far each displacement usually is from the cubic through its four neighbours, over the ticks and over the times, for samples
/// without a gap near them that `count`.
fn roughness(
    time: &[f64],
    ticks: &[usize],
    displacement: &[f64],
    counts: impl Fn(usize) -> bool,
) -> [f64; 2] {
    let left_out = |at: &dyn Fn(usize) -> f64| {
        let mut errors: Vec<f64> = (2..time.len().saturating_sub(2))
            .filter(|&index| ticks[index + 2] - ticks[index - 2] == 4 && counts(index))
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
        quantile(&mut errors, 0.5)
    };
    [
        left_out(&|index| ticks[index] as f64),
        left_out(&|index| time[index]),
    ]
}

//! Times that do not increase, as far as they can be put right: a clock that was set, a counter that began again, stamps with too few
//! digits.

use mesh_damper_tables::channel::Channel;

use crate::clock::ClockPolicy;
use crate::extremes::quantile;
use crate::faults::kind::{ChannelFault, ChannelFaultKind};
use crate::steady::{Steady, quantum};

/// Summer time, s.
const HOUR: f64 = 3600.0;
/// Widths of counters, bits.
const BITS: [i32; 5] = [8, 12, 16, 24, 32];
/// The least width of a counter that begins again where the times began: blocks of a narrower one are as likely tests.
const SURE: i32 = 16;
/// What one count may be, times a power of ten in the unit of the times.
const COUNTS: [f64; 4] = [1.0, 2.0, 2.5, 5.0];
/// A counter of time has a range of at least this many steps of the usual length. Derived: the range is known to half a step, and there
/// are about nine ranges to each factor of ten, so that another time is taken for one in a hundred.
const FEWEST_STEPS: f64 = 1000.0;

/// Puts `time`, s, right where that is certain; what was put right. It may still fall or stand still afterwards. Dates (`are_dates`) may
/// pass into summer time; other times may come from a counter in `unit`, s.
pub(super) fn put_right(time: &mut [f64], are_dates: bool, unit: f64) -> Vec<ChannelFault> {
    let found = if are_dates {
        summer_time(time)
    } else {
        counter(time, unit)
    };
    let spread = spread_stamps(time);
    let kinds = found.into_iter().chain(spread);
    let channel = Channel::Time;
    kinds.map(|kind| ChannelFault { channel, kind }).collect()
}

/// The usual step of times that increase, s.
fn usual_step(time: &[f64]) -> f64 {
    let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
    quantile(
        &mut steps.filter(|step| *step > 0.0).collect::<Vec<_>>(),
        0.5,
    )
}

/// Goes on after each step of the time that `change` gives a value for, as if the clock had not been changed by that much.
fn go_on(time: &mut [f64], change: impl Fn(f64) -> Option<f64>) -> (f64, usize) {
    let (mut changed, mut last, mut times) = (0.0, 0.0, 0);
    let mut before = time[0];
    for now in &mut time[1..] {
        let step = *now - before;
        before = *now;
        if let Some(change) = change(step) {
            changed -= change;
            last = change;
            times += 1;
        }
        *now += changed;
    }
    (last, times)
}

/// A clock that was put back or forward by an hour, between two samples that follow each other. An hour without samples is not taken
/// for one: it would have to end to within half a step of an hour, once only.
fn summer_time(time: &mut [f64]) -> Option<ChannelFaultKind> {
    let usual = usual_step(time);
    let change = |step: f64| {
        let set = HOUR.copysign(step - usual);
        ((step - usual - set).abs() <= 0.5 * usual).then_some(set)
    };
    let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
    let is_large = |step: &f64| *step < 0.0 || *step > 0.5 * HOUR;
    let large: Vec<f64> = steps.filter(is_large).collect();
    let &[only] = &large[..] else { return None };
    change(only)?;
    let (change, times) = go_on(time, change);
    Some(ChannelFaultKind::ClockSet {
        change,
        times,
        is_counter: false,
    })
}

/// A counter that began again from its lowest value, which fell by its range less one step.
fn counter(time: &mut [f64], unit: f64) -> Option<ChannelFaultKind> {
    let usual = usual_step(time);
    let first = time.windows(2).map(|pair| pair[1] - pair[0]);
    let fall = first.filter(|step| *step < 0.0).reduce(f64::min)?;
    let falls = |pair: &[f64]| pair[1] < pair[0] && (pair[1] - time[0]).abs() <= 0.5 * usual;
    let begins_again = time.windows(2).any(falls);
    let range = range_of((usual - fall) / unit, 0.5 * usual / unit, begins_again)? * unit;
    let is_fall = |step: f64| step < 0.0 && (usual - step - range).abs() <= 0.5 * usual;
    let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
    if steps.clone().any(|step| step < 0.0 && !is_fall(step)) {
        return None;
    }
    let (change, times) = go_on(time, |step| is_fall(step).then_some(-range));
    Some(ChannelFaultKind::ClockSet {
        change,
        times,
        is_counter: true,
    })
}

/// The range of a counter that is `about` so large, to within `off`. It may begin again where the times began.
fn range_of(about: f64, off: f64, begins_again: bool) -> Option<f64> {
    if about < 2.0 * FEWEST_STEPS * off {
        return None;
    }
    let widths = BITS.iter().filter(|bits| !begins_again || **bits >= SURE);
    let ranges = widths.flat_map(|bits| {
        let counts = &COUNTS[..if begins_again { 1 } else { COUNTS.len() }];
        counts.iter().map(move |count| {
            let range = 2.0_f64.powi(*bits) * count;
            range * 10.0_f64.powf((about / range).log10().round())
        })
    });
    let apart = |range: &f64| (range - about).abs();
    let nearest = ranges.min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    (apart(&nearest) <= off).then_some(nearest)
}

/// Times that repeat because they have too few digits: the equal steps behind them.
fn spread_stamps(time: &mut [f64]) -> Option<ChannelFaultKind> {
    let mut steps = time.windows(2).map(|pair| pair[1] - pair[0]);
    if !steps.clone().any(|step| step == 0.0) || steps.any(|step| step < 0.0) {
        return None;
    }
    let repeats = |steady: &Steady| {
        let repeated = time.windows(2).filter(|pair| pair[0] == pair[1]).count();
        steady.period < steady.quantum && repeated >= ClockPolicy::in_use().fewest_spread
    };
    let steady = Steady::of(time, quantum(time), repeats)?;
    let first = time[0];
    for (now, tick) in time.iter_mut().zip(&steady.ticks) {
        *now = first + *tick as f64 * steady.period;
    }
    Some(ChannelFaultKind::Stamps {
        period: steady.period,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults(time: &mut [f64], are_dates: bool, unit: f64) -> String {
        let found = put_right(time, are_dates, unit);
        let each = found.iter().map(ToString::to_string);
        each.collect::<Vec<_>>().join("; ")
    }

    fn are_steps(time: &[f64], step: f64) {
        for (index, now) in time.iter().enumerate() {
            let off = now - time[0] - step * index as f64;
            assert!(off.abs() < 1e-6 * step.max(1.0), "{index}: {now} s");
        }
    }

    #[test]
    fn a_counter_that_begins_again_goes_on() {
        // Of 16 bits in ms, of 32 bits in µs, and the same with a sign.
        for (range, unit, lowest, step) in [
            (65_536.0, 1e-3, 0.0, 2.0),
            (4_294_967_296.0, 1e-6, 0.0, 500.0),
            (4_294_967_296.0, 1e-6, -2_147_483_648.0, 1250.0),
        ] {
            let begin = 0.99 * range;
            let wrapped = |n: usize| (begin + step * n as f64) % range + lowest;
            let mut time: Vec<f64> = (0..90_000).map(|n| unit * wrapped(n)).collect();
            let said = faults(&mut time, false, unit);
            assert!(said.contains("the counter of time began again"), "{said}");
            are_steps(&time, unit * step);
        }
    }

    #[test]
    fn a_test_that_begins_again_is_no_counter() {
        for length in [1237, 4000, 7919] {
            let again = (0..2 * length).map(|n| 0.01 * f64::from(n % length));
            let mut time: Vec<f64> = again.collect();
            let before = time.clone();
            assert_eq!(faults(&mut time, false, 1.0), "", "{length}");
            assert_eq!(time, before);
        }
    }

    #[test]
    fn summer_time_begins_and_ends_for_dates_alone() {
        for (set, word) in [(3600.0, "forward"), (-3600.0, "back")] {
            let shown = |n: usize| 0.05 * n as f64 + if n < 700 { 0.0 } else { set };
            let times: Vec<f64> = (0..2000).map(shown).collect();
            let mut dates = times.clone();
            let said = faults(&mut dates, true, 1.0);
            assert!(said.contains(&format!("{word} by 3600 s")), "{said}");
            are_steps(&dates, 0.05);
            let mut seconds = times.clone();
            assert_eq!(faults(&mut seconds, false, 1.0), "");
            assert_eq!(seconds, times);
        }
        // An hour's pause.
        let paused = |n: usize| 0.05 * n as f64 + if n < 700 { 0.0 } else { 3600.2 };
        let mut pause: Vec<f64> = (0..2000).map(paused).collect();
        assert_eq!(faults(&mut pause, true, 1.0), "");
    }

    #[test]
    fn stamps_of_a_second_are_spread() {
        for rate in [7.0, 20.0, 33.0] {
            let stamp = |n: usize| (n as f64 / rate + 0.37).floor();
            let mut time: Vec<f64> = (0..3000).map(stamp).collect();
            assert!(faults(&mut time, true, 1.0).contains("spread evenly"));
            let found = 2999.0 / (time[2999] - time[0]);
            assert!((found / rate - 1.0).abs() < 1e-3, "{found} Hz");
        }
        // One stamp that is written twice is an error of the file.
        let mut time: Vec<f64> = (0..300).map(|n| 0.01 * f64::from(n)).collect();
        time[40] = time[39];
        assert_eq!(faults(&mut time, false, 1.0), "");
    }
}

//! A channel that has a new value in some rows only, held or interpolated between them: its converter is slower than the rows.
//!
//! Rows without a new value are no measurements. They look like a force without noise, and like one that is late.

use mesh_damper_tables::channel::Channel;

use super::super::Recording;
use super::super::steady::Steady;
use super::clipping::rounding;
use super::kind::{Between, ChannelFault, ChannelFaultKind};
use super::{FaultsPolicy, spread};
use crate::FEWEST_SAMPLES;
use crate::extremes::quantile;

crate::numbers! {
    /// When a channel is slower than the rows.
    SlowerPolicy {
        /// At most this fraction of the new values follow each other without a row between them.
        adjacent: f64 = 0.02, Convention("one in fifty, as where a recording was joined");
        /// At least this fraction of the new values come the usual number of rows after the last, or one row more or less.
        usual: f64 = 0.7, Convention("some values are equal by chance, or on the line between their neighbours");
        /// A value lies on the line between its neighbours if it is off by at most this many times the usual distance.
        on_line: f64 = 6.0, Convention("the usual distance is that of the last digit, of which three values have one each");
        /// A value is new if it is off the line between its neighbours by at least this many times what lies on it.
        off_line: f64 = 4.0, Convention("four times the last digit");
        /// Interpolated values are searched for where a value is new in at least one row of this many.
        most_rows: f64 = 16.0, Convention("a motion with corners farther apart is no interpolation");
        /// A displacement whose way from turn to turn is one line by this fraction has corners.
        of_one_line: f64 = 0.75, Derived("of a sine with five values a period, the longest line is at most 0.63 of the way");
        /// A coarse channel changes by its last digit only; a slower one does so in at most this fraction of its changes.
        digits: f64 = 0.8, Convention("a slow motion with noise has larger changes too");
        /// A channel changes in fewer rows than this fraction if it is slower; otherwise there is nothing to see.
        fewest_equal: f64 = 0.4, Derived("in every second row, and some for chance");
    }
}

/// Keeps the rows in which the slower of displacement and force has a new value.
pub(super) fn repair(recording: &mut Recording) -> bool {
    let channels = [
        (Channel::Force, &recording.force),
        (Channel::Displacement, &recording.displacement),
    ];
    let found = channels.into_iter().filter_map(|(channel, values)| {
        let (rows, between) = new_rows(values, &recording.displacement)?;
        Some((channel, rows, between))
    });
    let Some((channel, rows, between)) = found.min_by_key(|(_, rows, _)| rows.len()) else {
        return false;
    };
    let steps = rows[rows.len() - 1] - rows[0];
    let kind = ChannelFaultKind::Slower {
        rows: steps as f64 / (rows.len() - 1) as f64,
        between,
    };
    let mut is_kept = vec![false; recording.len()];
    for row in rows {
        is_kept[row] = true;
    }
    recording.keep(&is_kept);
    recording.faults.push(ChannelFault { channel, kind });
    true
}

/// The rows in which a slower channel has a new value, and what stands between them. With corners in the motion, a force has them too.
fn new_rows(values: &[f64], displacement: &[f64]) -> Option<(Vec<usize>, Between)> {
    // Sorts the channel. Most are at their full rate, and need no digit.
    let digit = || rounding(values, FaultsPolicy::in_use().same_value * spread(values));
    // What stands in the first row may be older.
    let held = (1..values.len()).filter(|&row| values[row] != values[row - 1]);
    let held: Vec<usize> = held.collect();
    let bends: Vec<f64> = values
        .windows(3)
        .map(|three| (three[2] - 2.0 * three[1] + three[0]).abs())
        .collect();
    let found = match regular(&held, values.len()) {
        Some(rows) => (rows, Between::Held),
        None => {
            let rows = regular(&knots(&bends, digit)?, values.len())?;
            if turns_at_each(displacement, &rows) {
                return None;
            }
            (rows, Between::Interpolated)
        }
    };
    // A slow motion crosses the digits of a coarse converter in equal times too.
    let one_and_a_half = 1.5 * digit();
    let by_digit = held.iter();
    let by_digit = by_digit.filter(|&&row| (values[row] - values[row - 1]).abs() < one_and_a_half);
    let is_coarse = by_digit.count() as f64 > SlowerPolicy::in_use().digits * held.len() as f64;
    (!is_coarse).then_some(found)
}

/// Whether the displacement goes from turn to turn by one line, and hardly by others: it is a motion with corners, as a triangle or a
/// trapezoid. A slower converter takes more values on the way.
fn turns_at_each(displacement: &[f64], rows: &[usize]) -> bool {
    let lines: Vec<f64> = rows
        .windows(2)
        .map(|pair| displacement[pair[1]] - displacement[pair[0]])
        .collect();
    let (mut longest, mut all) = (0.0, 0.0);
    for way in lines.chunk_by(|a, b| a * b > 0.0) {
        longest += way.iter().fold(0.0_f64, |most, line| most.max(line.abs()));
        all += way.iter().sum::<f64>().abs();
    }
    longest >= SlowerPolicy::in_use().of_one_line * all
}

/// The rows at which lines between values meet. Between two rows both bend, the nearer one more.
fn knots(bends: &[f64], digit: impl FnOnce() -> f64) -> Option<Vec<usize>> {
    let SlowerPolicy {
        on_line,
        off_line,
        most_rows,
        ..
    } = *SlowerPolicy::in_use();
    // Of a line with few knots, more than half of the values are on it.
    let usual = quantile(&mut bends.to_vec(), 0.4);
    let large = quantile(&mut bends.to_vec(), 1.0 - 1.0 / most_rows);
    // The digit is asked for only where it may matter.
    if large < off_line * on_line * usual {
        return None;
    }
    let on = (on_line * usual).max(2.5 * digit());
    if large < off_line * on {
        return None;
    }
    let at = |row: usize| bends.get(row).copied().unwrap_or(0.0);
    let is_knot = |&row: &usize| {
        let before = if row > 0 { at(row - 1) } else { 0.0 };
        at(row) > on && at(row) >= before && at(row) > at(row + 1)
    };
    Some(
        (0..bends.len())
            .filter(is_knot)
            .map(|row| row + 1)
            .collect(),
    )
}

/// These rows if new values come in equal steps of two rows and more, some of them missing by chance.
fn regular(rows: &[usize], count: usize) -> Option<Vec<usize>> {
    let SlowerPolicy {
        adjacent,
        usual,
        fewest_equal,
        ..
    } = *SlowerPolicy::in_use();
    if rows.len() < FEWEST_SAMPLES || rows.len() as f64 > (1.0 - fewest_equal) * count as f64 {
        return None;
    }
    let mut steps: Vec<f64> = rows
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) as f64)
        .collect();
    let part = |is: &dyn Fn(f64) -> bool| {
        let such = steps.iter().filter(|step| is(**step)).count();
        such as f64 / steps.len() as f64
    };
    let close = part(&|step| step < 1.5);
    if close > adjacent {
        return None;
    }
    let middle = quantile(&mut steps.clone(), 0.5);
    if part(&|step| (step - middle).abs() < 1.5) < usual {
        return None;
    }
    steps.clear();
    // The first rows of a hold are on the clock of the slower converter.
    let on_clock: Vec<f64> = rows.iter().map(|&row| row as f64).collect();
    let steady = Steady::of(&on_clock, 1.0, |steady| steady.period > 1.5)?;
    // With most steps missing any rows would be on it.
    let ticks = &steady.ticks;
    let missing = ticks[ticks.len() - 1] as f64 / rows.len() as f64;
    if missing >= 1.0 / usual {
        return None;
    }
    // A value that is equal to the one before, or on a line, is new too.
    let pairs = rows.windows(2).zip(ticks.windows(2));
    let each = pairs.flat_map(|(rows, ticks)| {
        let step = (rows[1] - rows[0]) as f64 / (ticks[1] - ticks[0]) as f64;
        (0..ticks[1] - ticks[0]).map(move |n| rows[0] + (n as f64 * step).round() as usize)
    });
    let last = rows[rows.len() - 1];
    Some(each.chain([last]).collect())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand::rngs::StdRng;
    use rand_distr::{Distribution, Normal};

    use super::*;

    /// A force with friction and noise at a sample of the faster clock, rounded to the last digit.
    fn measured(count: usize, noise: f64, digit: f64, seed: u64) -> Vec<f64> {
        let mut random = StdRng::seed_from_u64(seed);
        let normal = Normal::new(0.0, noise).unwrap();
        (0..count)
            .map(|n| {
                let turn = TAU * n as f64 / 180.0;
                let force = 0.4 * turn.sin() + 0.1 * (20.0 * turn.cos()).tanh();
                ((force + normal.sample(&mut random)) / digit).round() * digit
            })
            .collect()
    }

    /// The displacement of that test.
    fn moved(count: usize) -> Vec<f64> {
        (0..count).map(|n| (TAU * n as f64 / 180.0).sin()).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn held_values_are_found_where_they_are_new(rows in 2.0..12.0_f64, phase in 0.0..1.0_f64, seed: u64) {
            let truth = measured(6000, 0.002, 1e-6, seed);
            let new: Vec<usize> = (0..6000).filter(|&n| {
                n == 0 || (n as f64 / rows + phase).floor() > ((n - 1) as f64 / rows + phase).floor()
            }).collect();
            let mut values = truth.clone();
            for pair in new.windows(2) {
                values[pair[0]..pair[1]].fill(truth[pair[0]]);
            }
            values[new[new.len() - 1]..].fill(truth[new[new.len() - 1]]);
            let (found, between) = new_rows(&values, &moved(6000)).expect("held values");
            prop_assert_eq!(between, Between::Held);
            prop_assert_eq!(&found[..], &new[1..]);
        }

        #[test]
        fn interpolated_values_are_found_where_they_are_new(rows in 2_usize..12, phase in 0_usize..2, seed: u64) {
            let truth = measured(6000, 0.002, 1e-6, seed);
            let mut values = truth.clone();
            let new: Vec<usize> = (phase..6000).step_by(rows).collect();
            for pair in new.windows(2) {
                for (n, value) in values[pair[0]..pair[1]].iter_mut().enumerate() {
                    let part = n as f64 / rows as f64;
                    let line = truth[pair[0]] + part * (truth[pair[1]] - truth[pair[0]]);
                    *value = (line * 1e6).round() / 1e6;
                }
            }
            let last = new[new.len() - 1];
            values[last..].fill(truth[last]);
            values[..new[0]].fill(truth[new[0]]);
            let (found, between) = new_rows(&values, &moved(6000)).expect("interpolated values");
            prop_assert_eq!(between, Between::Interpolated);
            let are_new = found.iter().all(|row| new.contains(row));
            prop_assert!(are_new && found.len() + 4 >= new.len(), "{} of {}", found.len(), new.len());
        }

        /// A motion with corners at equal distances: a triangle, also one that grows, or a trapezoid.
        #[test]
        fn a_motion_with_corners_is_not_slower(rows in 3_usize..24, growth in 0.0..1.0_f64, hold: bool, noise in 0.0..1e-4_f64, seed: u64) {
            let mut random = StdRng::seed_from_u64(seed);
            let normal = Normal::new(0.0, noise).unwrap();
            let corner = |number: usize| {
                let place = if hold { [1.0, 1.0, -1.0, -1.0][number % 4] } else { [1.0, -1.0][number % 2] };
                place * (1.0 - growth + growth * (number * rows) as f64 / 6000.0)
            };
            let values: Vec<f64> = (0..6000)
                .map(|n| {
                    let (number, part) = (n / rows, (n % rows) as f64 / rows as f64);
                    let line = (1.0 - part) * corner(number) + part * corner(number + 1);
                    ((line + normal.sample(&mut random)) * 1e6).round() / 1e6
                })
                .collect();
            prop_assert_eq!(new_rows(&values, &values), None, "the displacement");
            let force: Vec<f64> = values.iter().map(|y| 0.3 * y).collect();
            prop_assert_eq!(new_rows(&force, &values), None, "an elastic force");
        }

        /// A coarse converter repeats values too, and so does a force without noise.
        #[test]
        fn a_coarse_channel_is_not_slower(noise in 0.0..0.004_f64, digit in 1e-6..0.01_f64, seed: u64) {
            let values = measured(6000, noise, digit, seed);
            prop_assert_eq!(new_rows(&values, &moved(6000)), None);
        }
    }
}
